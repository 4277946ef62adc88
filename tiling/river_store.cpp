#include "river_store.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

#include "block_index.h"
#include "river_input.h"

namespace hydrotin {
namespace {

[[noreturn]] void contradicts(const std::string& path) {
  throw Error(ErrorKind::storage, path + ": its arrays contradict each other; delete the scratch folder and run again");
}

template <class T>
std::vector<T> read_sized(const store::Reader& in, const std::string& name, std::uint64_t size) {
  if (in.size(name) != size) contradicts(in.path());
  return in.read<T>(name);
}

template <std::size_t N>
void write_items(store::Writer& out, const std::string& name, const std::vector<PatchItem<N>>& items,
                 const std::string& meaning) {
  std::vector<std::uint32_t> flat;
  for (const auto& item : items) {
    flat.push_back(item.tile);
    flat.insert(flat.end(), item.vertex.begin(), item.vertex.end());
  }
  out.append(name, flat, meaning);
}

template <std::size_t N>
std::vector<PatchItem<N>> read_items(const store::Reader& in, const std::string& name, std::uint32_t num_tiles,
                                     std::uint32_t num_vertices) {
  const auto flat = in.read<std::uint32_t>(name);
  if (flat.size() % (N + 1) != 0) contradicts(in.path());
  std::vector<PatchItem<N>> out(flat.size() / (N + 1));
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i].tile = flat[i * (N + 1)];
    if (out[i].tile >= num_tiles) contradicts(in.path());
    for (std::size_t k = 0; k < N; ++k) {
      out[i].vertex[k] = flat[i * (N + 1) + 1 + k];
      if (out[i].vertex[k] >= num_vertices) contradicts(in.path());
    }
  }
  if (!std::is_sorted(out.begin(), out.end())) contradicts(in.path());
  return out;
}

void write_edges(store::Writer& out, const std::string& name, const std::vector<RiverEdge>& edges,
                 const std::string& meaning) {
  std::vector<std::uint32_t> flat;
  for (const auto& [from, to] : edges) flat.insert(flat.end(), {from, to});
  out.append(name, flat, meaning);
}

std::vector<RiverEdge> read_edges(const store::Reader& in, const std::string& name, std::uint32_t num_vertices) {
  const auto flat = in.read<std::uint32_t>(name);
  if (flat.size() % 2 != 0 || std::any_of(flat.begin(), flat.end(), [&](auto v) { return v >= num_vertices; }))
    contradicts(in.path());
  std::vector<RiverEdge> out;
  for (std::size_t i = 0; i < flat.size(); i += 2) out.push_back({flat[i], flat[i + 1]});
  return out;
}

template <class T>
void check_below(const store::Reader& in, const std::vector<T>& values, std::uint64_t end) {
  if (std::any_of(values.begin(), values.end(), [&](T value) { return value >= end; })) contradicts(in.path());
}

void write_lakes(store::Writer& out, const RiverNetwork& network) {
  std::vector<std::uint64_t> begin{0};
  std::vector<std::uint32_t> vertex;
  std::vector<std::uint8_t> has_level;
  std::vector<double> level;
  for (const Lake& lake : network.lake) {
    vertex.insert(vertex.end(), lake.vertex.begin(), lake.vertex.end());
    begin.push_back(vertex.size());
    has_level.push_back(lake.has_level ? 1 : 0);
    level.push_back(lake.level);
  }
  out.append("lake_begin", begin, "offsets into lake_vertex, one more than lakes");
  out.append("lake_vertex", vertex, "vertices that become level");
  out.append("lake_has_level", has_level, "1: the level is given");
  out.append("lake_level", level, "z lattice");
  out.append("lake_group", network.lake_group, "its group");
}

void read_lakes(const store::Reader& in, RiverNetwork& out) {
  const auto begin = in.read<std::uint64_t>("lake_begin");
  const auto vertex = in.read<std::uint32_t>("lake_vertex");
  check_below(in, vertex, out.num_vertices());
  if (begin.empty() || begin.back() != vertex.size() || !std::is_sorted(begin.begin(), begin.end()))
    contradicts(in.path());
  const std::uint64_t n = begin.size() - 1;
  const auto has_level = read_sized<std::uint8_t>(in, "lake_has_level", n);
  const auto level = read_sized<double>(in, "lake_level", n);
  out.lake_group = read_sized<std::uint32_t>(in, "lake_group", n);
  check_below(in, out.lake_group, out.num_groups());
  for (std::size_t i = 0; i < n; ++i) {
    Lake& lake = out.lake.emplace_back();
    lake.vertex.assign(vertex.begin() + static_cast<std::ptrdiff_t>(begin[i]),
                       vertex.begin() + static_cast<std::ptrdiff_t>(begin[i + 1]));
    lake.has_level = has_level[i] != 0;
    lake.level = level[i];
  }
}

void write_counts(store::Writer& out, const StepCounts& counts) {
  std::vector<std::uint8_t> name;
  std::vector<std::uint64_t> number;
  for (const auto& [text, value] : counts) {
    name.insert(name.end(), text.begin(), text.end());
    name.push_back(0);
    number.push_back(value);
  }
  out.append("step_name", name, "what became of the lines, zero-terminated");
  out.append("step_count", number, "and how often");
}

StepCounts read_counts(const store::Reader& in) {
  const auto name = in.read<std::uint8_t>("step_name");
  StepCounts out;
  auto at = name.begin();
  for (const std::uint64_t number : in.read<std::uint64_t>("step_count")) {
    const auto end = std::find(at, name.end(), std::uint8_t{0});
    if (end == name.end()) contradicts(in.path());
    out.emplace_back(std::string(at, end), number);
    at = end + 1;
  }
  return out;
}

// Lists of lists as CSR.
template <class T, class List, class Of>
void write_lists(store::Writer& out, const std::string& name, const List& lists, Of of, const std::string& meaning) {
  std::vector<std::uint64_t> begin{0};
  std::vector<T> flat;
  for (const auto& entry : lists) {
    of(entry, flat);
    begin.push_back(flat.size());
  }
  out.append(name + "_begin", begin, "offsets into " + name + ", one more than lists");
  out.append(name, flat, meaning);
}

template <class T>
std::vector<std::vector<T>> read_lists(const store::Reader& in, const std::string& name, std::uint64_t count) {
  const auto begin = read_sized<std::uint64_t>(in, name + "_begin", count + 1);
  const auto flat = in.read<T>(name);
  if (begin.back() != flat.size() || !std::is_sorted(begin.begin(), begin.end())) contradicts(in.path());
  std::vector<std::vector<T>> out;
  for (std::uint64_t i = 0; i < count; ++i)
    out.emplace_back(flat.begin() + static_cast<std::ptrdiff_t>(begin[i]),
                     flat.begin() + static_cast<std::ptrdiff_t>(begin[i + 1]));
  return out;
}

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

RiverNames name_rivers(const RunContext& context, const RiverNetwork& network) {
  std::vector<std::uint32_t> parent(network.num_vertices());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto find = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const auto& [from, to] : network.river) {
    const std::uint32_t a = find(from), b = find(to);
    const bool a_first = network.position[a] < network.position[b];
    parent[a_first ? b : a] = a_first ? a : b;
  }
  const auto& names = context.river_input->name;
  std::map<std::string, std::uint32_t> named;
  std::map<LatticePoint, std::uint32_t> unnamed;
  std::map<LatticePoint, std::uint32_t> networks;
  for (std::size_t e = 0; e < network.river.size(); ++e) {
    const std::string& name = names[network.line[e]];
    const LatticePoint top = network.position[find(network.river[e].from)];
    networks.emplace(top, 0);
    if (name.empty())
      unnamed.emplace(top, 0);
    else
      named.emplace(name, 0);
  }
  RiverNames out;
  std::uint32_t count = 0;
  for (auto& [top, number] : networks) number = ++count;
  for (auto& [name, number] : named) {
    number = static_cast<std::uint32_t>(out.name.size());
    out.name.push_back(name);
  }
  for (auto& [top, number] : unnamed) {
    number = static_cast<std::uint32_t>(out.name.size());
    out.name.push_back("network " + std::to_string(networks.at(top)));
  }
  for (std::size_t e = 0; e < network.river.size(); ++e) {
    const std::string& name = names[network.line[e]];
    out.river.push_back(name.empty() ? unnamed.at(network.position[find(network.river[e].from)]) : named.at(name));
  }
  return out;
}

void write_network(store::Writer& out, const RiverNetwork& n) {
  std::vector<std::int32_t> xyz;
  for (std::uint32_t v = 0; v < n.num_vertices(); ++v)
    xyz.insert(xyz.end(), {n.position[v].x, n.position[v].y, n.height[v]});
  out.append("bounds", flatten(n.bounds), "boxes of the parts");
  out.append("point", n.point, "vertices: tile << 32 | index, ascending; new ones are of a tile of their own");
  out.append("xyz", xyz, "lattice");
  out.set("new_vertices", std::int64_t{n.num_new});
  write_items(out, "gone", n.gone, "triangles that go: tile, vertices");
  write_items(out, "come", n.come, "triangles that come: tile, vertices");
  write_items(out, "hull_gone", n.hull_gone, "hull edges that go: tile, vertices");
  write_items(out, "hull_come", n.hull_come, "hull edges that come: tile, vertices");
  out.append("group_tile", n.group_tile, "tile that solves each group");
  write_edges(out, "river", n.river, "river edges: from, to; vertices");
  out.append("line", n.line, "line of the file that each river edge is of");
  out.append("river_group", n.river_group, "its group");
  write_edges(out, "chain", n.chain, "edges of outlet chains: from, to; vertices");
  out.append("chain_group", n.chain_group, "its group");
  write_lakes(out, n);
  write_edges(out, "preserved", n.preserved, "edges whose type must not change; vertices");
  write_counts(out, n.counts);
  out.append("is_turned", n.is_turned, "1: the line runs against the order of its points");
  out.append("drop", n.drop, "of each line downstream, z lattice");
  out.append("disagrees", n.disagrees, "lines that rise downstream");
  out.append("cycle_begin", n.cycle_begin, "offsets into cycle");
  out.append("cycle", n.cycle, "lines that run in circles");
  out.append("mouth", n.mouth, "vertices where rivers end");
  out.append("outlet", n.outlet, "vertices where water may leave: closed mouths, lakes that no river leaves");
  out.append("mouth_length", n.mouth_length, "edges of its chain");
  out.append("mouth_climb", n.mouth_climb, "how far its water has to climb on the way, z lattice");
  out.append("mouth_kind", n.mouth_kind, "0: at an outlet, 1: with an outlet chain, 2: closed in by its own river");
}

RiverNetwork read_network(const RunContext& context) {
  const store::Reader in(context.layout.unit(Phase::match, 0));
  const std::uint32_t tiles = context.plan.num_tiles();
  RiverNetwork n;
  n.bounds = unflatten(in.read<std::int32_t>("bounds"));
  n.point = in.read<std::uint64_t>("point");
  const auto xyz = read_sized<std::int32_t>(in, "xyz", 3 * n.point.size());
  for (std::size_t v = 0; v < n.point.size(); ++v) {
    n.position.push_back({xyz[3 * v], xyz[3 * v + 1]});
    n.height.push_back(xyz[3 * v + 2]);
  }
  n.num_new = static_cast<std::uint32_t>(in.integer("new_vertices"));
  if (n.bounds.size() != tiles || n.num_new > n.point.size() || !std::is_sorted(n.point.begin(), n.point.end()))
    contradicts(in.path());
  n.gone = read_items<3>(in, "gone", tiles, n.num_vertices());
  n.come = read_items<3>(in, "come", tiles, n.num_vertices());
  n.hull_gone = read_items<2>(in, "hull_gone", tiles, n.num_vertices());
  n.hull_come = read_items<2>(in, "hull_come", tiles, n.num_vertices());
  n.group_tile = in.read<std::uint32_t>("group_tile");
  check_below(in, n.group_tile, tiles);
  n.river = read_edges(in, "river", n.num_vertices());
  n.line = read_sized<std::uint32_t>(in, "line", n.river.size());
  n.river_group = read_sized<std::uint32_t>(in, "river_group", n.river.size());
  n.chain = read_edges(in, "chain", n.num_vertices());
  n.chain_group = read_sized<std::uint32_t>(in, "chain_group", n.chain.size());
  check_below(in, n.line, context.river_input->lines.size());
  check_below(in, n.river_group, n.num_groups());
  check_below(in, n.chain_group, n.num_groups());
  read_lakes(in, n);
  n.preserved = read_edges(in, "preserved", n.num_vertices());
  n.counts = read_counts(in);
  const std::uint64_t lines = context.river_input->lines.size();
  n.is_turned = read_sized<std::uint8_t>(in, "is_turned", lines);
  n.drop = read_sized<double>(in, "drop", lines);
  n.disagrees = in.read<std::uint32_t>("disagrees");
  n.cycle_begin = in.read<std::uint32_t>("cycle_begin");
  n.cycle = in.read<std::uint32_t>("cycle");
  check_below(in, n.disagrees, lines);
  check_below(in, n.cycle, lines);
  if (n.cycle_begin.empty() || n.cycle_begin.back() != n.cycle.size() ||
      !std::is_sorted(n.cycle_begin.begin(), n.cycle_begin.end()))
    contradicts(in.path());
  n.mouth = in.read<std::uint32_t>("mouth");
  n.mouth_kind = read_sized<std::uint8_t>(in, "mouth_kind", n.mouth.size());
  n.mouth_length = read_sized<std::uint32_t>(in, "mouth_length", n.mouth.size());
  n.mouth_climb = read_sized<double>(in, "mouth_climb", n.mouth.size());
  check_below(in, n.mouth, n.num_vertices());
  check_below(in, n.mouth_kind, 3);
  n.outlet = in.read<std::uint32_t>("outlet");
  check_below(in, n.outlet, n.num_vertices());
  return n;
}

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

std::shared_ptr<const EmbeddedRivers> load_embedded_rivers(const RunContext& context) {
  auto out = std::make_shared<EmbeddedRivers>();
  out->network = read_network(context);
  const store::Reader in(context.layout.unit(Phase::unite, 0));
  out->solution = read_solutions(in);
  const RiverNetwork& n = out->network;
  std::vector<std::uint8_t> is_solved(n.river.size(), 0);
  for (const GroupSolution& s : out->solution)
    for (const EmbeddedEdge& e : s.edge) {
      if (e.edge >= is_solved.size() || is_solved[e.edge] != 0) contradicts(in.path());
      is_solved[e.edge] = 1;
    }
  if (std::find(is_solved.begin(), is_solved.end(), 0) != is_solved.end()) contradicts(in.path());
  for (const GroupSolution& s : out->solution) {
    for (const MovedVertex& v : s.moved) out->moved.emplace_back(v.point, v.after);
    for (const auto& [point, height] : s.floor) out->bound[point].lower = height;
    for (const BrokenPlace& place : s.broken) {
      if (place.is_strict_part) continue;
      if (place.kind == RowKind::flow) out->contradicted.emplace_back(place.point[0], place.point[1]);
      if (place.kind == RowKind::valley) out->contradicted.emplace_back(place.point[1], place.point[2]);
    }
  }
  std::sort(out->moved.begin(), out->moved.end());
  std::sort(out->contradicted.begin(), out->contradicted.end());
  out->contradicted.erase(std::unique(out->contradicted.begin(), out->contradicted.end()), out->contradicted.end());
  for (const auto* edges : {&n.river, &n.chain})
    for (const auto& [from, to] : *edges)
      for (const std::uint32_t v : {from, to}) out->bound[n.point[v]].is_way = true;
  for (const Lake& lake : n.lake)
    for (const std::uint32_t v : lake.vertex) out->bound[n.point[v]].is_way = true;
  for (const std::uint32_t v : n.outlet) out->outlet.push_back(n.point[v]);
  std::sort(out->outlet.begin(), out->outlet.end());
  for (const auto& [from, to] : n.river) out->edge.emplace_back(n.point[from], n.point[to]);
  std::sort(out->edge.begin(), out->edge.end());
  const auto twice = [](const auto& a, const auto& b) { return a.first == b.first; };
  if (std::adjacent_find(out->moved.begin(), out->moved.end(), twice) != out->moved.end()) contradicts(in.path());
  return out;
}

}  // namespace hydrotin
