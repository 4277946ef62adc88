#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/lattice.h"

/// The Delaunay triangulation of the points kept, with the points removed in the triangles that hold them.
///
/// Flat arrays; a triangle that goes leaves its number to one that comes. Each triangle knows its worst point. The set
/// of triangles and of points in each depends on the points kept only, not on the order of changes.

namespace hydrotin::thinning {

inline constexpr std::uint32_t kNone = 0xffffffffU;

__extension__ using Wide = __int128;
__extension__ using WideSize = unsigned __int128;

struct Triangle {
  std::array<std::uint32_t, 3> corner{};                     ///< counter-clockwise
  std::array<std::uint32_t, 3> across{kNone, kNone, kNone};  ///< triangle beyond the edge from corner i to corner i + 1
  std::uint32_t head = kNone;                                ///< first of its points
  std::uint32_t worst = kNone;                               ///< of its points, if beyond the limit
  double error = 0;                                          ///< of `worst`
  LatticeBox reach;                                          ///< around its circle, if local
  bool is_live = false, is_local = false;
  std::uint8_t mark = 0;  ///< free for callers; 0 in new triangles
};

/// Numerator of height minus plane, and twice the area.
struct Distance {
  Wide numerator = 0, denominator = 1;
};

/// +1 or -1: side of p + (e, e^2) against the line from a to b.
[[nodiscard]] int side(LatticePoint a, LatticePoint b, LatticePoint p);

class ThinMesh {
 public:
  /// @param first  points of the first triangulation, ascending along the curve; not all on one line
  ThinMesh(std::span<const LatticePoint> position, std::span<const std::int32_t> height,
           std::span<const std::uint32_t> first, std::int64_t limit_millionths, double local_radius);

  [[nodiscard]] std::uint32_t num_slots() const { return static_cast<std::uint32_t>(triangle_.size()); }
  [[nodiscard]] const Triangle& operator[](std::uint32_t t) const { return triangle_[t]; }
  [[nodiscard]] Triangle& operator[](std::uint32_t t) { return triangle_[t]; }
  [[nodiscard]] std::uint32_t next_point(std::uint32_t p) const { return next_[p]; }
  [[nodiscard]] LatticePoint at(std::uint32_t p) const { return position_[p]; }

  /// Keeps a removed point. New triangles are appended to `fresh`.
  void insert(std::uint32_t p, std::vector<std::uint32_t>& fresh);

  /// Triangles around a vertex, counter-clockwise, and their far vertices in that order. False on the hull.
  bool star(std::uint32_t v, std::vector<std::uint32_t>& triangles, std::vector<std::uint32_t>& link) const;

  /// What would take a star's place: triangles over the link, none if one of them were not local.
  /// @param fill  corners as places in `link`
  bool fill_hole(std::span<const std::uint32_t> link, std::vector<std::array<std::uint32_t, 3>>& fill) const;

  /// Greatest error of the vertex and the points below its star if `fill` took its place; negative: beyond the limit.
  [[nodiscard]] double error_without(std::uint32_t v, std::span<const std::uint32_t> triangles,
                                     std::span<const std::uint32_t> link,
                                     std::span<const std::array<std::uint32_t, 3>> fill) const;

  /// Removes a vertex. New triangles are appended to `fresh`.
  void remove(std::uint32_t v, std::span<const std::uint32_t> triangles, std::span<const std::uint32_t> link,
              std::span<const std::array<std::uint32_t, 3>> fill, std::vector<std::uint32_t>& fresh);

  [[nodiscard]] Distance distance(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t p) const;
  [[nodiscard]] bool is_beyond(const Distance& d) const;

  /// Whether p lies in the triangle over a, b, c as property (4) of thinning.h has it; hull edges apart.
  [[nodiscard]] bool holds(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t p) const;

 private:
  struct Edge {
    std::uint32_t from, to, beyond, fresh;
  };

  std::uint32_t take_slot();
  void give_back(std::uint32_t t);
  void link_to(std::uint32_t t, std::uint32_t i, std::uint32_t beyond);
  void take_shape(std::uint32_t t);
  void put(std::uint32_t p, std::uint32_t t);
  void rate(std::uint32_t t);
  void find_cavity(std::uint32_t p);
  void share_points(std::uint32_t p, std::vector<std::uint32_t>& fresh, std::size_t first);
  void load_points();
  [[nodiscard]] std::uint32_t locate(LatticePoint p, std::uint32_t from) const;

  std::span<const LatticePoint> position_;
  std::span<const std::int32_t> height_;
  std::int64_t limit_millionths_;
  double local_radius2_;
  std::vector<Triangle> triangle_;
  std::vector<std::uint32_t> free_;
  std::vector<std::uint32_t> next_;   // [n] in the list of a triangle
  std::vector<std::uint32_t> owner_;  // [n] triangle of a removed point, some triangle of a vertex
  std::vector<std::uint32_t> stamp_;  // [slots]
  std::uint32_t turn_ = 0;
  std::vector<std::uint32_t> cavity_, loose_;
  std::vector<Edge> rim_;
  std::vector<std::uint32_t> starts_;  // [n] number in `rim_` of the edge that starts at a vertex
};

}  // namespace hydrotin::thinning
