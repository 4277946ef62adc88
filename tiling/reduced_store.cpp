#include "reduced_store.h"

#include <algorithm>

namespace hydrotin {
namespace {

[[noreturn]] void contradicts(const store::Reader& in, const std::string& what) {
  throw Error(ErrorKind::storage, in.path() + ": " + what + "; delete the file and run again");
}

}  // namespace

void write_tree(store::Writer& out, const SpillTree& tree) {
  std::vector<std::uint32_t> a, b;
  std::vector<std::int32_t> height;
  for (const SpillEdge& e : tree.edge) {
    a.push_back(e.a);
    b.push_back(e.b);
    height.push_back(e.height);
  }
  out.append("rim", tree.rim, "vertices that other parts have too: tile << 32 | index, ascending");
  out.append("edge_a", a, "index into rim");
  out.append("edge_b", b, "index into rim, 4294967295: the outlets");
  out.append("edge_height", height, "z lattice: water at one end reaches the other when it stands so high");
}

SpillTree read_tree(const store::Reader& in) {
  SpillTree tree;
  tree.rim = in.read<std::uint64_t>("rim");
  const auto a = in.read<std::uint32_t>("edge_a");
  const auto b = in.read<std::uint32_t>("edge_b");
  const auto height = in.read<std::int32_t>("edge_height");
  if (a.size() != b.size() || a.size() != height.size()) contradicts(in, "the edges of its tree are cut");
  tree.edge.reserve(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) tree.edge.push_back({a[i], b[i], height[i]});
  if (!is_valid(tree)) contradicts(in, "its reduced tree contradicts itself");
  return tree;
}

void write_catchments(store::Writer& out, const Catchments& catchments, std::span<const std::int32_t> height) {
  std::vector<std::uint32_t> rise(height.size());  // most are 0, which takes no room
  for (std::size_t v = 0; v < rise.size(); ++v)
    rise[v] = static_cast<std::uint32_t>(catchments.level[v]) - static_cast<std::uint32_t>(height[v]);
  out.append("catchment_rise", rise,
             "z lattice: how much higher than the vertex water climbs to the nearest terminal, an entry of rim or an "
             "outlet");
  out.append("catchment_terminal", catchments.terminal, "that terminal: index into rim, 4294967295: an outlet");
}

Catchments read_catchments(const store::Reader& in, std::span<const std::int32_t> height, std::size_t num_rim) {
  const auto rise = in.read<std::uint32_t>("catchment_rise");
  Catchments out{std::vector<std::int32_t>(rise.size()), in.read<std::uint32_t>("catchment_terminal")};
  if (rise.size() != height.size() || out.terminal.size() != height.size() ||
      std::any_of(out.terminal.begin(), out.terminal.end(),
                  [&](std::uint32_t t) { return t >= num_rim && t != kOutlet; }))
    contradicts(in, "its catchments are not those of the tile's vertices");
  for (std::size_t v = 0; v < rise.size(); ++v)
    out.level[v] = static_cast<std::int32_t>(static_cast<std::uint32_t>(height[v]) + rise[v]);
  return out;
}

void write_plateaus(store::Writer& out, const std::string& prefix, const PlateauSummary& summary) {
  const auto interleaved = [](const auto& points, auto position_of) {
    std::vector<std::int32_t> xy;
    for (const auto& p : points) xy.insert(xy.end(), {position_of(p).x, position_of(p).y});
    return xy;
  };
  std::vector<std::uint64_t> vertex, vertices;
  std::vector<std::int32_t> height;
  for (const Pit& pit : summary.pit) {
    vertex.push_back(pit.vertex);
    height.push_back(pit.height);
    vertices.push_back(pit.num_vertices);
  }
  out.append(prefix + "pit_xy", interleaved(summary.pit, [](const Pit& p) { return p.representative; }),
             "smallest vertex by (x, y) of each pit that lies inside this part, lattice");
  out.append(prefix + "pit_vertex", vertex, "its tile << 32 | index");
  out.append(prefix + "pit_height", height, "z lattice");
  out.append(prefix + "pit_vertices", vertices, "vertices of the plateau");
  out.append(prefix + "plateau_xy", interleaved(summary.representative, [](LatticePoint p) { return p; }),
             "plateaus that reach the rim: smallest vertex by (x, y) of this part, lattice");
  out.append(prefix + "plateau_vertex", summary.vertex, "its tile << 32 | index");
  out.append(prefix + "plateau_height", summary.height, "z lattice");
  out.append(prefix + "plateau_inner", summary.num_inner, "vertices off the rim");
  out.append(prefix + "plateau_drains", summary.drains, "1: has an outlet or a lower neighbour in this part");
  out.append(prefix + "plateau_rim_begin", summary.rim_begin, "offsets into plateau_rim, one more than plateaus");
  out.append(prefix + "plateau_rim", summary.rim_vertex, "rim vertices of the plateaus: tile << 32 | index");
}

std::vector<Pit> read_pits(const store::Reader& in, const std::string& prefix) {
  const auto xy = in.read<std::int32_t>(prefix + "pit_xy");
  const auto vertex = in.read<std::uint64_t>(prefix + "pit_vertex");
  const auto height = in.read<std::int32_t>(prefix + "pit_height");
  const auto vertices = in.read<std::uint64_t>(prefix + "pit_vertices");
  if (xy.size() != 2 * vertex.size() || height.size() != vertex.size() || vertices.size() != vertex.size())
    contradicts(in, "the arrays of its pits have different lengths");
  std::vector<Pit> pits;
  pits.reserve(vertex.size());
  for (std::size_t i = 0; i < vertex.size(); ++i)
    pits.push_back({{xy[2 * i], xy[2 * i + 1]}, vertex[i], height[i], vertices[i]});
  return pits;
}

PlateauSummary read_open_plateaus(const store::Reader& in, const std::string& prefix) {
  PlateauSummary out;
  const auto xy = in.read<std::int32_t>(prefix + "plateau_xy");
  out.vertex = in.read<std::uint64_t>(prefix + "plateau_vertex");
  out.height = in.read<std::int32_t>(prefix + "plateau_height");
  out.num_inner = in.read<std::uint32_t>(prefix + "plateau_inner");
  out.drains = in.read<std::uint8_t>(prefix + "plateau_drains");
  out.rim_begin = in.read<std::uint32_t>(prefix + "plateau_rim_begin");
  out.rim_vertex = in.read<std::uint64_t>(prefix + "plateau_rim");
  const std::size_t n = out.height.size();
  // Every open plateau has a rim vertex, so offsets ascend strictly.
  if (xy.size() != 2 * n || out.vertex.size() != n || out.num_inner.size() != n || out.drains.size() != n ||
      out.rim_begin.size() != n + 1 || out.rim_begin.front() != 0 || out.rim_begin.back() != out.rim_vertex.size() ||
      std::adjacent_find(out.rim_begin.begin(), out.rim_begin.end(), std::greater_equal<>{}) != out.rim_begin.end())
    contradicts(in, "the arrays of its plateaus contradict each other");
  out.representative.reserve(n);
  for (std::size_t i = 0; i < n; ++i) out.representative.push_back({xy[2 * i], xy[2 * i + 1]});
  return out;
}

}  // namespace hydrotin
