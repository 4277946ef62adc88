#include <algorithm>
#include <set>

#include "hydrotin/lake_breaches.h"
#include "path_members.h"
#include "phases.h"
#include "pit_options.h"
#include "schedule.h"
#include "surface.h"

namespace hydrotin {
namespace {

struct OpenLake {
  std::uint64_t seed = 0;
  std::vector<Cell> cells;  // ascending
  int reach = 2;            // cells to add around those where the next search stops
};
constexpr int kMaxReach = 8;

void sort_unique(std::vector<Cell>& cells) {
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
}

// The cells around some, and these: where searches go on next.
void add_around(const std::vector<Cell>& cells, OpenLake& lake) {
  for (const Cell& c : cells)
    for (int dx = -lake.reach; dx <= lake.reach; ++dx)
      for (int dy = -lake.reach; dy <= lake.reach; ++dy) lake.cells.emplace_back(c.first + dx, c.second + dy);
  sort_unique(lake.cells);
  lake.reach = std::min(2 * lake.reach, kMaxReach);  // long searches do not come back for every step
}

std::vector<OpenLake> read_own_lakes(const RunContext& context, std::uint32_t tile) {
  const store::Reader in(context.layout.unit(Phase::lakes, 0));
  const auto begin = in.read_range<std::uint64_t>("lake_begin", tile, 2);
  const auto seed = in.read_range<std::uint64_t>("lake_seed", begin[0], begin[1] - begin[0]);
  const auto cell_begin = in.read_range<std::uint64_t>("lake_cell_begin", begin[0], seed.size() + 1);
  const auto cell =
      in.read_range<std::int32_t>("lake_cell", 2 * cell_begin.front(), 2 * (cell_begin.back() - cell_begin.front()));
  std::vector<OpenLake> out;
  for (std::size_t i = 0; i < seed.size(); ++i) {
    OpenLake& lake = out.emplace_back();
    lake.seed = seed[i];
    for (std::uint64_t c = cell_begin[i] - cell_begin[0]; c < cell_begin[i + 1] - cell_begin[0]; ++c)
      lake.cells.emplace_back(cell[2 * c], cell[2 * c + 1]);
    add_around(std::vector<Cell>(lake.cells), lake);  // most searches look a little farther than the lake
  }
  return out;
}

// The cells with those around them, where searches go on next.
void add_cells(const CellGrid& grid, const Surface& window, std::span<const std::uint32_t> unknown, OpenLake& lake) {
  std::vector<Cell> found;
  for (const std::uint32_t v : unknown) found.push_back(grid.of(window.position[v]));
  sort_unique(found);
  add_around(found, lake);
}

constexpr std::uint64_t kVertexBytes = 256;  // of a window, while it is put together and searched

// How many of the first lakes will fit in memory together, one at least.
std::size_t batch_of(const RunContext& context, std::span<const OpenLake> lakes) {
  constexpr std::uint64_t kCellBytes = kVertexBytes * CellGrid::kVertices;
  constexpr std::uint64_t kFewest = 64, kMost = 2048;  // more cells at once save nothing
  const std::uint64_t most = std::clamp<std::uint64_t>(
      context.options.run.memory_bytes / (4 * worker_count(context.options.run) * kCellBytes), kFewest, kMost);
  std::set<Cell> chosen;
  std::size_t num_lakes = 0;
  for (const OpenLake& lake : lakes) {
    chosen.insert(lake.cells.begin(), lake.cells.end());
    if (num_lakes > 0 && chosen.size() > most) break;
    ++num_lakes;
  }
  return num_lakes;
}

std::vector<Cell> cells_of(std::span<const OpenLake> lakes) {
  std::vector<Cell> cells;
  for (const OpenLake& lake : lakes) cells.insert(cells.end(), lake.cells.begin(), lake.cells.end());
  sort_unique(cells);
  return cells;
}

struct Window {
  std::vector<Cell> cells;
  Surface surface;
};

// Loads the terrain around the first lakes; where there are more vertices than memory, around fewer of them.
Window window_around(const RunContext& context, std::span<const OpenLake> lakes, std::size_t& num_lakes) {
  const CellGrid grid(context.outline);
  const std::uint64_t memory = context.options.run.memory_bytes;
  for (;;) {
    Window window{cells_of(lakes.first(num_lakes)), {}};
    if (auto surface = read_window(context, grid, window.cells, memory / kVertexBytes)) {
      window.surface = std::move(*surface);
      return window;
    }
    if (num_lakes > 1) {
      num_lakes /= 2;
      continue;
    }
    const LatticePoint corner = grid.box(window.cells.front()).min;
    throw Error(ErrorKind::resource, "the lake around (" + std::to_string(context.plan.lattice.x(corner.x)) + ", " +
                                         std::to_string(context.plan.lattice.y(corner.y)) + ") cannot be loaded into " +
                                         std::to_string(memory >> 20) +
                                         " MiB; raise run.memory, declare the lake an outlet, or use pits.method: "
                                         "lift");
  }
}

// Answers for the lakes that know enough; returns the others with more cells.
std::vector<OpenLake> breach_batch(const RunContext& context, std::span<const OpenLake> lakes, const Window& around,
                                   PathMembers& members) {
  const CellGrid grid(context.outline);
  const RemovalOptions options = removal_options(context);
  const Surface& window = around.surface;
  const std::vector<Cell>& cells = around.cells;
  const ChangeableSurface changeable(context, window, false);
  std::vector<std::uint8_t> is_known(window.num_vertices());
  for (std::uint32_t v = 0; v < is_known.size(); ++v)
    is_known[v] = std::binary_search(cells.begin(), cells.end(), grid.of(window.position[v]));
  std::vector<std::uint64_t> seeds;
  for (const OpenLake& lake : lakes) seeds.push_back(lake.seed);
  std::sort(seeds.begin(), seeds.end());
  std::vector<std::pair<std::uint64_t, std::uint32_t>> vertex_of;  // of the seeds
  for (std::uint32_t v = 0; v < window.num_vertices(); ++v)
    if (std::binary_search(seeds.begin(), seeds.end(), window.point[v])) vertex_of.emplace_back(window.point[v], v);
  std::sort(vertex_of.begin(), vertex_of.end());
  LakeBreacher breacher(changeable.view(), window.level, is_known, lowest_outlets_of(context), reach_of(options),
                        options.measure, options.limits);
  LakeBound bound(changeable.view(), window.level, is_known, options.measure);
  std::vector<OpenLake> still_open;
  LakeBreaches found;
  for (const OpenLake& lake : lakes) {
    const auto at = std::lower_bound(vertex_of.begin(), vertex_of.end(), std::pair{lake.seed, std::uint32_t{0}});
    if (at == vertex_of.end() || at->first != lake.seed)
      throw Error(ErrorKind::storage, context.layout.unit(Phase::lakes, 0) +
                                          ": a lake's vertex is not in its cells; delete the file and run again");
    const auto vertices = breacher.lake_around(at->second);
    breacher.run(found);
    const std::int64_t lake_bound = bound.run(vertices, found.unknown);
    if (found.unknown.empty()) {
      members.add(window, found, lake_bound);
    } else {
      still_open.push_back(lake);
      add_cells(grid, window, found.unknown, still_open.back());
    }
  }
  return still_open;
}

}  // namespace

void breach_lakes(const RunContext& context, std::uint32_t tile) {
  PathMembers members;
  std::vector<OpenLake> lakes = read_own_lakes(context, tile);
  while (!lakes.empty()) {
    std::vector<OpenLake> next;
    for (std::size_t first = 0; first < lakes.size();) {
      const std::span<const OpenLake> left = std::span(lakes).subspan(first);
      std::size_t count = batch_of(context, left);
      const Window window = window_around(context, left, count);
      for (OpenLake& lake : breach_batch(context, left.first(count), window, members)) next.push_back(std::move(lake));
      first += count;
    }
    lakes = std::move(next);
  }
  // What the tile's own searches found of vertices that other tiles have too is told along with it.
  const store::Reader own(context.layout.unit(Phase::pools, tile));
  const auto point = own.read<std::uint64_t>("point");
  const auto rim = own.read<std::uint8_t>("rim");
  std::vector<std::uint64_t> shared;
  for (std::size_t v = 0; v < point.size() && v < rim.size(); ++v)
    if (rim[v]) shared.push_back(point[v]);
  std::sort(shared.begin(), shared.end());
  for (const auto& member : read_path_members(own))
    if (std::binary_search(shared.begin(), shared.end(), member.first)) members.member.push_back(member);
  store::Writer out(context.layout.unit(Phase::breach, tile));
  out.set("recipe", context.recipe(Phase::breach));
  members.write(out);
  members.write_tiles(out);
  out.commit();
}

}  // namespace hydrotin
