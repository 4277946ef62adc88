#include "kept_pits.h"

#include <algorithm>

namespace hydrotin {

PitTable read_pit_table(const store::Reader& in) {
  const auto xyz = in.read<std::int32_t>("pit_xyz"), spill = in.read<std::int32_t>("spill_xyz");
  const auto plateau = in.read<std::uint64_t>("pit_plateau"), vertices = in.read<std::uint64_t>("basin_vertices");
  const auto parent = in.read<std::uint32_t>("pit_parent");
  const auto displacement = in.read<std::int64_t>("basin_displacement");
  const auto area = in.read<std::int64_t>("basin_doubled_area");
  const auto volume = in.read<double>("basin_volume");
  PitTable out;
  out.is_kept = in.read<std::uint8_t>("kept");
  const std::size_t n = out.is_kept.size();
  if (xyz.size() != 3 * n || spill.size() != 3 * n || plateau.size() != n || vertices.size() != n ||
      parent.size() != n || displacement.size() != n || area.size() != n || volume.size() != n)
    throw Error(ErrorKind::storage, in.path() + ": its arrays of pits differ in length; delete the file and run again");
  for (std::size_t i = 0; i < n; ++i) {
    PitBasin& b = out.pit.emplace_back();
    b.pit = {{xyz[3 * i], xyz[3 * i + 1]}, 0, xyz[3 * i + 2], plateau[i]};
    b.parent = parent[i];
    b.spill_vertex = 0;
    b.spill_position = {spill[3 * i], spill[3 * i + 1]};
    b.spill_level = spill[3 * i + 2];
    b.num_vertices = vertices[i];
    b.displacement = displacement[i];
    b.doubled_area = area[i];
    b.volume = volume[i];
  }
  return out;
}

std::vector<std::uint8_t> kept_flags(const RunContext& context, std::uint32_t tile, const Part& part) {
  std::vector<std::uint8_t> is_kept(part.num_vertices(), 0);
  const PitOptions& pits = context.options.pits;
  if (pits.method == PitMethod::none || (!pits.keep.any() && !pits.cheapest)) return is_kept;
  const store::Reader in(context.layout.unit(Phase::choose, 0));
  const auto begin = in.read_range<std::uint64_t>("kept_begin", tile, 2);
  std::vector<std::uint32_t> open;
  for (const std::uint64_t seed : in.read_range<std::uint64_t>("kept_seed", begin[0], begin[1] - begin[0])) {
    const auto v = part.find(PointId(seed));
    if (!v)
      throw Error(ErrorKind::storage, in.path() + ": a kept pit at no vertex of tile " + std::to_string(tile) +
                                          "; delete the file and run again");
    if (is_kept[*v]) continue;
    is_kept[*v] = 1;
    open.assign(1, *v);
    while (!open.empty()) {
      const std::uint32_t u = open.back();
      open.pop_back();
      for (const std::uint32_t w : part.graph.neighbors(u)) {
        if (is_kept[w] || part.height[w] != part.height[u]) continue;
        is_kept[w] = 1;
        open.push_back(w);
      }
    }
  }
  return is_kept;
}

}  // namespace hydrotin
