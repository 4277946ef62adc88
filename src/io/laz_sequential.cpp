#include "laz_sequential.h"

#include <algorithm>
#include <cstring>

#include "hydrotin/error.h"

namespace hydrotin {
namespace {
constexpr std::size_t kWindow = std::size_t{1} << 20U;
constexpr std::size_t kBlock = PointwiseDecoder::kPointsPerCheck;
}  // namespace

LazSequential::LazSequential(const LasSource& source, const LazLayout& layout, std::uint64_t begin,
                             std::uint64_t chunk_size)
    : source_(source),
      record_length_(layout.record_length),
      chunk_size_(chunk_size),
      chunk_begin_{begin},
      decoder_(layout) {}

LazSequential::Turn LazSequential::seek(std::uint64_t point) {
  Turn turn(mutex_);
  const std::uint64_t chunk = std::min<std::uint64_t>(point / chunk_size_, chunk_begin_.size() - 1);
  if (point_ > point || point_ < chunk * chunk_size_) {
    point_ = chunk * chunk_size_;
    window_begin_ = window_end_ = chunk_begin_[static_cast<std::size_t>(chunk)];
    decoder_.rebase(window_.data(), window_.data());
  }
  std::vector<std::uint8_t> skipped(kBlock * record_length_);
  while (point_ < point) {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(kBlock, point - point_));
    const std::uint64_t first = point_;
    if (!read(count, skipped.data()))
      throw Error(ErrorKind::input, source_.path() + ": the compressed points from " + std::to_string(first) +
                                        " on are damaged or cut off (get the file again)");
  }
  return turn;
}

bool LazSequential::read(std::size_t count, std::uint8_t* records) {
  while (count > 0) {
    const std::size_t some = std::min(count, kBlock);
    if (!read_some(some, records)) {
      point_ = ~std::uint64_t{0};  // what comes next is unknown: a later seek starts afresh
      return false;
    }
    records += some * record_length_;
    count -= some;
  }
  return true;
}

bool LazSequential::read_some(std::size_t count, std::uint8_t* records) {
  while (count > 0) {
    fill();
    const std::uint8_t* const end = window_.data() + (window_end_ - window_begin_);
    const std::uint64_t in_chunk = point_ % chunk_size_;
    if (in_chunk == 0) {
      const std::uint64_t at = window_begin_ + static_cast<std::uint64_t>(decoder_.next() - window_.data());
      if (point_ / chunk_size_ == chunk_begin_.size()) chunk_begin_.push_back(at);
      if (!decoder_.start(decoder_.next(), end)) return false;
    }
    const auto some = static_cast<std::size_t>(std::min<std::uint64_t>(count, chunk_size_ - in_chunk));
    if (!decoder_.read(some, records)) return false;
    point_ += some;
    records += some * record_length_;
    count -= some;
  }
  return true;
}

// Makes sure that the window holds all that the next block of points can take, or all there is.
void LazSequential::fill() {
  const std::size_t need = kBlock * PointwiseDecoder::max_point_bytes(record_length_) + record_length_;
  const auto used = static_cast<std::size_t>(decoder_.next() - window_.data());
  const auto held = static_cast<std::size_t>(window_end_ - window_begin_) - used;
  if (held >= need || (window_end_ == source_.size() && !window_.empty())) return;
  std::vector<std::uint8_t> next(std::max(kWindow, 2 * need) + need);
  if (held > 0) std::memcpy(next.data(), window_.data() + used, held);
  const std::uint64_t from = window_begin_ + used;
  const auto more =
      static_cast<std::size_t>(std::min<std::uint64_t>(next.size() - need - held, source_.size() - window_end_));
  source_.read(window_end_, next.data() + held, more);
  window_ = std::move(next);
  window_begin_ = from;
  window_end_ = from + held + more;
  decoder_.rebase(window_.data(), window_.data() + held + more);
}

}  // namespace hydrotin
