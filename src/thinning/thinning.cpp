#include "hydrotin/thinning.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "hydrotin/hilbert.h"
#include "rounds.h"

namespace hydrotin {
namespace {

using namespace thinning;

constexpr std::int64_t kLocalCells = 2;  // circumradius of local triangles at most

// Points along the curve: neighbours lie near each other in all arrays.
struct CurveOrder {
  std::vector<std::uint32_t> index;  // of the input
  std::vector<LatticePoint> position;
  std::vector<std::int32_t> height;

  CurveOrder(std::span<const LatticePoint> p, std::span<const std::int32_t> z) {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> key(p.size());
    for (std::uint32_t i = 0; i < p.size(); ++i) key[i] = {hilbert_key(p[i]), i};
    if (!std::is_sorted(key.begin(), key.end())) std::sort(key.begin(), key.end());
    index.reserve(p.size());
    position.reserve(p.size());
    height.reserve(p.size());
    for (const auto& [unused, i] : key) {
      index.push_back(i);
      position.push_back(p[i]);
      height.push_back(z[i]);
    }
  }
};

// In each cell the point nearest to its centre.
std::vector<std::uint32_t> seeds(const CurveOrder& points, const ThinningOptions& options) {
  struct Candidate {
    std::int64_t column, row;
    std::uint64_t distance2;
    std::uint32_t point;
  };
  std::vector<Candidate> candidates;
  candidates.reserve(points.position.size());
  const std::int64_t cell = options.cell;
  for (std::uint32_t i = 0; i < points.position.size(); ++i) {
    const LatticePoint p = points.position[i];
    const std::int64_t column = grid_cell(p.x, options.grid_x, cell), row = grid_cell(p.y, options.grid_y, cell);
    const std::int64_t dx = 2 * (p.x - options.grid_x) - (2 * column + 1) * cell;
    const std::int64_t dy = 2 * (p.y - options.grid_y) - (2 * row + 1) * cell;
    const Candidate next{column, row, static_cast<std::uint64_t>(dx * dx + dy * dy), i};
    // Along the curve a cell's points come in a few stretches, of which one candidate each is enough.
    if (!candidates.empty() && candidates.back().column == column && candidates.back().row == row) {
      Candidate& last = candidates.back();
      if (std::pair{next.distance2, p} < std::pair{last.distance2, points.position[last.point]}) last = next;
      continue;
    }
    candidates.push_back(next);
  }
  const auto comes_first = [&](const Candidate& a, const Candidate& b) {
    if (a.column != b.column) return a.column < b.column;
    if (a.row != b.row) return a.row < b.row;
    if (a.distance2 != b.distance2) return a.distance2 < b.distance2;
    return points.position[a.point] < points.position[b.point];
  };
  std::sort(candidates.begin(), candidates.end(), comes_first);
  std::vector<std::uint32_t> out;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (i == 0 || candidates[i].column != candidates[i - 1].column || candidates[i].row != candidates[i - 1].row)
      out.push_back(candidates[i].point);
  return out;
}

// Greatest error and what is left beyond the limit.
void measure(const ThinMesh& mesh, const CurveOrder& points, Thinning& out) {
  for (std::uint32_t t = 0; t < mesh.num_slots(); ++t) {
    const Triangle& at = mesh[t];
    if (!at.is_live) continue;
    for (std::uint32_t p = at.head; p != kNone; p = mesh.next_point(p)) {
      const Distance d = mesh.distance(at.corner[0], at.corner[1], at.corner[2], p);
      const double error = std::abs(static_cast<double>(d.numerator) / static_cast<double>(d.denominator));
      out.max_error = std::max(out.max_error, error);
      out.squared_error += error * error;
      if (mesh.is_beyond(d)) out.unsettled.push_back(points.index[p]);
    }
  }
  std::sort(out.unsettled.begin(), out.unsettled.end());
}

// A run from the points kept at first on.
Thinning run(const CurveOrder& points, std::vector<PointFate> fate, const ThinningOptions& options,
             const InsertingStages& stages, bool prune, const ThinningWindow* window) {
  const auto n = static_cast<std::uint32_t>(points.index.size());
  std::vector<std::uint32_t> first;
  for (std::uint32_t i = 0; i < n; ++i)
    if (is_kept(fate[i])) first.push_back(i);
  ThinMesh mesh(points.position, points.height, first, options.limit_millionths,
                static_cast<double>(kLocalCells) * options.cell);
  std::optional<DoubtMap> doubt;
  constexpr std::int64_t kPixelsPerCell = 8;
  if (window != nullptr) {
    doubt.emplace(*window, options.cell / kPixelsPerCell, std::uint64_t{4} * n + (1U << 16));
    if (!doubt->is_open()) doubt.reset();
  }
  RoundState state{mesh,
                   doubt ? &*doubt : nullptr,
                   static_cast<std::int32_t>(2 * kLocalCells * options.cell + 4),
                   options.grid_x,
                   options.grid_y,
                   std::move(fate),
                   std::vector<std::uint8_t>(n, 0),
                   std::vector<std::uint8_t>(n, 0)};
  insert_in_rounds(state, stages);
  if (prune) prune_in_rounds(state);

  Thinning out;
  out.fate.resize(n);
  out.round.resize(n);
  out.doubtful.resize(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t at = points.index[i];
    out.fate[at] = state.fate[i];
    out.round[at] = state.round[i];
    out.doubtful[at] = state.doubtful[i] != 0 || (doubt && !window->box.contains(points.position[i]));
  }
  out.rounds = state.rounds;
  out.pruning_rounds = state.pruning_rounds;
  measure(mesh, points, out);
  return out;
}

}  // namespace

void ThinningOptions::set_grid(const Lattice& lattice, double side) {
  cell = static_cast<std::int32_t>(std::max(1.0, std::round(side)));
  const auto units = [&](double offset) {
    const double n = std::round(offset / lattice.scale_xy);
    return std::fabs(n) < 0x1p52 ? static_cast<std::int64_t>(n) : 0;
  };
  grid_x = -lattice.base_x - units(lattice.offset_x);
  grid_y = -lattice.base_y - units(lattice.offset_y);
}

Thinning thin_together(std::span<const LatticePoint> position, std::span<const std::int32_t> height,
                       std::span<const std::uint32_t> hull, const ThinningOptions& options) {
  assert(options.cell >= 1 && options.cell <= (1 << 28) && hull.size() >= 3);
  const CurveOrder points(position, height);
  std::vector<PointFate> fate(position.size(), PointFate::removed);
  for (const std::uint32_t i : seeds(points, options)) fate[i] = PointFate::seed;
  std::vector<std::uint8_t> is_hull(position.size(), 0);
  for (const std::uint32_t v : hull) is_hull[v] = 1;
  for (std::uint32_t i = 0; i < fate.size(); ++i)
    if (is_hull[points.index[i]] != 0) fate[i] = PointFate::seed;
  return run(points, std::move(fate), options, {kPoliteRounds, kEagerRounds, kLastRounds}, options.prune, nullptr);
}

Thinning settle(std::span<const LatticePoint> position, std::span<const std::int32_t> height,
                std::span<const PointFate> fate, std::span<const std::uint32_t> hull, const ThinningOptions& options,
                const ThinningWindow* window) {
  assert(fate.size() == position.size() && hull.size() >= 3);
  const CurveOrder points(position, height);
  std::vector<PointFate> start(fate.begin(), fate.end());
  for (const std::uint32_t v : hull)
    if (!is_kept(start[v])) start[v] = PointFate::seed;
  std::vector<PointFate> sorted;
  sorted.reserve(start.size());
  for (const std::uint32_t i : points.index) sorted.push_back(start[i]);
  return run(points, std::move(sorted), options, {0, kSettlingRounds / 2, kSettlingRounds / 2, PointFate::settled},
             false, window);
}

Thinning thin(std::span<const LatticePoint> position, std::span<const std::int32_t> height,
              std::span<const std::uint32_t> hull, const ThinningOptions& options) {
  LatticeBox all;
  for (const LatticePoint p : position) all.extend(p);
  return settle(position, height, thin_blocks(position, height, options, all), hull, options);
}

}  // namespace hydrotin
