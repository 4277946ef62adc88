#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <filesystem>
#include <mutex>
#include <optional>

#include "check_order.h"
#include "check_tile.h"
#include "check_topology.h"
#include "file_checksum.h"
#include "hydrotin/pipeline.h"
#include "removed_errors.h"

namespace hydrotin {
namespace {

// Each task holds a tile and more; a few at a time are enough to be limited by the disk.
constexpr int kTilesInFlight = 4;

template <class Body>
void for_each_tile(const DatasetIndex& index, Body body) {
  tbb::task_arena arena(std::min(kTilesInFlight, tbb::this_task_arena::max_concurrency()));
  arena.execute([&] {
    tbb::parallel_for(
        std::uint32_t{0}, index.num_tiles(), [&](std::uint32_t tile) { body(tile); }, tbb::simple_partitioner());
  });
}

// A changed byte is found wherever it lies, also where no array does. A file that cannot be read is a problem already.
void check_bytes(const DatasetIndex& index, std::uint32_t tile, Problems& problems) {
  const std::string path = index.tile_path(tile);
  if (index.checksum.empty() || !std::filesystem::is_regular_file(path)) return;
  if (file_checksum(path) != index.checksum[tile])
    problems.add("bytes", path + ": its bytes are not those that were written; make it again with --overwrite");
}

struct Reading {
  std::vector<TileFacts> facts;
  std::vector<std::uint64_t> bins = std::vector<std::uint64_t>(kSampleBins, 0);
};

Reading check_tiles(const DatasetIndex& index, Problems& problems) {
  Reading out;
  out.facts.resize(index.num_tiles());
  std::mutex adding;
  for_each_tile(index, [&](std::uint32_t tile) {
    TileFacts facts = check_tile(index, tile);
    check_bytes(index, tile, facts.problems);
    {
      const std::lock_guard lock(adding);
      for (std::size_t i = 0; i < facts.bins.size(); ++i) out.bins[i] += facts.bins[i];
    }
    facts.bins = {};
    out.facts[tile] = std::move(facts);
  });
  for (const TileFacts& f : out.facts) problems.add(f.problems);
  return out;
}

// The most bins whose triangles are no more than the sample; all for 0.
std::uint32_t bins_for(const std::vector<std::uint64_t>& bins, std::uint64_t sample) {
  std::uint32_t n = 0;
  for (std::uint64_t sum = 0; n < bins.size(); ++n) {
    sum += bins[n];
    if (sample != 0 && sum > sample) break;
  }
  return n;
}

void check_all_orders(const DatasetIndex& index, std::uint32_t bins, DatasetSummary& summary, Problems& problems) {
  const BoxTree tile_boxes(index.box);
  std::vector<OrderCount> count(index.num_tiles());
  std::vector<Problems> found(index.num_tiles());
  for_each_tile(index, [&](std::uint32_t tile) {
    try {
      count[tile] = check_orders(index, tile_boxes, tile, bins, found[tile]);
    } catch (const Error& error) {
      found[tile].add("unreadable", error.what());
    }
  });
  for (const Problems& p : found) problems.add(p);
  for (const OrderCount& c : count) {
    summary.order_sample += c.counted;
    summary.max_triangle_order = std::max(summary.max_triangle_order, c.max_order);
  }
}

void check_owners(const DatasetIndex& index, std::span<const TileFacts> facts, Problems& problems) {
  const std::vector<ForeignVertex> claims = sorted_claims(facts);
  std::vector<Problems> found(index.num_tiles());
  for_each_tile(index, [&](std::uint32_t tile) {
    const auto first = std::partition_point(claims.begin(), claims.end(),
                                            [&](const ForeignVertex& c) { return PointId(c.point).tile() < tile; });
    const auto last = std::partition_point(first, claims.end(),
                                           [&](const ForeignVertex& c) { return PointId(c.point).tile() == tile; });
    try {
      check_owner(index, tile, {first, last}, found[tile]);
    } catch (const Error& error) {
      found[tile].add("unreadable", error.what());
    }
  });
  for (const Problems& p : found) problems.add(p);
  const auto first = std::partition_point(claims.begin(), claims.end(), [&](const ForeignVertex& c) {
    return PointId(c.point).tile() < index.num_tiles();
  });
  check_new_vertices(index, {first, claims.end()}, problems);
}

std::uint64_t check_pits(const DatasetIndex& index, std::vector<TileFacts>& facts, Problems& problems) {
  std::vector<Pit> pits;
  std::vector<PlateauSummary> parts;
  for (TileFacts& f : facts) {
    pits.insert(pits.end(), f.plateaus.pit.begin(), f.plateaus.pit.end());
    parts.push_back(std::move(f.plateaus));
  }
  const std::vector<Pit> across = resolve_plateaus(parts);
  pits.insert(pits.end(), across.begin(), across.end());
  if (index.outlets != "none")
    for (const Pit& pit : pits)
      problems.add("pits", index.tile_path(PointId(pit.vertex).tile()) + ": a pit of " +
                               std::to_string(pit.num_vertices) + " vertices is left at " +
                               index.place(pit.representative));
  if (pits.size() != index.pits)
    problems.add("index", index.path + ": it states " + std::to_string(index.pits) + " pits, but there are " +
                              std::to_string(pits.size()));
  return pits.size();
}

std::uint64_t num_pits(std::span<const PlateauSummary> parts) {
  std::uint64_t decided = 0;
  for (const PlateauSummary& part : parts) decided += part.pit.size();
  return decided + resolve_plateaus(parts).size();
}

// Pits that became none because they were to be kept.
void check_kept(const DatasetIndex& index, std::vector<TileFacts>& facts, Problems& problems) {
  std::vector<PlateauSummary> before, unkept;
  for (TileFacts& f : facts) {
    before.push_back(std::move(f.before));
    unkept.push_back(std::move(f.unkept));
  }
  const std::uint64_t kept = num_pits(before) - num_pits(unkept);
  if (kept != index.pits_kept)
    problems.add("kept pits", index.path + ": it states " + std::to_string(index.pits_kept) +
                                  " kept pits, but there are " + std::to_string(kept));
}

// The errors of the points that thinning removed, measured again.
void check_removed(const DatasetIndex& index, Problems& problems) {
  std::vector<LatticeBox> bounds(index.num_tiles());
  std::vector<RemovedFigures> figures(index.num_tiles());
  std::vector<Problems> found(index.num_tiles());
  const auto open = [&](std::uint32_t tile) { return store::Reader(index.tile_path(tile)); };
  for_each_tile(index, [&](std::uint32_t tile) {
    for (const LatticeBox& box : unflatten(open(tile).read<std::int32_t>("triangle_box"))) bounds[tile].extend(box);
  });
  const BoxTree tree(std::move(bounds));
  std::optional<ErrorLimit> limit;
  if (index.removed_limit_millionths >= 0) limit = ErrorLimit{index.removed_limit_millionths};
  for_each_tile(index, [&](std::uint32_t tile) {
    try {
      figures[tile] = measure_removed(tile, open, tree, limit);
    } catch (const Error& error) {
      found[tile].add("unreadable", error.what());
    }
  });
  RemovedFigures all;
  for (std::uint32_t tile = 0; tile < index.num_tiles(); ++tile) {
    problems.add(found[tile]);
    const RemovedFigures& f = figures[tile];
    if (f.beyond > 0)
      problems.add("errors", index.tile_path(tile) + ": " + std::to_string(f.beyond) +
                                 " points that thinning removed are farther from the terrain than promised");
    if (f.not_once > 0)
      problems.add("errors", index.tile_path(tile) + ": " + std::to_string(f.not_once) +
                                 " points that thinning removed do not lie in exactly one triangle");
    all.add(f);
  }
  if (all.points != index.removed)
    problems.add("index", index.path + ": it states " + std::to_string(index.removed) +
                              " points removed, but the files hold " + std::to_string(all.points));
  else if (all.measured.largest != index.removed_max_error)
    problems.add("index", index.path + ": it states another largest error of the points removed");
}

DatasetSummary stated(const DatasetIndex& index) {
  DatasetSummary out;
  out.points = index.points;
  out.vertices = index.vertices;
  out.duplicates = index.duplicates;
  out.triangles = index.num_triangles;
  out.order = index.order;
  out.pits = index.pits;
  out.fingerprint = index.fingerprint;
  return out;
}

}  // namespace

DatasetSummary check_dataset(const std::string& dir, std::uint64_t order_sample) {
  const DatasetIndex index = load_index(dir);
  DatasetSummary summary = stated(index);
  Problems problems;
  Reading reading = check_tiles(index, problems);
  const auto unreadable =
      std::count_if(reading.facts.begin(), reading.facts.end(), [](const TileFacts& f) { return !f.is_readable; });
  if (unreadable > 0) {
    problems.add("across files", index.path + ": edges, orders and pits across files were not checked, because " +
                                     std::to_string(unreadable) + " of " + std::to_string(index.num_tiles()) +
                                     " files cannot be read");
  } else {
    check_sums(index, reading.facts, problems);
    Fingerprint fingerprint;
    for (const TileFacts& f : reading.facts) fingerprint.add(f.fingerprint);
    summary.fingerprint = fingerprint.hex();
    check_edges(index, reading.facts, problems);
    check_owners(index, reading.facts, problems);
    check_rivers(index, reading.facts, summary.river_edges, summary.invalid_river_edges, problems);
    // Parts that disagree about the heights of shared vertices have no plateaus in common.
    if (problems.count("foreign heights") == 0 && problems.count("use of vertices") == 0) {
      check_kept(index, reading.facts, problems);
      summary.pits = check_pits(index, reading.facts, problems);
    } else
      problems.add("across files", index.path + ": pits were not counted, because files disagree about heights");
    check_removed(index, problems);
    reading.facts.clear();
    check_all_orders(index, bins_for(reading.bins, order_sample), summary, problems);
  }
  summary.problems = problems.sentences();
  summary.ok = problems.empty();
  return summary;
}

}  // namespace hydrotin
