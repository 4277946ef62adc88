#include "linear_program.h"

#include <Clp_C_Interface.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <span>

namespace hydrotin {
namespace {

constexpr double kTolerance = 1e-9;

struct Deleter {
  void operator()(Clp_Simplex* model) const { Clp_deleteModel(model); }
};

// The rows and columns. Columns: the triangles that are not blocked, then one per vertex that wants a lower neighbour.
class Formulation {
 public:
  Formulation(const PolygonGraph& graph, const PolygonCosts& costs, const std::vector<std::uint8_t>& blocked)
      : graph_(graph), costs_(costs) {
    number_triangles(blocked);
    number_wishes();
    add_rows();
    make_columns();
  }

  [[nodiscard]] int num_columns() const { return static_cast<int>(triangle_.size() + wish_.size()); }
  [[nodiscard]] int num_triangles() const { return static_cast<int>(triangle_.size()); }
  [[nodiscard]] const std::vector<double>& row_lower() const { return row_lower_; }
  [[nodiscard]] int num_rows() const { return static_cast<int>(row_lower_.size()); }
  [[nodiscard]] std::uint32_t triangle(std::size_t column) const { return triangle_[column]; }

  [[nodiscard]] std::unique_ptr<Clp_Simplex, Deleter> model() const {
    std::unique_ptr<Clp_Simplex, Deleter> owner(Clp_newModel());
    Clp_Simplex* model = owner.get();
    Clp_setLogLevel(model, 0);
    const std::vector<double> zero(static_cast<std::size_t>(num_columns()), 0.0), one(zero.size(), 1.0);
    Clp_loadProblem(model, num_columns(), num_rows(), start_.data(), index_.data(), element_.data(), zero.data(),
                    one.data(), zero.data(), row_lower_.data(), row_upper_.data());
    Clp_setPrimalTolerance(model, kTolerance);
    Clp_setDualTolerance(model, kTolerance);
    Clp_setMaximumIterations(model, 20 * num_columns() + 10'000);
    return owner;
  }

  // The objectives, one after the other; served vertices before those that may be served.
  [[nodiscard]] std::vector<std::vector<double>> stages() const {
    std::vector<std::vector<double>> out;
    for (int slot = 0; slot < costs_.num_slots; ++slot) {
      std::vector<double> stage(static_cast<std::size_t>(num_columns()), 0.0);
      if (slot != costs_.minima_slot) {
        for (std::size_t c = 0; c < triangle_.size(); ++c) stage[c] = from_fixed(costs_.of(triangle_[c], slot));
        out.push_back(stage);
        continue;
      }
      for (const int level : {2, 1}) {
        std::fill(stage.begin(), stage.end(), 0.0);
        for (std::size_t w = 0; w < wish_.size(); ++w)
          if (graph_.problem().wants_lower[wish_[w]] == level) stage[triangle_.size() + w] = -1;
        out.push_back(stage);
      }
    }
    return out;
  }

  // Lower bound by weak duality, for any multipliers: columns lie between 0 and 1.
  [[nodiscard]] double dual_bound(const std::vector<double>& cost, const double* multiplier) const {
    long double bound = 0;
    for (std::size_t r = 0; r < row_lower_.size(); ++r) {
      // A row at most zero allows multipliers that are not positive.
      if (row_lower_[r] != row_upper_[r]) continue;
      bound += static_cast<long double>(row_lower_[r]) * multiplier[r];
    }
    for (std::size_t c = 0; c < cost.size(); ++c) {
      long double reduced = cost[c];
      for (int i = start_[c]; i < start_[c + 1]; ++i) {
        const auto r = static_cast<std::size_t>(index_[static_cast<std::size_t>(i)]);
        const bool inequality = row_lower_[r] != row_upper_[r];
        reduced -= element_[static_cast<std::size_t>(i)] *
                   static_cast<long double>(inequality ? std::min(0.0, multiplier[r]) : multiplier[r]);
      }
      bound += std::min(0.0L, reduced);
    }
    return static_cast<double>(bound);
  }

 private:
  using Key = std::array<LatticePoint, 3>;

  [[nodiscard]] LatticePoint at(std::uint32_t v) const { return graph_.problem().position[v]; }

  void number_triangles(const std::vector<std::uint8_t>& blocked) {
    std::vector<Key> key(graph_.num_triangles());
    for (std::uint32_t t = 0; t < graph_.num_triangles(); ++t) {
      const auto& v = graph_.triangle(t);
      key[t] = {at(v[0]), at(v[1]), at(v[2])};
      std::sort(key[t].begin(), key[t].end());
      if (!blocked[t]) triangle_.push_back(t);
    }
    std::sort(triangle_.begin(), triangle_.end(), [&](std::uint32_t s, std::uint32_t t) { return key[s] < key[t]; });
    column_.assign(graph_.num_triangles(), -1);
    for (std::size_t c = 0; c < triangle_.size(); ++c) column_[triangle_[c]] = static_cast<int>(c);
  }

  void number_wishes() {
    if (costs_.minima_slot < 0) return;
    for (std::uint32_t v = 0; v < graph_.problem().wants_lower.size(); ++v)
      if (graph_.problem().wants_lower[v]) wish_.push_back(v);
    std::sort(wish_.begin(), wish_.end(), [&](std::uint32_t a, std::uint32_t b) { return at(a) < at(b); });
    wish_column_.assign(graph_.problem().position.size(), -1);
    for (std::size_t w = 0; w < wish_.size(); ++w) wish_column_[wish_[w]] = static_cast<int>(triangle_.size() + w);
  }

  // Appends a row: the triangles left of e, with the given sign.
  void add_left(std::uint32_t e, double sign) {
    for (std::uint32_t o = graph_.edge(e).first_option; o != kNoEdge; o = graph_.option(o).next)
      if (const int column = column_[PolygonGraph::triangle_of(o)]; column >= 0)
        entry_.push_back({column, static_cast<int>(row_lower_.size()), sign});
  }

  void close_row(double lower, double upper) {
    row_lower_.push_back(lower);
    row_upper_.push_back(upper);
  }

  void add_rows() {
    std::vector<std::uint32_t> edge(graph_.num_edges());
    std::iota(edge.begin(), edge.end(), 0U);
    std::sort(edge.begin(), edge.end(), [&](std::uint32_t e, std::uint32_t f) {
      const PolygonEdge &a = graph_.edge(e), &b = graph_.edge(f);
      return std::pair{at(a.origin), at(a.target)} < std::pair{at(b.origin), at(b.target)};
    });
    for (const std::uint32_t e : edge) {
      const std::uint32_t twin = PolygonGraph::twin(e);
      if (graph_.edge(twin).is_boundary) {
        add_left(e, 1);
        close_row(1, 1);
      } else if (!graph_.edge(e).is_boundary && at(graph_.edge(e).origin) < at(graph_.edge(e).target)) {
        add_left(e, 1);
        add_left(twin, -1);
        close_row(0, 0);
      }
    }
    // The edges of one origin stand together, and so do the wishes: both by position.
    auto from = edge.begin();
    for (const std::uint32_t v : wish_) {
      while (at(graph_.edge(*from).origin) < at(v)) ++from;
      auto to = from;
      while (to != edge.end() && graph_.edge(*to).origin == v) ++to;
      add_wish_row(v, {from, to});
      from = to;
    }
  }

  // A vertex is served at most as often as edges lead down from it.
  void add_wish_row(std::uint32_t v, std::span<const std::uint32_t> edges_of_v) {
    entry_.push_back({wish_column_[v], static_cast<int>(row_lower_.size()), 1});
    for (const std::uint32_t e : edges_of_v)
      if (graph_.edge(e).goes_down && graph_.is_inner(e)) add_left(e, -1);
    close_row(-std::numeric_limits<double>::max(), 0);
  }

  void make_columns() {
    std::sort(entry_.begin(), entry_.end(), [](const Entry& a, const Entry& b) {
      return std::pair{a.column, a.row} < std::pair{b.column, b.row};
    });
    start_.assign(static_cast<std::size_t>(num_columns()) + 1, 0);
    for (std::size_t i = 0; i < entry_.size(); ++i) {
      const Entry& e = entry_[i];
      if (i > 0 && entry_[i - 1].column == e.column && entry_[i - 1].row == e.row) {
        element_.back() += e.value;
        continue;
      }
      index_.push_back(e.row);
      element_.push_back(e.value);
      ++start_[static_cast<std::size_t>(e.column) + 1];
    }
    std::partial_sum(start_.begin(), start_.end(), start_.begin());
  }

  struct Entry {
    int column, row;
    double value;
  };

  const PolygonGraph& graph_;
  const PolygonCosts& costs_;
  std::vector<std::uint32_t> triangle_, wish_;
  std::vector<int> column_, wish_column_;
  std::vector<Entry> entry_;
  std::vector<double> row_lower_, row_upper_, element_;
  std::vector<CoinBigIndex> start_;
  std::vector<int> index_;
};

// Branches on triangles until the best integral answer is found.
class Tree {
 public:
  Tree(const Formulation& formulation, const PolygonGraph& graph, const PolygonCosts& costs, std::uint32_t size,
       std::uint32_t max_programs)
      : form_(formulation),
        graph_(graph),
        costs_(costs),
        stages_(formulation.stages()),
        size_(size),
        max_programs_(max_programs) {
    for (const auto& stage : stages_) {
      double largest = 0;
      for (const double c : stage) largest = std::max(largest, std::abs(c));
      scale_.push_back(largest > 0 ? largest : 1);
    }
  }

  LinearOutcome grow(std::vector<std::uint32_t> incumbent) {
    LinearOutcome out;
    if (!incumbent.empty()) keep(std::move(incumbent));
    model_ = form_.model();
    stack_.push_back({});
    while (!stack_.empty() && out.programs < max_programs_) {
      const Fixings fixings = std::move(stack_.back());
      stack_.pop_back();
      ++out.programs;
      visit(fixings, out);
    }
    out.proven = stack_.empty() && !gave_up_;
    if (!best_) return out;
    out.triangle = best_->triangle;
    // Without branches the dual must certify the answer; the tree of branches is a proof of its own.
    const double certified = counts_minima_only() ? std::ceil(out.first_bound - 1e-6) : out.first_bound;
    if (out.programs == 1 && best_->first - certified > 100 * slack(best_->first)) out.proven = false;
    if (out.proven) out.first_bound = best_->first;
    return out;
  }

 private:
  struct Fixing {
    int column;
    bool used;
  };
  using Fixings = std::vector<Fixing>;
  struct Best {
    std::vector<std::uint32_t> triangle;
    SlotValues value;
    double first;
  };

  void visit(const Fixings& fixings, LinearOutcome& out) {
    Clp_Simplex* model = model_.get();  // its last basis is a good start
    Clp_chgRowLower(model, form_.row_lower().data());
    std::vector<double> lower(static_cast<std::size_t>(form_.num_columns()), 0.0), upper(lower.size(), 1.0);
    for (const auto& [column, used] : fixings)
      (used ? lower : upper)[static_cast<std::size_t>(column)] = used ? 1.0 : 0.0;
    Clp_chgColumnLower(model, lower.data());
    Clp_chgColumnUpper(model, upper.data());
    for (std::size_t s = 0; s < stages_.size(); ++s) {
      std::vector<double> scaled(stages_[s]);
      for (double& c : scaled) c /= scale_[s];
      Clp_chgObjCoefficients(model, scaled.data());
      if (s == 0)
        Clp_dual(model, 0);
      else
        Clp_primal(model, 0);
      if (Clp_status(model) == 1) return;  // no triangulation keeps the fixings
      if (s == 0 && fixings.empty()) out.first_bound = form_.dual_bound(scaled, Clp_dualRowSolution(model)) * scale_[0];
      if (Clp_status(model) != 0) {
        gave_up_ = true;
        return;
      }
      if (s == 0 && best_ && !may_improve(Clp_objectiveValue(model) * scale_[0])) return;
      tighten(model, lower, upper);
    }
    branch_or_keep(model, fixings);
  }

  [[nodiscard]] bool counts_minima_only() const {
    return costs_.minima_slot == 0 && (costs_.num_slots == 1 || costs_.counts_foreign);
  }

  // Whether answers with at least this much in the first slot may be better than the best so far.
  [[nodiscard]] bool may_improve(double first) const {
    if (counts_minima_only()) return std::ceil(first - 1e-6) < best_->first;
    return first <= best_->first + slack(best_->first);
  }

  [[nodiscard]] double slack(double value) const { return kTolerance * (scale_[0] + std::abs(value)); }

  // All optima of a stage lie where no reduced cost is paid.
  void tighten(Clp_Simplex* model, std::vector<double>& lower, std::vector<double>& upper) const {
    const double* reduced = Clp_dualColumnSolution(model);
    const double* x = Clp_primalColumnSolution(model);
    for (std::size_t c = 0; c < lower.size(); ++c) {
      if (std::abs(reduced[c]) <= kTolerance) continue;
      if (reduced[c] > 0 && x[c] < lower[c] + 1e-7) upper[c] = lower[c];
      if (reduced[c] < 0 && x[c] > upper[c] - 1e-7) lower[c] = upper[c];
    }
    Clp_chgColumnLower(model, lower.data());
    Clp_chgColumnUpper(model, upper.data());
    const double* multiplier = Clp_dualRowSolution(model);
    std::vector<double> row_lower(Clp_getRowLower(model), Clp_getRowLower(model) + form_.num_rows());
    const double* row_upper = Clp_getRowUpper(model);
    for (std::size_t r = 0; r < row_lower.size(); ++r)
      if (std::abs(multiplier[r]) > kTolerance) row_lower[r] = row_upper[r];
    Clp_chgRowLower(model, row_lower.data());
  }

  void branch_or_keep(Clp_Simplex* model, const Fixings& fixings) {
    const double* x = Clp_primalColumnSolution(model);
    int worst = -1;
    double farthest = 1e-6;
    std::vector<std::uint32_t> triangle;
    for (int c = 0; c < form_.num_triangles(); ++c) {
      const double distance = std::min(x[c], 1 - x[c]);
      if (distance > farthest) {
        farthest = distance;
        worst = c;
      }
      if (x[c] > 0.5) triangle.push_back(form_.triangle(static_cast<std::size_t>(c)));
    }
    if (worst >= 0) {
      for (const bool used : {false, true}) {
        stack_.push_back(fixings);
        stack_.back().push_back({worst, used});
      }
      return;
    }
    if (triangle.size() != size_) {
      gave_up_ = true;
      return;
    }
    keep(std::move(triangle));
  }

  void keep(std::vector<std::uint32_t> triangle) {
    const SlotValues value = value_of(graph_, costs_, triangle);
    if (best_ && !(value < best_->value)) return;
    const double first = costs_.minima_slot == 0
                             ? -std::floor(static_cast<double>(-value[0]) / static_cast<double>(PolygonCosts::kGain[2]))
                             : from_fixed(value[0]);
    best_ = {std::move(triangle), value, first};
  }

  const Formulation& form_;
  const PolygonGraph& graph_;
  const PolygonCosts& costs_;
  std::vector<std::vector<double>> stages_;
  std::vector<double> scale_;
  std::uint32_t size_, max_programs_;
  std::unique_ptr<Clp_Simplex, Deleter> model_;
  std::vector<Fixings> stack_;
  std::optional<Best> best_;
  bool gave_up_ = false;
};

}  // namespace

LinearOutcome solve_linear_program(const PolygonGraph& graph, const PolygonCosts& costs,
                                   const std::vector<std::uint8_t>& blocked, std::uint32_t size,
                                   std::uint32_t max_programs, std::vector<std::uint32_t> incumbent) {
  const Formulation formulation(graph, costs, blocked);
  return Tree(formulation, graph, costs, size, max_programs).grow(std::move(incumbent));
}

}  // namespace hydrotin
