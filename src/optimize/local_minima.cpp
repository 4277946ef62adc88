#include "hydrotin/local_minima.h"

#include <atomic>
#include <bit>

#include "hydrotin/polygon.h"

namespace hydrotin {
namespace {

constexpr std::uint32_t kVertexRange = 1U << 14;

// The lowest useful neighbour found so far, and a triangle on the way to it.
struct alignas(8) Offer {
  VertexId neighbor;
  TriangleId where;
};

class Assigner {
 public:
  Assigner(const TriangulationView& triangulation, const VertexLinks& links, const UsefulEdges& edges,
           const Crossings& crossings, std::span<const std::int32_t> height)
      : tri_(triangulation),
        links_(links),
        edges_(edges),
        crossings_(crossings),
        height_(height),
        best_(triangulation.num_vertices(), std::bit_cast<std::uint64_t>(Offer{})),
        fate_(triangulation.num_vertices(), MinimumFate::always) {}

  // Offers what is below v to v, and v to what is above it over useful edges.
  void look_at(VertexId v) {
    Offer own{};
    const auto consider = [&](VertexId w, HalfedgeId h) {
      if (own.neighbor.is_none() || lower(w, own.neighbor)) own = {w, triangle_of(h)};
    };
    for (std::uint32_t i = links_.begin[v.value]; i < links_.begin[v.value + 1]; ++i) {
      const VertexId w = links_.neighbor[i];
      const HalfedgeId spoke = links_.spoke[i];
      const bool fixed = spoke.is_none() || !crossings_.crossed[spoke.value];
      if (!lower(w, v)) continue;
      if (fixed) fate_[v.value] = MinimumFate::never;
      if (fixed) break;
      consider(w, spoke);
    }
    for (std::uint32_t e = edges_.begin[v.value]; e < edges_.begin[v.value + 1]; ++e) {
      const VertexId w = edges_.b[e];
      if (lower(w, v))
        consider(w, edges_.entry[e]);
      else
        offer(w, {v, triangle_of(crossings_.exit[e])});
    }
    if (!own.neighbor.is_none()) offer(v, own);
  }

  void decide(VertexId v, MinimaAssignment& out) const {
    const auto best = std::bit_cast<Offer>(best_[v.value]);
    MinimumFate fate = fate_[v.value];
    if (fate != MinimumFate::never && !best.neighbor.is_none()) fate = MinimumFate::assigned;
    out.fate[v.value] = fate;
    if (fate == MinimumFate::assigned) out.where[v.value] = best.where;
  }

 private:
  [[nodiscard]] bool lower(VertexId p, VertexId q) const {
    return is_lower(height_[p.value], tri_.position[p], height_[q.value], tri_.position[q]);
  }

  // Edges of several ranges of vertices may lead to v.
  void offer(VertexId v, Offer offered) {
    const std::atomic_ref<std::uint64_t> best(best_[v.value]);
    std::uint64_t held = best.load(std::memory_order_relaxed);
    for (;;) {
      const VertexId lowest = std::bit_cast<Offer>(held).neighbor;
      if (!lowest.is_none() && !lower(offered.neighbor, lowest)) return;
      if (best.compare_exchange_weak(held, std::bit_cast<std::uint64_t>(offered), std::memory_order_relaxed)) return;
    }
  }

  TriangulationView tri_;
  const VertexLinks& links_;
  const UsefulEdges& edges_;
  const Crossings& crossings_;
  std::span<const std::int32_t> height_;
  std::vector<std::uint64_t> best_;
  std::vector<MinimumFate> fate_;
};

}  // namespace

MinimaAssignment assign_minima(const TriangulationView& tri, const VertexLinks& links, const UsefulEdges& edges,
                               const Crossings& crossings, std::span<const std::int32_t> height,
                               const Executor& executor) {
  const std::uint32_t n = tri.num_vertices();
  Assigner assigner(tri, links, edges, crossings, height);
  for_ranges(executor, n, kVertexRange, [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t v = begin; v < end; ++v) assigner.look_at(VertexId{v});
  });
  MinimaAssignment out;
  out.fate.resize(n);
  out.where.resize(n);
  for_ranges(executor, n, kVertexRange, [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t v = begin; v < end; ++v) assigner.decide(VertexId{v}, out);
  });
  return out;
}

}  // namespace hydrotin
