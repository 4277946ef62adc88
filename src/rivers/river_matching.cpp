#include "hydrotin/river_matching.h"

#include <algorithm>
#include <numeric>

#include "hydrotin/flow_direction.h"
#include "hydrotin/line_insertion.h"
#include "hydrotin/line_snapping.h"
#include "hydrotin/network_cleaning.h"
#include "hydrotin/wingtip_clearing.h"

namespace hydrotin {
namespace {

class LineMatcher {
 public:
  LineMatcher(const LatticeTerrain& terrain, std::size_t num_lines, const LineMatching& options,
              std::span<const std::uint8_t> is_against)
      : terrain_(terrain), num_lines_(num_lines), options_(options), is_against_(is_against), locator_(terrain) {}

  MatchedLines run(const RiverLines& given, std::span<const std::pair<LatticePoint, double>> z) {
    const RiverLines lines = without_repeats(given);
    count("repeated_points", given.point.size() - lines.point.size());
    const RiverLines reaches = split_at_nodes(directed(lines));
    count("reaches", reaches.size());
    options_.insert ? insert(reaches, z) : snap(reaches);
    return std::move(match_);
  }

 private:
  void count(const std::string& name, std::uint64_t number) { match_.counts.emplace_back(name, number); }

  RiverLines directed(const RiverLines& lines) {
    match_.is_turned.assign(num_lines_, 0);
    match_.drop.assign(num_lines_, 0);
    std::vector<std::uint8_t> is_turned(lines.size(), 0);
    if (options_.direction == LineDirection::automatic) {
      const FlowVote vote = vote_on_flow(locator_, lines);
      is_turned = vote.is_turned;
      count("line_networks", vote.num_networks);
      count("line_networks_turned", vote.num_turned);
    } else {
      for (std::size_t i = 0; i < lines.size(); ++i) is_turned[i] = wants_turn(lines.source[i]) ? 1 : 0;
    }
    RiverLines result = turned(lines, is_turned);
    const auto drops = drops_along(locator_, result);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      match_.is_turned[lines.source[i]] = is_turned[i];
      match_.drop[lines.source[i]] += drops[i];
    }
    for (std::uint32_t i = 0; i < match_.drop.size(); ++i)
      if (match_.drop[i] < 0) match_.disagrees.push_back(i);
    count("lines_turned", static_cast<std::uint64_t>(std::count(match_.is_turned.begin(), match_.is_turned.end(), 1)));
    count("lines_that_rise", match_.disagrees.size());
    return result;
  }

  [[nodiscard]] bool wants_turn(std::uint32_t line) const {
    if (options_.direction == LineDirection::reversed) return true;
    return options_.direction == LineDirection::attribute && is_against_[line] != 0;
  }

  void snap(const RiverLines& reaches) {
    SnappedLines snapped = snap_lines(locator_, reaches);
    count("reaches_outside", snapped.counts.outside);
    count("pieces", snapped.counts.pieces);
    count("crossings", snapped.counts.crossings);
    count("points_inside_triangles", snapped.counts.dropped_points);
    count("points_snapped_together", snapped.counts.repeated);
    count("pieces_snapped_to_a_vertex", snapped.counts.vanished);
    match_.terrain = terrain_;
    clean(snapped.paths);
  }

  void insert(const RiverLines& reaches, std::span<const std::pair<LatticePoint, double>> z) {
    InsertedLines inserted = insert_lines(locator_, reaches);
    match_.terrain = std::move(inserted.terrain);
    if (!z.empty()) take_heights(z);
    count("reaches_outside", inserted.counts.outside);
    count("pieces", inserted.counts.pieces);
    count("line_crossings", inserted.counts.crossings);
    count("points_bent_in", inserted.counts.bent);
    count("vertices_inserted", inserted.counts.new_vertices);
    count("vertices_on_the_rim", inserted.counts.rim_vertices);
    count("segments_lost", inserted.counts.lost_segments);
    clean(inserted.paths);
  }

  void take_heights(std::span<const std::pair<LatticePoint, double>> z) {
    std::uint64_t taken = 0;
    for (std::uint32_t v = terrain_.num_vertices(); v < match_.terrain.num_vertices(); ++v) {
      const LatticePoint p = match_.terrain.position[v];
      const auto at =
          std::lower_bound(z.begin(), z.end(), p, [](const auto& a, LatticePoint b) { return a.first < b; });
      if (at == z.end() || at->first != p) continue;
      match_.terrain.height[v] = at->second;
      ++taken;
    }
    count("heights_from_lines", taken);
  }

  void clean(const RiverPaths& paths) {
    CleanNetwork network = clean_network(match_.terrain.position, match_.terrain.height, paths);
    count("loop_edges", network.counts.loop_edges);
    count("repeated_edges", network.counts.repeated_edges);
    count("opposed_edges", network.counts.opposed_edges);
    count("shortcut_edges", network.counts.shortcut_edges);
    count("joined_edges", network.counts.joined_edges);
    count("cycles", network.cycle_begin.size() - 1);
    count("cycle_edges", network.counts.cycle_edges);
    if (!options_.insert) count("third_edges", take_third_edges(match_.terrain, network));
    for (std::size_t i = 0; i + 1 < network.cycle_begin.size(); ++i)
      match_.cycles.emplace_back(network.cycle.begin() + static_cast<std::ptrdiff_t>(network.cycle_begin[i]),
                                 network.cycle.begin() + static_cast<std::ptrdiff_t>(network.cycle_begin[i + 1]));
    match_.rivers = std::move(network.edge);
    match_.line = std::move(network.line);
  }

  const LatticeTerrain& terrain_;
  std::size_t num_lines_;
  const LineMatching& options_;
  std::span<const std::uint8_t> is_against_;
  TerrainLocator locator_;
  MatchedLines match_;
};

// Even-odd rule over all rings; the border belongs to the polygon.
bool is_inside(const PlanePolygons& polygons, std::size_t i, const std::array<double, 2>& p) {
  bool inside = false;
  for (std::size_t r = polygons.ring_begin[i]; r < polygons.ring_begin[i + 1]; ++r) {
    const auto ring =
        polygons.point.subspan(polygons.point_begin[r], polygons.point_begin[r + 1] - polygons.point_begin[r]);
    for (std::size_t k = 0, j = ring.size() - 1; k < ring.size(); j = k++) {
      const auto &a = ring[j], &b = ring[k];
      const double turn = (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
      const auto [west, east] = std::minmax(a[0], b[0]);
      const auto [south, north] = std::minmax(a[1], b[1]);
      if (turn == 0 && p[0] >= west && p[0] <= east && p[1] >= south && p[1] <= north) return true;
      if ((a[1] > p[1]) != (b[1] > p[1]) && (turn > 0) == (b[1] > a[1])) inside = !inside;
    }
  }
  return inside;
}

}  // namespace

MatchedLines match_lines(const LatticeTerrain& terrain, const RiverLines& lines, std::size_t num_lines,
                         const LineMatching& options, std::span<const std::uint8_t> is_against,
                         std::span<const std::pair<LatticePoint, double>> z) {
  return LineMatcher(terrain, num_lines, options, is_against).run(lines, z);
}

void add_closed_lakes(std::span<const RiverEdge> rivers, std::span<const std::uint32_t> lake,
                      std::span<std::uint8_t> is_outlet) {
  std::uint32_t most = 0;
  for (const std::uint32_t number : lake) most = std::max(most, number);
  std::vector<std::uint8_t> is_left(std::size_t{most} + 1, 0);
  for (const auto& [from, to] : rivers)
    if (lake[from] != lake[to]) is_left[lake[from]] = 1;
  for (std::size_t v = 0; v < lake.size(); ++v)
    if (lake[v] != 0 && is_left[lake[v]] == 0) is_outlet[v] = 1;
}

void count_mouths(const OutletChains& mouths, StepCounts& counts) {
  const auto count = [&](MouthKind kind) {
    return static_cast<std::uint64_t>(std::count_if(mouths.mouth.begin(), mouths.mouth.end(),
                                                    [&](const RiverMouth& mouth) { return mouth.kind == kind; }));
  };
  counts.emplace_back("mouths_at_outlets", count(MouthKind::outlet));
  counts.emplace_back("mouths_with_chains", count(MouthKind::chained));
  counts.emplace_back("mouths_closed", count(MouthKind::closed));
  counts.emplace_back("chain_edges", mouths.edge.size());
}

CoveredVertices vertices_in(const PlanePolygons& polygons, std::span<const std::array<double, 2>> position) {
  std::vector<std::uint32_t> order(position.size()), polygon_of(position.size(), 0);
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return position[a] < position[b]; });
  CoveredVertices out;
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    const std::size_t first = polygons.point_begin[polygons.ring_begin[i]];
    const std::size_t last = polygons.point_begin[polygons.ring_begin[i + 1]];
    double west = polygons.point[first][0], east = west;
    for (std::size_t p = first; p < last; ++p) {
      west = std::min(west, polygons.point[p][0]);
      east = std::max(east, polygons.point[p][0]);
    }
    auto& covered = out.vertex.emplace_back();
    auto v = std::lower_bound(order.begin(), order.end(), west,
                              [&](std::uint32_t a, double x) { return position[a][0] < x; });
    for (; v != order.end() && position[*v][0] <= east; ++v) {
      if (!is_inside(polygons, i, position[*v])) continue;
      if (polygon_of[*v] != 0 && !out.overlaps) {
        out.overlaps = true;
        out.first = polygon_of[*v] - 1;
        out.second = static_cast<std::uint32_t>(i);
        out.overlap = *v;
      }
      polygon_of[*v] = static_cast<std::uint32_t>(i + 1);
      covered.push_back(*v);
    }
  }
  return out;
}

}  // namespace hydrotin
