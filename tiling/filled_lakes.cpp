#include "filled_lakes.h"

#include <algorithm>
#include <string>
#include <vector>

#include "hydrotin/pit_removal.h"
#include "store.h"

namespace hydrotin {
namespace {

// Vertices of the filled lakes' pieces in this tile.
std::vector<std::uint32_t> vertices_of(const RunContext& context, std::uint32_t tile, const Surface& surface) {
  const store::Reader in(context.layout.unit(Phase::lakes, 0));
  const auto begin = in.read_range<std::uint64_t>("filled_begin", tile, 2);
  auto seeds = in.read_range<std::uint64_t>("filled_seed", begin[0], begin[1] - begin[0]);
  std::sort(seeds.begin(), seeds.end());
  std::vector<std::uint32_t> lake;
  std::vector<std::uint8_t> is_met(surface.num_vertices(), 0);
  const auto meet = [&](std::uint32_t v) {
    if (is_met[v] || surface.level[v] == surface.height[v]) return;
    is_met[v] = 1;
    lake.push_back(v);
  };
  for (std::uint32_t v = 0; !seeds.empty() && v < surface.num_vertices(); ++v)
    if (std::binary_search(seeds.begin(), seeds.end(), surface.point[v])) meet(v);
  if (lake.size() != seeds.size())
    throw Error(ErrorKind::storage, in.path() + ": a lake's vertex is not in the water of tile " +
                                        std::to_string(tile) + "; delete the file and run again");
  for (std::size_t next = 0; next < lake.size(); ++next)
    for (const std::uint32_t w : surface.graph.neighbors(lake[next])) meet(w);
  return lake;
}

// [n] nonzero where this tile counts the vertex.
std::vector<std::uint8_t> counted_here(const RunContext& context, std::uint32_t tile, const Surface& surface) {
  std::vector<std::uint32_t> rim;
  for (std::uint32_t v = 0; v < surface.num_vertices(); ++v)
    if (surface.is_rim[v]) rim.push_back(v);
  std::sort(rim.begin(), rim.end(),
            [&](std::uint32_t a, std::uint32_t b) { return surface.point[a] < surface.point[b]; });
  const store::Reader in(context.layout.unit(Phase::rank, 0));
  const auto begin = in.read_range<std::uint64_t>("count_begin", tile, 2);
  const auto counts = in.read_range<std::uint8_t>("rim_counts", begin[0], begin[1] - begin[0]);
  if (counts.size() != rim.size())
    throw Error(ErrorKind::storage, in.path() + ": its rim is not that of tile " + std::to_string(tile) +
                                        "; delete the scratch folder's nest and rank and run again");
  std::vector<std::uint8_t> out(surface.num_vertices(), 1);
  for (std::size_t i = 0; i < rim.size(); ++i) out[rim[i]] = counts[i];
  return out;
}

}  // namespace

std::vector<std::uint8_t> fill_largest_lakes(const RunContext& context, std::uint32_t tile, Surface& surface,
                                             ChangeFigures& figures) {
  const std::vector<std::uint32_t> lake = vertices_of(context, tile, surface);
  std::vector<std::uint8_t> is_filled(surface.num_vertices(), 0);
  if (lake.empty()) return is_filled;
  const std::vector<std::uint8_t> counts = counted_here(context, tile, surface);
  const std::vector<std::int64_t> star = star_weights(surface.position, surface.triangle);
  for (const std::uint32_t v : lake) {
    const std::int64_t rise = std::int64_t{surface.level[v]} - surface.height[v];
    if (counts[v])
      figures.add(rise, star[v]);
    else
      figures.volume.add(static_cast<double>(star[v]) * static_cast<double>(rise));
    surface.height[v] = surface.level[v];
    surface.is_outlet[v] = 1;
    is_filled[v] = 1;
  }
  return is_filled;
}

}  // namespace hydrotin
