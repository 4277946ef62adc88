#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>

#include "hydrotin/lattice.h"

/// Fingerprint of a set of triangles as coordinates with heights.
///
/// Each triangle, as its three (x, y, z) in ascending order, is mixed to 128 bits; the fingerprint is the sum of these
/// over the set, each half modulo 2^64. A sum does not know the order of its terms, so the fingerprint is the same for
/// every tiling, numbering and order of triangles. It guards against mistakes, not against forgers.
///
/// Threads  Pure.

namespace hydrotin {

struct Fingerprint {
  std::uint64_t low = 0, high = 0;

  using Corner = std::array<std::int32_t, 3>;  ///< x, y, final z

  void add(std::array<Corner, 3> corners) {
    const auto put_in_order = [](Corner& low_corner, Corner& high_corner) {
      if (key(high_corner) < key(low_corner)) std::swap(low_corner, high_corner);
    };
    put_in_order(corners[0], corners[1]);
    put_in_order(corners[1], corners[2]);
    put_in_order(corners[0], corners[1]);
    std::uint64_t a = 0x6a09e667f3bcc908ULL, b = 0xbb67ae8584caa73bULL;
    for (const Corner& c : corners) {
      const std::uint64_t xy = std::uint64_t{static_cast<std::uint32_t>(c[0])} << 32 | static_cast<std::uint32_t>(c[1]);
      const std::uint64_t z = static_cast<std::uint32_t>(c[2]);
      a = mixed(a ^ xy) + b;
      b = mixed(b ^ z ^ (xy << 17 | xy >> 47)) ^ (a << 31 | a >> 33);
      a = mixed(a ^ (z + 0x9e3779b97f4a7c15ULL));
    }
    low += mixed(a + 0x3c6ef372fe94f82bULL * b);
    high += mixed(b ^ (a << 23 | a >> 41));
  }
  void add(const Fingerprint& other) {
    low += other.low;
    high += other.high;
  }
  /// 32 hexadecimal digits.
  [[nodiscard]] std::string hex() const {
    std::array<char, 33> text{};
    std::snprintf(text.data(), text.size(), "%016llx%016llx", static_cast<unsigned long long>(high),
                  static_cast<unsigned long long>(low));
    return text.data();
  }
  [[nodiscard]] static std::optional<Fingerprint> parse(const std::string& hex) {
    if (hex.size() != 32 || hex.find_first_not_of("0123456789abcdef") != std::string::npos) return std::nullopt;
    return Fingerprint{std::stoull(hex.substr(16), nullptr, 16), std::stoull(hex.substr(0, 16), nullptr, 16)};
  }
  friend bool operator==(const Fingerprint&, const Fingerprint&) = default;

 private:
  // Ascends with (x, y), then z. Vertices of a sound triangle differ in (x, y); of a damaged one they need not.
  static constexpr std::pair<std::int64_t, std::int32_t> key(const Corner& c) {
    return {std::int64_t{c[0]} * (std::int64_t{1} << 32) + (c[1] + (std::int64_t{1} << 31)), c[2]};
  }
  // A bijection of 64 bits in which every bit of the input moves about half of the output's.
  static constexpr std::uint64_t mixed(std::uint64_t v) {
    v = (v ^ v >> 32) * 0xd6e8feb86659fd93ULL;
    v = (v ^ v >> 32) * 0xd6e8feb86659fd93ULL;
    return v ^ v >> 32;
  }

 public:
  Fingerprint() = default;
  Fingerprint(std::uint64_t low_half, std::uint64_t high_half) : low(low_half), high(high_half) {}
};

}  // namespace hydrotin
