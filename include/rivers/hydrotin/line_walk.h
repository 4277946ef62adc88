#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hydrotin/lattice_terrain.h"

/// The exact way of a polyline through a terrain: which edges it crosses, which vertices it meets, where it is outside.
///
/// Source   thesis, Section 7.2, preparation of the data: "all intersections between the river and terrain edges".
/// Properties
///   (1) The stops of a piece are the points of the polyline on edges and vertices of the terrain, in its order, and
///       its own points; what lies between two stops lies in one triangle or along one edge.
///   (2) A polyline may pass through vertices, run along edges, cross holes and leave the terrain: each part inside is
///       a piece. Where it only touches the terrain there is no piece.
///   (3) Only orientations of lattice points decide: nothing is rounded.
/// Threads  A locator may be used by many threads at once.

namespace hydrotin {

/// Where a point lies.
enum class PlaceKind : std::uint8_t { outside, triangle, edge, vertex };
struct Place {
  PlaceKind kind = PlaceKind::outside;
  std::uint32_t id = 0;  ///< triangle; half-edge (one of the two; on the rim the one that has a triangle); vertex
  friend bool operator==(const Place&, const Place&) = default;
};

/// Finds places and rims. Keeps a reference: the terrain must outlive it unchanged.
class TerrainLocator {
 public:
  /// O(n + T log T).
  explicit TerrainLocator(const LatticeTerrain& terrain);
  ~TerrainLocator();
  TerrainLocator(TerrainLocator&&) noexcept;

  [[nodiscard]] const LatticeTerrain& terrain() const;
  /// O(log T).
  [[nodiscard]] Place locate(LatticePoint p) const;
  /// Half-edges with origin v, of all pieces that meet there.
  [[nodiscard]] std::span<const std::uint32_t> spokes(std::uint32_t v) const;
  /// Calls for every half-edge of the rim whose box meets that of p and q.
  [[nodiscard]] std::vector<std::uint32_t> rim_near(LatticePoint p, LatticePoint q) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

inline constexpr std::uint32_t kNoPoint = 0xffffffffu;

struct WalkStop {
  Place place;                ///< never outside
  std::uint32_t segment = 0;  ///< it lies on the segment between points `segment` and `segment` + 1 of the polyline
  std::uint32_t point = kNoPoint;  ///< it is this point of the polyline
  friend bool operator==(const WalkStop&, const WalkStop&) = default;
};

struct LineWalk {
  std::vector<std::size_t> piece_begin{0};  ///< [pieces + 1]
  std::vector<WalkStop> stop;

  [[nodiscard]] std::size_t num_pieces() const { return piece_begin.size() - 1; }
  [[nodiscard]] std::span<const WalkStop> piece(std::size_t i) const {
    return {stop.data() + piece_begin[i], stop.data() + piece_begin[i + 1]};
  }
};

/// @param line  at least two points, consecutive ones different.
/// Complexity: O(log T + stops) times the degrees of vertices met, and O(log T + rim edges near) for each part outside.
[[nodiscard]] LineWalk walk_line(const TerrainLocator& locator, std::span<const LatticePoint> line);

}  // namespace hydrotin
