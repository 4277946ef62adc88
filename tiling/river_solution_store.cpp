#include "river_solution_store.h"

#include <algorithm>

#include "store_arrays.h"

namespace hydrotin {
namespace {

using store::check_below;
using store::contradicts;
using store::read_lists;
using store::read_sized;
using store::write_lists;

using PointHeights = std::vector<std::pair<std::uint64_t, std::int32_t>>;

void write_heights(store::Writer& out, const std::string& name, std::span<const GroupSolution> solutions,
                   PointHeights GroupSolution::*list, const std::string& meaning) {
  write_lists<std::uint64_t>(
      out, name + "_point", solutions,
      [&](const GroupSolution& s, std::vector<std::uint64_t>& flat) {
        for (const auto& [point, height] : s.*list) flat.push_back(point);
      },
      meaning + ": tile << 32 | index, ascending");
  std::vector<std::int32_t> height;
  for (const GroupSolution& s : solutions)
    for (const auto& [point, h] : s.*list) height.push_back(h);
  out.append(name + "_height", height, "z lattice");
}

void read_heights(const store::Reader& in, const std::string& name, std::vector<GroupSolution>& solutions,
                  PointHeights GroupSolution::*list) {
  const auto points = read_lists<std::uint64_t>(in, name + "_point", solutions.size());
  const auto height = read_sized<std::int32_t>(in, name + "_height", in.size(name + "_point"));
  auto at = height.begin();
  for (std::size_t s = 0; s < solutions.size(); ++s)
    for (const std::uint64_t point : points[s]) (solutions[s].*list).emplace_back(point, *at++);
}

void write_moved(store::Writer& out, std::span<const GroupSolution> solutions) {
  write_lists<std::uint64_t>(
      out, "moved_point", solutions,
      [](const GroupSolution& s, std::vector<std::uint64_t>& flat) {
        for (const MovedVertex& v : s.moved) flat.push_back(v.point);
      },
      "vertices that the rivers move: tile << 32 | index, ascending");
  std::vector<std::int32_t> flat;
  for (const GroupSolution& s : solutions)
    for (const MovedVertex& v : s.moved) flat.insert(flat.end(), {v.position.x, v.position.y, v.before, v.after});
  out.append("moved_xyzh", flat, "lattice: place, height before, height after");
}

void read_moved(const store::Reader& in, std::vector<GroupSolution>& solutions) {
  const auto points = read_lists<std::uint64_t>(in, "moved_point", solutions.size());
  const auto flat = read_sized<std::int32_t>(in, "moved_xyzh", 4 * in.size("moved_point"));
  const std::int32_t* at = flat.data();
  for (std::size_t s = 0; s < solutions.size(); ++s)
    for (const std::uint64_t point : points[s]) {
      solutions[s].moved.push_back({point, {at[0], at[1]}, at[2], at[3]});
      at += 4;
    }
}

constexpr std::size_t kNumColumns = 15;

void write_table(store::Writer& out, std::span<const GroupSolution> solutions) {
  write_lists<std::uint32_t>(
      out, "table_river", solutions,
      [](const GroupSolution& s, std::vector<std::uint32_t>& flat) {
        for (const RiverShare& share : s.table) flat.push_back(share.river);
      },
      "rivers of the tables");
  std::vector<double> flat;
  for (const GroupSolution& s : solutions)
    for (const auto& [river, r] : s.table) {
      for (const std::uint64_t number :
           {r.edges, r.wrong_flow_before, r.not_valley_before, r.flat_before, r.leaks_before, r.wrong_flow_after,
            r.not_valley_after, r.flat_after, r.leaks_after, r.moved})
        flat.push_back(static_cast<double>(number));
      flat.insert(flat.end(), {r.length, r.drop_before, r.drop_after, r.total, r.largest});
    }
  out.append("table", flat,
             "edges; before: wrong flow, not valley, flat, leaks; after: the same; moved, length, drop before, drop "
             "after, total change, largest change");
}

void read_table(const store::Reader& in, std::vector<GroupSolution>& solutions) {
  const auto rivers = read_lists<std::uint32_t>(in, "table_river", solutions.size());
  const auto flat = read_sized<double>(in, "table", kNumColumns * in.size("table_river"));
  const double* at = flat.data();
  for (std::size_t s = 0; s < solutions.size(); ++s)
    for (const std::uint32_t river : rivers[s]) {
      RiverShare& share = solutions[s].table.emplace_back();
      share.river = river;
      RiverRow& r = share.row;
      for (std::uint64_t* number :
           {&r.edges, &r.wrong_flow_before, &r.not_valley_before, &r.flat_before, &r.leaks_before, &r.wrong_flow_after,
            &r.not_valley_after, &r.flat_after, &r.leaks_after, &r.moved})
        *number = static_cast<std::uint64_t>(*at++);
      for (double* value : {&r.length, &r.drop_before, &r.drop_after, &r.total, &r.largest}) *value = *at++;
    }
}

void write_broken(store::Writer& out, std::span<const GroupSolution> solutions) {
  std::vector<BrokenPlace> all;
  std::vector<std::uint64_t> begin{0};
  for (const GroupSolution& s : solutions) {
    all.insert(all.end(), s.broken.begin(), s.broken.end());
    begin.push_back(all.size());
  }
  std::vector<std::uint8_t> kind, strict;
  std::vector<double> missing;
  std::vector<std::int32_t> xyz;
  for (const BrokenPlace& b : all) {
    kind.push_back(static_cast<std::uint8_t>(b.kind));
    strict.push_back(b.is_strict_part ? 1 : 0);
    missing.push_back(b.missing);
    xyz.insert(xyz.end(), {b.at.x, b.at.y, b.height});
  }
  out.append("broken_begin", begin, "rows that do not hold, of each solution");
  out.append("broken_kind", kind, "kind of row");
  out.append("broken_strict", strict, "1: only what goes beyond the weak row is missing");
  out.append("broken_missing", missing, "how much, in the unit of heights");
  out.append("broken_xyz", xyz, "the first vertex, as embedded, lattice");
  write_lists<std::uint64_t>(
      out, "broken_point", all,
      [](const BrokenPlace& b, std::vector<std::uint64_t>& flat) {
        flat.insert(flat.end(), b.point.begin(), b.point.end());
      },
      "the row's vertices");
}

void read_broken(const store::Reader& in, std::vector<GroupSolution>& solutions) {
  const auto begin = read_sized<std::uint64_t>(in, "broken_begin", solutions.size() + 1);
  const auto kind = in.read<std::uint8_t>("broken_kind");
  const std::uint64_t n = kind.size();
  const auto strict = read_sized<std::uint8_t>(in, "broken_strict", n);
  const auto missing = read_sized<double>(in, "broken_missing", n);
  const auto xyz = read_sized<std::int32_t>(in, "broken_xyz", 3 * n);
  auto points = read_lists<std::uint64_t>(in, "broken_point", n);
  if (begin.back() != n || !std::is_sorted(begin.begin(), begin.end())) contradicts(in.path());
  check_below(in, kind, static_cast<std::uint64_t>(RowKind::chain) + 1);
  for (std::size_t s = 0; s < solutions.size(); ++s)
    for (std::uint64_t i = begin[s]; i < begin[s + 1]; ++i)
      solutions[s].broken.push_back({static_cast<RowKind>(kind[i]),
                                     strict[i] != 0,
                                     missing[i],
                                     std::move(points[i]),
                                     {xyz[3 * i], xyz[3 * i + 1]},
                                     xyz[3 * i + 2]});
}

std::uint8_t flags_of(const RiverEdgeState& state) {
  return static_cast<std::uint8_t>((state.wrong_flow ? 1 : 0) + (state.not_valley ? 2 : 0) + (state.is_level ? 4 : 0));
}

RiverEdgeState state_of(unsigned flags) {
  return {(flags & 1U) != 0, (flags & 2U) != 0, (flags & 4U) != 0};
}

void write_edge_states(store::Writer& out, std::span<const GroupSolution> solutions) {
  write_lists<std::uint32_t>(
      out, "edge", solutions,
      [](const GroupSolution& s, std::vector<std::uint32_t>& flat) {
        for (const EmbeddedEdge& e : s.edge) flat.push_back(e.edge);
      },
      "river edges of the network");
  std::vector<std::uint8_t> state;
  for (const GroupSolution& s : solutions)
    for (const EmbeddedEdge& e : s.edge)
      state.push_back(static_cast<std::uint8_t>(flags_of(e.before) | flags_of(e.after) << 4));
  out.append("edge_state", state, "1: wrong flow, 2: no valley, 4: level; before, and 16 times that after");
}

void read_edge_states(const store::Reader& in, std::vector<GroupSolution>& solutions) {
  const auto edge = read_lists<std::uint32_t>(in, "edge", solutions.size());
  const auto state = read_sized<std::uint8_t>(in, "edge_state", in.size("edge"));
  auto at = state.begin();
  for (std::size_t s = 0; s < solutions.size(); ++s)
    for (const std::uint32_t e : edge[s]) {
      solutions[s].edge.push_back({e, state_of(*at & 15U), state_of(*at / 16U)});
      ++at;
    }
}

constexpr std::uint8_t kLargestChange = 255;

void write_limits(store::Writer& out, std::span<const GroupSolution> solutions) {
  std::vector<LimitPlace> all;
  std::vector<std::uint64_t> begin{0};
  std::vector<std::uint8_t> kind;
  std::vector<std::int32_t> change;
  for (const GroupSolution& s : solutions) {
    for (const LimitPlace& limit : s.limit) {
      kind.push_back(limit.is_largest_change ? kLargestChange : static_cast<std::uint8_t>(limit.kind));
      change.push_back(limit.change);
      all.push_back(limit);
    }
    begin.push_back(all.size());
  }
  out.append("limit_begin", begin, "rows without room, of each solution");
  out.append("limit_kind", kind, "kind of row; 255: the largest change of one vertex");
  out.append("limit_change", change, "of a vertex that moved as far as it may, z lattice");
  write_lists<std::int32_t>(
      out, "limit_xyz", all,
      [](const LimitPlace& limit, std::vector<std::int32_t>& flat) {
        for (const auto& p : limit.corner) flat.insert(flat.end(), p.begin(), p.end());
      },
      "their vertices as embedded, lattice");
}

void read_limits(const store::Reader& in, std::vector<GroupSolution>& solutions) {
  const auto begin = read_sized<std::uint64_t>(in, "limit_begin", solutions.size() + 1);
  const auto kind = in.read<std::uint8_t>("limit_kind");
  const auto change = read_sized<std::int32_t>(in, "limit_change", kind.size());
  const auto corners = read_lists<std::int32_t>(in, "limit_xyz", kind.size());
  if (begin.back() != kind.size() || !std::is_sorted(begin.begin(), begin.end())) contradicts(in.path());
  for (std::size_t s = 0; s < solutions.size(); ++s)
    for (std::uint64_t i = begin[s]; i < begin[s + 1]; ++i) {
      const bool is_largest = kind[i] == kLargestChange;
      const std::vector<std::int32_t>& flat = corners[i];
      if ((!is_largest && kind[i] > static_cast<std::uint8_t>(RowKind::chain)) ||
          flat.size() < (is_largest ? 3U : 6U) || flat.size() % 3 != 0)
        contradicts(in.path());
      LimitPlace& limit = solutions[s].limit.emplace_back();
      limit.kind = is_largest ? RowKind::flow : static_cast<RowKind>(kind[i]);
      limit.is_largest_change = is_largest;
      limit.change = change[i];
      for (std::size_t k = 0; k < flat.size(); k += 3) limit.corner.push_back({flat[k], flat[k + 1], flat[k + 2]});
    }
}

constexpr std::size_t kNumFigures = 6;

}  // namespace

void write_solutions(store::Writer& out, std::span<const GroupSolution> solutions) {
  write_lists<std::uint32_t>(
      out, "solution_group", solutions,
      [](const GroupSolution& s, std::vector<std::uint32_t>& flat) {
        flat.insert(flat.end(), s.group.begin(), s.group.end());
      },
      "groups solved together");
  write_moved(out, solutions);
  write_table(out, solutions);
  write_heights(out, "floor", solutions, &GroupSolution::floor, "wingtips, and the least height the valleys leave");
  write_lists<std::uint64_t>(
      out, "near", solutions,
      [](const GroupSolution& s, std::vector<std::uint64_t>& flat) {
        flat.insert(flat.end(), s.near.begin(), s.near.end());
      },
      "vertices that no other solution may come near");
  write_broken(out, solutions);
  write_edge_states(out, solutions);
  write_limits(out, solutions);
  std::vector<double> objective;
  std::vector<std::uint64_t> figure;
  for (const GroupSolution& s : solutions) {
    objective.insert(objective.end(), {s.objective, s.bound});
    figure.insert(figure.end(), {s.rows, s.columns, s.rounds, s.iterations, s.clamped, s.optimal ? 1u : 0u});
  }
  out.append("objective", objective, "total change and its bound of each solution, in the unit of heights");
  out.append("figure", figure, "rows, columns, rounds, iterations, clamped networks, 1: optimal");
}

std::vector<GroupSolution> read_solutions(const store::Reader& in) {
  const std::uint64_t begins = in.size("solution_group_begin");
  if (begins == 0) contradicts(in.path());
  std::vector<GroupSolution> out(begins - 1);
  auto group = read_lists<std::uint32_t>(in, "solution_group", out.size());
  auto near = read_lists<std::uint64_t>(in, "near", out.size());
  read_moved(in, out);
  read_table(in, out);
  read_heights(in, "floor", out, &GroupSolution::floor);
  read_broken(in, out);
  read_edge_states(in, out);
  read_limits(in, out);
  const auto objective = read_sized<double>(in, "objective", 2 * out.size());
  const auto figure = read_sized<std::uint64_t>(in, "figure", kNumFigures * out.size());
  for (std::size_t s = 0; s < out.size(); ++s) {
    out[s].group = std::move(group[s]);
    out[s].near = std::move(near[s]);
    out[s].objective = objective[2 * s];
    out[s].bound = objective[2 * s + 1];
    const std::uint64_t* f = figure.data() + kNumFigures * s;
    out[s].rows = f[0];
    out[s].columns = f[1];
    out[s].rounds = f[2];
    out[s].iterations = f[3];
    out[s].clamped = f[4];
    out[s].optimal = f[5] != 0;
  }
  return out;
}

}  // namespace hydrotin
