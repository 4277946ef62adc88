#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "hydrotin/lattice.h"

/// Seeded point clouds and reliefs for tests: the same points for the same seed on every machine.
///
/// No distribution of the standard library is used (their sequences differ between libraries) and no transcendental
/// function. Points come in no useful order unless a generator says so. Clouds may hold equal points: pass them through
/// `distinct` where the tested code asks for distinct ones.
///
/// Units  lattice units. All coordinates lie in [0, 2^30).

namespace hydrotin::testing {

/// SplitMix64: small, seedable with any number, good enough to lay out points.
class Random {
 public:
  // The state is a place in one long stream: seeds are mixed, or neighbouring ones would share all but a few numbers.
  explicit Random(std::uint64_t seed) : state_(mixed(seed + 0x2545f4914f6cdd1du)) {}

  std::uint64_t bits() { return mixed(state_ += 0x9e3779b97f4a7c15u); }
  /// Uniform in [0, bound), bound in [1, 2^32).
  std::uint32_t below(std::uint64_t bound) { return static_cast<std::uint32_t>(((bits() >> 32) * bound) >> 32); }
  /// Uniform in [low, high].
  std::int32_t between(std::int32_t low, std::int32_t high) {
    return static_cast<std::int32_t>(low +
                                     std::int64_t{below(static_cast<std::uint64_t>(std::int64_t{high} - low + 1))});
  }
  /// Uniform in [0, 1), a multiple of 2^-53.
  double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }

 private:
  static std::uint64_t mixed(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }

  std::uint64_t state_;
};

template <class T>
void shuffle(std::uint64_t seed, std::vector<T>& values) {
  Random random(seed ^ 0x5bd1e995u);
  for (std::size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[random.below(i)]);
}

/// Sorted by (x, y), each position once.
inline std::vector<LatticePoint> distinct(std::vector<LatticePoint> points) {
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

/// A side long enough for n points at a mean spacing of `spacing` units.
inline std::int32_t extent_for(std::size_t n, double spacing) {
  return static_cast<std::int32_t>(std::ceil(std::sqrt(static_cast<double>(std::max<std::size_t>(n, 1))) * spacing));
}

/// Uniform in [0, extent)^2. A small extent gives many ties and equal points.
inline std::vector<LatticePoint> random_points(std::uint64_t seed, std::size_t n, std::int32_t extent) {
  Random random(seed);
  std::vector<LatticePoint> points(n);
  for (auto& p : points) p = {random.between(0, extent - 1), random.between(0, extent - 1)};
  return points;
}

/// The first n nodes of a square lattice, row by row, moved by at most `jitter` in x and y; distinct if 2 jitter <
/// spacing.
inline std::vector<LatticePoint> jittered_lattice_points(std::uint64_t seed, std::size_t n, std::int32_t spacing,
                                                         std::int32_t jitter) {
  Random random(seed);
  const auto columns = static_cast<std::size_t>(extent_for(n, 1.0));
  std::vector<LatticePoint> points(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto column = static_cast<std::int32_t>(i % columns), row = static_cast<std::int32_t>(i / columns);
    points[i] = {jitter + column * spacing + random.between(-jitter, jitter),
                 jitter + row * spacing + random.between(-jitter, jitter)};
  }
  shuffle(seed, points);
  return points;
}

/// A perfect square lattice: all cells cocircular, all rows collinear.
inline std::vector<LatticePoint> lattice_points(std::uint64_t seed, std::size_t n, std::int32_t spacing) {
  return jittered_lattice_points(seed, n, spacing, 0);
}

/// Airborne scan lines: points `spacing` apart along x with a little noise, lines `line_gap` apart in y, in flight
/// strips that overlap by a quarter, each strip with its own phase and skew.
inline std::vector<LatticePoint> scanline_points(std::uint64_t seed, std::size_t n, std::int32_t spacing,
                                                 std::int32_t line_gap) {
  Random random(seed);
  constexpr std::int32_t kStrips = 2;
  const double area = static_cast<double>(std::max<std::size_t>(n, 1)) * spacing * line_gap;
  const auto side = static_cast<std::int32_t>(std::ceil(std::sqrt(area))) + 1;
  const std::int32_t strip_width = std::max(side * 5 / (4 * kStrips), spacing);
  std::vector<LatticePoint> points;
  points.reserve(n);
  for (std::int32_t strip = 0; points.size() < n; ++strip) {
    const std::int32_t left = (strip % kStrips) * (side - strip_width) / std::max(kStrips - 1, 1);
    const std::int32_t phase = random.between(0, line_gap - 1) + (strip / kStrips) * side;
    const std::int32_t skew = random.between(-line_gap, line_gap);
    const std::size_t share = strip % kStrips + 1 < kStrips ? (n - points.size() + 1) / 2 : n - points.size();
    std::size_t in_strip = 0;
    for (std::int32_t y = phase; y < phase + side && in_strip < share; y += line_gap)
      for (std::int32_t x = random.between(0, spacing - 1); x < strip_width && in_strip < share;
           x += spacing, ++in_strip) {
        const auto slant = static_cast<std::int32_t>(std::int64_t{skew} * x / strip_width);
        points.push_back({left + x + random.between(0, spacing / 4), line_gap + y + slant + random.between(0, 1)});
      }
  }
  shuffle(seed, points);
  return points;
}

/// Dense clumps (triangular profile) of very different width on a thin uniform background.
inline std::vector<LatticePoint> clustered_points(std::uint64_t seed, std::size_t n, std::int32_t extent) {
  Random random(seed);
  struct Clump {
    std::int32_t x, y, radius;
  };
  std::vector<Clump> clumps(3 + random.below(6));
  for (auto& clump : clumps)
    clump = {random.between(0, extent - 1), random.between(0, extent - 1),
             std::max(1, extent / (8 << random.below(4)))};
  const auto near = [&](std::int32_t centre, std::int32_t radius) {
    const std::int32_t v = centre + (random.between(-radius, radius) + random.between(-radius, radius)) / 2;
    return std::clamp(v, 0, extent - 1);
  };
  std::vector<LatticePoint> points(n);
  for (auto& p : points) {
    const Clump& clump = clumps[random.below(clumps.size())];
    p = random.below(10) == 0 ? LatticePoint{random.between(0, extent - 1), random.between(0, extent - 1)}
                              : LatticePoint{near(clump.x, clump.radius), near(clump.y, clump.radius)};
  }
  return points;
}

/// Uniform outside one to four round lakes whose diameters are up to a third of the side.
inline std::vector<LatticePoint> voided_points(std::uint64_t seed, std::size_t n, std::int32_t extent) {
  Random random(seed);
  struct Lake {
    std::int64_t x, y, radius;
  };
  std::vector<Lake> lakes(1 + random.below(4));
  for (auto& lake : lakes)
    lake = {random.between(0, extent - 1), random.between(0, extent - 1),
            random.between(std::min(extent / 12, extent / 6), extent / 6)};
  const auto is_wet = [&](LatticePoint p) {
    return std::any_of(lakes.begin(), lakes.end(), [&](const Lake& lake) {
      const std::int64_t dx = p.x - lake.x, dy = p.y - lake.y;
      return dx * dx + dy * dy < lake.radius * lake.radius;
    });
  };
  std::vector<LatticePoint> points;
  points.reserve(n);
  while (points.size() < n) {
    const LatticePoint p{random.between(0, extent - 1), random.between(0, extent - 1)};
    if (!is_wet(p)) points.push_back(p);
  }
  return points;
}

/// All on one line; its direction (horizontal, vertical, diagonal, or any) depends on the seed.
inline std::vector<LatticePoint> collinear_points(std::uint64_t seed, std::size_t n) {
  Random random(seed);
  constexpr std::array<LatticePoint, 6> kDirections{{{1, 0}, {0, 1}, {1, 1}, {1, -1}, {3, 7}, {-5, 2}}};
  const LatticePoint d = kDirections[seed % kDirections.size()];
  const auto reach = static_cast<std::int32_t>(2 * n);
  std::vector<LatticePoint> points(n);
  for (auto& p : points) {
    const std::int32_t t = random.between(0, reach);
    p = {d.x * t + (d.x < 0 ? -d.x * reach : 0), d.y * t + (d.y < 0 ? -d.y * reach : 0)};
  }
  return points;
}

/// Uniform, with about half of the points equal to another one, some of them many times.
inline std::vector<LatticePoint> duplicated_points(std::uint64_t seed, std::size_t n, std::int32_t extent) {
  Random random(seed);
  std::vector<LatticePoint> points(n);
  for (std::size_t i = 0; i < n; ++i)
    points[i] = i > 0 && random.below(2) == 0
                    ? points[random.below(random.below(4) == 0 ? 1 : i)]
                    : LatticePoint{random.between(0, extent - 1), random.between(0, extent - 1)};
  return points;
}

/// Uniform in an L: a data set whose outline is not convex.
inline std::vector<LatticePoint> l_shaped_points(std::uint64_t seed, std::size_t n, std::int32_t extent) {
  Random random(seed);
  std::vector<LatticePoint> points;
  points.reserve(n);
  const std::int32_t arm = std::max(1, extent / 4);
  while (points.size() < n) {
    const LatticePoint p{random.between(0, extent - 1), random.between(0, extent - 1)};
    if (p.x < arm || p.y < arm) points.push_back(p);
  }
  return points;
}

/// Zero to six points on a lattice of 4 x 4: every degenerate case comes up within a few hundred seeds.
inline std::vector<LatticePoint> tiny_points(std::uint64_t seed) {
  return random_points(seed, Random(seed ^ 0x9e37u).below(7), 4);
}

enum class CloudKind {
  uniform,
  lattice,
  jittered,
  scanlines,
  clustered,
  voided,
  collinear,
  duplicated,
  l_shaped,
  tiny
};

inline constexpr std::array<CloudKind, 10> kCloudKinds{
    CloudKind::uniform, CloudKind::lattice,   CloudKind::jittered,   CloudKind::scanlines, CloudKind::clustered,
    CloudKind::voided,  CloudKind::collinear, CloudKind::duplicated, CloudKind::l_shaped,  CloudKind::tiny};

inline const char* name_of(CloudKind kind) {
  constexpr std::array<const char*, 10> kNames{"uniform", "lattice",   "jittered",   "scanlines", "clustered",
                                               "voided",  "collinear", "duplicated", "l_shaped",  "tiny"};
  return kNames[static_cast<std::size_t>(kind)];
}

/// A cloud of a kind with mean spacing near `spacing` units (`tiny` ignores n and spacing, `collinear` the spacing).
inline std::vector<LatticePoint> make_cloud(CloudKind kind, std::uint64_t seed, std::size_t n, std::int32_t spacing) {
  const std::int32_t extent = extent_for(n, spacing) + 1;
  switch (kind) {
    case CloudKind::uniform:
      return random_points(seed, n, extent);
    case CloudKind::lattice:
      return lattice_points(seed, n, spacing);
    case CloudKind::jittered:
      return jittered_lattice_points(seed, n, spacing, (spacing - 1) / 3);
    case CloudKind::scanlines:
      return scanline_points(seed, n, std::max(1, spacing / 3), spacing * 3);
    case CloudKind::clustered:
      return clustered_points(seed, n, extent);
    case CloudKind::voided:
      return voided_points(seed, n, extent);
    case CloudKind::collinear:
      return collinear_points(seed, n);
    case CloudKind::duplicated:
      return duplicated_points(seed, n, extent);
    case CloudKind::l_shaped:
      return l_shaped_points(seed, n, extent * 3 / 2);
    case CloudKind::tiny:
      return tiny_points(seed);
  }
  return {};
}

// Heights -----------------------------------------------------------------------------------------------------------

/// Independent uniform heights in [0, range): range 1 is flat, a small range is full of plateaus.
inline std::vector<std::int32_t> random_heights(std::uint64_t seed, std::size_t n, std::int32_t range) {
  Random random(seed ^ 0xc2b2ae35u);
  std::vector<std::int32_t> heights(n);
  for (auto& z : heights) z = random.between(0, range - 1);
  return heights;
}

/// Smooth hills: octaves of lattice noise from `wavelength` units down, in [0, amplitude], plus noise in [0, noise].
/// A function of position and seed only (noise included), so equal points get equal heights and parts of a cloud agree.
inline std::int32_t relief_at(std::uint64_t seed, LatticePoint p, std::int32_t wavelength, std::int32_t amplitude,
                              std::int32_t noise = 0) {
  const auto hash = [&](std::int64_t i, std::int64_t j, std::uint64_t octave) {
    const auto key = static_cast<std::uint64_t>(i) * 0x8da6b343u ^ static_cast<std::uint64_t>(j) * 0xd8163841cb1ab5u;
    return Random(key ^ (seed << 8) ^ octave * 0x51ed27u);
  };
  double sum = 0, weight = 0.5;
  std::int32_t length = std::max(1, wavelength);
  for (std::uint64_t octave = 1; octave <= 6; ++octave, weight /= 2, length = std::max(1, length / 2)) {
    const std::int32_t i = p.x / length, j = p.y / length;
    const double u = static_cast<double>(p.x % length) / length, v = static_cast<double>(p.y % length) / length;
    const double s = u * u * (3 - 2 * u), t = v * v * (3 - 2 * v);
    const double low = hash(i, j, octave).unit() * (1 - s) + hash(i + 1, j, octave).unit() * s;
    const double high = hash(i, j + 1, octave).unit() * (1 - s) + hash(i + 1, j + 1, octave).unit() * s;
    sum += weight * (low * (1 - t) + high * t);
  }
  const std::int32_t rough = noise > 0 ? hash(p.x, p.y, 0).between(0, noise) : 0;
  return static_cast<std::int32_t>(sum * amplitude) + rough;
}

inline std::vector<std::int32_t> relief_heights(std::uint64_t seed, const std::vector<LatticePoint>& points,
                                                std::int32_t wavelength, std::int32_t amplitude,
                                                std::int32_t noise = 0) {
  std::vector<std::int32_t> heights(points.size());
  std::transform(points.begin(), points.end(), heights.begin(),
                 [&](LatticePoint p) { return relief_at(seed, p, wavelength, amplitude, noise); });
  return heights;
}

}  // namespace hydrotin::testing
