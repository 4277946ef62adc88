#include "hydrotin/las_summary.h"

#include <algorithm>
#include <cassert>
#include <cstdio>

#include "hydrotin/error.h"

namespace hydrotin {
namespace {

constexpr std::uint64_t kPrime = (std::uint64_t{1} << 61U) - 1;
constexpr std::uint64_t kBase = 0x0A3C59AC2E2D5A47ULL;  // any number below the prime

std::uint64_t multiply(std::uint64_t a, std::uint64_t b) {
  __extension__ using Wide = unsigned __int128;
  const Wide product = static_cast<Wide>(a) * b;
  const std::uint64_t folded =
      static_cast<std::uint64_t>(product & kPrime) + static_cast<std::uint64_t>(product >> 61U);
  return folded >= kPrime ? folded - kPrime : folded;
}

std::uint64_t sum(std::uint64_t a, std::uint64_t b) {
  return a + b >= kPrime ? a + b - kPrime : a + b;
}

std::uint64_t power(std::uint64_t base, std::uint64_t exponent) {
  std::uint64_t result = 1;
  for (; exponent > 0; exponent >>= 1U, base = multiply(base, base))
    if ((exponent & 1U) != 0) result = multiply(result, base);
  return result;
}

std::uint64_t scramble(std::uint64_t word) {  // the finaliser of splitmix64
  word = (word ^ (word >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  word = (word ^ (word >> 27U)) * 0x94D049BB133111EBULL;
  return word ^ (word >> 31U);
}

}  // namespace

void LasTally::add(const PointBatch& batch) {
  assert(batch.classification.size() == batch.size() && batch.flags.size() == batch.size());
  const std::array<const std::vector<std::int32_t>*, 3> axes{&batch.x, &batch.y, &batch.z};
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const std::int32_t value : *axes[axis]) {
      min_[axis] = std::min(min_[axis], value);
      max_[axis] = std::max(max_[axis], value);
    }
  for (const std::uint8_t code : batch.classification) ++classes_[code];
  for (const std::uint8_t flags : batch.flags) withheld_ += (flags & PointFlag::withheld) != 0 ? 1 : 0;
  if (with_checksum_) add_checksum(batch);
  points_ += batch.size();
}

void LasTally::add_checksum(const PointBatch& batch) {
  assert(batch.return_number.size() == batch.size());
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const auto x = static_cast<std::uint32_t>(batch.x[i]), y = static_cast<std::uint32_t>(batch.y[i]);
    const auto z = static_cast<std::uint32_t>(batch.z[i]);
    const std::uint64_t attributes = std::uint64_t{batch.classification[i]} | (std::uint64_t{batch.flags[i]} << 8U) |
                                     (std::uint64_t{batch.return_number[i]} << 16U) |
                                     (std::uint64_t{batch.number_of_returns[i]} << 24U);
    const std::uint64_t low = scramble((std::uint64_t{x} << 32U) | y);
    const std::uint64_t digit = scramble(low ^ ((std::uint64_t{z} << 32U) | attributes)) % kPrime;
    checksum_ = sum(multiply(checksum_, kBase), digit);
  }
}

void LasTally::append(const LasTally& later) {
  assert(with_checksum_ == later.with_checksum_);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    min_[axis] = std::min(min_[axis], later.min_[axis]);
    max_[axis] = std::max(max_[axis], later.max_[axis]);
  }
  for (std::size_t code = 0; code < classes_.size(); ++code) classes_[code] += later.classes_[code];
  withheld_ += later.withheld_;
  if (with_checksum_) checksum_ = sum(multiply(checksum_, power(kBase, later.points_)), later.checksum_);
  points_ += later.points_;
}

LasSummary summarize_las(const std::string& path, bool with_checksum) {
  LasSummary summary;
  summary.header = read_las_header(path);
  summary.tally = LasTally(with_checksum);
  try {
    const LasFile file(path);
    summary.header = file.header();
    PointBatch batch;
    for (std::size_t chunk = 0; chunk < file.num_chunks(); ++chunk) {
      file.decode(chunk, batch, {.classification = true, .flags = true, .returns = with_checksum});
      summary.tally.add(batch);
    }
  } catch (const Error& error) {  // incomplete files are what this summary is there to tell about
    if (error.kind() != ErrorKind::input) throw;
    summary.complete = false;
    summary.problem = error.what();
  }
  if (summary.tally.points() > 0)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double scale = summary.header.scale[axis], offset = summary.header.offset[axis];
      summary.min[axis] = summary.tally.min()[axis] * scale + offset;
      summary.max[axis] = summary.tally.max()[axis] * scale + offset;
    }
  if (with_checksum && summary.complete) {
    // The length keeps apart files that differ only in leading points of digit zero.
    std::array<char, 17> text{};
    std::snprintf(
        text.data(), text.size(), "%016llx",
        static_cast<unsigned long long>(scramble(summary.tally.checksum() ^ scramble(summary.tally.points()))));
    summary.checksum = text.data();
  }
  return summary;
}

}  // namespace hydrotin
