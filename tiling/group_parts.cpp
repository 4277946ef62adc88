#include "group_parts.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace hydrotin {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// A vertex with what decides its part.
struct Placed {
  std::uint32_t piece, lake;  // lake: number of one that reaches the rim; kNone
  std::uint64_t cell;
  std::uint32_t vertex;
  LatticePoint place;
  [[nodiscard]] auto key() const { return std::tie(piece, lake, cell); }
};

GroupParts parts_by(std::vector<Placed> placed, std::uint32_t num_vertices) {
  std::sort(placed.begin(), placed.end(), [](const Placed& a, const Placed& b) {
    return a.key() != b.key() ? a.key() < b.key() : a.vertex < b.vertex;
  });
  GroupParts out;
  out.of.assign(num_vertices, kNone);
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const Placed& p = placed[i];
    if (i == 0 || placed[i - 1].key() != p.key()) {
      out.piece.push_back(p.piece);
      out.size.push_back(0);
      out.place.push_back(p.place);
      out.is_lake.push_back(p.lake != kNone);
    }
    ++out.size.back();
    out.of[p.vertex] = static_cast<std::uint32_t>(out.size.size() - 1);
  }
  return out;
}

}  // namespace

GroupParts parts_of(const Surface& surface, const ChangeableTerrain& terrain, std::span<const std::uint32_t> label,
                    const CutGrid& grid) {
  std::vector<Placed> placed;
  std::vector<std::uint8_t> is_seen(surface.num_vertices(), 0);
  std::vector<std::uint32_t> lake;
  std::uint32_t num_lakes = 0;
  for (std::uint32_t v = 0; v < surface.num_vertices(); ++v) {
    if (label[v] == kNone || is_seen[v]) continue;
    const LatticePoint p = surface.position[v];
    if (surface.level[v] == terrain.height[v]) {
      placed.push_back({label[v], kNone, grid.cell_of(p), v, p});
      continue;
    }
    collect_lake(terrain, surface.level, v, is_seen, lake);
    LatticePoint first = p;
    bool is_open = false;
    for (const std::uint32_t w : lake) {
      first = std::min(first, surface.position[w]);
      is_open = is_open || surface.is_rim[w];
    }
    const std::uint32_t number = is_open ? num_lakes++ : kNone;
    for (const std::uint32_t w : lake) placed.push_back({label[v], number, grid.cell_of(first), w, first});
  }
  return parts_by(std::move(placed), surface.num_vertices());
}

GroupParts whole_parts(const Surface& surface, std::span<const std::uint32_t> label) {
  std::vector<Placed> placed;
  for (std::uint32_t v = 0; v < surface.num_vertices(); ++v)
    if (label[v] != kNone) placed.push_back({label[v], kNone, 0, v, surface.position[v]});
  return parts_by(std::move(placed), surface.num_vertices());
}

void write_parts(store::Writer& out, const GroupParts& parts) {
  std::vector<std::int32_t> xy;
  for (const LatticePoint p : parts.place) xy.insert(xy.end(), {p.x, p.y});
  out.append("part_piece", parts.piece, "parts between which a group may be cut: index into piece_size, ascending");
  out.append("part_size", parts.size, "their vertices");
  out.append("part_xy", xy, "a point of the cell in which the part has its place; of a lake its smallest vertex here");
  out.append("part_is_lake", parts.is_lake, "1: a lake that other tiles have too");
}

GroupParts read_parts(const store::Reader& in, std::size_t num_pieces) {
  GroupParts out;
  out.piece = in.read<std::uint32_t>("part_piece");
  out.size = in.read<std::uint64_t>("part_size");
  const auto xy = in.read<std::int32_t>("part_xy");
  out.is_lake = in.read<std::uint8_t>("part_is_lake");
  const std::size_t n = out.piece.size();
  if (out.size.size() != n || xy.size() != 2 * n || out.is_lake.size() != n ||
      !std::is_sorted(out.piece.begin(), out.piece.end()) || (n > 0 && out.piece.back() >= num_pieces))
    throw Error(ErrorKind::storage, in.path() +
                                        ": the parts of its groups contradict each other; delete the file and "
                                        "run again");
  for (std::size_t i = 0; i < n; ++i) out.place.push_back({xy[2 * i], xy[2 * i + 1]});
  return out;
}

}  // namespace hydrotin
