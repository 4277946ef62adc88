#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <map>
#include <vector>

/// An arithmetic encoder written from Said's report, slow and plain: the other side of what the reader decodes.
namespace hydrotin::testing {

/// Frequencies of the symbols 0 .. n - 1; the scaled distribution changes only every so often.
class SlowModel {
 public:
  explicit SlowModel(std::uint32_t n) : count_(n, 1), begin_(n) {
    cycle_ = n;
    rescale();
    cycle_ = left_ = (n + 6) / 2;
  }
  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(count_.size()); }
  [[nodiscard]] std::uint32_t begin(std::uint32_t symbol) const { return begin_[symbol]; }
  void saw(std::uint32_t symbol) {
    ++count_[symbol];
    if (--left_ == 0) rescale();
  }

 private:
  void rescale() {
    total_ += cycle_;
    if (total_ > 32768) {
      total_ = 0;
      for (auto& c : count_) total_ += c = (c + 1) / 2;
    }
    const std::uint32_t scale = 0x80000000U / total_;
    std::uint32_t sum = 0;
    for (std::size_t i = 0; i < count_.size(); ++i) {
      begin_[i] = static_cast<std::uint32_t>((std::uint64_t{scale} * sum) >> 16U);
      sum += count_[i];
    }
    cycle_ = left_ = std::min(cycle_ * 5 / 4, (size() + 6) * 8);
  }
  std::vector<std::uint32_t> count_, begin_;
  std::uint32_t total_ = 0, cycle_ = 0, left_ = 0;
};

class SlowBitModel {
 public:
  [[nodiscard]] std::uint32_t zero() const { return zero_; }
  void saw(std::uint32_t bit) {
    zeros_ += 1 - bit;
    if (--left_ > 0) return;
    total_ += cycle_;
    if (total_ > 8192) {
      total_ = (total_ + 1) / 2;
      zeros_ = (zeros_ + 1) / 2;
      if (zeros_ == total_) ++total_;
    }
    zero_ = static_cast<std::uint32_t>((std::uint64_t{zeros_} * (0x80000000U / total_)) >> 18U);
    cycle_ = left_ = std::min(cycle_ * 5 / 4, 64U);
  }

 private:
  std::uint32_t zeros_ = 1, total_ = 2, zero_ = 4096, cycle_ = 4, left_ = 4;
};

class SlowEncoder {
 public:
  void symbol(SlowModel& model, std::uint32_t s) {
    const std::uint32_t step = length_ >> 15U, low = model.begin(s) * step;
    narrow(low, s + 1 == model.size() ? length_ - low : model.begin(s + 1) * step - low);
    model.saw(s);
  }
  void bit(SlowBitModel& model, std::uint32_t b) {
    const std::uint32_t split = model.zero() * (length_ >> 13U);
    narrow(b != 0 ? split : 0, b != 0 ? length_ - split : split);
    model.saw(b);
  }
  void bits(std::uint32_t n, std::uint32_t value) {
    if (n > 19) {
      bits(16, value & 0xFFFFU);
      bits(n - 16, value >> 16U);
      return;
    }
    const std::uint32_t step = length_ >> n;
    narrow(value * step, step);
  }
  /// Ends the stream; a decoder that has read all symbols has then read all bytes.
  std::vector<std::uint8_t> done() {
    if (length_ > 0x2000000U) {
      narrow(0x1000000U, 0x800000U);
      out_.push_back(0);
    } else {
      narrow(0x800000U, 0x8000U);
    }
    out_.insert(out_.end(), 2, 0);
    return std::move(out_);
  }

 private:
  void narrow(std::uint32_t low, std::uint32_t length) {
    const std::uint32_t before = base_;
    base_ += low;
    length_ = length;
    if (base_ < before)
      for (std::size_t i = out_.size(); ++out_[--i] == 0;) {
      }
    for (; length_ < 0x1000000U; length_ <<= 8U, base_ <<= 8U) out_.push_back(static_cast<std::uint8_t>(base_ >> 24U));
  }
  std::uint32_t base_ = 0, length_ = 0xFFFFFFFFU;
  std::vector<std::uint8_t> out_;
};

/// Integers of `bits` bits as corrections of predictions.
class SlowInteger {
 public:
  explicit SlowInteger(std::uint32_t bits, std::size_t contexts = 1)
      : bits_(bits), class_(contexts, SlowModel(bits + 1)) {}

  void encode(SlowEncoder& to, std::uint32_t predicted, std::uint32_t real, std::size_t context = 0) {
    std::int64_t c = std::int64_t{real} - std::int64_t{predicted};  // folded into [-2^(bits-1), 2^(bits-1))
    const std::int64_t range = std::int64_t{1} << bits_;
    while (c < -range / 2) c += range;
    while (c >= range / 2) c -= range;
    std::uint32_t k = 0;  // the least k with -(2^k - 1) <= c <= 2^k
    while (c > (std::int64_t{1} << k) || c < 1 - (std::int64_t{1} << k)) ++k;
    to.symbol(class_[context], k);
    if (k == 32) return;
    if (k == 0) {
      to.bit(unit_, static_cast<std::uint32_t>(c));
      return;
    }
    const auto place = static_cast<std::uint32_t>(c < 0 ? c + (std::int64_t{1} << k) - 1 : c - 1);
    const std::uint32_t low = k > 8 ? k - 8 : 0;
    const auto model = place_.try_emplace(k, 1U << (k - low)).first;
    to.symbol(model->second, place >> low);
    if (low > 0) to.bits(low, place & ((1U << low) - 1));
  }

 private:
  std::uint32_t bits_;
  std::vector<SlowModel> class_;
  SlowBitModel unit_;
  std::map<std::uint32_t, SlowModel> place_;
};

}  // namespace hydrotin::testing
