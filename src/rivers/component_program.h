#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace hydrotin {

/// The linear program of one component: minimise sum |d_j| with |d_j| <= limit_j and rows lower <= A d <= upper.
/// Rows and columns come in (x, y) order, so that the answer does not depend on any numbering.
struct ComponentProgram {
  std::vector<double> limit;       ///< [columns] may be infinite
  std::vector<int> begin, column;  ///< rows as CSR
  std::vector<double> coefficient;
  std::vector<double> lower, upper;         ///< [rows] may be infinite
  std::vector<double> strict;               ///< [rows] part of `lower` that is given up first
  std::vector<double> weight;               ///< [rows] price of giving up the weak row
  std::vector<std::uint8_t> column_status;  ///< [2 columns] of the basis: rises, falls by turns; in and out
  std::vector<std::uint8_t> row_status;     ///< [rows] in and out

  [[nodiscard]] int num_columns() const { return static_cast<int>(limit.size()); }
  [[nodiscard]] int num_rows() const { return static_cast<int>(lower.size()); }
};

inline constexpr std::uint8_t kBasic = 1, kAtLower = 3;

enum class ProgramEnd : std::uint8_t { optimal, infeasible, stopped };

struct ComponentAnswer {
  ProgramEnd end = ProgramEnd::stopped;
  std::vector<double> displacement;  ///< [columns]
  double objective = 0;
  std::uint64_t iterations = 0;
};

/// Dual simplex from the given basis.
/// @param stop  asked at the beginning and every so many iterations; may be empty
[[nodiscard]] ComponentAnswer solve(ComponentProgram& program, std::uint64_t max_iterations,
                                    const std::function<bool()>& stop);

/// What rows must give up so that all can hold: the cheapest by weight; the strict part costs less than the weak row.
struct Concession {
  int row = 0;
  double amount = 0;
};
[[nodiscard]] std::vector<Concession> concede(const ComponentProgram& program);

}  // namespace hydrotin
