#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace hydrotin {

/// A sum of real numbers that does not depend on the order of addition, nor on how the terms were grouped: each term is
/// rounded to a multiple of 2^-40 once, then integers of 128 bits are added.
class ExactSum {
 public:
  ExactSum() = default;
  /// From what `high` and `low` gave.
  ExactSum(std::int64_t high, std::uint64_t low) : value_((static_cast<Wide>(high) * (Wide{1} << 64)) | low) {}

  /// Terms beyond 2^70 count as that.
  void add(double term) {
    constexpr double kLargest = 0x1p110;
    value_ += static_cast<Wide>(std::nearbyint(std::clamp(std::ldexp(term, kFractionBits), -kLargest, kLargest)));
  }
  void add(const ExactSum& other) { value_ += other.value_; }

  [[nodiscard]] double value() const { return std::ldexp(static_cast<double>(value_), -kFractionBits); }
  [[nodiscard]] std::int64_t high() const { return static_cast<std::int64_t>(value_ >> 64); }
  [[nodiscard]] std::uint64_t low() const { return static_cast<std::uint64_t>(value_); }
  friend bool operator==(const ExactSum&, const ExactSum&) = default;

 private:
  __extension__ using Wide = __int128;
  static constexpr int kFractionBits = 40;
  Wide value_ = 0;
};

}  // namespace hydrotin
