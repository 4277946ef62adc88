#include <algorithm>
#include <numeric>

#include "phases.h"
#include "pieces.h"
#include "whole_array.h"

namespace hydrotin {
namespace {

// Border edges of all tiles with the piece's number among all pieces.
struct GlobalEdge {
  PointId a, b;
  std::uint64_t piece;
  friend auto operator<=>(const GlobalEdge&, const GlobalEdge&) = default;
};

struct AllPieces {
  std::vector<std::uint64_t> first{0};       // [tiles + 1] first piece of each tile
  std::vector<std::uint32_t> num_triangles;  // [pieces]
  std::vector<GlobalEdge> border;
};

AllPieces read_all(const RunContext& context) {
  std::vector<PieceSummary> tiles(context.plan.num_tiles());
  for_all(context, tiles.size(), [&](std::uint64_t t) {
    tiles[t] = read_piece_summary(store::Reader(context.layout.unit(Phase::triangulate, t)));
  });
  AllPieces all;
  for (const PieceSummary& tile : tiles) {
    for (const BorderEdge& e : tile.border) all.border.push_back({e.a, e.b, all.first.back() + e.piece});
    all.num_triangles.insert(all.num_triangles.end(), tile.num_triangles.begin(), tile.num_triangles.end());
    all.first.push_back(all.num_triangles.size());
  }
  std::sort(all.border.begin(), all.border.end());
  return all;
}

// Root of each piece; every border edge has to be listed by exactly the two tiles beside it.
std::vector<std::uint64_t> unite(const AllPieces& all) {
  std::vector<std::uint64_t> root(all.num_triangles.size());
  std::iota(root.begin(), root.end(), std::uint64_t{0});
  const auto find = [&](std::uint64_t p) {
    while (root[p] != p) p = root[p] = root[root[p]];
    return p;
  };
  for (std::size_t i = 0; i < all.border.size(); i += 2) {
    const bool paired =
        i + 1 < all.border.size() && all.border[i].a == all.border[i + 1].a && all.border[i].b == all.border[i + 1].b;
    if (!paired)
      throw std::logic_error("join: the edge between point " + std::to_string(all.border[i].a.value) + " and point " +
                             std::to_string(all.border[i].b.value) + " is known to one tile only");
    const std::uint64_t p = find(all.border[i].piece), q = find(all.border[i + 1].piece);
    root[std::max(p, q)] = std::min(p, q);
  }
  for (std::uint64_t p = 0; p < root.size(); ++p) root[p] = find(p);
  return root;
}

}  // namespace

void join_pieces(const RunContext& context) {
  const AllPieces all = read_all(context);
  const std::vector<std::uint64_t> root = unite(all);
  const std::uint32_t num_tiles = context.plan.num_tiles();
  std::vector<std::uint32_t> tile_of(root.size());
  for (std::uint32_t t = 0; t < num_tiles; ++t)
    for (std::uint64_t p = all.first[t]; p < all.first[t + 1]; ++p) tile_of[p] = t;

  // The tile of the largest piece solves the polygon.
  std::vector<std::uint64_t> largest(root.size(), static_cast<std::uint64_t>(-1));
  for (std::uint64_t p = 0; p < root.size(); ++p) {
    std::uint64_t& best = largest[root[p]];
    if (best == static_cast<std::uint64_t>(-1) || all.num_triangles[p] > all.num_triangles[best]) best = p;
  }
  std::vector<std::uint64_t> order(root.size());
  std::iota(order.begin(), order.end(), std::uint64_t{0});
  const auto solver = [&](std::uint64_t p) { return tile_of[largest[root[p]]]; };
  std::sort(order.begin(), order.end(), [&](std::uint64_t p, std::uint64_t q) {
    return std::tuple(solver(p), root[p], p) < std::tuple(solver(q), root[q], q);
  });

  std::vector<std::uint64_t> polygon_begin(num_tiles + 1), member_begin{0};
  std::vector<std::uint32_t> member_tile, member_piece;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::uint64_t p = order[i];
    member_tile.push_back(tile_of[p]);
    member_piece.push_back(static_cast<std::uint32_t>(p - all.first[tile_of[p]]));
    if (i + 1 == order.size() || root[order[i + 1]] != root[p]) {
      member_begin.push_back(member_tile.size());
      ++polygon_begin[solver(p) + 1];
    }
  }
  std::partial_sum(polygon_begin.begin(), polygon_begin.end(), polygon_begin.begin());

  store::Writer out(context.layout.unit(Phase::join, 0));
  out.set("recipe", context.recipe(Phase::join));
  out.append("polygon_begin", polygon_begin, "first polygon of each solving tile");
  out.append("member_begin", member_begin, "first piece of each polygon");
  out.append("member_tile", member_tile);
  out.append("member_piece", member_piece);
  out.commit();
}

}  // namespace hydrotin
