#include "double_counts.h"

#include <algorithm>
#include <utility>

#include "hydrotin/predicates.h"

namespace hydrotin {
namespace {

// What is decided about some vertices.
struct Node {
  std::vector<std::uint32_t> free;                             // served for nothing
  std::vector<std::uint32_t> never;                            // not served
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;  // served, by the edge to this neighbour
};

class Tree {
 public:
  Tree(const PolygonGraph& graph, const PolygonCosts& costs, const std::vector<std::uint8_t>& blocked,
       const CountedProgram& program)
      : graph_(graph), costs_(costs), blocked_(blocked), program_(program) {}

  bool grow(std::uint32_t max_programs, const CountedAnswer& root, PolygonAnswer& best) {
    stack_.push_back({root.counted_twice, {}, {}});
    for (std::uint32_t programs = 0; !stack_.empty(); ++programs) {
      if (programs == max_programs) return false;
      const Node node = std::move(stack_.back());
      stack_.pop_back();
      visit(node, best);
    }
    return true;
  }

 private:
  [[nodiscard]] LatticePoint at(std::uint32_t v) const { return graph_.problem().position[v]; }
  [[nodiscard]] Wide gain(std::uint32_t v) const { return PolygonCosts::kGain[graph_.problem().wants_lower[v]]; }

  void visit(const Node& node, PolygonAnswer& best) {
    CountedAnswer found;
    if (!program_(wishes_of(node), blocked_of(node), found)) return;
    SlotValues bound = found.claimed;
    Wide& served = bound[static_cast<std::size_t>(costs_.minima_slot)];
    for (const std::uint32_t v : node.free) served -= gain(v);
    for (const auto& [v, w] : node.edges) served -= gain(v);
    if (found.answer.value < best.value) best = found.answer;
    if (!(bound < best.value)) return;
    mark_served(graph_, found.answer.triangle, served_);
    const auto unserved =
        std::find_if(node.free.begin(), node.free.end(), [&](std::uint32_t v) { return !served_[v]; });
    if (unserved != node.free.end())
      branch(node, *unserved);
    else
      relax(node, found.counted_twice);
  }

  void relax(const Node& node, const std::vector<std::uint32_t>& counted_twice) {
    stack_.push_back(node);
    auto& free = stack_.back().free;
    free.insert(free.end(), counted_twice.begin(), counted_twice.end());
    std::sort(free.begin(), free.end(), [&](std::uint32_t a, std::uint32_t b) { return at(a) < at(b); });
  }

  // Vertex v served by one of its edges, or not at all; the first edge is looked at first.
  void branch(const Node& node, std::uint32_t v) {
    Node child = node;
    std::erase(child.free, v);
    child.never.push_back(v);
    stack_.push_back(child);
    child.never.pop_back();
    std::vector<std::uint32_t> ends;
    for (std::uint32_t e = 0; e < graph_.num_edges(); ++e)
      if (graph_.edge(e).origin == v && graph_.edge(e).goes_down && graph_.is_inner(e))
        ends.push_back(graph_.edge(e).target);
    std::sort(ends.begin(), ends.end(), [&](std::uint32_t a, std::uint32_t b) { return at(b) < at(a); });
    for (const std::uint32_t w : ends) {
      stack_.push_back(child);
      stack_.back().edges.emplace_back(v, w);
    }
  }

  [[nodiscard]] std::vector<std::uint8_t> wishes_of(const Node& node) const {
    const auto given = graph_.problem().wants_lower;
    std::vector<std::uint8_t> wishes(given.begin(), given.end());
    for (const std::uint32_t v : node.free) wishes[v] = 0;
    for (const std::uint32_t v : node.never) wishes[v] = 0;
    for (const auto& [v, w] : node.edges) wishes[v] = 0;
    return wishes;
  }

  [[nodiscard]] std::vector<std::uint8_t> blocked_of(const Node& node) const {
    std::vector<std::uint8_t> out = blocked_;
    for (const auto& [v, w] : node.edges)
      for (std::uint32_t t = 0; t < graph_.num_triangles(); ++t) {
        const auto& corner = graph_.triangle(t);
        if (lies_aside(corner, at(v), at(w))) continue;
        for (std::size_t i = 0; i < 3; ++i)
          if (properly_cross(at(v), at(w), at(corner[i]), at(corner[(i + 1) % 3]))) out[t] = 1;
      }
    return out;
  }

  // Whether a segment cannot meet a triangle, as their boxes do not.
  [[nodiscard]] bool lies_aside(const std::array<std::uint32_t, 3>& corner, LatticePoint a, LatticePoint b) const {
    LatticeBox segment, triangle;
    segment.extend(a);
    segment.extend(b);
    for (const std::uint32_t v : corner) triangle.extend(at(v));
    return !segment.intersects(triangle);
  }

  const PolygonGraph& graph_;
  const PolygonCosts& costs_;
  const std::vector<std::uint8_t>& blocked_;
  const CountedProgram& program_;
  std::vector<Node> stack_;
  std::vector<std::uint8_t> served_;
};

}  // namespace

bool resolve_double_counts(const PolygonGraph& graph, const PolygonCosts& costs,
                           const std::vector<std::uint8_t>& blocked, const CountedProgram& program,
                           std::uint32_t max_programs, const CountedAnswer& root, PolygonAnswer& best) {
  return Tree(graph, costs, blocked, program).grow(max_programs, root, best);
}

}  // namespace hydrotin
