#include "hydrotin/rasterize.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "hydrotin/wide.h"

namespace hydrotin {
namespace {

__extension__ typedef unsigned __int128 UWide;

/// The centres of the columns of a window from the left, or of its rows from below.
class Axis {
 public:
  explicit Axis(std::vector<std::int64_t> centers) : center_(std::move(centers)) {
    const std::size_t n = center_.size();
    if (n > 1 && center_.back() > center_.front())
      per_unit_ = static_cast<double>(n - 1) / static_cast<double>(center_.back() - center_.front());
  }

  [[nodiscard]] std::int32_t size() const { return static_cast<std::int32_t>(center_.size()); }
  [[nodiscard]] std::int64_t operator[](std::int32_t i) const { return center_[static_cast<std::size_t>(i)]; }

  /// A guess, off by one at most where centres are evenly spaced, of the number of centres below a coordinate.
  [[nodiscard]] std::int32_t guess(double coordinate) const {
    const double i = (coordinate - static_cast<double>(center_.front())) * per_unit_ + 1.0;
    return static_cast<std::int32_t>(std::clamp(i, 0.0, static_cast<double>(center_.size())));
  }
  /// The number of centres below a coordinate, exactly.
  [[nodiscard]] std::int32_t count_below(std::int64_t coordinate) const {
    std::int32_t i = guess(static_cast<double>(coordinate));
    while (i < size() && (*this)[i] < coordinate) ++i;
    while (i > 0 && (*this)[i - 1] >= coordinate) --i;
    return i;
  }

 private:
  std::vector<std::int64_t> center_;  // ascending
  double per_unit_ = 0.0;
};

constexpr std::int64_t kUnit = std::int64_t{1} << kSubLatticeBits;

/// A directed edge of a triangle on its left. Coordinates are sub-lattice units relative to the triangle's first
/// vertex.
template <class Int>
struct Side {
  Int x, y, dx, dy;
  Int on_edge;  // 1 if a centre on the edge, shifted by (eps, eps^2), is on the left: the sign of dx eps^2 - dy eps

  Side(Int x0, Int y0, Int x1, Int y1)
      : x(x0), y(y0), dx(x1 - x0), dy(y1 - y0), on_edge(dy < 0 || (dy == 0 && dx > 0)) {}
  /// Twice the area of the triangle between the edge and a centre.
  [[nodiscard]] Int area(Int px, Int py) const { return dx * (py - y) - dy * (px - x); }
  [[nodiscard]] bool contains(Int px, Int py) const { return area(px, py) + on_edge > 0; }
};

struct Corner {
  LatticePoint position;
  std::int32_t height;
};

struct Canvas {
  Lattice lattice;
  Axis columns;
  Axis rows;  // from below
  std::span<float> value;
};

/// Columns [left, right) and rows from below [low, high).
struct Block {
  std::int32_t left, right, low, high;
};

/// One triangle whose coordinates and products of them fit Int.
template <class Int>
class Painter {
 public:
  /// @param v  sorted by (x, y), so that every caller computes the same value in the same way.
  Painter(const std::array<Corner, 3>& v, const Canvas& canvas) : v_(v), canvas_(&canvas) {}

  std::uint64_t paint(const Block& block) const {
    const Int x1 = local_x(1), y1 = local_y(1), x2 = local_x(2), y2 = local_y(2);
    const Int area = x1 * y2 - y1 * x2;
    if (area == 0) return 0;
    const bool is_ccw = area > 0;
    // The first two are the sides opposite to vertices 1 and 2: their areas weigh the heights of these.
    const std::array<Side<Int>, 3> sides =
        is_ccw ? std::array<Side<Int>, 3>{Side<Int>(x2, y2, 0, 0), Side<Int>(0, 0, x1, y1), Side<Int>(x1, y1, x2, y2)}
               : std::array<Side<Int>, 3>{Side<Int>(0, 0, x2, y2), Side<Int>(x1, y1, 0, 0), Side<Int>(x2, y2, x1, y1)};
    const auto whole = static_cast<double>(is_ccw ? area : -area);
    std::uint64_t num_written = 0;
    for (std::int32_t row = block.low; row < block.high; ++row) {
      const Int y = canvas_->rows[row] - origin_y();
      const auto [first, last] = span_of_row(sides, y, block);
      float* const line = line_of(row);
      for (std::int32_t column = first; column < last; ++column) {
        const Int x = canvas_->columns[column] - origin_x();
        line[column] = value(sides[0].area(x, y), sides[1].area(x, y), whole);
      }
      num_written += static_cast<std::uint64_t>(std::max(0, last - first));
    }
    return num_written;
  }

 private:
  [[nodiscard]] std::int64_t origin_x() const { return v_[0].position.x * kUnit; }
  [[nodiscard]] std::int64_t origin_y() const { return v_[0].position.y * kUnit; }
  [[nodiscard]] Int local_x(std::size_t i) const { return v_[i].position.x * kUnit - origin_x(); }
  [[nodiscard]] Int local_y(std::size_t i) const { return v_[i].position.y * kUnit - origin_y(); }

  [[nodiscard]] float* line_of(std::int32_t row) const {
    const auto from_top = static_cast<std::size_t>(canvas_->rows.size() - 1 - row);
    return canvas_->value.data() + from_top * static_cast<std::size_t>(canvas_->columns.size());
  }

  /// The columns of a row inside all three sides. Each side is passed once from left to right, into the triangle if it
  /// goes down and out of it if it goes up; where, is guessed in doubles and settled by exact tests.
  [[nodiscard]] std::pair<std::int32_t, std::int32_t> span_of_row(const std::array<Side<Int>, 3>& sides, Int y,
                                                                  const Block& block) const {
    std::int32_t first = block.left, last = block.right;
    for (const Side<Int>& side : sides) {
      if (side.dy == 0) {
        if (!side.contains(0, y)) return {0, 0};
        continue;
      }
      const bool is_entry = side.dy < 0;
      const auto is_past = [&](std::int32_t column) {
        return side.contains(canvas_->columns[column] - origin_x(), y) == is_entry;
      };
      const double crossing =
          static_cast<double>(side.x) +
          static_cast<double>(side.dx) * (static_cast<double>(y - side.y) / static_cast<double>(side.dy));
      std::int32_t column = block.left;
      if (block.right - block.left > 4)
        column =
            std::clamp(canvas_->columns.guess(crossing + static_cast<double>(origin_x())), block.left, block.right);
      while (column < block.right && !is_past(column)) ++column;
      while (column > block.left && is_past(column - 1)) --column;
      if (is_entry)
        first = std::max(first, column);
      else
        last = std::min(last, column);
    }
    return {first, last};
  }

  [[nodiscard]] float value(Int weight_1, Int weight_2, double whole) const {
    const double rise_1 = static_cast<double>(std::int64_t{v_[1].height} - v_[0].height);
    const double rise_2 = static_cast<double>(std::int64_t{v_[2].height} - v_[0].height);
    const double rise = (static_cast<double>(weight_1) * rise_1 + static_cast<double>(weight_2) * rise_2) / whole;
    const double z = static_cast<double>(canvas_->lattice.base_z + v_[0].height) + rise;
    return static_cast<float>(z * canvas_->lattice.scale_z + canvas_->lattice.offset_z);
  }

  std::array<Corner, 3> v_;
  const Canvas* canvas_;
};

UWide squared_distance(LatticePoint a, LatticePoint b) {
  const std::int64_t dx = std::int64_t{a.x} - b.x, dy = std::int64_t{a.y} - b.y;
  return static_cast<UWide>(static_cast<Wide>(dx) * dx + static_cast<Wide>(dy) * dy);
}

std::uint64_t paint_triangle(std::array<Corner, 3> v, const Block& block, std::uint64_t max_squared_edge,
                             const Canvas& canvas) {
  std::sort(v.begin(), v.end(), [](const Corner& a, const Corner& b) { return a.position < b.position; });
  const LatticePoint a = v[0].position, b = v[1].position, c = v[2].position;
  if (max_squared_edge != kNoEdgeLimit &&
      std::max({squared_distance(a, b), squared_distance(b, c), squared_distance(c, a)}) > max_squared_edge)
    return 0;
  // Below 2^14 lattice units across, coordinates are below 2^30 and doubled areas below 2^61 sub-lattice units.
  constexpr std::int64_t kSmall = std::int64_t{1} << 14;
  const auto [low, high] = std::minmax({a.y, b.y, c.y});
  const bool is_small = std::int64_t{c.x} - a.x < kSmall && std::int64_t{high} - low < kSmall;
  return is_small ? Painter<std::int64_t>(v, canvas).paint(block) : Painter<Wide>(v, canvas).paint(block);
}

}  // namespace

std::uint64_t squared_edge_limit(double max_edge, const Lattice& lattice) {
  assert(max_edge >= 0 && "an edge limit is a length");
  const double units = max_edge / lattice.scale_xy;
  const double squared = std::floor(units * units);
  return squared < 0x1p64 ? static_cast<std::uint64_t>(squared) : kNoEdgeLimit;
}

std::uint64_t rasterize(std::span<const LatticePoint> position, std::span<const std::int32_t> height,
                        std::span<const std::uint32_t> triangle_vertex, const Lattice& lattice,
                        const RasterFrame& frame, const CellRange& window, std::uint64_t max_squared_edge,
                        std::span<float> value) {
  if (window.is_empty()) return 0;
  [[maybe_unused]] constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
  assert(window.num_columns() <= kMost && window.num_rows() <= kMost && "columns and rows are counted with 32 bits");
  assert(value.size() == static_cast<std::size_t>(window.num_columns()) * static_cast<std::size_t>(window.num_rows()));
  assert(height.size() == position.size() && triangle_vertex.size() % 3 == 0);
  std::vector<std::int64_t> x, y;
  for (std::int64_t column = window.column_begin; column < window.column_end; ++column)
    x.push_back(center_x(frame, lattice, column));
  for (std::int64_t row = window.row_end; row-- > window.row_begin;) y.push_back(center_y(frame, lattice, row));
  const Canvas canvas{lattice, Axis(std::move(x)), Axis(std::move(y)), value};

  // Centres below each vertex in x and in y: a triangle can contain a centre only if these differ among its vertices in
  // both. Shifted centres are never level with a vertex, so "below" is strict.
  struct Below {
    std::int32_t column, row;
  };
  std::vector<Below> below(position.size());
  for (std::size_t v = 0; v < position.size(); ++v)
    below[v] = {canvas.columns.count_below(position[v].x * kUnit), canvas.rows.count_below(position[v].y * kUnit)};

  std::uint64_t num_written = 0;
  for (std::size_t t = 0; t + 3 <= triangle_vertex.size(); t += 3) {
    const std::uint32_t a = triangle_vertex[t], b = triangle_vertex[t + 1], c = triangle_vertex[t + 2];
    assert(a < below.size() && b < below.size() && c < below.size() && "a triangle names a vertex beyond n");
    const Block block{std::min({below[a].column, below[b].column, below[c].column}),
                      std::max({below[a].column, below[b].column, below[c].column}),
                      std::min({below[a].row, below[b].row, below[c].row}),
                      std::max({below[a].row, below[b].row, below[c].row})};
    if (block.left == block.right || block.low == block.high) continue;
    num_written +=
        paint_triangle({Corner{position[a], height[a]}, Corner{position[b], height[b]}, Corner{position[c], height[c]}},
                       block, max_squared_edge, canvas);
  }
  return num_written;
}

}  // namespace hydrotin
