#include "polygon_graph.h"

#include <bit>
#include <cassert>
#include <utility>

namespace hydrotin {
namespace {

std::uint32_t hash(std::uint32_t origin, std::uint32_t target) {
  const std::uint64_t key = (std::uint64_t{origin} << 32 | target) * 0x9e3779b97f4a7c15ULL;
  return static_cast<std::uint32_t>(key >> 32);
}

}  // namespace

std::uint32_t PolygonGraph::find(std::uint32_t origin, std::uint32_t target) const {
  const auto mask = static_cast<std::uint32_t>(slot_.size() - 1);
  for (std::uint32_t i = hash(origin, target) & mask; slot_[i] != kNoEdge; i = (i + 1) & mask)
    if (edges_[slot_[i]].origin == origin && edges_[slot_[i]].target == target) return slot_[i];
  return kNoEdge;
}

std::uint32_t PolygonGraph::find_or_add(std::uint32_t origin, std::uint32_t target) {
  const auto mask = static_cast<std::uint32_t>(slot_.size() - 1);
  std::uint32_t i = hash(origin, target) & mask;
  for (; slot_[i] != kNoEdge; i = (i + 1) & mask)
    if (edges_[slot_[i]].origin == origin && edges_[slot_[i]].target == target) return slot_[i];
  slot_[i] = static_cast<std::uint32_t>(edges_.size());
  edges_.push_back({origin, target, kNoEdge, false, false});
  return slot_[i];
}

// The triangle stands on each of its three sides; the other two, reversed, are what is left to solve.
void PolygonGraph::add_triangle(std::uint32_t t, bool delaunay) {
  const auto& v = triangle(t);
  std::array<std::uint32_t, 3> inner, outer;
  std::uint8_t foreign = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    inner[i] = find_or_add(v[i], v[(i + 1) % 3]);
    outer[i] = find_or_add(v[(i + 1) % 3], v[i]);
    if (delaunay) edges_[inner[i]].is_delaunay = edges_[outer[i]].is_delaunay = true;
    foreign = static_cast<std::uint8_t>(foreign + !edges_[inner[i]].is_delaunay);
  }
  foreign_.push_back(foreign);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto o = static_cast<std::uint32_t>(options_.size());
    options_.push_back({t, v[(i + 2) % 3], outer[(i + 2) % 3], outer[(i + 1) % 3], edges_[inner[i]].first_option});
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
  options_.clear();
  foreign_.clear();
  const auto num_delaunay = static_cast<std::uint32_t>(problem.delaunay.size());
  slot_.assign(std::bit_ceil(std::size_t{12} * num_triangles() + 4 * problem.rim.size() + 4), kNoEdge);
  for (std::uint32_t t = 0; t < num_delaunay; ++t) add_triangle(t, true);
  for (std::uint32_t t = num_delaunay; t < num_triangles(); ++t) add_triangle(t, false);
  for_sides([&](std::uint32_t a, std::uint32_t b) {
    find_or_add(a, b);
    edges_[find_or_add(b, a)].is_boundary = true;
  });
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
