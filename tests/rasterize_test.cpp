#include "hydrotin/rasterize.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <optional>

#include "grid_terrain.h"
#include "hydrotin/raster_frame.h"

namespace hydrotin {
namespace {

__extension__ typedef __int128 Int128;

using testing::GridTerrain;
using testing::make_grid;
using testing::Random;

constexpr float kNoData = std::numeric_limits<float>::quiet_NaN();

struct Raster {
  std::vector<float> value;
  std::uint64_t num_written = 0;
};

Raster paint(const GridTerrain& grid, const std::vector<std::uint32_t>& triangle, const Lattice& lattice,
             const RasterFrame& frame, const CellRange& window, std::uint64_t limit = kNoEdgeLimit) {
  Raster raster;
  raster.value.assign(static_cast<std::size_t>(window.num_columns() * window.num_rows()), kNoData);
  raster.num_written = rasterize(grid.position, grid.height, triangle, lattice, frame, window, limit, raster.value);
  return raster;
}

CellRange whole(const RasterFrame& frame) {
  return {0, frame.columns, 0, frame.rows};
}

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0);
}

// Oracle ------------------------------------------------------------------------------------------------------------

struct Point {
  Int128 x, y;
};

Int128 area(Point a, Point b, Point c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Barycentric weights of a point strictly inside a triangle of either orientation.
std::optional<std::array<Int128, 3>> strictly_inside(const std::array<Point, 3>& t, Point p) {
  const std::array<Int128, 3> w{area(t[1], t[2], p), area(t[2], t[0], p), area(t[0], t[1], p)};
  if ((w[0] > 0 && w[1] > 0 && w[2] > 0) || (w[0] < 0 && w[1] < 0 && w[2] < 0)) return w;
  return std::nullopt;
}

/// All coordinates are multiples of 1/4 below 256, and so small that a shift by (2^-12, 2^-22) quarters is
/// infinitesimal: it moves no centre over an edge that the centre is not on.
bool owns_center(const std::array<LatticePoint, 3>& t, std::int64_t center_x4, std::int64_t center_y4) {
  constexpr std::int64_t kScale = std::int64_t{1} << 22;
  const auto scaled = [&](LatticePoint p) { return Point{p.x * 4 * kScale, p.y * 4 * kScale}; };
  return strictly_inside({scaled(t[0]), scaled(t[1]), scaled(t[2])},
                         {center_x4 * kScale + (std::int64_t{1} << 10), center_y4 * kScale + 1})
      .has_value();
}

double plane_at(const std::array<LatticePoint, 3>& t, const std::array<std::int32_t, 3>& z, std::int64_t center_x4,
                std::int64_t center_y4) {
  const auto quarter = [](LatticePoint p) { return Point{p.x * 4, p.y * 4}; };
  const std::array<Point, 3> v{quarter(t[0]), quarter(t[1]), quarter(t[2])};
  const Point p{center_x4, center_y4};
  const Int128 sum = area(v[1], v[2], p) * z[0] + area(v[2], v[0], p) * z[1] + area(v[0], v[1], p) * z[2];
  return static_cast<double>(static_cast<long double>(sum) / static_cast<long double>(area(v[0], v[1], v[2])));
}

/// A small terrain on a plain lattice and a frame whose centres are multiples of 1/4, many on vertices and edges.
struct Instance {
  GridTerrain grid;
  Lattice lattice;
  RasterFrame frame;
};

Instance make_instance(std::uint64_t seed) {
  Random random(seed);
  Instance i;
  const std::int32_t spacing = random.between(2, 8);
  i.grid =
      make_grid(seed, 2 + random.below(6), 2 + random.below(6), spacing, random.below(2) == 0 ? 0 : (spacing - 1) / 3);
  i.grid.height = testing::random_heights(seed, i.grid.num_vertices(), random.below(2) == 0 ? 5 : 100000);
  i.frame = {random.between(-20, 8) * 0.25, random.between(20, 180) * 0.25, random.between(1, 12) * 0.5,
             random.between(1, 60), random.between(1, 60)};
  return i;
}

TEST(Rasterize, EachCentreBelongsToTheOneTriangleThatContainsItAfterTheShift) {
  std::size_t num_covered = 0, num_on_lattice = 0;
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    SCOPED_TRACE(seed);
    const auto [grid, lattice, frame] = make_instance(seed);
    const Raster raster = paint(grid, grid.triangle, lattice, frame, whole(frame));
    std::uint64_t expected_written = 0;
    for (std::int64_t row = 0; row < frame.rows; ++row)
      for (std::int64_t column = 0; column < frame.columns; ++column) {
        const auto x4 =
            static_cast<std::int64_t>(4 * frame.origin_x + static_cast<double>(4 * column + 2) * frame.cell);
        const auto y4 = static_cast<std::int64_t>(4 * frame.origin_y - static_cast<double>(4 * row + 2) * frame.cell);
        int num_owners = 0;
        double expected = 0;
        for (std::size_t t = 0; t < grid.num_triangles(); ++t) {
          std::array<LatticePoint, 3> p;
          std::array<std::int32_t, 3> z;
          for (std::size_t k = 0; k < 3; ++k)
            p[k] = grid.position[grid.triangle[3 * t + k]], z[k] = grid.height[grid.triangle[3 * t + k]];
          if (!owns_center(p, x4, y4)) continue;
          ++num_owners;
          expected = plane_at(p, z, x4, y4);
        }
        ASSERT_LE(num_owners, 1);
        expected_written += static_cast<std::uint64_t>(num_owners);
        const float got = raster.value[static_cast<std::size_t>(row * frame.columns + column)];
        ASSERT_EQ(std::isnan(got), num_owners == 0) << column << " " << row;
        if (num_owners == 1) {
          ASSERT_NEAR(got, expected, std::abs(expected) * 0x1p-23 + 1e-9) << column << " " << row;
        }
        num_on_lattice += num_owners == 1 && x4 % 4 == 0 && y4 % 4 == 0;
      }
    EXPECT_EQ(raster.num_written, expected_written);
    num_covered += expected_written;
  }
  EXPECT_GT(num_covered, 40000u);
  EXPECT_GT(num_on_lattice, 3000u);
}

TEST(Rasterize, CoversASquareGridOnceWithItsLeftAndLowerSides) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const RasterFrame frame = make_instance(seed).frame;
    const std::int32_t spacing = random.between(2, 8);
    const GridTerrain grid = make_grid(seed, 2 + random.below(6), 2 + random.below(6), spacing, 0);
    std::vector<int> count(static_cast<std::size_t>(frame.columns * frame.rows), 0);
    for (std::size_t t = 0; t < grid.triangle.size(); t += 3) {
      const std::vector<std::uint32_t> one(&grid.triangle[t], &grid.triangle[t] + 3);
      const Raster raster = paint(grid, one, {}, frame, whole(frame));
      for (std::size_t i = 0; i < count.size(); ++i) count[i] += !std::isnan(raster.value[i]);
    }
    const double right = spacing * static_cast<double>(grid.columns - 1);
    const double top = spacing * static_cast<double>(grid.rows - 1);
    for (std::int64_t row = 0; row < frame.rows; ++row)
      for (std::int64_t column = 0; column < frame.columns; ++column) {
        const double x = frame.origin_x + (static_cast<double>(column) + 0.5) * frame.cell;
        const double y = frame.origin_y - (static_cast<double>(row) + 0.5) * frame.cell;
        EXPECT_EQ(count[static_cast<std::size_t>(row * frame.columns + column)],
                  x >= 0 && y >= 0 && x < right && y < top);
      }
  }
}

TEST(Rasterize, SameBitsForEveryOrderAndNumberingAndWindow) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    auto [grid, lattice, frame] = make_instance(seed);
    Random random(seed + 1);
    if (seed % 2 == 1) {  // a lattice of centimetres far from the origin, cells in no relation to it
      lattice = {0.01, 0.001, 0.005, 0.0, 100.0, 60012345, 512345678, -70000};
      LatticeBox box;
      for (const LatticePoint p : grid.position) box.extend(p);
      frame = frame_around(lattice, box, random.between(1, 100) * 0.001 + 0.0001);
    }
    const Raster expected = paint(grid, grid.triangle, lattice, frame, whole(frame));

    std::vector<std::uint32_t> to(grid.num_vertices()), order(grid.num_triangles());
    std::iota(to.begin(), to.end(), 0u);
    std::iota(order.begin(), order.end(), 0u);
    testing::shuffle(seed, to);
    testing::shuffle(seed, order);
    GridTerrain other = grid;
    for (std::uint32_t v = 0; v < to.size(); ++v) {
      other.position[to[v]] = grid.position[v];
      other.height[to[v]] = grid.height[v];
    }
    other.triangle.clear();
    for (const std::uint32_t t : order) {
      std::array<std::uint32_t, 3> v{to[grid.triangle[3 * t]], to[grid.triangle[3 * t + 1]],
                                     to[grid.triangle[3 * t + 2]]};
      std::rotate(v.begin(), v.begin() + random.below(3), v.end());
      if (random.below(2) == 0) std::swap(v[0], v[1]);
      other.triangle.insert(other.triangle.end(), v.begin(), v.end());
    }
    const Raster shuffled = paint(other, other.triangle, lattice, frame, whole(frame));
    EXPECT_TRUE(same_bits(shuffled.value, expected.value));
    EXPECT_EQ(shuffled.num_written, expected.num_written);

    // Parts of the triangles in windows of the frame, put together.
    std::vector<float> assembled(expected.value.size(), kNoData);
    const std::int64_t column_cut = random.between(0, static_cast<std::int32_t>(frame.columns));
    const std::int64_t row_cut = random.between(0, static_cast<std::int32_t>(frame.rows));
    const std::size_t triangle_cut = 3 * random.below(grid.num_triangles() + 1);
    const auto middle = grid.triangle.begin() + static_cast<std::ptrdiff_t>(triangle_cut);
    for (const CellRange& window :
         {CellRange{0, column_cut, 0, row_cut}, CellRange{column_cut, frame.columns, 0, row_cut},
          CellRange{0, column_cut, row_cut, frame.rows}, CellRange{column_cut, frame.columns, row_cut, frame.rows}})
      for (const std::vector<std::uint32_t>& part : {std::vector<std::uint32_t>(grid.triangle.begin(), middle),
                                                     std::vector<std::uint32_t>(middle, grid.triangle.end())}) {
        const Raster piece = paint(grid, part, lattice, frame, window);
        for (std::int64_t row = window.row_begin; row < window.row_end; ++row)
          for (std::int64_t column = window.column_begin; column < window.column_end; ++column) {
            const float v = piece.value[static_cast<std::size_t>((row - window.row_begin) * window.num_columns() +
                                                                 column - window.column_begin)];
            if (!std::isnan(v)) assembled[static_cast<std::size_t>(row * frame.columns + column)] = v;
          }
      }
    EXPECT_TRUE(same_bits(assembled, expected.value));
  }
}

TEST(Rasterize, TrianglesOfEverySizeEqualTheDefinition) {
  std::size_t num_covered = 0;
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const std::int32_t reach = 1 << random.between(2, 30);
    GridTerrain one;
    const LatticePoint base{random.between(-reach, reach), random.between(-reach, reach)};
    for (int i = 0; i < 3; ++i) {
      const bool is_thin = random.below(3) == 0;
      one.position.push_back({base.x + (is_thin ? random.between(-2, 2) : random.between(-reach / 2, reach / 2)),
                              base.y + random.between(-reach / 2, reach / 2)});
    }
    one.height = {random.between(-1000, 1000), random.between(-1000000, 1000000), random.between(0, 3)};
    const std::vector<std::uint32_t> triangle{0, 1, 2};
    const Lattice lattice;
    LatticeBox box;
    for (const LatticePoint p : one.position) box.extend(p);
    const double side =
        static_cast<double>(std::max(std::int64_t{box.max.x} - box.min.x, std::int64_t{box.max.y} - box.min.y));
    const RasterFrame frame =
        frame_around(lattice, box, std::max(0.05, side / random.between(1, 40) * (0.5 + random.unit())));
    const Raster raster = paint(one, triangle, lattice, frame, whole(frame));
    std::array<Point, 3> p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = {Int128{one.position[i].x} * 65536, Int128{one.position[i].y} * 65536};
    for (std::int64_t row = 0; row < frame.rows; ++row)
      for (std::int64_t column = 0; column < frame.columns; ++column) {
        const Point c{center_x(frame, lattice, column), center_y(frame, lattice, row)};
        const float got = raster.value[static_cast<std::size_t>(row * frame.columns + column)];
        if (area(p[0], p[1], c) == 0 || area(p[1], p[2], c) == 0 || area(p[2], p[0], c) == 0) continue;  // tested above
        const auto w = strictly_inside(p, c);
        ASSERT_EQ(!std::isnan(got), w.has_value()) << column << " " << row;
        if (!w) continue;
        ++num_covered;
        const auto total = static_cast<long double>((*w)[0] + (*w)[1] + (*w)[2]);
        long double expected = 0, size = 0;
        for (std::size_t i = 0; i < 3; ++i) {
          expected += static_cast<long double>((*w)[i]) / total * one.height[i];
          size = std::max(size, std::abs(static_cast<long double>(one.height[i])));
        }
        ASSERT_NEAR(got, static_cast<double>(expected),
                    std::abs(static_cast<double>(expected)) * 0x1p-23 + static_cast<double>(size) * 1e-14);
      }
  }
  EXPECT_GT(num_covered, 50000u);
}

TEST(Rasterize, LeavesOutLongEdgesExactly) {
  GridTerrain grid;
  grid.position = {{0, 0}, {300, 0}, {300, 400}, {0, 400}};
  grid.height = {1, 2, 3, 4};
  const std::vector<std::uint32_t> triangles{0, 1, 2, 0, 2, 3};
  const RasterFrame frame{0, 400, 100, 3, 4};
  EXPECT_EQ(paint(grid, triangles, {}, frame, whole(frame), 250000).num_written, 12u);
  EXPECT_EQ(paint(grid, triangles, {}, frame, whole(frame), 249999).num_written, 0u);

  const Lattice centimetres{0.01, 0.01, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(squared_edge_limit(5.0, centimetres), 250000u);
  EXPECT_EQ(squared_edge_limit(4.999, centimetres), 249900u);
  EXPECT_EQ(squared_edge_limit(0.0, centimetres), 0u);
  EXPECT_EQ(squared_edge_limit(1e12, centimetres), kNoEdgeLimit);
  EXPECT_EQ(squared_edge_limit(std::numeric_limits<double>::infinity(), centimetres), kNoEdgeLimit);

  constexpr std::int32_t kEnd = std::numeric_limits<std::int32_t>::max();
  grid.position = {{-kEnd - 1, -kEnd - 1}, {kEnd, -kEnd - 1}, {kEnd, kEnd}, {-kEnd - 1, kEnd}};
  const RasterFrame huge{-0x1p31, 0x1p31, 0x1p30, 4, 4};
  EXPECT_EQ(paint(grid, triangles, {}, huge, whole(huge)).num_written, 16u);
  EXPECT_EQ(paint(grid, triangles, {}, huge, whole(huge), kNoEdgeLimit - 1).num_written, 0u);
}

TEST(Rasterize, NothingAndFlatTriangles) {
  GridTerrain grid;
  grid.position = {{0, 0}, {10, 10}, {20, 20}, {0, 10}, {0, 20}};
  grid.height = {1, 2, 3, 4, 5};
  const RasterFrame frame{0, 20, 1, 20, 20};
  EXPECT_EQ(paint(grid, {0, 1, 2, 0, 3, 4, 1, 1, 2, 3, 3, 3}, {}, frame, whole(frame)).num_written, 0u);
  EXPECT_EQ(paint(grid, {}, {}, frame, whole(frame)).num_written, 0u);
  EXPECT_EQ(paint(grid, {0, 1, 3}, {}, frame, {5, 5, 0, 20}).num_written, 0u);
  EXPECT_EQ(paint(grid, {0, 2, 4}, {}, frame, {3, 4, 10, 11}).num_written, 1u);
}

TEST(RasterFrame, CentresAscendWithColumnsAndDescendWithRows) {
  const Lattice lattice{0.01, 0.01, 0.003, -0.001, 0, 60000000, 500000000, 0};
  const RasterFrame frame{600000.0, 5000100.0, 0.37, 1000, 1000};
  for (std::int64_t i = 1; i < 1000; ++i) {
    EXPECT_LT(center_x(frame, lattice, i - 1), center_x(frame, lattice, i));
    EXPECT_GT(center_y(frame, lattice, i - 1), center_y(frame, lattice, i));
  }
  // A centre that is a lattice point in world coordinates is one on the sub-lattice.
  const Lattice plain{0.01, 0.01, 0, 0, 0, 60000000, 500000000, 0};
  const RasterFrame metre{600000.0, 5000100.0, 1.0, 1000, 1000};
  for (std::int64_t i = 0; i < 1000; ++i) {
    EXPECT_EQ(center_x(metre, plain, i), (100 * i + 50) * 65536);
    EXPECT_EQ(center_y(metre, plain, i), (10000 - 100 * i - 50) * 65536);
  }
}

TEST(RasterFrame, BoxesThatPartitionTheLatticePartitionTheCells) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Lattice lattice = seed % 3 == 0 ? Lattice{} : Lattice{0.01, 0.01, 0.5, 0.25, 0, 1234, -99, 0};
    const LatticeBox data{{random.between(-500, 0), random.between(-500, 0)},
                          {random.between(0, 500), random.between(0, 500)}};
    RasterFrame frame =
        frame_around(lattice, data, lattice.scale_xy * random.between(1, 80) * (random.below(2) == 0 ? 0.5 : 0.37));
    // The next cells outside the frame have their centres outside the box.
    EXPECT_LT(center_x(frame, lattice, -1), data.min.x * std::int64_t{65536});
    EXPECT_GT(center_x(frame, lattice, frame.columns), data.max.x * std::int64_t{65536});
    EXPECT_GT(center_y(frame, lattice, -1), data.max.y * std::int64_t{65536});
    EXPECT_LT(center_y(frame, lattice, frame.rows), data.min.y * std::int64_t{65536});

    std::vector<int> count(static_cast<std::size_t>(frame.columns * frame.rows), 0);
    constexpr std::int32_t kFar = 1 << 20;
    const std::int32_t x = random.between(-600, 600), y = random.between(-600, 600);
    for (const LatticeBox& box : {LatticeBox{{-kFar, -kFar}, {x, y}}, LatticeBox{{x + 1, -kFar}, {kFar, y}},
                                  LatticeBox{{-kFar, y + 1}, {x, kFar}}, LatticeBox{{x + 1, y + 1}, {kFar, kFar}}}) {
      const CellRange cells = cells_in(frame, lattice, box);
      for (std::int64_t row = cells.row_begin; row < cells.row_end; ++row)
        for (std::int64_t column = cells.column_begin; column < cells.column_end; ++column) {
          ++count[static_cast<std::size_t>(row * frame.columns + column)];
          EXPECT_GE(center_x(frame, lattice, column), box.min.x * std::int64_t{65536});
          EXPECT_LT(center_x(frame, lattice, column), (box.max.x + std::int64_t{1}) * 65536);
          EXPECT_GE(center_y(frame, lattice, row), box.min.y * std::int64_t{65536});
          EXPECT_LT(center_y(frame, lattice, row), (box.max.y + std::int64_t{1}) * 65536);
        }
    }
    EXPECT_EQ(std::count(count.begin(), count.end(), 1), frame.columns * frame.rows);
    EXPECT_TRUE(cells_in(frame, lattice, LatticeBox{}).is_empty());
  }
}

}  // namespace
}  // namespace hydrotin
