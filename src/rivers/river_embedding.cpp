#include "hydrotin/river_embedding.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "component_program.h"
#include "exact_edges.h"
#include "river_rows.h"

namespace hydrotin {
namespace {

constexpr double kViolated = 1e-9;       // a row is added beyond this [m]
constexpr double kPoolTolerance = 1e-7;  // what the simplex may leave open in a row it has [m]
constexpr double kRelaxation = 1e-7;     // given on top of a concession, so that the rest is not infeasible by rounding
constexpr double kNoCoefficient = 1e-12;  // rounding: scaling in the simplex would blow it up
constexpr std::uint32_t kMaxSweeps = 20;

// Price of giving a row up, by kind: a river that is no valley or flows uphill is the last to be accepted.
double price_of(RowKind kind) {
  switch (kind) {
    case RowKind::flow:
    case RowKind::valley:
    case RowKind::chain:
      return 256;
    case RowKind::lake:
      return 64;
    default:
      return 1;
  }
}

struct PoolRow {
  Row row;
  double lower, upper;  // with margin and concessions
  std::uint8_t status = kBasic;
  bool is_relaxed = false;
};

class Solver {
 public:
  Solver(const RiverTerrain& terrain, std::span<const RiverEdge> rivers, const EmbeddingOptions& options)
      : terrain_(terrain),
        rivers_(rivers),
        options_(options),
        catalog_(terrain, rivers, options.constraints, options.quantum),
        d_(terrain.num_vertices(), 0.0),
        parent_(terrain.num_vertices()),
        touched_(terrain.num_vertices(), 0),
        status_(2 * std::size_t{terrain.num_vertices()}, kAtLower),
        local_(terrain.num_vertices()) {
    std::iota(parent_.begin(), parent_.end(), 0u);
    edges_.assign(rivers.begin(), rivers.end());
    edges_.insert(edges_.end(), options.constraints.chain.begin(), options.constraints.chain.end());
  }

  Embedding run() {
    result_.clamped_networks = catalog_.clamped_networks();
    if (lacks_triangles()) return std::move(result_);
    for (const Row& row : catalog_.listed()) consider(row);
    if (options_.constraints.contiguity == Contiguity::exact)
      for (const auto& edge : rivers_) catalog_.visit(edge.from, d_, [&](const Row& row) { consider(row); });
    for (std::uint32_t sweep = 0; sweep < kMaxSweeps; ++sweep) {
      solve_until_satisfied();
      if (!result_.incomplete.empty()) return std::move(result_);
      if (is_stopped_) blend_with_burned();
      write_heights();
      if (is_stopped_ || !sweep_all()) break;
    }
    finish();
    return std::move(result_);
  }

 private:
  struct Component {
    std::vector<std::uint32_t> vertex, row;
    std::size_t sorted_vertices = 0, sorted_rows = 0;  // so many at the beginning are in (x, y) order
    double bound = 0;
    bool is_dirty = false;
  };

  std::uint32_t find(std::uint32_t v) {
    while (parent_[v] != v) v = parent_[v] = parent_[parent_[v]];
    return v;
  }

  // Adds the row if it is violated, or wanted in any case, and not yet there.
  bool consider(const Row& row, bool is_wanted = false) {
    if (!is_wanted && !(row.violation(d_) > kViolated)) return false;
    if (row.key != 0 && in_pool_.contains(row.key)) return false;
    if (row.key == 0 && !(row.violation(d_) > kPoolTolerance)) return false;  // a cut comes again and again otherwise
    const auto index = static_cast<std::uint32_t>(pool_.size());
    if (row.key != 0) in_pool_.emplace(row.key, index);
    pool_.push_back({row, row.lower + row.margin, row.upper - row.margin});
    // Sides that cross have no room for the margin: meet in the middle, the sweep shows what it costs.
    if (pool_.back().lower > pool_.back().upper) pool_.back().lower = pool_.back().upper = (row.lower + row.upper) / 2;
    std::uint32_t root = touch(row.vertex[0]);
    for (std::uint32_t i = 1; i < row.size; ++i) root = unite(root, touch(row.vertex[i]));
    component_[root].row.push_back(index);
    mark_dirty(root);
    return true;
  }

  std::uint32_t touch(std::uint32_t v) {
    if (touched_[v] == 0) {
      touched_[v] = 1;
      component_[v].vertex.push_back(v);
      ++num_touched_;
    }
    return find(v);
  }

  std::uint32_t unite(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    if (a == b) return a;
    Component &x = component_[a], &y = component_[b];
    if (x.vertex.size() < y.vertex.size()) return unite_into(b, a, y, x);
    return unite_into(a, b, x, y);
  }

  std::uint32_t unite_into(std::uint32_t a, std::uint32_t b, Component& x, Component& y) {
    parent_[b] = a;
    x.vertex.insert(x.vertex.end(), y.vertex.begin(), y.vertex.end());
    x.row.insert(x.row.end(), y.row.begin(), y.row.end());
    x.bound += y.bound;
    component_.erase(b);
    return a;
  }

  void mark_dirty(std::uint32_t root) {
    if (component_[root].is_dirty) return;
    component_[root].is_dirty = true;
    dirty_.push_back(root);
  }

  void solve_until_satisfied() {
    while (!dirty_.empty()) {
      ++result_.rounds;
      const std::vector<Component*> now = take_dirty();
      std::vector<ComponentSolution> solutions(now.size());
      options_.executor(static_cast<std::uint32_t>(now.size()),
                        [&](std::uint32_t i) { solutions[i] = solve_component(*now[i]); });
      std::vector<std::uint32_t> changed;
      for (const ComponentSolution& solution : solutions) {
        result_.iterations = std::min(options_.max_iterations, result_.iterations + solution.iterations);
        is_stopped_ = is_stopped_ || solution.is_stopped;
        changed.insert(changed.end(), solution.changed.begin(), solution.changed.end());
      }
      if (is_stopped_) return;
      // What moves pushes its neighbours along the river next: their rows now save rounds of the simplex.
      const auto take = [&](const Row& row) { consider(row, row.kind == RowKind::flow || row.kind == RowKind::chain); };
      for (const std::uint32_t v : changed) catalog_.visit(v, d_, take);
      if (lacks_triangles(changed)) return;
    }
  }

  // The components to solve, large ones first, so that none of them is left to one thread at the end.
  std::vector<Component*> take_dirty() {
    std::vector<Component*> now;
    for (const std::uint32_t root : std::exchange(dirty_, {})) {
      const auto found = component_.find(root);
      if (found == component_.end() || !found->second.is_dirty) continue;
      found->second.is_dirty = false;
      now.push_back(&found->second);
    }
    std::stable_sort(now.begin(), now.end(),
                     [](const Component* a, const Component* b) { return a->row.size() > b->row.size(); });
    return now;
  }

  // Whether some of the vertices lack triangles, and so rows: they are listed.
  bool lacks_triangles(std::vector<std::uint32_t> vertices) {
    std::vector<std::uint32_t>& incomplete = result_.incomplete;
    if (options_.is_complete.empty()) return false;
    std::erase_if(vertices, [&](std::uint32_t v) { return options_.is_complete[v] != 0; });
    incomplete.insert(incomplete.end(), vertices.begin(), vertices.end());
    std::sort(incomplete.begin(), incomplete.end());
    incomplete.erase(std::unique(incomplete.begin(), incomplete.end()), incomplete.end());
    return !incomplete.empty();
  }

  // The same of all vertices whose rows are made at the beginning.
  bool lacks_triangles() {
    std::vector<std::uint32_t> ends;
    for (const auto& [from, to] : edges_) ends.insert(ends.end(), {from, to});
    for (const PreservedEdge& edge : options_.constraints.preserve) ends.insert(ends.end(), {edge.a, edge.b});
    return lacks_triangles(std::move(ends));
  }

  // Most of a component is in order since the last time: only what is new is sorted, then merged in.
  void sort_component(Component& component) {
    const auto sort_tail = [](std::vector<std::uint32_t>& list, std::size_t& sorted, const auto& less) {
      const auto middle = list.begin() + static_cast<std::ptrdiff_t>(sorted);
      std::sort(middle, list.end(), less);
      std::inplace_merge(list.begin(), middle, list.end(), less);
      sorted = list.size();
    };
    sort_tail(component.vertex, component.sorted_vertices,
              [&](std::uint32_t a, std::uint32_t b) { return terrain_.position[a] < terrain_.position[b]; });
    for (std::size_t i = 0; i < component.vertex.size(); ++i) local_[component.vertex[i]] = static_cast<int>(i);
    const auto places = [&](const Row& row) {
      std::array<int, 4> at{-1, -1, -1, -1};
      for (std::uint32_t i = 0; i < row.size; ++i) at[i] = local_[row.vertex[i]];
      return at;
    };
    sort_tail(component.row, component.sorted_rows, [&](std::uint32_t a, std::uint32_t b) {
      const Row &x = pool_[a].row, &y = pool_[b].row;
      const int first = local_[x.vertex[0]], second = local_[y.vertex[0]];
      if (first != second) return first < second;
      return std::tuple(places(x), x.kind, x.coefficient, x.lower) <
             std::tuple(places(y), y.kind, y.coefficient, y.lower);
    });
  }

  [[nodiscard]] double limit_of(std::uint32_t v) const {
    const RiverConstraints& c = options_.constraints;
    if (c.river_only && !catalog_.is_river(v)) return 0;
    if (!(c.max_change > 0)) return std::numeric_limits<double>::infinity();
    return std::max(0.0, c.max_change - options_.quantum / 2);
  }

  ComponentProgram formulate(const Component& component) {
    ComponentProgram program;
    program.begin.push_back(0);
    for (const std::uint32_t v : component.vertex) {
      program.limit.push_back(limit_of(v));
      program.column_status.push_back(status_[2 * std::size_t{v}]);
      program.column_status.push_back(status_[2 * std::size_t{v} + 1]);
    }
    for (const std::uint32_t r : component.row) {
      const PoolRow& pooled = pool_[r];
      for (std::uint32_t i = 0; i < pooled.row.size; ++i) {
        if (std::abs(pooled.row.coefficient[i]) < kNoCoefficient) continue;
        program.column.push_back(local_[pooled.row.vertex[i]]);
        program.coefficient.push_back(pooled.row.coefficient[i]);
      }
      program.begin.push_back(static_cast<int>(program.column.size()));
      program.lower.push_back(pooled.lower);
      program.upper.push_back(pooled.upper);
      program.strict.push_back(pooled.row.strict);
      program.weight.push_back(price_of(pooled.row.kind));
      program.row_status.push_back(pooled.status);
    }
    return program;
  }

  // What solving a component gave besides its displacements and its basis.
  struct ComponentSolution {
    std::vector<std::uint32_t> changed;
    std::uint64_t iterations = 0;
    bool is_stopped = false;
  };

  // Touches nothing but what is the component's own: components may be solved at the same time.
  ComponentSolution solve_component(Component& component) {
    ComponentSolution out;
    const auto solve_now = [&](ComponentProgram& program) {
      const std::uint64_t left = options_.max_iterations - result_.iterations;
      const ComponentAnswer answer = solve(program, left - std::min(left, out.iterations), options_.stop);
      out.iterations += answer.iterations;
      return answer;
    };
    sort_component(component);
    ComponentProgram program = formulate(component);
    ComponentAnswer answer = solve_now(program);
    if (answer.end == ProgramEnd::infeasible) {
      for (const auto& [r, amount] : concede(program)) {
        PoolRow& pooled = pool_[component.row[static_cast<std::size_t>(r)]];
        pooled.is_relaxed = true;
        if (std::isfinite(pooled.lower)) pooled.lower -= amount + kRelaxation;
        if (std::isfinite(pooled.upper)) pooled.upper += amount + kRelaxation;
      }
      program = formulate(component);
      answer = solve_now(program);
    }
    out.is_stopped = answer.end != ProgramEnd::optimal;
    if (!out.is_stopped) take_over(component, program, answer, out.changed);
    return out;
  }

  void take_over(Component& component, const ComponentProgram& program, const ComponentAnswer& answer,
                 std::vector<std::uint32_t>& changed) {
    component.bound = answer.objective;
    for (std::size_t i = 0; i < component.vertex.size(); ++i) {
      const std::uint32_t v = component.vertex[i];
      status_[2 * std::size_t{v}] = program.column_status[2 * i];
      status_[2 * std::size_t{v} + 1] = program.column_status[2 * i + 1];
      if (d_[v] == answer.displacement[i]) continue;
      d_[v] = answer.displacement[i];
      changed.push_back(v);
    }
    for (std::size_t i = 0; i < component.row.size(); ++i) pool_[component.row[i]].status = program.row_status[i];
  }

  // Out of time: the nearest heights on the way from what there is to rivers lowered until every row of flow and valley
  // holds. On a straight way a row that holds at its end is left at one point.
  void blend_with_burned() {
    const std::vector<double> burned = burn();
    double share = 0;
    catalog_.visit_all(d_, [&](const Row& row) {
      const double now = row.violation(d_), then = row.violation(burned);
      if (now > 0) share = std::max(share, then < 0 ? now / (now - then) : 1.0);
    });
    share = std::min(1.0, share * (1 + 1e-9));
    if (share == 0) return;
    for (std::size_t v = 0; v < d_.size(); ++v) d_[v] += share * (burned[v] - d_[v]);
  }

  // Lowers whole networks: the drops between river vertices as the declines ask, all of them below their wingtips. A
  // lake is one vertex of its network.
  [[nodiscard]] std::vector<double> burn() const {
    std::vector<double> potential(d_.size(), 0), lowered(d_.size(), 0);
    raise_upstream(potential);
    std::vector<RiverEdge> bonds = edges_;
    for (const Lake& lake : options_.constraints.lakes)
      for (const std::uint32_t v : lake.vertex) {
        potential[v] = potential[lake.vertex[0]];
        if (v != lake.vertex[0]) bonds.push_back({lake.vertex[0], v});
      }
    const RiverNetworks networks = connect_networks(terrain_, bonds);
    std::vector<double> level(networks.num_networks, std::numeric_limits<double>::infinity());
    std::unordered_map<std::uint32_t, std::uint32_t> network_of;
    for (std::size_t e = 0; e < bonds.size(); ++e)
      for (const std::uint32_t v : {bonds[e].from, bonds[e].to}) network_of.emplace(v, networks.network[e]);
    for (const auto& [v, network] : network_of)
      level[network] = std::min(level[network], terrain_.height[v] - potential[v]);
    for (const Row& row : catalog_.listed()) {
      if (row.kind != RowKind::valley || network_of.contains(row.vertex[0])) continue;
      // h_w >= level + (1 - t) g_from + t g_to + side slope, all divided by the row's scale.
      const double scale = 1 / row.coefficient[0];
      const double g = -(row.coefficient[1] * potential[row.vertex[1]] + row.coefficient[2] * potential[row.vertex[2]]);
      double& l = level[network_of.at(row.vertex[1])];
      l = std::min(l, terrain_.height[row.vertex[0]] - (g + row.strict + row.margin) * scale);
    }
    for (const auto& [v, network] : network_of)
      lowered[v] = level[network] - options_.quantum - kPoolTolerance + potential[v] - terrain_.height[v];
    return lowered;
  }

  // Longest ways up from the mouths, by declines and a little more.
  void raise_upstream(std::vector<double>& potential) const {
    std::unordered_map<std::uint32_t, std::uint32_t> open;  // edges down that are not yet used
    std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> above;
    std::vector<std::uint32_t> ready;
    std::unordered_map<std::uint32_t, std::uint32_t> lake_of;  // its first vertex stands for a lake
    for (const Lake& lake : options_.constraints.lakes)
      for (const std::uint32_t v : lake.vertex) lake_of.emplace(v, lake.vertex[0]);
    const auto top = [&](std::uint32_t v) {
      const auto found = lake_of.find(v);
      return found != lake_of.end() ? found->second : v;
    };
    for (std::uint32_t e = 0; e < edges_.size(); ++e) {
      const std::uint32_t from = top(edges_[e].from), to = top(edges_[e].to);
      if (from == to) continue;
      ++open[from];
      above[to].push_back(e);
    }
    for (const auto& edge : edges_)
      if (!open.contains(top(edge.to))) ready.push_back(top(edge.to));
    std::sort(ready.begin(), ready.end());
    ready.erase(std::unique(ready.begin(), ready.end()), ready.end());
    while (!ready.empty()) {
      const std::uint32_t v = ready.back();
      ready.pop_back();
      const auto found = above.find(v);
      if (found == above.end()) continue;
      for (const std::uint32_t e : found->second) {
        const std::uint32_t u = top(edges_[e].from);
        potential[u] = std::max(potential[u], potential[v] + (e < rivers_.size() ? catalog_.decline()[e] : 0.0) +
                                                  2 * (options_.quantum + kPoolTolerance));
        if (--open[u] == 0) ready.push_back(u);
      }
    }
  }

  void write_heights() {
    result_.height.assign(terrain_.height.begin(), terrain_.height.end());
    for (std::size_t v = 0; v < d_.size(); ++v) {
      if (d_[v] == 0) continue;
      const double h = terrain_.height[v] + d_[v];
      result_.height[v] = options_.quantum > 0 ? std::round(h / options_.quantum) * options_.quantum : h;
    }
    for (const Lake& lake : options_.constraints.lakes) {
      if (lake.vertex.empty()) continue;
      const std::uint32_t first = *std::min_element(
          lake.vertex.begin(), lake.vertex.end(),
          [&](std::uint32_t a, std::uint32_t b) { return terrain_.position[a] < terrain_.position[b]; });
      const bool is_level = std::all_of(lake.vertex.begin(), lake.vertex.end(), [&](std::uint32_t v) {
        return std::abs(terrain_.height[v] + d_[v] - terrain_.height[first] - d_[first]) < 1e-6;
      });
      if (!is_level) continue;  // given up: it is listed as broken
      const double level = lake.has_level && std::abs(terrain_.height[first] + d_[first] - lake.level) < 1e-6
                               ? lake.level
                               : result_.height[first];
      for (const std::uint32_t v : lake.vertex) result_.height[v] = level;
    }
  }

  // How far the heights as written are outside a row, without margin; flow and valley exactly where they are weak.
  [[nodiscard]] double missing(const Row& row, std::span<const double> written) const {
    const double tolerance = options_.quantum > 0 ? 0 : kPoolTolerance;
    const double violation = row.violation(written) - row.margin;
    if (row.kind != RowKind::flow && row.kind != RowKind::valley && row.kind != RowKind::chain)
      return violation > std::max(tolerance, 1e-9) ? violation : 0;
    if (options_.quantum > 0 && !is_weakly_valid(row)) return std::max(violation, 1e-12);
    return violation > std::max(tolerance, row.strict > 0 ? 1e-9 : 1e-12) ? violation : 0;
  }

  [[nodiscard]] bool is_weakly_valid(const Row& row) const {
    const auto& h = result_.height;
    if (row.kind == RowKind::flow || row.kind == RowKind::chain) return h[row.vertex[0]] >= h[row.vertex[1]];
    const auto [w, a, b, none] = row.vertex;
    return valley_sign(terrain_.position[a], terrain_.position[b], terrain_.position[w], h[a], h[b], h[w]) >= 0;
  }

  [[nodiscard]] std::vector<double> written() const {
    std::vector<double> d(d_.size());
    for (std::size_t v = 0; v < d.size(); ++v) d[v] = result_.height[v] - terrain_.height[v];
    return d;
  }

  // The last look at all rows, at the heights as written. True if something has to be solved again.
  bool sweep_all() {
    const std::vector<double> values = written();
    bool again = false;
    catalog_.visit_all(values, [&](const Row& row) {
      const double lacking = missing(row, values);
      if (lacking == 0) return;
      const auto found = in_pool_.find(row.key);
      if (row.key == 0 || found == in_pool_.end()) {
        if (consider(row)) again = true;
        return;
      }
      PoolRow& pooled = pool_[found->second];
      if (pooled.is_relaxed || row.kind == RowKind::lake || options_.quantum == 0) return;
      if (std::isfinite(pooled.lower)) pooled.lower += lacking + kPoolTolerance;
      if (std::isfinite(pooled.upper)) pooled.upper -= lacking + kPoolTolerance;
      if (pooled.lower > pooled.upper) pooled.lower = pooled.upper = (pooled.lower + pooled.upper) / 2;
      mark_dirty(find(row.vertex[0]));
      again = true;
    });
    return again;
  }

  void finish() {
    const std::vector<double> values = written();
    catalog_.visit_all(values, [&](const Row& row) {
      const double lacking = missing(row, values);
      if (lacking == 0) return;
      BrokenRow broken{row.kind, {row.vertex.begin(), row.vertex.begin() + row.size}, lacking, false};
      broken.is_strict_part = row.strict > 0 && lacking <= row.strict &&
                              (row.kind == RowKind::flow || row.kind == RowKind::valley) && is_weakly_valid(row);
      result_.broken.push_back(std::move(broken));
    });
    const auto key = [&](const BrokenRow& b) {
      std::vector<std::array<double, 2>> place;
      for (const std::uint32_t v : b.vertex) place.push_back(terrain_.position[v]);
      return std::pair(place, b.kind);
    };
    std::sort(result_.broken.begin(), result_.broken.end(),
              [&](const BrokenRow& a, const BrokenRow& b) { return key(a) < key(b); });
    result_.broken.erase(
        std::unique(result_.broken.begin(), result_.broken.end(),
                    [](const BrokenRow& a, const BrokenRow& b) { return a.kind == b.kind && a.vertex == b.vertex; }),
        result_.broken.end());
    // Sums in (x, y) order of the components' first vertices would do; vertices are simpler and as deterministic.
    std::vector<std::uint32_t> moved;
    for (std::uint32_t v = 0; v < values.size(); ++v)
      if (values[v] != 0) moved.push_back(v);
    std::sort(moved.begin(), moved.end(),
              [&](std::uint32_t a, std::uint32_t b) { return terrain_.position[a] < terrain_.position[b]; });
    for (const std::uint32_t v : moved) result_.objective += std::abs(values[v]);
    lacks_triangles(moved);
    for (std::uint32_t v = 0; v < touched_.size(); ++v)
      if (touched_[v] != 0) result_.touched.push_back(v);
    std::vector<double> bounds;
    for (const auto& [root, component] : component_) bounds.push_back(component.bound);
    std::sort(bounds.begin(), bounds.end());
    for (const double bound : bounds) result_.bound += bound;
    result_.optimal = !is_stopped_;
    result_.rows = pool_.size();
    result_.columns = num_touched_;
    result_.components = static_cast<std::uint32_t>(component_.size());
  }

  RiverTerrain terrain_;
  std::span<const RiverEdge> rivers_;
  std::vector<RiverEdge> edges_;  ///< of rivers, then of outlet chains
  const EmbeddingOptions& options_;
  RowCatalog catalog_;
  std::vector<double> d_;
  std::vector<std::uint32_t> parent_;
  std::vector<std::uint8_t> touched_, status_;
  std::vector<int> local_;
  std::vector<PoolRow> pool_;
  std::unordered_map<std::uint64_t, std::uint32_t> in_pool_;
  std::unordered_map<std::uint32_t, Component> component_;
  std::vector<std::uint32_t> dirty_;
  std::uint64_t num_touched_ = 0;
  bool is_stopped_ = false;
  Embedding result_;
};

}  // namespace

Embedding embed_rivers(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                       const EmbeddingOptions& options) {
  assert(terrain.position.size() == terrain.height.size());
  return Solver(terrain, rivers, options).run();
}

}  // namespace hydrotin
