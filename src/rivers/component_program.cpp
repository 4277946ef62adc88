#include "component_program.h"

#include <Clp_C_Interface.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace hydrotin {
namespace {

constexpr double kTolerance = 1e-9;
constexpr std::uint64_t kSlice = 20'000;   // iterations between two looks at the clock
constexpr int kIterationsUsed = 3;         // Clp's status
constexpr double kStrictShare = 1.0 / 16;  // of the price of the weak row

struct Deleter {
  void operator()(Clp_Simplex* model) const { Clp_deleteModel(model); }
};
using Model = std::unique_ptr<Clp_Simplex, Deleter>;

Model make_model() {
  Model model(Clp_newModel());
  Clp_setLogLevel(model.get(), 0);
  return model;
}

// Columns of a matrix given by rows: each once as it is and once negated (rises and falls), by turns.
struct Columns {
  std::vector<CoinBigIndex> start;
  std::vector<int> row;
  std::vector<double> value, lower, upper, cost;

  explicit Columns(const ComponentProgram& program) {
    std::vector<int> count(static_cast<std::size_t>(program.num_columns()), 0), next;
    for (const int c : program.column) ++count[static_cast<std::size_t>(c)];
    start.push_back(0);
    for (const int c : count) {
      next.push_back(start.back());
      start.push_back(start.back() + c);
      start.push_back(start.back() + c);
    }
    row.resize(static_cast<std::size_t>(start.back()));
    value.resize(row.size());
    for (int r = 0; r < program.num_rows(); ++r)
      for (int i = program.begin[static_cast<std::size_t>(r)]; i < program.begin[static_cast<std::size_t>(r) + 1];
           ++i) {
        const auto c = static_cast<std::size_t>(program.column[static_cast<std::size_t>(i)]);
        const auto up = static_cast<std::size_t>(next[c]++), down = up + static_cast<std::size_t>(count[c]);
        row[up] = row[down] = r;
        value[up] = program.coefficient[static_cast<std::size_t>(i)];
        value[down] = -value[up];
      }
    for (const double limit : program.limit)
      for (int side = 0; side < 2; ++side) add_bounds(limit, 1);
  }

  void add_bounds(double limit, double price) {
    lower.push_back(0);
    upper.push_back(limit);
    cost.push_back(price);
  }

  // A column that helps one row.
  void add_helper(int r, double sign, double limit, double price) {
    row.push_back(r);
    value.push_back(sign);
    start.push_back(static_cast<CoinBigIndex>(row.size()));
    add_bounds(limit, price);
  }

  void load(Clp_Simplex* model, const ComponentProgram& program) const {
    Clp_loadProblem(model, static_cast<int>(cost.size()), program.num_rows(), start.data(), row.data(), value.data(),
                    lower.data(), upper.data(), cost.data(), program.lower.data(), program.upper.data());
    Clp_scaling(model, 0);  // rows come scaled
    Clp_setPrimalTolerance(model, kTolerance);
    Clp_setDualTolerance(model, kTolerance);
  }
};

void set_basis(Clp_Simplex* model, const std::vector<std::uint8_t>& columns, const std::vector<std::uint8_t>& rows) {
  for (std::size_t j = 0; j < columns.size(); ++j) Clp_setColumnStatus(model, static_cast<int>(j), columns[j]);
  for (std::size_t r = 0; r < rows.size(); ++r) Clp_setRowStatus(model, static_cast<int>(r), rows[r]);
}

}  // namespace

ComponentAnswer solve(ComponentProgram& program, std::uint64_t max_iterations, const std::function<bool()>& stop) {
  const Model model = make_model();
  Columns(program).load(model.get(), program);
  set_basis(model.get(), program.column_status, program.row_status);
  ComponentAnswer answer;
  do {
    if (answer.iterations >= max_iterations || (stop && stop())) return answer;
    const std::uint64_t slice = std::min(kSlice, max_iterations - answer.iterations);
    Clp_setMaximumIterations(model.get(), static_cast<int>(slice));
    Clp_dual(model.get(), 0);
    answer.iterations += static_cast<std::uint64_t>(Clp_numberIterations(model.get()));
  } while (Clp_status(model.get()) == kIterationsUsed);
  if (Clp_status(model.get()) > kIterationsUsed) {  // numerical trouble: once more from scratch
    set_basis(model.get(), std::vector<std::uint8_t>(2 * program.limit.size(), kAtLower),
              std::vector<std::uint8_t>(program.lower.size(), kBasic));
    Clp_setMaximumIterations(model.get(), static_cast<int>(std::min<std::uint64_t>(max_iterations, 2'000'000'000)));
    Clp_primal(model.get(), 0);
    answer.iterations += static_cast<std::uint64_t>(Clp_numberIterations(model.get()));
  }
  const int status = Clp_status(model.get());
  answer.end = status == 0 ? ProgramEnd::optimal : status == 1 ? ProgramEnd::infeasible : ProgramEnd::stopped;
  if (answer.end != ProgramEnd::optimal) return answer;
  const double* x = Clp_primalColumnSolution(model.get());
  for (std::size_t j = 0; j < program.limit.size(); ++j) {
    const double d = x[2 * j] - x[2 * j + 1];
    answer.displacement.push_back(std::abs(d) <= kTolerance ? 0 : d);
    answer.objective += std::abs(answer.displacement.back());
  }
  for (int j = 0; j < 2 * program.num_columns(); ++j)
    program.column_status[static_cast<std::size_t>(j)] = static_cast<std::uint8_t>(Clp_getColumnStatus(model.get(), j));
  for (int r = 0; r < program.num_rows(); ++r)
    program.row_status[static_cast<std::size_t>(r)] = static_cast<std::uint8_t>(Clp_getRowStatus(model.get(), r));
  return answer;
}

std::vector<Concession> concede(const ComponentProgram& program) {
  const Model model = make_model();
  Columns columns(program);
  std::fill(columns.cost.begin(), columns.cost.end(), 0.0);
  std::vector<int> row_of;
  const auto help = [&](int r, double sign, double limit, double price) {
    columns.add_helper(r, sign, limit, price);
    row_of.push_back(r);
  };
  for (int r = 0; r < program.num_rows(); ++r) {
    const auto i = static_cast<std::size_t>(r);
    if (std::isfinite(program.lower[i])) {
      if (program.strict[i] > 0) help(r, 1, program.strict[i], program.weight[i] * kStrictShare);
      help(r, 1, HUGE_VAL, program.weight[i]);
    }
    if (std::isfinite(program.upper[i])) help(r, -1, HUGE_VAL, program.weight[i]);
  }
  columns.load(model.get(), program);
  Clp_primal(model.get(), 0);
  std::vector<Concession> concessions;
  const double* x = Clp_primalColumnSolution(model.get()) + 2 * program.num_columns();
  for (std::size_t k = 0; k < row_of.size(); ++k) {
    if (x[k] <= kTolerance) continue;
    if (concessions.empty() || concessions.back().row != row_of[k]) concessions.push_back({row_of[k], 0});
    concessions.back().amount += x[k];
  }
  return concessions;
}

}  // namespace hydrotin
