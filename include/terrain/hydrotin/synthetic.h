#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "hydrotin/lattice.h"

/// Seeded synthetic terrain: point clouds of any size for quick starts, scale tests and benchmarks.
///
/// A terrain is a pure function of its options: the points of any box are made without those of any other, so that the
/// union over A x B tiles is the same set of points whatever A and B are. There is about one point per square metre;
/// the domain is a square.
///
///   fluvial   mountains (about 200 m of relief per kilometre) that a branching drainage network has carved, which
///             leaves by the southern edge; one point at random in every square metre
///   urban     gentle ground with streets; the flat-roofed blocks are left out as voids; points as in `fluvial`
///   lattice   rolling ground; points exactly on a grid of one metre (every in-circle test is a tie)
///   scanline  rolling ground; swaths of an airborne scanner that overlap a little, with parallel and zig-zag lines in
///             turn: spacing along a line differs from that across, with little jitter
///
/// Method   The relief of `fluvial` is the fixed point of: drain (priority flood from the southern edge), accumulate
///          area, rebuild heights along the drainage tree with slope ~ area^-0.45 (Flint's law); then fine noise, and
///          valleys cut along the tree, whose beds descend all the way down.
/// Units    Coordinates are integers: centimetres; heights too. The origin is that of a UTM zone.
/// Threads  Const functions may be called concurrently.

namespace hydrotin {

enum class SyntheticKind : std::uint8_t { fluvial, urban, lattice, scanline };

struct SyntheticOptions {
  SyntheticKind kind = SyntheticKind::fluvial;
  std::uint64_t num_points = 1'000'000;  ///< about; voids come off it. 16 .. kMaxSyntheticPoints
  std::uint64_t seed = 1;
  double noise = 0;    ///< standard deviation of white noise on the heights [m], 0 .. 100
  bool voids = false;  ///< lakes: round holes, some hundreds of metres wide
};

inline constexpr std::uint64_t kMaxSyntheticPoints = 100'000'000'000;
inline constexpr double kSyntheticScale = 0.01;  ///< metres per integer, x, y and z; offsets are 0

struct SyntheticPoint {
  std::int32_t x = 0, y = 0, z = 0;  ///< [cm]
  friend constexpr auto operator<=>(const SyntheticPoint&, const SyntheticPoint&) = default;
};

/// A river from its head or a confluence down to the next confluence or the edge.
struct SyntheticRiver {
  std::vector<std::array<double, 3>> line;  ///< downstream, z of the bed [m]
  int strahler = 1;
  double catchment_m2 = 0;  ///< at the lower end
};

class SyntheticTerrain {
 public:
  /// Complexity: O(min(points / 64, 600,000) log) time for `fluvial`, constant otherwise.
  explicit SyntheticTerrain(const SyntheticOptions& options);
  ~SyntheticTerrain();

  /// The whole domain; closed.
  [[nodiscard]] LatticeBox box() const;

  /// Tile (column a of num_a, row b of num_b, from the south-west): tiles cover the domain without overlap; closed.
  [[nodiscard]] LatticeBox tile(std::uint32_t a, std::uint32_t num_a, std::uint32_t b, std::uint32_t num_b) const;

  /// Height of the ground without white noise [m] at x, y [m].
  [[nodiscard]] double height(double x, double y) const;

  /// Whether no point may lie here: in a lake or under a roof; x, y [m].
  [[nodiscard]] bool is_void(double x, double y) const;

  /// Gives every point in `box` (closed) to `sink`, a batch at a time, in an order that depends on the box.
  /// Complexity: O(points) time, O(width of the box) memory.
  void points_in(const LatticeBox& box, const std::function<void(std::span<const SyntheticPoint>)>& sink) const;

  /// The drainage network; empty unless `fluvial`.
  [[nodiscard]] std::vector<SyntheticRiver> rivers() const;

 private:
  struct State;
  std::unique_ptr<const State> state_;
};

}  // namespace hydrotin
