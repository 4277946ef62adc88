#include "polygon_graph.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <utility>

namespace hydrotin {
namespace {

constexpr std::size_t kLarge = 4096;  // vertices; beyond it places for edges are made as they are needed

}  // namespace

// Where the edge stands, or the free place where it would. Vertices near each other have numbers near each other, so
// that a linear hash keeps the table's places for a region together; the edges of one vertex are spread evenly.
std::size_t PolygonGraph::slot_of(std::uint32_t low, std::uint32_t high) const {
  const std::size_t mask = slot_.size() - 1;
  std::size_t i = (std::size_t{9} * low + std::size_t{7} * high) & mask;
  for (;; i = (i + 1) & mask) {
    const std::uint32_t e = slot_[i];
    if (e == kNoEdge || (edges_[e].origin == low && edges_[e].target == high)) return i;
  }
}

// Places for the edges that there are, and for twice as many at least.
void PolygonGraph::make_slots(std::size_t size) {
  slot_.assign(std::bit_ceil(size), kNoEdge);
  for (std::uint32_t e = 0; e < num_edges(); e += 2) {
    const auto [low, high] = std::minmax(edges_[e].origin, edges_[e].target);
    slot_[slot_of(low, high)] = edges_[e].origin == low ? e : twin(e);
  }
}

std::uint32_t PolygonGraph::find(std::uint32_t origin, std::uint32_t target) const {
  const auto [low, high] = std::minmax(origin, target);
  const std::uint32_t edge = slot_[slot_of(low, high)];
  return edge == kNoEdge || origin == low ? edge : twin(edge);
}

// Adds both directions.
void PolygonGraph::add(std::uint32_t origin, std::uint32_t target) {
  const PolygonProblem& p = *problem_;
  const bool down =
      !p.height.empty() && is_lower(p.height[target], p.position[target], p.height[origin], p.position[origin]);
  const bool by_wishes = !p.wants_lower.empty();
  const bool first = by_wishes && p.wants_lower[origin] != 0, second = by_wishes && p.wants_lower[target] != 0;
  const auto wishes = [](bool of_origin, bool of_target) {
    return static_cast<std::uint8_t>((of_origin ? PolygonEdge::kOriginWishes : 0) |
                                     (of_target ? PolygonEdge::kTargetWishes : 0));
  };
  edges_.push_back({origin, target, kNoEdge, false, false, down, wishes(first, second)});
  edges_.push_back({target, origin, kNoEdge, false, false, !down, wishes(second, first)});
}

std::uint32_t PolygonGraph::find_or_add(std::uint32_t origin, std::uint32_t target) {
  const auto [low, high] = std::minmax(origin, target);
  std::uint32_t& slot = slot_[slot_of(low, high)];
  const auto turn = static_cast<std::uint32_t>(origin != low);
  if (slot != kNoEdge) return slot ^ turn;
  const std::uint32_t edge = num_edges();
  slot = edge ^ turn;
  add(origin, target);
  if (edges_.size() > slot_.size()) make_slots(2 * slot_.size());
  return edge;
}

// The triangle stands on each of its three sides; the other two, reversed, are what is left to solve.
void PolygonGraph::add_triangle(std::uint32_t t, bool delaunay) {
  const auto& v = triangle(t);
  std::array<std::uint32_t, 3> inner;
  std::uint8_t foreign = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    inner[i] = find_or_add(v[i], v[(i + 1) % 3]);
    if (delaunay) edges_[inner[i]].is_delaunay = edges_[twin(inner[i])].is_delaunay = true;
    foreign = static_cast<std::uint8_t>(foreign + !edges_[inner[i]].is_delaunay);
  }
  foreign_[t] = foreign;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint32_t o = option_on(t, i);
    options_[o] = {v[(i + 2) % 3], twin(inner[(i + 2) % 3]), twin(inner[(i + 1) % 3]), edges_[inner[i]].first_option};
    edges_[inner[i]].first_option = o;
  }
}

// Directed sides with the polygon on their left.
template <class Visit>
void PolygonGraph::for_sides(Visit visit) const {
  for (const auto& [a, b] : problem_->rim) visit(a, b);
  if (!problem_->rim.empty()) return;
  for (std::size_t t = 0; t < problem_->delaunay.size(); ++t)
    for (std::uint32_t i = 0; i < 3; ++i)
      if (problem_->fixed[t] >> i & 1U) visit(problem_->delaunay[t][i], problem_->delaunay[t][(i + 1) % 3]);
}

void PolygonGraph::build(const PolygonProblem& problem) {
  problem_ = &problem;
  edges_.clear();
  options_.resize(3 * std::size_t{num_triangles()});
  foreign_.resize(num_triangles());
  const auto num_delaunay = static_cast<std::uint32_t>(problem.delaunay.size());
  const std::size_t n = problem.position.size();
  make_slots(n > kLarge ? 8 * n : std::max<std::size_t>(16, 16 * n));
  for (std::uint32_t t = 0; t < num_delaunay; ++t) add_triangle(t, true);
  for (std::uint32_t t = num_delaunay; t < num_triangles(); ++t) add_triangle(t, false);
  for_sides([&](std::uint32_t a, std::uint32_t b) { edges_[twin(find_or_add(a, b))].is_boundary = true; });
  root_ = kNoEdge;
  std::pair<LatticePoint, LatticePoint> smallest;
  for_sides([&](std::uint32_t a, std::uint32_t b) {
    const std::uint32_t side = find(a, b);
    const std::pair key{problem.position[a], problem.position[b]};
    if (edges_[side].is_boundary) return;  // the same polygon on both sides
    if (root_ == kNoEdge || key < smallest) {
      root_ = side;
      smallest = key;
    }
  });
  assert(root_ != kNoEdge && "a polygon has a boundary");
}

}  // namespace hydrotin
