#include "river_network_store.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "block_index.h"
#include "river_input.h"
#include "store_arrays.h"

namespace hydrotin {
namespace {

using store::check_below;
using store::contradicts;
using store::read_sized;

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

}  // namespace hydrotin
