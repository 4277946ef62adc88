#include "check_topology.h"

#include <algorithm>
#include <tuple>

#include "hydrotin/predicates.h"
#include "hydrotin/wide.h"
#include "terrain_file.h"

namespace hydrotin {
namespace {

std::string file_of(const DatasetIndex& index, std::uint64_t point) {
  return index.tile_path(PointId(point).tile());
}

std::string edge_text(const DatasetIndex& index, const PlacedEdge& e) {
  return file_of(index, e.origin) + ": the edge from " + index.place(e.from) + " to " + index.place(e.to);
}

bool same_edge(const PlacedEdge& a, const PlacedEdge& b) {
  return a.origin == b.origin && a.target == b.target;
}

// The open edges that no other file has the other way round, by origin and target.
std::vector<PlacedEdge> unmatched_edges(const DatasetIndex& index, std::span<const TileFacts> facts,
                                        Problems& problems) {
  std::vector<PlacedEdge> open;
  for (const TileFacts& f : facts) open.insert(open.end(), f.open.begin(), f.open.end());
  const auto key = [](const PlacedEdge& e) {
    return std::tuple(std::min(e.origin, e.target), std::max(e.origin, e.target), e.origin);
  };
  std::sort(open.begin(), open.end(), [&](const PlacedEdge& a, const PlacedEdge& b) { return key(a) < key(b); });
  std::vector<PlacedEdge> out;
  for (std::size_t first = 0; first < open.size();) {
    std::size_t last = first + 1;
    const auto ends = [&](std::size_t i) { return std::minmax(open[i].origin, open[i].target); };
    while (last < open.size() && ends(last) == ends(first)) ++last;
    if (last - first == 1) {
      out.push_back(open[first]);
    } else if (last - first > 2 || same_edge(open[first], open[first + 1])) {
      problems.add("topology", edge_text(index, open[first]) + " has more than one triangle on a side");
    }
    first = last;
  }
  std::sort(out.begin(), out.end(), [](const PlacedEdge& a, const PlacedEdge& b) {
    return std::tie(a.origin, a.target) < std::tie(b.origin, b.target);
  });
  return out;
}

// The edges of the hull in their order, from the first by origin; fewer if the chain does not close.
std::vector<PlacedEdge> chain_of(const std::vector<PlacedEdge>& edges) {
  std::vector<PlacedEdge> chain;
  std::size_t at = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    chain.push_back(edges[at]);
    const auto found = std::partition_point(edges.begin(), edges.end(),
                                            [&](const PlacedEdge& e) { return e.origin < chain.back().target; });
    if (found == edges.end() || found->origin != chain.back().target) break;
    at = static_cast<std::size_t>(found - edges.begin());
    if (at == 0) break;
  }
  return chain;
}

// Without the vertices that rivers added, which may lie a unit beside their hull edge.
std::vector<PlacedEdge> without_new_vertices(const DatasetIndex& index, const std::vector<PlacedEdge>& chain) {
  const auto is_new = [&](std::uint64_t point) { return PointId(point).tile() == index.num_tiles(); };
  std::vector<PlacedEdge> out;
  std::size_t first = 0;
  while (first < chain.size() && is_new(chain[first].origin)) ++first;
  for (std::size_t i = 0; i < chain.size() && first < chain.size(); ++i) {
    const PlacedEdge& e = chain[(first + i) % chain.size()];
    if (is_new(e.origin)) {
      out.back().target = e.target;
      out.back().to = e.to;
    } else {
      out.push_back(e);
    }
  }
  return out;
}

// Turns left everywhere, and goes around once: it passes from leftward to rightward directions once.
void check_convex(const DatasetIndex& index, const std::vector<PlacedEdge>& chain, Problems& problems) {
  int turns_to_right = 0;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const PlacedEdge& e = chain[i];
    const PlacedEdge& f = chain[(i + 1) % chain.size()];
    if (orientation(e.from, e.to, f.to) < 0) problems.add("hull", edge_text(index, f) + " makes the hull reflex");
    turns_to_right += !(e.from < e.to) && f.from < f.to;
  }
  if (turns_to_right != 1) problems.add("hull", index.path + ": the hull goes around more than once");
}

Wide twice_area_inside(const std::vector<PlacedEdge>& chain) {
  Wide area = 0;
  const LatticePoint o = chain.front().from;
  for (const PlacedEdge& e : chain) {
    const Wide ax = std::int64_t{e.from.x} - o.x, ay = std::int64_t{e.from.y} - o.y;
    const Wide bx = std::int64_t{e.to.x} - o.x, by = std::int64_t{e.to.y} - o.y;
    area += ax * by - ay * bx;
  }
  return area;
}

}  // namespace

void check_edges(const DatasetIndex& index, std::span<const TileFacts> facts, Problems& problems) {
  const std::vector<PlacedEdge> left = unmatched_edges(index, facts, problems);
  std::vector<std::pair<std::uint64_t, std::uint64_t>> stated;
  Area covered = 0;
  std::uint64_t num_triangles = 0, num_vertices = 0;
  for (std::uint32_t t = 0; t < facts.size(); ++t) {
    for (const PlacedEdge& e : facts[t].hull) stated.emplace_back(e.origin, e.target);
    covered += facts[t].twice_area;
    num_triangles += index.triangles[t];
    num_vertices += index.count[t];
  }
  num_vertices += index.new_position.size();
  std::sort(stated.begin(), stated.end());
  std::uint64_t on_hull = 0;
  for (const PlacedEdge& e : left) {
    const bool is_stated = std::binary_search(stated.begin(), stated.end(), std::pair{e.origin, e.target});
    on_hull += is_stated ? 1 : 0;
    if (!is_stated) problems.add("topology", edge_text(index, e) + " has no triangle on its other side");
  }
  if (on_hull < stated.size())
    problems.add("hull", index.path + ": " + std::to_string(stated.size() - on_hull) +
                             " edges that files put on the hull have triangles on both sides");
  if (left.size() < 3) {
    problems.add("hull", index.path + ": the terrain has no closed hull");
    return;
  }
  const std::vector<PlacedEdge> chain = chain_of(left);
  if (chain.size() != left.size() || chain.back().target != chain.front().origin) {
    problems.add("hull", edge_text(index, chain.back()) + " ends the chain of the hull after " +
                             std::to_string(chain.size()) + " of " + std::to_string(left.size()) + " boundary edges");
    return;
  }
  check_convex(index, without_new_vertices(index, chain), problems);
  const Wide inside = twice_area_inside(chain);
  if (inside < 0 || static_cast<Area>(inside) != covered)
    problems.add("area", index.path +
                             ": the areas of the triangles do not sum up to the area of the hull, so triangles "
                             "overlap or leave gaps");
  // V - E + F = 1 with E = (3F + H) / 2.
  if (2 * num_vertices != num_triangles + left.size() + 2)
    problems.add("topology", index.path + ": " + std::to_string(num_vertices) + " vertices, " +
                                 std::to_string(num_triangles) + " triangles and " + std::to_string(left.size()) +
                                 " hull edges contradict Euler's formula");
}

std::vector<ForeignVertex> sorted_claims(std::span<const TileFacts> facts) {
  std::vector<ForeignVertex> out;
  for (const TileFacts& f : facts) out.insert(out.end(), f.foreign.begin(), f.foreign.end());
  std::sort(out.begin(), out.end(), [](const ForeignVertex& a, const ForeignVertex& b) {
    return std::tie(a.point, a.tile) < std::tie(b.point, b.tile);
  });
  return out;
}

void check_owner(const DatasetIndex& index, std::uint32_t owner, std::span<const ForeignVertex> claims,
                 Problems& problems) {
  const store::Reader in(index.tile_path(owner));
  const TilePoints own = read_points(in, 0, index.count[owner]);
  const auto height = in.read_range<std::int32_t>("height", 0, index.count[owner]);
  auto claim = claims.begin();
  for (std::uint32_t i = 0; i < height.size(); ++i) {
    std::int32_t final_height = height[i];
    for (; claim != claims.end() && PointId(claim->point).index() == i; ++claim) {
      const std::string where = index.tile_path(claim->tile) + ": the point of tile " + std::to_string(owner) + " at " +
                                index.place(claim->position);
      if (claim->position != own.position[i] || claim->measured != own.height[i])
        problems.add("foreign coordinates", where + " has other coordinates in " + in.path());
      if (final_height == kUnusedHeight) final_height = claim->height;
      if (claim->height != final_height) problems.add("foreign heights", where + " has another height elsewhere");
    }
    if (final_height == kUnusedHeight)
      problems.add("use of vertices",
                   in.path() + ": the point at " + index.place(own.position[i]) + " is a vertex of no triangle");
  }
}

void check_new_vertices(const DatasetIndex& index, std::span<const ForeignVertex> claims, Problems& problems) {
  auto claim = claims.begin();
  for (std::uint32_t i = 0; i < index.new_position.size(); ++i) {
    const std::string where =
        index.tile_path(index.num_tiles()) + ": the new vertex at " + index.place(index.new_position[i]);
    if (claim == claims.end() || PointId(claim->point).index() != i)
      problems.add("use of vertices", where + " is a vertex of no triangle");
    for (const auto first = claim; claim != claims.end() && PointId(claim->point).index() == i; ++claim) {
      if (claim->position != index.new_position[i] || claim->measured != index.new_height[i])
        problems.add("foreign coordinates", where + " has other coordinates in " + index.tile_path(claim->tile));
      if (claim->height != first->height)
        problems.add("foreign heights", where + " has another height in " + index.tile_path(claim->tile));
    }
  }
}

void check_rivers(const DatasetIndex& index, std::span<const TileFacts> facts, std::uint64_t& num_edges,
                  std::uint64_t& num_invalid, Problems& problems) {
  using Edges = std::vector<std::pair<std::uint64_t, std::uint64_t>>;
  const auto all = [&](Edges TileFacts::*list) {
    Edges out;
    for (const TileFacts& f : facts) out.insert(out.end(), (f.*list).begin(), (f.*list).end());
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  };
  num_edges = all(&TileFacts::river).size();
  const Edges invalid = all(&TileFacts::invalid_river);
  num_invalid = invalid.size();
  if (num_edges != index.river_edges || num_invalid != index.invalid_river_edges)
    problems.add("index", index.path + ": it states " + std::to_string(index.river_edges) + " river edges, " +
                              std::to_string(index.invalid_river_edges) + " of them invalid, but there are " +
                              std::to_string(num_edges) + " and " + std::to_string(num_invalid));
  for (const auto& edge : invalid)
    if (!std::binary_search(index.contradicted.begin(), index.contradicted.end(), edge))
      problems.add("rivers", file_of(index, edge.first) + ": a river edge from point " +
                                 std::to_string(PointId(edge.first).index()) +
                                 " is invalid, though nothing speaks "
                                 "against it");
}

void check_sums(const DatasetIndex& index, std::span<const TileFacts> facts, Problems& problems) {
  std::uint64_t vertices = 0, triangles = 0;
  Fingerprint fingerprint;
  for (std::uint32_t t = 0; t < facts.size(); ++t) {
    vertices += index.count[t];
    triangles += index.triangles[t];
    fingerprint.add(facts[t].fingerprint);
  }
  vertices += index.new_position.size();
  const auto expect = [&](const std::string& what, std::uint64_t stated, std::uint64_t counted) {
    if (stated != counted)
      problems.add("index", index.path + ": it states " + std::to_string(stated) + " " + what + ", but there are " +
                                std::to_string(counted));
  };
  expect("vertices", index.vertices, vertices);
  expect("triangles", index.num_triangles, triangles);
  expect("points", index.points, index.vertices - index.new_position.size() + index.removed + index.duplicates);
  if (fingerprint.hex() != index.fingerprint)
    problems.add("fingerprint", index.path + ": the files have the fingerprint " + fingerprint.hex() + ", not " +
                                    index.fingerprint + " as it states");
}

}  // namespace hydrotin
