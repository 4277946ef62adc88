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

// Places for the edges that there are, and for as many as there are places.
void PolygonGraph::make_slots(std::size_t size) {
  slot_.assign(std::bit_ceil(size), kNoEdge);
  for (std::uint32_t e = 0; e < num_edges_; e += 2) {
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
  std::uint8_t of_origin = 0, of_target = 0;
  if (!p.wants_lower.empty()) {
    of_origin = p.wants_lower[origin] != 0;
    of_target = p.wants_lower[target] != 0;
  }
  constexpr int kTarget = std::countr_zero(PolygonEdge::kTargetWishes);
  if (num_edges_ + 2 > edges_.size()) edges_.resize(std::max<std::size_t>(64, edges_.size() + edges_.size() / 2));
  PolygonEdge* const edge = edges_.data() + num_edges_;
  edge[0] = {origin, target, kNoEdge, false, false, down, static_cast<std::uint8_t>(of_origin | of_target << kTarget)};
  edge[1] = {target, origin, kNoEdge, false, false, !down, static_cast<std::uint8_t>(of_target | of_origin << kTarget)};
  num_edges_ += 2;
}

inline std::uint32_t PolygonGraph::find_or_add(std::uint32_t origin, std::uint32_t target) {
  const std::uint32_t low = std::min(origin, target), high = std::max(origin, target);
  std::uint32_t& slot = slot_[slot_of(low, high)];
  const auto turn = static_cast<std::uint32_t>(origin != low);
  if (slot != kNoEdge) return slot ^ turn;
  const std::uint32_t edge = num_edges_;
  slot = edge ^ turn;
  add(origin, target);
  if (num_edges_ > slot_.size()) make_slots(2 * slot_.size());
  return edge;
}

// The triangle stands on each of its three sides; the other two, reversed, are what is left to solve.
inline void PolygonGraph::stand(std::uint32_t t, const std::array<std::uint32_t, 3>& v,
                                const std::array<std::uint32_t, 3>& side) {
  Option* const option = options_.data() + option_on(t, 0);
  const auto put = [&](std::size_t i, std::size_t j, std::size_t k) {
    std::uint32_t& first = edges_[side[i]].first_option;
    option[i] = {v[k], twin(side[k]), twin(side[j]), first};
    first = option_on(t, i);
  };
  put(0, 1, 2);
  put(1, 2, 0);
  put(2, 0, 1);
}

void PolygonGraph::add_delaunay(std::uint32_t t) {
  const auto& v = problem_->delaunay[t];
  const std::array side{find_or_add(v[0], v[1]), find_or_add(v[1], v[2]), find_or_add(v[2], v[0])};
  for (const std::uint32_t e : side) edges_[e].is_delaunay = edges_[twin(e)].is_delaunay = true;
  foreign_[t] = 0;
  stand(t, v, side);
}

void PolygonGraph::add_other(std::uint32_t t, const std::array<std::uint32_t, 3>& v) {
  const std::array side{find_or_add(v[0], v[1]), find_or_add(v[1], v[2]), find_or_add(v[2], v[0])};
  unsigned foreign = 3;
  for (const std::uint32_t e : side) foreign -= edges_[e].is_delaunay;
  foreign_[t] = static_cast<std::uint8_t>(foreign);
  stand(t, v, side);
}

// Calls visit(e) for the directed sides with the polygon on their left.
template <class Visit>
void PolygonGraph::for_sides(Visit visit) {
  for (const auto& [a, b] : problem_->rim) visit(find_or_add(a, b));
  if (!problem_->rim.empty()) return;
  for (std::uint32_t t = 0; t < problem_->delaunay.size(); ++t)
    for (std::uint32_t i = 0; i < 3; ++i)
      if (problem_->fixed[t] >> i & 1U) visit(side(t, i));
}

void PolygonGraph::build(const PolygonProblem& problem) {
  problem_ = &problem;
  num_edges_ = 0;
  options_.resize(3 * std::size_t{num_triangles()});
  foreign_.resize(num_triangles());
  const auto num_delaunay = static_cast<std::uint32_t>(problem.delaunay.size());
  const std::size_t n = problem.position.size();
  make_slots(n > kLarge ? 8 * n : std::max<std::size_t>(16, 16 * n));
  for (std::uint32_t t = 0; t < num_delaunay; ++t) add_delaunay(t);
  for (std::uint32_t i = 0; i < problem.others.size(); ++i) add_other(num_delaunay + i, problem.others[i]);
  for_sides([&](std::uint32_t side) { edges_[twin(side)].is_boundary = true; });
  root_ = kNoEdge;
  std::pair<LatticePoint, LatticePoint> smallest;
  for_sides([&](std::uint32_t side) {
    if (edges_[side].is_boundary) return;  // the same polygon on both sides
    const std::pair key{problem.position[edges_[side].origin], problem.position[edges_[side].target]};
    if (root_ == kNoEdge || key < smallest) {
      root_ = side;
      smallest = key;
    }
  });
  assert(root_ != kNoEdge && "a polygon has a boundary");
}

}  // namespace hydrotin
