#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "hydrotin/wide.h"

/// Real numbers as integers, so that sums do not depend on the order of addition.
///
/// Units    multiples of 2^-40.
/// Threads  pure.

namespace hydrotin {

inline constexpr int kFractionBits = 40;

/// Nearest multiple; beyond 2^70 that.
[[nodiscard]] inline Wide to_fixed(double value) {
  constexpr double kLargest = 0x1p110;
  return static_cast<Wide>(std::nearbyint(std::clamp(std::ldexp(value, kFractionBits), -kLargest, kLargest)));
}

[[nodiscard]] inline double from_fixed(Wide value) {
  return std::ldexp(static_cast<double>(value), -kFractionBits);
}

/// A sum of real numbers that does not depend on the order of addition, nor on how the terms were grouped: each term is
/// rounded once, then integers of 128 bits are added.
class ExactSum {
 public:
  ExactSum() = default;
  /// From what `high` and `low` gave.
  ExactSum(std::int64_t high, std::uint64_t low) : units_((static_cast<Wide>(high) * (Wide{1} << 64)) | low) {}

  void add(double term) { units_ += to_fixed(term); }
  void add(const ExactSum& other) { units_ += other.units_; }

  [[nodiscard]] double value() const { return from_fixed(units_); }
  [[nodiscard]] Wide units() const { return units_; }
  [[nodiscard]] std::int64_t high() const { return static_cast<std::int64_t>(units_ >> 64); }
  [[nodiscard]] std::uint64_t low() const { return static_cast<std::uint64_t>(units_); }
  friend bool operator==(const ExactSum&, const ExactSum&) = default;

 private:
  Wide units_ = 0;
};

}  // namespace hydrotin
