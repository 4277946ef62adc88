#include "river_groups.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>

#include "hydrotin/river_burning.h"
#include "hydrotin/valley_floor.h"
#include "tile_executor.h"

namespace hydrotin {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// Entries by group.
void sort_by_group(std::span<const std::uint32_t> group_of, std::uint32_t num_groups, std::vector<std::uint32_t>& begin,
                   std::vector<std::uint32_t>& entry) {
  begin.assign(std::size_t{num_groups} + 1, 0);
  for (const std::uint32_t g : group_of) ++begin[g + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  entry.resize(group_of.size());
  std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
  for (std::uint32_t i = 0; i < group_of.size(); ++i) entry[next[group_of[i]]++] = i;
}

// Coordinates relative to the lattice: few digits, and multiples of the quantum are lattice heights.
struct Relief {
  std::vector<std::array<double, 2>> position;
  std::vector<double> height;
  std::span<const std::uint32_t> triangle;

  Relief(const RiverWindow& window, double unit_xy, double unit_z) : triangle(window.triangle) {
    for (const LatticePoint p : window.position) position.push_back({p.x * unit_xy, p.y * unit_xy});
    for (const std::int32_t h : window.height) height.push_back(h * unit_z);
  }
  [[nodiscard]] RiverTerrain terrain() const { return {position, height, triangle}; }
};

}  // namespace

struct GroupSolver::Share {
  std::vector<RiverEdge> river;
  EmbeddingOptions options;
  std::vector<std::uint8_t> is_way;   // [n] of rivers, chains and lakes
  std::vector<std::uint32_t> number;  // [rivers] of the network
};

GroupSolver::GroupSolver(const RunContext& context, const RiverNetwork& network)
    : context_(context),
      network_(network),
      names_(name_rivers(context, network)),
      reader_(context, network.bounds, &network) {
  sort_by_group(network.river_group, network.num_groups(), river_begin_, river_);
  sort_by_group(network.chain_group, network.num_groups(), chain_begin_, chain_);
  sort_by_group(network.lake_group, network.num_groups(), lake_begin_, lake_);
  for (const auto& [a, b] : network.preserved) preserved_.emplace_back(std::minmax(network.point[a], network.point[b]));
  std::sort(preserved_.begin(), preserved_.end());
}

std::vector<std::uint32_t> GroupSolver::vertices_of(std::span<const std::uint32_t> group) const {
  std::vector<std::uint32_t> out;
  const auto add = [&](const RiverEdge& edge) { out.insert(out.end(), {edge.from, edge.to}); };
  for (const std::uint32_t g : group) {
    for (std::uint32_t i = river_begin_[g]; i < river_begin_[g + 1]; ++i) add(network_.river[river_[i]]);
    for (std::uint32_t i = chain_begin_[g]; i < chain_begin_[g + 1]; ++i) add(network_.chain[chain_[i]]);
    for (std::uint32_t i = lake_begin_[g]; i < lake_begin_[g + 1]; ++i) {
      const std::vector<std::uint32_t>& shore = network_.lake[lake_[i]].vertex;
      out.insert(out.end(), shore.begin(), shore.end());
    }
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

GroupSolver::Share GroupSolver::share_in(const RiverWindow& window, std::span<const std::uint32_t> group,
                                         std::span<const PointEdge> preserved) const {
  Share out;
  out.is_way.assign(window.num_vertices(), 0);
  const auto local = [&](std::uint32_t v) {
    const std::uint32_t at = window.find(network_.position[v]);
    if (at == kNone || window.point[at] != network_.point[v])
      throw Error(ErrorKind::storage, context_.layout.unit(Phase::match, 0) +
                                          ": a river runs where no vertex is; delete the scratch folder's lay and "
                                          "match and run again");
    out.is_way[at] = 1;
    return at;
  };
  const Lattice& lattice = context_.plan.lattice;
  out.options.constraints = context_.options.rivers.constraints;
  out.options.quantum = lattice.scale_z;
  out.options.executor = tile_executor();
  RiverConstraints& constraints = out.options.constraints;
  std::vector<std::pair<RiverEdge, std::uint32_t>> river;
  for (const std::uint32_t g : group) {
    for (std::uint32_t i = river_begin_[g]; i < river_begin_[g + 1]; ++i) {
      const RiverEdge& edge = network_.river[river_[i]];
      river.emplace_back(RiverEdge{local(edge.from), local(edge.to)}, river_[i]);
    }
    for (std::uint32_t i = chain_begin_[g]; i < chain_begin_[g + 1]; ++i) {
      const RiverEdge& edge = network_.chain[chain_[i]];
      constraints.chain.push_back({local(edge.from), local(edge.to)});
    }
    for (std::uint32_t i = lake_begin_[g]; i < lake_begin_[g + 1]; ++i) {
      Lake lake = network_.lake[lake_[i]];
      for (std::uint32_t& v : lake.vertex) v = local(v);
      std::sort(lake.vertex.begin(), lake.vertex.end());
      lake.level *= lattice.scale_z;
      constraints.lakes.push_back(std::move(lake));
    }
  }
  for (const auto& [a, b] : preserved) {
    const auto place = [&](std::uint64_t point) {
      const auto at = std::lower_bound(network_.point.begin(), network_.point.end(), point);
      return window.find(network_.position[static_cast<std::size_t>(at - network_.point.begin())]);
    };
    constraints.preserve.push_back(
        {place(a), place(b), context_.options.rivers.preserve_drainage, context_.options.rivers.preserve_curvature});
  }
  std::sort(constraints.preserve.begin(), constraints.preserve.end(), [](const auto& x, const auto& y) {
    return std::pair(std::min(x.a, x.b), std::max(x.a, x.b)) < std::pair(std::min(y.a, y.b), std::max(y.a, y.b));
  });
  // Vertices of a window ascend by (x, y): so do the edges.
  std::sort(river.begin(), river.end());
  for (const auto& [edge, number] : river) {
    out.river.push_back(edge);
    out.number.push_back(number);
  }
  std::sort(constraints.chain.begin(), constraints.chain.end());
  std::sort(constraints.lakes.begin(), constraints.lakes.end(),
            [](const Lake& a, const Lake& b) { return a.vertex < b.vertex; });
  return out;
}

// Section 7.3 on integers of the lattice: its rationals stay small.
Embedding GroupSolver::embed(const RiverWindow& window, const Share& share) const {
  const Lattice& lattice = context_.plan.lattice;
  if (context_.options.rivers.method == RiverMethod::lp)
    return embed_rivers(Relief(window, lattice.scale_xy, lattice.scale_z).terrain(), share.river, share.options);
  EmbeddingOptions options = share.options;
  options.quantum = 1;
  RiverConstraints& constraints = options.constraints;
  const double unit = lattice.scale_xy / lattice.scale_z;
  constraints.side_slope *= unit;
  if (constraints.decline_measure == DeclineMeasure::slope) constraints.decline *= unit;
  const Relief relief(window, 1, 1);
  BurnedEmbedding burned = embed_by_burning(relief.terrain(), share.river, options);
  if (burned.fault != BurningFault::none) {
    static constexpr const char* kCause[] = {"", "the river parts", "a triangle has a third river vertex",
                                             "no heights of river vertices alone make it a valley"};
    const LatticePoint at = window.position[burned.edge.from];
    throw Error(ErrorKind::input, context_.options.rivers.lines + ": near x " + std::to_string(lattice.x(at.x)) +
                                      ", y " + std::to_string(lattice.y(at.y)) + ": " +
                                      kCause[static_cast<std::size_t>(burned.fault)] +
                                      ", which rivers.method: dp cannot handle; set rivers.method: lp");
  }
  Embedding& out = burned.embedding;
  for (double& h : out.height) h *= lattice.scale_z;
  out.objective *= lattice.scale_z;
  out.bound *= lattice.scale_z;
  return std::move(out);
}

// Adds the edges to be preserved with a vertex that is touched, or next to one: others cannot matter. True if there are
// new ones.
bool GroupSolver::preserve_near(const RiverWindow& window, std::span<const std::uint8_t> is_touched,
                                std::vector<PointEdge>& preserved) const {
  const std::size_t known = preserved.size();
  for (std::size_t t = 0; t < window.triangle.size() && !preserved_.empty(); t += 3) {
    const std::uint32_t* v = &window.triangle[t];
    if (is_touched[v[0]] == 0 && is_touched[v[1]] == 0 && is_touched[v[2]] == 0) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const PointEdge edge = std::minmax(window.point[v[i]], window.point[v[(i + 1) % 3]]);
      if (std::binary_search(preserved_.begin(), preserved_.end(), edge)) preserved.push_back(edge);
    }
  }
  std::sort(preserved.begin(), preserved.end());
  preserved.erase(std::unique(preserved.begin(), preserved.end()), preserved.end());
  return preserved.size() > known;
}

GroupSolution GroupSolver::solve(std::vector<std::uint32_t> group) const {
  CellSet cells(context_.outline);
  cells.grow(network_.position, vertices_of(group), 1);
  std::vector<PointEdge> preserved;
  const auto start = std::chrono::steady_clock::now();
  for (std::int32_t rings = 1;;) {
    const RiverWindow window = reader_.read(cells.grid(), cells.cells());
    Share share = share_in(window, group, preserved);
    share.options.is_complete = window.is_complete;
    if (const double limit = context_.options.rivers.time_limit; limit > 0)
      share.options.stop = [start, limit] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() >= limit;
      };
    const Embedding embedding = embed(window, share);
    if (!embedding.incomplete.empty()) {
      cells.grow(window.position, embedding.incomplete, rings);
      rings *= 2;
      continue;
    }
    std::vector<std::uint8_t> is_touched = share.is_way;
    for (const std::uint32_t v : embedding.touched) is_touched[v] = 1;
    if (preserve_near(window, is_touched, preserved)) continue;
    GroupSolution out;
    out.group = std::move(group);
    describe(window, share, embedding, is_touched, out);
    return out;
  }
}

void GroupSolver::describe(const RiverWindow& window, const Share& share, const Embedding& embedding,
                           std::span<const std::uint8_t> is_touched, GroupSolution& out) const {
  const Lattice& lattice = context_.plan.lattice;
  const RiverConstraints& constraints = share.options.constraints;
  // On the lattice everything is an integer: what holds here holds in the files, to the last bit.
  Relief lattice_relief(window, 1, 1);
  for (std::uint32_t v = 0; v < window.num_vertices(); ++v) {
    const double height = std::round(embedding.height[v] / lattice.scale_z);
    if (!(std::abs(height) < 2147483647.0))
      throw Error(ErrorKind::resource, context_.layout.unit(Phase::embed, 0) +
                                           ": a river asks for a height beyond the lattice; set rivers.max_change_m");
    if (height != lattice_relief.height[v])
      out.moved.push_back({window.point[v], window.position[v], window.height[v], static_cast<std::int32_t>(height)});
    lattice_relief.height[v] = height;
  }
  std::sort(out.moved.begin(), out.moved.end(),
            [](const MovedVertex& a, const MovedVertex& b) { return a.point < b.point; });
  tabulate(window, share, embedding, out);
  list_limits(window, share, embedding, out);
  if (constraints.valley) {
    const double side_slope = constraints.side_slope * lattice.scale_xy / lattice.scale_z;
    const auto floor = valley_floor(lattice_relief.terrain(), share.river, side_slope, lattice_relief.height);
    for (std::uint32_t v = 0; v < window.num_vertices(); ++v) {
      if (!std::isfinite(floor[v])) continue;
      const double least = std::min(std::ceil(floor[v]), lattice_relief.height[v]);
      out.floor.emplace_back(window.point[v], static_cast<std::int32_t>(std::max(least, -2147483648.0)));
    }
    std::sort(out.floor.begin(), out.floor.end());
  }
  for (std::size_t t = 0; t < window.triangle.size(); t += 3) {
    const std::uint32_t* v = &window.triangle[t];
    if (is_touched[v[0]] == 0 && is_touched[v[1]] == 0 && is_touched[v[2]] == 0) continue;
    for (std::size_t i = 0; i < 3; ++i) out.near.push_back(window.point[v[i]]);
  }
  std::sort(out.near.begin(), out.near.end());
  out.near.erase(std::unique(out.near.begin(), out.near.end()), out.near.end());
  for (const BrokenRow& row : embedding.broken) {
    BrokenPlace& place =
        out.broken.emplace_back(BrokenPlace{row.kind,
                                            row.is_strict_part,
                                            row.missing,
                                            {},
                                            window.position[row.vertex.front()],
                                            static_cast<std::int32_t>(lattice_relief.height[row.vertex.front()])});
    for (const std::uint32_t v : row.vertex) place.point.push_back(window.point[v]);
  }
  out.objective = embedding.objective;
  out.bound = embedding.bound;
  out.rows = embedding.rows;
  out.columns = embedding.columns;
  out.rounds = embedding.rounds;
  out.iterations = embedding.iterations;
  out.clamped = embedding.clamped_networks.size();
  out.optimal = embedding.optimal;
}

// The tables of the rivers, in the numbers of all.
void GroupSolver::tabulate(const RiverWindow& window, const Share& share, const Embedding& embedding,
                           GroupSolution& out) const {
  const Lattice& lattice = context_.plan.lattice;
  std::vector<std::uint32_t> number;
  for (const std::uint32_t e : share.number) number.push_back(names_.river[e]);
  std::vector<std::uint32_t> rivers = number;
  std::sort(rivers.begin(), rivers.end());
  rivers.erase(std::unique(rivers.begin(), rivers.end()), rivers.end());
  for (std::uint32_t& r : number)
    r = static_cast<std::uint32_t>(std::lower_bound(rivers.begin(), rivers.end(), r) - rivers.begin());
  const Relief relief(window, lattice.scale_xy, lattice.scale_z);
  const RiverFaults before = river_faults(relief.terrain(), share.river, relief.height, 0);
  const RiverFaults after = river_faults(relief.terrain(), share.river, embedding.height, 0);
  const auto rows = river_table(relief.terrain(), share.river, number, static_cast<std::uint32_t>(rivers.size()),
                                embedding.height, 0, before, after);
  for (std::size_t r = 0; r < rivers.size(); ++r) out.table.push_back({rivers[r], rows[r]});
  for (std::size_t e = 0; e < share.river.size(); ++e)
    out.edge.push_back({share.number[e], state_of(before, e), state_of(after, e)});
}

// Rows that leave no room, by the heights as embedded.
void GroupSolver::list_limits(const RiverWindow& window, const Share& share, const Embedding& embedding,
                              GroupSolution& out) const {
  constexpr double kNear = 1e-6;
  const Lattice& lattice = context_.plan.lattice;
  const Relief relief(window, lattice.scale_xy, lattice.scale_z);
  const auto height = [&](std::uint32_t v) {
    return static_cast<std::int32_t>(std::lround(embedding.height[v] / lattice.scale_z));
  };
  for (const BindingLimit& limit : binding_limits(relief.terrain(), share.river, share.options.constraints,
                                                  embedding.height, kNear, lattice.scale_z)) {
    LimitPlace& place = out.limit.emplace_back();
    place.kind = limit.kind;
    place.is_largest_change = limit.is_largest_change;
    if (limit.is_largest_change) place.change = height(limit.vertex[0]) - window.height[limit.vertex[0]];
    for (const std::uint32_t v : limit.vertex)
      place.corner.push_back({window.position[v].x, window.position[v].y, height(v)});
  }
}

std::vector<GroupSolution> unite(const GroupSolver& solver, std::vector<GroupSolution> solutions) {
  const auto by_group = [](const GroupSolution& a, const GroupSolution& b) { return a.group < b.group; };
  std::sort(solutions.begin(), solutions.end(), by_group);
  for (;;) {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> near;
    for (std::uint32_t s = 0; s < solutions.size(); ++s)
      for (const std::uint64_t point : solutions[s].near) near.emplace_back(point, s);
    std::sort(near.begin(), near.end());
    std::vector<std::uint32_t> parent(solutions.size());
    std::iota(parent.begin(), parent.end(), 0u);
    const auto find = [&](std::uint32_t s) {
      while (parent[s] != s) s = parent[s] = parent[parent[s]];
      return s;
    };
    for (std::size_t i = 1; i < near.size(); ++i) {
      if (near[i].first != near[i - 1].first) continue;
      const std::uint32_t a = find(near[i - 1].second), b = find(near[i].second);
      parent[std::max(a, b)] = std::min(a, b);
    }
    near = {};
    std::vector<std::vector<std::uint32_t>> members(solutions.size());
    for (std::uint32_t s = 0; s < solutions.size(); ++s) members[find(s)].push_back(s);
    std::vector<GroupSolution> next;
    std::vector<std::vector<std::uint32_t>> joined;
    for (std::uint32_t s = 0; s < solutions.size(); ++s) {
      if (members[s].size() == 1) next.push_back(std::move(solutions[s]));
      if (members[s].size() < 2) continue;
      auto& group = joined.emplace_back();
      for (const std::uint32_t m : members[s])
        group.insert(group.end(), solutions[m].group.begin(), solutions[m].group.end());
      std::sort(group.begin(), group.end());
    }
    if (joined.empty()) return next;
    std::vector<GroupSolution> solved(joined.size());
    tile_executor()(static_cast<std::uint32_t>(joined.size()),
                    [&](std::uint32_t i) { solved[i] = solver.solve(std::move(joined[i])); });
    for (GroupSolution& s : solved) next.push_back(std::move(s));
    std::sort(next.begin(), next.end(), by_group);
    solutions = std::move(next);
  }
}

}  // namespace hydrotin
