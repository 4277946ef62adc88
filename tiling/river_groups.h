#pragma once

#include <cstdint>
#include <vector>

#include "river_network_store.h"
#include "river_solution_store.h"
#include "river_window.h"

/// Groups of rivers on windows that grow until they hold all that the embedding asks.
///
/// A group is what connected networks, outlet chains and lakes hold together. Its program knows nothing of other
/// groups: where two of them come near each other (a vertex that moves, or is of the network, or is next to such a one,
/// in both), they are solved as one. What comes out depends neither on tiles nor on the order of groups.
///
/// Threads  Const functions are safe to call concurrently.

namespace hydrotin {

class GroupSolver {
 public:
  /// Keeps references: both must outlive it.
  GroupSolver(const RunContext& context, const RiverNetwork& network);

  /// @param group  ascending
  [[nodiscard]] GroupSolution solve(std::vector<std::uint32_t> group) const;

 private:
  struct Share;  // the rivers of some groups over a window

  using PointEdge = std::pair<std::uint64_t, std::uint64_t>;

  [[nodiscard]] Embedding embed(const RiverWindow& window, const Share& share) const;
  [[nodiscard]] bool preserve_near(const RiverWindow& window, std::span<const std::uint8_t> is_touched,
                                   std::vector<PointEdge>& preserved) const;
  [[nodiscard]] std::vector<std::uint32_t> vertices_of(std::span<const std::uint32_t> group) const;
  [[nodiscard]] Share share_in(const RiverWindow& window, std::span<const std::uint32_t> group,
                               std::span<const PointEdge> preserved) const;
  void describe(const RiverWindow& window, const Share& share, const Embedding& embedding,
                std::span<const std::uint8_t> is_touched, GroupSolution& out) const;

  void tabulate(const RiverWindow& window, const Share& share, const Embedding& embedding, GroupSolution& out) const;
  void list_limits(const RiverWindow& window, const Share& share, const Embedding& embedding, GroupSolution& out) const;

  const RunContext& context_;
  const RiverNetwork& network_;
  RiverNames names_;
  WindowReader reader_;
  std::vector<PointEdge> preserved_;  // ascending, the smaller point first
  std::vector<std::uint32_t> river_begin_, river_, chain_begin_, chain_, lake_begin_, lake_;  // of each group
};

/// Joins solutions that come near each other and solves them again, until none do.
[[nodiscard]] std::vector<GroupSolution> unite(const GroupSolver& solver, std::vector<GroupSolution> solutions);

}  // namespace hydrotin
