#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/polygon.h"

/// The directed edges of the triangles that a polygon may be made of, and the triangles that can stand on them.

namespace hydrotin {

inline constexpr std::uint32_t kNoEdge = static_cast<std::uint32_t>(-1);

/// A triangle that can stand on the left of a directed edge. Which one its number tells: PolygonGraph::triangle_of.
struct Option {
  std::uint32_t apex;
  std::uint32_t left_child;   ///< directed edge origin -> apex; its left side is still to be triangulated
  std::uint32_t right_child;  ///< directed edge apex -> target
  std::uint32_t next;         ///< next option of the same edge, or kNoEdge
};

struct PolygonEdge {
  std::uint32_t origin, target;
  std::uint32_t first_option;  ///< kNoEdge: none
  bool is_delaunay;
  bool is_boundary;     ///< the outside (or a slit) is on its left: nothing to triangulate
  bool goes_down;       ///< the target is lower than the origin, where heights are known
  std::uint8_t wishes;  ///< kOriginWishes, kTargetWishes: ends that want a lower neighbour

  static constexpr std::uint8_t kOriginWishes = 1, kTargetWishes = 2;
};

/// Built anew for each polygon; the arrays are reused. Both directions of an edge are there, side by side.
class PolygonGraph {
 public:
  void build(const PolygonProblem& problem);

  [[nodiscard]] std::uint32_t num_edges() const { return num_edges_; }
  [[nodiscard]] const PolygonEdge& edge(std::uint32_t e) const { return edges_[e]; }
  [[nodiscard]] std::uint32_t num_options() const { return static_cast<std::uint32_t>(options_.size()); }
  /// The option of triangle t to stand on its side i.
  [[nodiscard]] static std::uint32_t option_on(std::uint32_t t, std::size_t i) {
    return 3 * t + static_cast<std::uint32_t>(i);
  }
  /// The triangle of an option, by number among Delaunay triangles, then others.
  [[nodiscard]] static std::uint32_t triangle_of(std::uint32_t o) { return o / 3; }
  [[nodiscard]] const Option& option(std::uint32_t o) const { return options_[o]; }
  /// Has an option, or kNoEdge, brought near without waiting for it: those of an edge stand far from each other.
  void fetch_option(std::uint32_t o) const { __builtin_prefetch(options_.data() + (o == kNoEdge ? 0 : o)); }
  /// The smallest side of the polygon by (origin, target) in (x, y), with the polygon on its left only.
  [[nodiscard]] std::uint32_t root() const { return root_; }
  [[nodiscard]] std::uint32_t find(std::uint32_t origin, std::uint32_t target) const;
  [[nodiscard]] static std::uint32_t twin(std::uint32_t e) { return e ^ 1U; }
  /// Whether the polygon is on both sides.
  [[nodiscard]] bool is_inner(std::uint32_t e) const { return !edges_[e].is_boundary && !edges_[twin(e)].is_boundary; }
  /// The directed edge from corner i of triangle t to the next, with the triangle on its left.
  [[nodiscard]] std::uint32_t side(std::uint32_t t, std::size_t i) const {
    return twin(options_[3 * std::size_t{t} + (i + 1) % 3].left_child);
  }
  [[nodiscard]] const std::array<std::uint32_t, 3>& triangle(std::uint32_t t) const {
    return t < problem_->delaunay.size() ? problem_->delaunay[t] : problem_->others[t - problem_->delaunay.size()];
  }
  [[nodiscard]] std::uint32_t num_triangles() const {
    return static_cast<std::uint32_t>(problem_->delaunay.size() + problem_->others.size());
  }
  /// Sides of triangle t that are not Delaunay edges.
  [[nodiscard]] std::uint32_t foreign_sides(std::uint32_t t) const { return foreign_[t]; }
  [[nodiscard]] std::span<const std::uint8_t> foreign_sides() const { return foreign_; }
  [[nodiscard]] const PolygonProblem& problem() const { return *problem_; }

 private:
  [[nodiscard]] std::size_t slot_of(std::uint32_t low, std::uint32_t high) const;
  void make_slots(std::size_t size);
  std::uint32_t find_or_add(std::uint32_t origin, std::uint32_t target);
  void add(std::uint32_t origin, std::uint32_t target);
  void stand(std::uint32_t t, const std::array<std::uint32_t, 3>& v, const std::array<std::uint32_t, 3>& side);
  void add_delaunay(std::uint32_t t);
  void add_other(std::uint32_t t, const std::array<std::uint32_t, 3>& v);
  template <class Visit>
  void for_sides(Visit visit);

  const PolygonProblem* problem_ = nullptr;
  std::vector<PolygonEdge> edges_;  // the first `num_edges_`
  std::uint32_t num_edges_ = 0;
  std::vector<Option> options_;
  std::vector<std::uint8_t> foreign_;
  std::vector<std::uint32_t> slot_;  // from smaller ends to larger ones, in the order of the vertices by and large
  std::uint32_t root_ = kNoEdge;
};

}  // namespace hydrotin
