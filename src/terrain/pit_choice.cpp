#include "hydrotin/pit_choice.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <tuple>

#include "hydrotin/error.h"

namespace hydrotin {
namespace {

bool holds(const KeepClause& clause, const PitBasin& pit, bool is_marked) {
  if (clause.only_marked && !is_marked) return false;
  if (pit.spill_vertex == kNoPit) return true;
  return pit.depth() > clause.deeper_than && static_cast<double>(pit.doubled_area) / 2 > clause.larger_than &&
         pit.volume > clause.volume_above;
}

}  // namespace

std::vector<std::uint8_t> pits_to_keep(std::span<const PitBasin> pits, std::span<const KeepClause> clauses,
                                       std::span<const std::uint8_t> is_marked) {
  assert((is_marked.empty() || is_marked.size() == pits.size()) && "one mark per pit");
  std::vector<std::uint8_t> is_kept(pits.size(), 0);
  for (std::size_t i = 0; i < pits.size(); ++i)
    is_kept[i] = std::any_of(clauses.begin(), clauses.end(), [&](const KeepClause& clause) {
      return holds(clause, pits[i], !is_marked.empty() && is_marked[i] != 0);
    });
  return is_kept;
}

std::vector<std::uint8_t> pits_to_keep(std::span<const PitBasin> pits, const KeepConditions& conditions) {
  const KeepConditions& c = conditions;
  std::vector<KeepClause> clauses;
  const auto clause = [&]() -> KeepClause& {
    return c.all_conditions && !clauses.empty() ? clauses.front() : clauses.emplace_back();
  };
  if (c.deeper_than)
    clause().deeper_than = static_cast<std::int64_t>(std::floor(std::min(*c.deeper_than + 1e-6, 1e18)));
  if (c.larger_than) clause().larger_than = *c.larger_than;
  if (c.volume_above) clause().volume_above = *c.volume_above;
  const bool asks_inside = !c.is_inside.empty(), asks_listed = !c.is_listed.empty();
  assert((!asks_inside || c.is_inside.size() == pits.size()) && "one entry per pit");
  assert((!asks_listed || c.is_listed.size() == pits.size()) && "one entry per pit");
  std::vector<std::uint8_t> is_marked;
  if (asks_inside || asks_listed) {
    clause().only_marked = true;
    for (std::size_t i = 0; i < pits.size(); ++i) {
      const bool inside = asks_inside && c.is_inside[i] != 0, listed = asks_listed && c.is_listed[i] != 0;
      is_marked.push_back(asks_inside && asks_listed && c.all_conditions ? inside && listed : inside || listed);
    }
  }
  return pits_to_keep(pits, clauses, is_marked);
}

std::vector<std::uint8_t> listed_pits(std::span<const std::uint64_t> ids, std::size_t num_pits,
                                      const std::string& option) {
  std::vector<std::uint8_t> is_listed(num_pits, 0);
  for (const std::uint64_t id : ids) {
    if (id >= num_pits)
      throw Error(ErrorKind::config, option + ": there is no pit " + std::to_string(id) + "; ids count from 0 to " +
                                         std::to_string(num_pits) +
                                         " (excluded): see the table of pits of a run on the same points");
    is_listed[id] = 1;
  }
  return is_listed;
}

std::vector<std::uint8_t> keep_all_but_cheapest(std::span<const PitBasin> pits, std::size_t m) {
  std::vector<std::uint32_t> order(pits.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t i) {
    return std::tie(pits[i].price, pits[i].pit.height, pits[i].pit.representative);
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  std::vector<std::uint8_t> is_kept(pits.size(), 1);
  for (std::size_t i = 0; i < std::min(m, order.size()); ++i)
    if (pits[order[i]].price != kNoPrice) is_kept[order[i]] = 0;
  return is_kept;
}

std::vector<std::uint8_t> outlets_and_kept_pits(const VertexGraph& graph, std::span<const std::int32_t> height,
                                                std::span<const std::uint8_t> is_outlet, std::span<const PitBasin> pits,
                                                std::span<const std::uint8_t> is_kept) {
  assert(height.size() == graph.num_vertices() && is_outlet.size() == height.size() && "one entry per vertex");
  assert(is_kept.size() == pits.size() && "one entry per pit");
  std::vector<std::uint8_t> result(is_outlet.begin(), is_outlet.end());
  std::vector<std::uint32_t> open;
  for (std::size_t i = 0; i < pits.size(); ++i) {
    if (!is_kept[i]) continue;
    open.assign(1, static_cast<std::uint32_t>(pits[i].pit.vertex));
    result[open.back()] = 1;
    while (!open.empty()) {
      const std::uint32_t v = open.back();
      open.pop_back();
      for (const std::uint32_t w : graph.neighbors(v)) {
        if (height[w] != height[v] || result[w]) continue;
        result[w] = 1;
        open.push_back(w);
      }
    }
  }
  return result;
}

}  // namespace hydrotin
