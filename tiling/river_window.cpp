#include "river_window.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "block_index.h"
#include "river_input.h"
#include "river_need.h"
#include "store_arrays.h"
#include "terrain_file.h"
#include "triangle_runs.h"
#include "whole_array.h"

namespace hydrotin {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

using store::contradicts;

struct Vertex {
  LatticePoint position;
  std::uint64_t point = 0;
  std::int32_t height = 0;
  std::uint8_t is_outlet = 0;
};

// Triangles by their corners, with what a window says of each.
struct Share {
  std::vector<Vertex> vertex;
  std::vector<std::uint32_t> triangle;
  std::vector<std::uint8_t> is_hull_edge;
};

void read_vertices(const store::Reader& in, std::span<const std::uint32_t> number, Share& out) {
  store::for_stretches(number, kVertexGap,
                       [&](std::uint64_t begin, std::uint64_t count, std::span<const std::uint32_t> some) {
                         const auto point = in.read_range<std::uint64_t>("point", begin, count);
                         const auto xyz = in.read_range<std::int32_t>("xyz", 3 * begin, 3 * count);
                         const auto outlet = in.read_range<std::uint8_t>("outlet", begin, count);
                         for (const std::uint32_t v : some) {
                           const std::size_t i = v - begin;
                           out.vertex.push_back({{xyz[3 * i], xyz[3 * i + 1]}, point[i], xyz[3 * i + 2], outlet[i]});
                         }
                       });
}

Share read_share(const store::Reader& in, const CellGrid& grid, std::span<const Cell> cells) {
  const std::uint64_t n = in.size("point");
  if (in.size("xyz") != 3 * n || in.size("outlet") != n) contradicts(in.path(), "its arrays have different lengths");
  const std::vector<std::uint32_t> triangle = read_triangle_runs(in, grid, cells);
  const auto [used, number] = number_used(triangle, n);
  const auto hull = in.read<std::uint32_t>("hull_edge");
  std::vector<std::pair<std::uint32_t, std::uint32_t>> hull_edge;
  for (std::size_t i = 0; i + 1 < hull.size(); i += 2) hull_edge.emplace_back(hull[i], hull[i + 1]);
  Share out;
  read_vertices(in, used, out);
  for (std::size_t t = 0; t < triangle.size(); t += 3) {
    LatticeBox box;
    for (std::size_t i = 0; i < 3; ++i) box.extend(out.vertex[number[triangle[t + i]]].position);
    if (!meets(box, grid, cells)) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::pair edge(triangle[t + i], triangle[t + (i + 1) % 3]);
      out.is_hull_edge.push_back(std::binary_search(hull_edge.begin(), hull_edge.end(), edge) ? 1 : 0);
      out.triangle.push_back(number[edge.first]);
    }
  }
  return out;
}

// Vertices of all shares numbered by (x, y), triangles in the order of their vertices: the same at any tiling.
class Merger {
 public:
  void add(std::uint32_t tile, const Share& share) {
    std::vector<std::uint32_t> number(share.vertex.size(), kNone);
    for (std::size_t i = 0; i < share.triangle.size(); ++i) {
      const std::uint32_t v = share.triangle[i];
      if (number[v] == kNone) {
        number[v] = static_cast<std::uint32_t>(vertex_.size());
        vertex_.push_back(share.vertex[v]);
      }
      if (i % 3 == 0) triangle_.push_back({{}, {}, tile});
      triangle_.back().vertex[i % 3] = number[v];
      triangle_.back().is_hull_edge[i % 3] = share.is_hull_edge[i];
    }
  }

  RiverWindow merge(const CellGrid& grid, std::span<const Cell> cells, const std::string& path) {
    if (triangle_.size() >= std::size_t{1} << 29)
      throw Error(ErrorKind::resource, path + ": too many triangles around the rivers; give fewer lines at once");
    RiverWindow out;
    const std::vector<std::uint32_t> number = number_vertices(out, path);
    for (Triangle& t : triangle_) {
      for (std::uint32_t& v : t.vertex) v = number[v];
      const auto first = std::min_element(t.vertex.begin(), t.vertex.end()) - t.vertex.begin();
      std::rotate(t.vertex.begin(), t.vertex.begin() + first, t.vertex.end());
      std::rotate(t.is_hull_edge.begin(), t.is_hull_edge.begin() + first, t.is_hull_edge.end());
    }
    std::sort(triangle_.begin(), triangle_.end(),
              [](const Triangle& a, const Triangle& b) { return a.vertex < b.vertex; });
    for (const Triangle& t : triangle_) {
      out.triangle.insert(out.triangle.end(), t.vertex.begin(), t.vertex.end());
      out.is_hull_edge.insert(out.is_hull_edge.end(), t.is_hull_edge.begin(), t.is_hull_edge.end());
      out.tile.push_back(t.tile);
    }
    for (const LatticePoint p : out.position)
      out.is_complete.push_back(std::binary_search(cells.begin(), cells.end(), grid.of(p)) ? 1 : 0);
    return out;
  }

 private:
  struct Triangle {
    std::array<std::uint32_t, 3> vertex;
    std::array<std::uint8_t, 3> is_hull_edge;
    std::uint32_t tile;
  };

  std::vector<std::uint32_t> number_vertices(RiverWindow& out, const std::string& path) const {
    std::vector<std::uint32_t> order(vertex_.size()), number(vertex_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return vertex_[a].position < vertex_[b].position; });
    for (const std::uint32_t i : order) {
      const Vertex& v = vertex_[i];
      if (out.position.empty() || out.position.back() != v.position) {
        out.point.push_back(v.point);
        out.position.push_back(v.position);
        out.height.push_back(v.height);
        out.is_outlet.push_back(v.is_outlet);
      } else if (out.point.back() != v.point || out.height.back() != v.height) {
        contradicts(path, "tiles disagree about a vertex that they share");
      }
      out.is_outlet.back() |= v.is_outlet;
      number[i] = out.num_vertices() - 1;
    }
    return number;
  }

  std::vector<Vertex> vertex_;
  std::vector<Triangle> triangle_;
};

using Corners = std::array<std::uint64_t, 3>;

Corners canonical(Corners t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

Vertex listed(const RiverNetwork& patch, std::uint32_t v) {
  return {patch.position[v], patch.point[v], patch.height[v], 0};
}

// Takes out of a tile's share what the patch removes.
void remove_gone(const RiverNetwork& patch, std::uint32_t tile, Share& share) {
  const auto [first, last] = items_of(patch.gone, tile);
  if (first == last) return;
  std::vector<Corners> gone;
  for (auto at = first; at != last; ++at)
    gone.push_back(canonical({patch.point[at->vertex[0]], patch.point[at->vertex[1]], patch.point[at->vertex[2]]}));
  std::sort(gone.begin(), gone.end());
  std::size_t kept = 0;
  for (std::size_t t = 0; t < share.triangle.size(); t += 3) {
    const auto id = [&](std::size_t i) { return share.vertex[share.triangle[t + i]].point; };
    if (std::binary_search(gone.begin(), gone.end(), canonical({id(0), id(1), id(2)}))) continue;
    for (std::size_t i = 0; i < 3; ++i, ++kept) {
      share.triangle[kept] = share.triangle[t + i];
      share.is_hull_edge[kept] = share.is_hull_edge[t + i];
    }
  }
  share.triangle.resize(kept);
  share.is_hull_edge.resize(kept);
}

Share share_of_patch(const RiverNetwork& patch, const CellGrid& grid, std::span<const Cell> cells) {
  Share out;
  for (const PatchItem<3>& t : patch.come) {
    LatticeBox box;
    for (const std::uint32_t v : t.vertex) box.extend(patch.position[v]);
    if (!meets(box, grid, cells)) continue;
    for (const std::uint32_t v : t.vertex) {
      out.triangle.push_back(static_cast<std::uint32_t>(out.vertex.size()));
      out.vertex.push_back(listed(patch, v));
      out.is_hull_edge.push_back(0);
    }
  }
  return out;
}

}  // namespace

// The box of the data and as much again around it: where lines have a say.
LatticeBox reach_of(const LatticeBox& box) {
  const auto wide = [](std::int32_t low, std::int32_t high) {
    const std::int64_t size = std::int64_t{high} - low + 1;
    constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max() - 1;
    return std::pair(static_cast<std::int32_t>(std::max(low - size, -kMost)),
                     static_cast<std::int32_t>(std::min(high + size, kMost)));
  };
  const auto [west, east] = wide(box.min.x, box.max.x);
  const auto [south, north] = wide(box.min.y, box.max.y);
  return {{west, south}, {east, north}};
}

namespace {

// The boxes of polygons on the lattice, a unit wider.
void add_lakes(const RunContext& context, const LatticeBox& bounds, CellSet& cells) {
  const RiverInput& input = *context.river_input;
  const Lattice& l = context.plan.lattice;
  const LatticeBox reach = reach_of(bounds);
  const auto at = [&](double x, double offset, std::int64_t base, std::int32_t low, std::int32_t high) {
    const double unit = (x - offset) / l.scale_xy - static_cast<double>(base);
    return std::clamp(unit, static_cast<double>(low), static_cast<double>(high));
  };
  for (std::size_t i = 0; i < input.lakes.size(); ++i) {
    LatticeBox box;
    for (std::size_t r = input.lakes.ring_begin[i]; r < input.lakes.ring_begin[i + 1]; ++r)
      for (const auto& p : input.lakes.ring(r)) {
        const double x = at(p[0], l.offset_x, l.base_x, reach.min.x + 1, reach.max.x - 1);
        const double y = at(p[1], l.offset_y, l.base_y, reach.min.y + 1, reach.max.y - 1);
        box.extend(
            LatticePoint{static_cast<std::int32_t>(std::floor(x)) - 1, static_cast<std::int32_t>(std::floor(y)) - 1});
        box.extend(
            LatticePoint{static_cast<std::int32_t>(std::ceil(x)) + 1, static_cast<std::int32_t>(std::ceil(y)) + 1});
      }
    if (!box.is_empty()) cells.add_box(box);
  }
}

}  // namespace

void add_river_cells(const RunContext& context, const RiverLines& lines, const LatticeBox& bounds, CellSet& cells) {
  for (std::size_t i = 0; i < lines.size(); ++i)
    for (std::size_t p = 1; p < lines.line(i).size(); ++p) cells.add_segment(lines.line(i)[p - 1], lines.line(i)[p]);
  add_lakes(context, bounds, cells);
  if (context.river_input->preserved.size() == 0) return;
  for (const PreservedSegment& s : preserved_segments(*context.river_input, context.plan.lattice, bounds))
    cells.add_segment(s.a, s.b);
}

std::uint32_t RiverWindow::find(LatticePoint p) const {
  const auto at = std::lower_bound(position.begin(), position.end(), p);
  return at != position.end() && *at == p ? static_cast<std::uint32_t>(at - position.begin()) : kNone;
}

void CellSet::grow(std::span<const LatticePoint> position, std::span<const std::uint32_t> vertex, std::int32_t rings) {
  constexpr std::size_t kMostUnsorted = std::size_t{1} << 22;
  std::vector<Cell> middle;
  for (const std::uint32_t v : vertex) middle.push_back(grid_.of(position[v]));
  std::sort(middle.begin(), middle.end());
  middle.erase(std::unique(middle.begin(), middle.end()), middle.end());
  const Cell low = grid_.of(bounds_.min), high = grid_.of(bounds_.max);
  const auto range = [rings](std::int32_t at, std::int32_t least, std::int32_t most) {
    return std::pair(static_cast<std::int32_t>(std::max<std::int64_t>(least, std::int64_t{at} - rings)),
                     static_cast<std::int32_t>(std::min<std::int64_t>(most, std::int64_t{at} + rings)));
  };
  for (const Cell& m : middle) {
    const auto [west, east] = range(m.first, low.first, high.first);
    const auto [south, north] = range(m.second, low.second, high.second);
    for (std::int32_t x = west; x <= east; ++x)
      for (std::int32_t y = south; y <= north; ++y) cell_.emplace_back(x, y);
    if (cell_.size() - sorted_ > kMostUnsorted) (void)cells();
  }
}

void CellSet::add_segment(LatticePoint a, LatticePoint b) {
  if (b < a) std::swap(a, b);
  const Cell low = grid_.of(bounds_.min), high = grid_.of(bounds_.max);
  const std::int32_t first = std::max(grid_.of(a).first, low.first), last = std::min(grid_.of(b).first, high.first);
  const double slope = a.x == b.x ? 0 : (static_cast<double>(b.y) - a.y) / (static_cast<double>(b.x) - a.x);
  for (std::int32_t column = first; column <= last; ++column) {
    const LatticeBox box = grid_.box({column, 0});
    // A unit more on both sides takes up what rounding may cost.
    double south = std::min(a.y, b.y), north = std::max(a.y, b.y);
    if (slope != 0) {
      const double west = a.y + slope * (std::max(box.min.x, a.x) - static_cast<double>(a.x));
      const double east = a.y + slope * (std::min(box.max.x, b.x) + 1.0 - a.x);
      south = std::max(south, std::min(west, east) - 2);
      north = std::min(north, std::max(west, east) + 2);
    }
    south = std::max(south, static_cast<double>(bounds_.min.y));
    north = std::min(north, static_cast<double>(bounds_.max.y));
    if (south > north) continue;
    const std::int32_t from = grid_.of({a.x, static_cast<std::int32_t>(std::floor(south))}).second;
    const std::int32_t to = grid_.of({a.x, static_cast<std::int32_t>(std::floor(north))}).second;
    for (std::int32_t row = std::max(from, low.second); row <= std::min(to, high.second); ++row)
      cell_.emplace_back(column, row);
  }
}

void CellSet::add_box(const LatticeBox& box) {
  if (!box.intersects(bounds_)) return;
  const Cell low = grid_.of({std::max(box.min.x, bounds_.min.x), std::max(box.min.y, bounds_.min.y)});
  const Cell high = grid_.of({std::min(box.max.x, bounds_.max.x), std::min(box.max.y, bounds_.max.y)});
  for (std::int32_t x = low.first; x <= high.first; ++x)
    for (std::int32_t y = low.second; y <= high.second; ++y) cell_.emplace_back(x, y);
}

std::span<const Cell> CellSet::cells() {
  if (sorted_ < cell_.size()) {
    std::sort(cell_.begin(), cell_.end());
    cell_.erase(std::unique(cell_.begin(), cell_.end()), cell_.end());
    sorted_ = cell_.size();
  }
  return cell_;
}

RiverWindow WindowReader::read(const CellGrid& grid, std::span<const Cell> cells) const {
  std::vector<std::pair<std::uint32_t, Share>> shares;
  for (std::uint32_t t = 0; t < bounds_.size(); ++t) {
    if (bounds_[t].is_empty() || !meets(bounds_[t], grid, cells)) continue;
    Share& share =
        shares.emplace_back(t, read_share(store::Reader(context_.layout.unit(Phase::lay, t)), grid, cells)).second;
    if (patch_ != nullptr) remove_gone(*patch_, t, share);
  }
  if (patch_ != nullptr) shares.emplace_back(context_.plan.num_tiles(), share_of_patch(*patch_, grid, cells));
  std::uint64_t corners = 0;
  for (const auto& [tile, share] : shares) corners += share.triangle.size();
  if (const std::uint64_t need = corners / 3 * kBytesPerRiverTriangle; need > context_.options.run.memory_bytes)
    throw Error(ErrorKind::resource, context_.options.rivers.lines + ": the terrain around these rivers needs " +
                                         std::to_string(need >> 20) + " MiB, but run.memory is " +
                                         std::to_string(context_.options.run.memory_bytes >> 20) +
                                         " MiB; raise run.memory or give fewer lines");
  Merger merger;
  for (const auto& [tile, share] : shares) merger.add(tile, share);
  return merger.merge(grid, cells, context_.layout.unit(Phase::lay, 0));
}

std::vector<LatticeBox> bounds_of_laid(const RunContext& context) {
  std::vector<LatticeBox> out(context.plan.num_tiles());
  for_all(context, out.size(), [&](std::uint64_t t) {
    const store::Reader in(context.layout.unit(Phase::lay, t));
    const auto bounds = unflatten(in.read<std::int32_t>("bounds"));
    if (bounds.size() != 1) contradicts(in.path(), "its bounds are not one box");
    out[t] = bounds[0];
  });
  return out;
}

}  // namespace hydrotin
