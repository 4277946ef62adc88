#include <algorithm>
#include <optional>

#include "hydrotin/lake_breaches.h"
#include "hydrotin/lifting.h"
#include "part.h"
#include "path_members.h"
#include "phases.h"
#include "pit_options.h"
#include "surface.h"

namespace hydrotin {
namespace {

// Lakes that this tile cannot answer for alone, as CSR.
struct OpenLakes {
  std::vector<std::uint64_t> seed, size;  // a vertex; vertices in this part
  std::vector<std::uint64_t> rim_begin{0}, rim;
  std::vector<std::uint64_t> cell_begin{0};
  std::vector<std::int32_t> cell;  // x, y

  void add(const Surface& surface, const CellGrid& grid, std::span<const std::uint32_t> lake,
           std::span<const std::uint32_t> unknown) {
    seed.push_back(surface.point[lake.front()]);
    size.push_back(lake.size());
    std::vector<Cell> cells;
    for (const std::uint32_t v : lake) {
      if (surface.is_rim[v]) rim.push_back(surface.point[v]);
      cells.push_back(grid.of(surface.position[v]));
    }
    for (const std::uint32_t v : unknown) cells.push_back(grid.of(surface.position[v]));
    std::sort(cells.begin(), cells.end());
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    for (const Cell& c : cells) cell.insert(cell.end(), {c.first, c.second});
    rim_begin.push_back(rim.size());
    cell_begin.push_back(cell.size() / 2);
  }
};

void write_lakes(store::Writer& out, const OpenLakes& lakes) {
  out.append("lake_seed", lakes.seed, "lakes left to `breach`: a vertex of each, tile << 32 | index");
  out.append("lake_size", lakes.size, "their vertices in this part");
  out.append("lake_rim_begin", lakes.rim_begin, "offsets into lake_rim, one more than lakes");
  out.append("lake_rim", lakes.rim, "their vertices on the rim");
  out.append("lake_cell_begin", lakes.cell_begin, "offsets into lake_cell, one more than lakes");
  out.append("lake_cell", lakes.cell, "cells of the grid in which they lie: x, y");
}

}  // namespace

void pool_tile(const RunContext& context, std::uint32_t tile) {
  Surface surface;
  {
    Part part = load_part(context, tile);
    PartLevels levels = levels_of(context, tile, part);
    surface.point = std::move(part.point);
    surface.position = std::move(part.position);
    surface.height = std::move(part.height);
    surface.level = std::move(levels.level);
    surface.is_outlet = std::move(levels.is_outlet);
    surface.is_rim = std::move(part.is_rim);
    surface.triangle = std::move(part.triangle);
    surface.graph = std::move(part.graph);
  }
  store::Writer out(context.layout.unit(Phase::pools, tile));
  out.set("recipe", context.recipe(Phase::pools));
  write_surface(out, surface);
  std::int64_t deepest = 0;
  for (std::uint32_t v = 0; v < surface.num_vertices(); ++v)
    deepest = std::max(deepest, std::int64_t{surface.level[v]} - surface.height[v]);
  out.set("deepest", deepest);
  PathMembers members;
  OpenLakes open;
  if (context.options.pits.method != PitMethod::lift) {
    const RemovalOptions options = removal_options(context);
    const ChangeableSurface changeable(context, surface, false);
    const CellGrid grid(context.outline);
    std::vector<std::uint8_t> is_known(surface.num_vertices()), is_seen(surface.num_vertices(), 0);
    for (std::uint32_t v = 0; v < is_known.size(); ++v) is_known[v] = surface.is_rim[v] == 0;
    LakeBreacher breacher(changeable.view(), surface.level, is_known, lowest_outlets_of(context), reach_of(options),
                          options.measure, options.limits);
    LakeBound bound(changeable.view(), surface.level, is_known, options.measure);
    LakeBreaches found;
    for (std::uint32_t seed = 0; seed < is_seen.size(); ++seed) {
      if (is_seen[seed] || surface.level[seed] == surface.height[seed]) continue;
      const auto lake = breacher.lake_around(seed);
      for (const std::uint32_t v : lake) is_seen[v] = 1;
      if (lake.size() > options.limits.max_lake) {  // filled: `lakes` tells all tiles
        open.add(surface, grid, lake, {});
        continue;
      }
      breacher.run(found);
      const std::int64_t lake_bound = bound.run(lake, found.unknown);
      if (found.unknown.empty())
        members.add(surface, found, lake_bound);
      else
        open.add(surface, grid, lake, found.unknown);
    }
  }
  write_lakes(out, open);
  members.write(out);
  out.commit();
}

}  // namespace hydrotin
