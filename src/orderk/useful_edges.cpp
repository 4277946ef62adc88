#include "hydrotin/useful_edges.h"

#include <algorithm>
#include <memory>
#include <numeric>

#include "hydrotin/pencil_growth.h"
#include "hydrotin/predicates.h"

namespace hydrotin {
namespace {

// Calls visit(array of edges) for all arrays that have an entry per edge.
template <class Visit>
void for_columns(Visit visit) {
  visit(&UsefulEdges::b);
  visit(&UsefulEdges::left);
  visit(&UsefulEdges::right);
  visit(&UsefulEdges::num_left);
  visit(&UsefulEdges::num_right);
  visit(&UsefulEdges::entry);
}

// Where the edges of a part's vertices go: runs of vertices whose edges stay together.
struct Run {
  std::uint32_t from, to, count;
};

std::vector<Run> runs_of(const GrownEdges& part, const std::vector<std::uint32_t>& begin) {
  std::vector<Run> out;
  for (std::size_t i = 0; i < part.vertex.size(); ++i) {
    const std::uint32_t from = part.edges.begin[i], count = part.edges.begin[i + 1] - from;
    const std::uint32_t to = begin[part.vertex[i].value];
    if (count == 0) continue;
    if (!out.empty() && out.back().to + out.back().count == to)
      out.back().count += count;
    else
      out.push_back({from, to, count});
  }
  return out;
}

// Moves one array of all parts.
template <class Array>
void move_array(std::vector<GrownEdges>& parts, const std::vector<std::vector<Run>>& runs, Array UsefulEdges::*array,
                UsefulEdges& out, const Executor& executor) {
  (out.*array).resize(out.begin.back());
  executor(static_cast<std::uint32_t>(parts.size()), [&](std::uint32_t p) {
    Array& from = parts[p].edges.*array;
    for (const Run& run : runs[p]) std::copy_n(from.begin() + run.from, run.count, (out.*array).begin() + run.to);
    Array().swap(from);
  });
}

// First edge of each vertex.
std::vector<std::uint32_t> first_edges(std::uint32_t n, const std::vector<GrownEdges>& parts) {
  std::vector<std::uint32_t> out(std::size_t{n} + 1);
  for (const GrownEdges& part : parts)
    for (std::size_t i = 0; i < part.vertex.size(); ++i)
      out[part.vertex[i].value + 1] = part.edges.begin[i + 1] - part.edges.begin[i];
  std::partial_sum(out.begin(), out.end(), out.begin());
  return out;
}

// Numbers the edges of a part's apexes as in the whole, and forgets those with a leg that is not useful.
void settle_apexes(const TriangulationView& tri, const VertexLinks& links, const UsefulEdges& whole, GrownEdges& part) {
  const auto is_useful = [&](VertexId p, VertexId q) {
    if (find_edge(tri, whole, p, q) != UsefulEdges::kNone) return true;
    const auto link = links.of(p);
    return std::find(link.begin(), link.end(), q) != link.end();
  };
  std::size_t i = 0, kept = 0;
  for (Apex apex : part.edges.apex) {
    while (part.edges.begin[i + 1] <= apex.edge) ++i;
    const VertexId a = part.vertex[i];
    apex.edge += whole.begin[a.value] - part.edges.begin[i];
    if (is_useful(whole.b[apex.edge], apex.point) && is_useful(a, apex.point)) part.edges.apex[kept++] = apex;
  }
  part.edges.apex.resize(kept);
}

}  // namespace

std::uint32_t UsefulEdges::find(VertexId from, VertexId to) const {
  for (std::uint32_t e = begin[from.value]; e < begin[from.value + 1]; ++e)
    if (b[e] == to) return e;
  return kNone;
}

void UsefulEdges::set_apexes(std::vector<Apex> apexes) {
  apex = std::move(apexes);
  const auto by_edge = [](const Apex& p, const Apex& q) { return p.edge < q.edge; };
  if (!std::is_sorted(apex.begin(), apex.end(), by_edge)) std::stable_sort(apex.begin(), apex.end(), by_edge);
  apex_begin_.assign(size() / kBlock + 2, 0);
  for (const Apex& p : apex) ++apex_begin_[p.edge / kBlock + 1];
  std::partial_sum(apex_begin_.begin(), apex_begin_.end(), apex_begin_.begin());
}

std::span<const Apex> UsefulEdges::apexes(std::uint32_t e) const {
  const std::uint32_t from = apex_begin_[e / kBlock], to = apex_begin_[e / kBlock + 1];
  if (from == to) return {};
  const auto all = std::span(apex).subspan(from, to - from);
  const auto first = std::partition_point(all.begin(), all.end(), [&](const Apex& p) { return p.edge < e; });
  const auto last = std::partition_point(first, all.end(), [&](const Apex& p) { return p.edge == e; });
  return {first, last};
}

void GrownEdges::keep(std::span<const std::uint8_t> wanted) {
  if (std::find(wanted.begin(), wanted.end(), std::uint8_t{0}) == wanted.end()) return;
  GrownEdges kept;
  std::size_t p = 0;  // among the apexes
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const std::uint32_t begin = edges.begin[i], end = edges.begin[i + 1], shift = begin - kept.edges.size();
    for (; p < edges.apex.size() && edges.apex[p].edge < end; ++p)
      if (wanted[i])
        kept.edges.apex.push_back(
            {edges.apex[p].edge - shift, edges.apex[p].point, edges.apex[p].order, edges.apex[p].is_right});
    if (!wanted[i]) continue;
    kept.vertex.push_back(vertex[i]);
    for_columns([&](auto column) {
      const auto& from = edges.*column;
      (kept.edges.*column).insert((kept.edges.*column).end(), from.begin() + begin, from.begin() + end);
    });
    kept.edges.begin.push_back(kept.edges.size());
  }
  *this = std::move(kept);
}

void GrownEdges::clear() {
  vertex.clear();
  for_columns([&](auto column) { (edges.*column).clear(); });
  edges.apex.clear();
  edges.begin.assign(1, 0);
}

UsefulEdges assemble(const TriangulationView& tri, const VertexLinks& links, std::vector<GrownEdges> parts,
                     const Executor& executor) {
  UsefulEdges out;
  out.begin = first_edges(tri.num_vertices(), parts);
  std::vector<std::vector<Run>> runs;
  for (const GrownEdges& part : parts) runs.push_back(runs_of(part, out.begin));
  for_columns([&](auto column) { move_array(parts, runs, column, out, executor); });
  executor(static_cast<std::uint32_t>(parts.size()),
           [&](std::uint32_t p) { settle_apexes(tri, links, out, parts[p]); });
  std::size_t num_apexes = 0;
  for (const GrownEdges& part : parts) num_apexes += part.edges.apex.size();
  std::vector<Apex> apexes;
  apexes.reserve(num_apexes);
  for (GrownEdges& part : parts) {
    apexes.insert(apexes.end(), part.edges.apex.begin(), part.edges.apex.end());
    part = {};
  }
  out.set_apexes(std::move(apexes));
  return out;
}

void locate_entries(const TriangulationView& tri, const VertexLinks& links, UsefulEdges& edges) {
  for (VertexId a{0}; a.value + 1 < edges.begin.size(); ++a.value)
    for (std::uint32_t e = edges.begin[a.value]; e < edges.begin[a.value + 1]; ++e) {
      const LatticePoint at_a = tri.position[a], at_b = tri.position[edges.b[e]];
      const std::uint32_t begin = links.begin[a.value], end = links.begin[a.value + 1];
      for (std::uint32_t i = begin; i < end; ++i) {
        const HalfedgeId spoke = links.spoke[i];
        if (spoke.is_none()) continue;
        const VertexId right = links.neighbor[i], left = links.neighbor[i + 1 == end ? begin : i + 1];
        if (orientation(at_a, tri.position[right], at_b) <= 0 || orientation(at_a, tri.position[left], at_b) >= 0)
          continue;
        edges.entry[e] = next(spoke);
        break;
      }
    }
}

UsefulEdges useful_edges(const TriangulationView& tri, const VertexLinks& links, int k, const Executor& executor) {
  const std::uint32_t n = tri.num_vertices();
  std::vector<GrownEdges> parts(k == 0 ? 0 : n / kGrowthRange + (n % kGrowthRange != 0));
  struct Tools {
    PencilGrowth growth;
    GrownEdges grown;  // its memory serves one part after the other
  };
  Pool<Tools> pool([&] { return std::unique_ptr<Tools>(new Tools{PencilGrowth(tri, links, k, kWholePlane), {}}); });
  executor(static_cast<std::uint32_t>(parts.size()), [&](std::uint32_t p) {
    const auto tools = pool.lend();
    std::vector<DecidingCircle> beyond;  // none: everything is known
    const std::uint32_t begin = p * kGrowthRange;
    for (std::uint32_t u = begin; u < begin + std::min(kGrowthRange, n - begin); ++u)
      tools->growth.grow(VertexId{u}, tools->grown, beyond);
    parts[p] = tools->grown;
    tools->grown.clear();
  });
  return assemble(tri, links, std::move(parts), executor);
}

}  // namespace hydrotin
