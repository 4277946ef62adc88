#include "removed_errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <unordered_map>
#include <vector>

#include "block_index.h"
#include "terrain_file.h"

namespace hydrotin {
namespace {

// Points by the cells of a grid, row by row.
class PointGrid {
 public:
  explicit PointGrid(std::span<const LatticePoint> position) : position_(position) {
    for (const LatticePoint p : position) box_.extend(p);
    constexpr double kPointsPerCell = 4;
    const double width = static_cast<double>(box_.max.x) - box_.min.x + 1;
    const double height = static_cast<double>(box_.max.y) - box_.min.y + 1;
    cell_ = std::max(1.0, std::ceil(std::sqrt(width * height * kPointsPerCell / static_cast<double>(position.size()))));
    // A line of points would get more cells than points.
    while (std::ceil(width / cell_) * std::ceil(height / cell_) > 4.0 * static_cast<double>(position.size()) + 64)
      cell_ *= 2;
    columns_ = static_cast<std::int64_t>(std::ceil(width / cell_));
    rows_ = static_cast<std::int64_t>(std::ceil(height / cell_));
    begin_.assign(static_cast<std::size_t>(columns_ * rows_) + 1, 0);
    for (const LatticePoint p : position) ++begin_[cell_of(p) + 1];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    point_.resize(position.size());
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    for (std::uint32_t i = 0; i < position.size(); ++i) point_[next[cell_of(position[i])]++] = i;
  }

  [[nodiscard]] const LatticeBox& box() const { return box_; }

  /// Calls visit(i) for the points of all cells that a triangle meets, and of some more.
  template <class Visit>
  void around(const std::array<LatticePoint, 3>& corner, Visit visit) const {
    LatticeBox box;
    for (const LatticePoint p : corner) box.extend(p);
    if (!box.intersects(box_)) return;
    const std::int64_t first = row_of(std::max(box.min.y, box_.min.y)), last = row_of(std::min(box.max.y, box_.max.y));
    for (std::int64_t r = first; r <= last; ++r) {
      const double low = box_.min.y + static_cast<double>(r) * cell_, high = low + cell_;
      const auto [from, to] = stretch(corner, low, high);
      const double left = std::max(from - 1, static_cast<double>(box_.min.x));
      const double right = std::min(to + 1, static_cast<double>(box_.max.x));
      if (left > right) continue;
      const auto column = [&](double x) { return static_cast<std::int64_t>((x - box_.min.x) / cell_); };
      const auto row_begin = static_cast<std::size_t>(r * columns_);
      const std::uint32_t begin = begin_[row_begin + static_cast<std::size_t>(column(left))];
      const std::uint32_t end = begin_[row_begin + static_cast<std::size_t>(column(right)) + 1];
      for (std::uint32_t i = begin; i < end; ++i) visit(point_[i]);
    }
  }

 private:
  // Where a triangle lies between two heights y.
  static std::pair<double, double> stretch(const std::array<LatticePoint, 3>& corner, double low, double high) {
    double from = 1e300, to = -1e300;
    const auto take = [&](double x) {
      from = std::min(from, x);
      to = std::max(to, x);
    };
    for (std::size_t i = 0; i < 3; ++i) {
      const LatticePoint a = corner[i], b = corner[(i + 1) % 3];
      if (a.y >= low && a.y <= high) take(a.x);
      for (const double y : {low, high})
        if ((a.y < y) != (b.y < y))
          take(a.x + (static_cast<double>(b.x) - a.x) * ((y - a.y) / (static_cast<double>(b.y) - a.y)));
    }
    return {from, to};
  }

  [[nodiscard]] std::int64_t row_of(std::int32_t y) const {
    return static_cast<std::int64_t>((static_cast<double>(y) - box_.min.y) / cell_);
  }
  [[nodiscard]] std::size_t cell_of(LatticePoint p) const {
    const auto column = static_cast<std::int64_t>((static_cast<double>(p.x) - box_.min.x) / cell_);
    return static_cast<std::size_t>(row_of(p.y) * columns_ + column);
  }

  std::span<const LatticePoint> position_;
  LatticeBox box_;
  double cell_ = 1;
  std::int64_t columns_ = 0, rows_ = 0;
  std::vector<std::uint32_t> begin_, point_;
};

struct Distances {
  VerticalDistance measured, final;
  bool is_promised = true;  // not of a triangle that came with rivers
};

class Measurement {
 public:
  Measurement(const TilePoints& points, const std::optional<ErrorLimit>& limit)
      : points_(points), limit_(limit), grid_(points.position), times_(points.position.size(), 0) {
    figures_.points = points.position.size();
  }

  [[nodiscard]] const LatticeBox& box() const { return grid_.box(); }

  void add(const TrianglePatch& patch) {
    for (std::size_t t = 0; t < patch.triangle.size(); t += 3) {
      const std::array v{patch.triangle[t], patch.triangle[t + 1], patch.triangle[t + 2]};
      const std::array p{patch.position[v[0]], patch.position[v[1]], patch.position[v[2]]};
      grid_.around(p, [&](std::uint32_t i) {
        if (!owns(p[0], p[1], p[2], points_.position[i], true)) return;
        const auto distance = [&](const std::vector<std::int32_t>& z) {
          return vertical_distance({p[0], z[v[0]]}, {p[1], z[v[1]]}, {p[2], z[v[2]]}, points_.position[i],
                                   points_.height[i]);
        };
        const Distances at{distance(patch.measured), distance(patch.height), patch.is_added[t / 3] == 0};
        if (!owns(p[0], p[1], p[2], points_.position[i], false)) {
          if (times_[i] == 0) touched_.try_emplace(i, at);
          return;
        }
        if (times_[i] == 0) count(at);
        if (times_[i] < 2) ++times_[i];
        touched_.erase(i);
      });
    }
  }

  RemovedFigures finish() {
    for (const auto& [i, at] : touched_) {  // on the rim of everything, where no triangle lies beyond
      times_[i] = 1;
      count(at);
    }
    figures_.not_once =
        static_cast<std::uint64_t>(std::count_if(times_.begin(), times_.end(), [](std::uint8_t n) { return n != 1; }));
    return figures_;
  }

 private:
  void count(const Distances& at) {
    figures_.final.add(at.final, nullptr);
    if (!at.is_promised) return;
    figures_.measured.add(at.measured, nullptr);
    if (limit_ && !limit_->allows(at.measured)) ++figures_.beyond;
  }

  const TilePoints& points_;
  const std::optional<ErrorLimit>& limit_;
  PointGrid grid_;
  std::vector<std::uint8_t> times_;  // a point was found; 2: more than once
  std::unordered_map<std::uint32_t, Distances> touched_;
  RemovedFigures figures_;
};

}  // namespace

void RemovedFigures::add(const RemovedFigures& other) {
  points += other.points;
  beyond += other.beyond;
  not_once += other.not_once;
  measured.add(other.measured);
  final.add(other.final);
}

RemovedFigures measure_removed(std::uint32_t tile, const std::function<store::Reader(std::uint32_t)>& open,
                               const BoxTree& bounds, const std::optional<ErrorLimit>& limit) {
  TilePoints points;
  {
    const store::Reader own = open(tile);
    const std::string x = std::string(kRemoved) + "x";
    if (own.has(x)) points = read_points(own, 0, own.size(x), kRemoved);
  }
  if (points.position.empty()) return {};
  Measurement measurement(points, limit);
  bounds.for_each([&](const LatticeBox& box) { return box.intersects(measurement.box()); },
                  [&](std::uint32_t t) {
                    measurement.add(read_patch(open(t), measurement.box(), true));
                    return true;
                  });
  return measurement.finish();
}

void write_removed_figures(store::Writer& out, const RemovedFigures& figures) {
  out.set("points", static_cast<std::int64_t>(figures.points));
  out.set("beyond", static_cast<std::int64_t>(figures.beyond));
  out.set("not_once", static_cast<std::int64_t>(figures.not_once));
  write_errors(out, "measured_", figures.measured);
  write_errors(out, "final_", figures.final);
}

RemovedFigures read_removed_figures(const store::Reader& in) {
  const auto count = [&](const char* key) { return static_cast<std::uint64_t>(in.integer(key)); };
  return {count("points"), count("beyond"), count("not_once"), read_errors(in, "measured_"), read_errors(in, "final_")};
}

}  // namespace hydrotin
