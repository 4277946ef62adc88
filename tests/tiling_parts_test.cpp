// The phases from `spill` on, over hand-cut parts, against the same work on the whole terrain.

#include "tiling_parts.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <tuple>

#include "fingerprint.h"
#include "hydrotin/mesh.h"
#include "hydrotin/pits.h"
#include "hydrotin/raster.h"
#include "hydrotin/rasterize.h"
#include "part.h"
#include "temporary_folder.h"
#include "terrain_file.h"

namespace hydrotin {
namespace {

using testing::CutTerrain;
using testing::WholeTerrain;

const Lattice kLattice{0.01, 0.001, 0.0, 0.0, 0.0, 65432100, 512345600, -20};

PipelineOptions options_in(const testing::TemporaryFolder& folder) {
  PipelineOptions options;
  options.output.dir = folder.path().string();
  options.output.dem.cell_m = 0.07;
  options.output.dem.max_edge_m = 0;
  options.triangulation.order = 0;
  return options;
}

std::vector<std::int32_t> expected_heights(const WholeTerrain& whole, const PipelineOptions& options) {
  return options.pits.method == PitMethod::none
             ? whole.height
             : lift(whole.graph(), whole.height, testing::outlets_of(whole, options.pits.outlets));
}

// Final heights by vertex, from every place that states one.
std::vector<std::set<std::int32_t>> stated_heights(const CutTerrain& cut, std::size_t n) {
  std::vector<std::set<std::int32_t>> out(n);
  for (std::uint32_t t = 0; t < cut.owned.size(); ++t) {
    const store::Reader in(cut.context.layout.terrain(t));
    const auto height = in.read<std::int32_t>("height");
    EXPECT_EQ(height.size(), cut.owned[t].size());
    for (std::size_t i = 0; i < height.size(); ++i)
      if (height[i] != kUnusedHeight) out[cut.owned[t][i]].insert(height[i]);
    const auto foreign = in.read<std::uint64_t>("foreign_point");
    const auto foreign_height = in.read<std::int32_t>("foreign_height");
    for (std::size_t i = 0; i < foreign.size(); ++i) {
      EXPECT_NE(PointId(foreign[i]).tile(), t);
      out[cut.owned[PointId(foreign[i]).tile()][PointId(foreign[i]).index()]].insert(foreign_height[i]);
    }
  }
  return out;
}

using PitFact = std::tuple<LatticePoint, std::int32_t, std::int32_t, std::uint64_t>;  // place, height, level, vertices

void add_pits(const store::Reader& in, std::vector<PitFact>& out) {
  const auto xyz = in.read<std::int32_t>("pit_xyz");
  const auto level = in.read<std::int32_t>("pit_level");
  const auto vertices = in.read<std::uint64_t>("pit_vertices");
  ASSERT_EQ(xyz.size(), 3 * level.size());
  for (std::size_t i = 0; i < level.size(); ++i)
    out.emplace_back(LatticePoint{xyz[3 * i], xyz[3 * i + 1]}, xyz[3 * i + 2], level[i], vertices[i]);
}

void expect_same_pits(const CutTerrain& cut, const WholeTerrain& whole) {
  const auto is_outlet = testing::outlets_of(whole, cut.context.options.pits.outlets);
  const auto level = lift(whole.graph(), whole.height, is_outlet);
  std::vector<PitFact> expected, got;
  for (const Pit& pit : find_pits(whole.graph(), whole.height, whole.position, is_outlet))
    expected.emplace_back(pit.representative, pit.height, level[pit.vertex], pit.num_vertices);
  for (std::uint32_t t = 0; t < cut.owned.size(); ++t) add_pits(store::Reader(cut.context.layout.terrain(t)), got);
  const store::Reader drained(cut.context.layout.unit(Phase::drain, 0));
  add_pits(drained, got);
  std::sort(got.begin(), got.end());
  EXPECT_EQ(got, expected);
  EXPECT_EQ(drained.integer("pits_before"), static_cast<std::int64_t>(expected.size()));
}

void expect_same_minima(const CutTerrain& cut, const WholeTerrain& whole) {
  std::vector<std::uint8_t> is_minimum(whole.position.size(), 1);
  for (std::size_t h = 0; h < whole.triangle.size(); ++h)
    for (std::size_t g = h / 3 * 3; g < h / 3 * 3 + 3; ++g) {
      const std::uint32_t v = whole.triangle[h], w = whole.triangle[g];
      if (std::tie(whole.height[w], whole.position[w]) < std::tie(whole.height[v], whole.position[v]))
        is_minimum[v] = 0;
    }
  EXPECT_EQ(store::Reader(cut.context.layout.unit(Phase::drain, 0)).integer("minima_before"),
            std::count(is_minimum.begin(), is_minimum.end(), 1));
}

void expect_same_lift_figures(const CutTerrain& cut, const WholeTerrain& whole,
                              const std::vector<std::int32_t>& final) {
  std::int64_t lifted = 0, total = 0, greatest = 0, got_lifted = 0, got_total = 0, got_greatest = 0;
  for (std::size_t v = 0; v < final.size(); ++v) {
    lifted += final[v] != whole.height[v];
    total += final[v] - whole.height[v];
    greatest = std::max<std::int64_t>(greatest, final[v] - whole.height[v]);
  }
  const auto add = [&](const store::Reader& in, const std::string& where) {
    got_lifted += in.integer(where + "_lifted");
    got_total += in.integer(where + "_lift_total");
    got_greatest = std::max(got_greatest, in.integer(where + "_lift_max"));
  };
  add(store::Reader(cut.context.layout.unit(Phase::drain, 0)), "rim");
  for (std::uint32_t t = 0; t < cut.owned.size(); ++t) add(store::Reader(cut.context.layout.terrain(t)), "inner");
  EXPECT_EQ(std::tuple(got_lifted, got_total, got_greatest), std::tuple(lifted, total, greatest));
}

using Corners = std::array<Fingerprint::Corner, 3>;

std::vector<Corners> sorted_corners(const std::vector<LatticePoint>& position, const std::vector<std::int32_t>& height,
                                    const std::vector<std::uint32_t>& triangle) {
  std::vector<Corners> out;
  for (std::size_t i = 0; i < triangle.size(); i += 3) {
    Corners c{};
    for (std::size_t j = 0; j < 3; ++j)
      c[j] = {position[triangle[i + j]].x, position[triangle[i + j]].y, height[triangle[i + j]]};
    std::sort(c.begin(), c.end());
    out.push_back(c);
  }
  return out;
}

void expect_same_triangles(const CutTerrain& cut, const WholeTerrain& whole, const std::vector<std::int32_t>& final) {
  std::vector<Corners> expected = sorted_corners(whole.position, final, whole.triangle), got;
  constexpr LatticeBox kAll{{std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::min()},
                            {std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::max()}};
  Fingerprint sum, direct;
  for (std::uint32_t t = 0; t < cut.owned.size(); ++t) {
    const store::Reader in(cut.context.layout.terrain(t));
    const TrianglePatch patch = read_patch(in, kAll);
    const auto part = sorted_corners(patch.position, patch.height, patch.triangle);
    got.insert(got.end(), part.begin(), part.end());
    const auto print = Fingerprint::parse(in.text("fingerprint"));
    ASSERT_TRUE(print.has_value());
    sum.add(*print);
    const bool has_mesh = cut.context.options.output.mesh_ply && !part.empty();
    ASSERT_EQ(std::filesystem::exists(cut.context.layout.mesh(t)), has_mesh);
    if (!has_mesh) continue;
    const Mesh mesh = read_mesh(cut.context.layout.mesh(t));
    EXPECT_EQ(mesh.triangle.size(), part.size());
    EXPECT_EQ(static_cast<std::int64_t>(mesh.vertex.size()), in.integer("vertices"));
    for (const MeshTriangle& triangle : mesh.triangle) {
      const auto& a = mesh.vertex[triangle[0]];
      const auto& b = mesh.vertex[triangle[1]];
      const auto& c = mesh.vertex[triangle[2]];
      EXPECT_GT((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]), 0);
      EXPECT_NEAR(a[0], 654321.0, 1000);
    }
  }
  for (Corners c : expected) {
    std::swap(c[0], c[2]);
    direct.add(c);
  }
  std::sort(expected.begin(), expected.end());
  std::sort(got.begin(), got.end());
  EXPECT_EQ(got, expected);
  EXPECT_EQ(sum, direct);
}

void expect_same_raster(const CutTerrain& cut, const WholeTerrain& whole, const std::vector<std::int32_t>& final) {
  const DemOptions& dem = cut.context.options.output.dem;
  LatticeBox bounds;
  for (const LatticePoint p : whole.position) bounds.extend(p);
  const RasterFrame frame = frame_around(kLattice, bounds, dem.cell_m);
  const CellRange all{0, frame.columns, 0, frame.rows};
  const auto cells = static_cast<std::size_t>(frame.columns * frame.rows);
  std::vector<float> expected(cells, kNodata), got(cells, kNodata);
  std::vector<int> times(cells, 0);
  const std::uint64_t limit = dem.max_edge_m > 0 ? squared_edge_limit(dem.max_edge_m, kLattice) : kNoEdgeLimit;
  const std::uint64_t written = rasterize(whole.position, final, whole.triangle, kLattice, frame, all, limit, expected);
  std::uint64_t counted = 0;
  for (std::uint32_t t = 0; t < cut.owned.size(); ++t) {
    const store::Reader marker(cut.context.layout.unit(Phase::raster, t));
    counted += static_cast<std::uint64_t>(marker.integer("cells_with_height"));
    const std::string path = cut.context.layout.dem_tile(t);
    ASSERT_EQ(marker.integer("cells") > 0, std::filesystem::exists(path));
    if (!std::filesystem::exists(path)) continue;
    const Raster raster = read_raster(path);
    const auto column = std::llround((raster.grid.x_min - frame.origin_x) / frame.cell);
    const auto row = std::llround((frame.origin_y - raster.grid.y_max) / frame.cell);
    for (std::int64_t r = 0; r < raster.grid.num_rows; ++r)
      for (std::int64_t c = 0; c < raster.grid.num_columns; ++c) {
        const auto at = static_cast<std::size_t>((row + r) * frame.columns + column + c);
        ++times[at];
        got[at] = raster.value[static_cast<std::size_t>(r * raster.grid.num_columns + c)];
      }
  }
  EXPECT_EQ(counted, written);
  EXPECT_LE(*std::max_element(times.begin(), times.end()), 1);
  EXPECT_EQ(got, expected);
}

void expect_same_as_whole(const WholeTerrain& whole, const PipelineOptions& options, std::uint64_t seed, int depth) {
  const CutTerrain cut = testing::cut_terrain(whole, options, kLattice, seed, depth);
  testing::run_parts(cut.context);
  const auto final = expected_heights(whole, options);
  const auto stated = stated_heights(cut, final.size());
  for (std::size_t v = 0; v < final.size(); ++v) EXPECT_EQ(stated[v], std::set{final[v]});
  expect_same_pits(cut, whole);
  expect_same_minima(cut, whole);
  expect_same_lift_figures(cut, whole, final);
  expect_same_triangles(cut, whole, final);
  expect_same_raster(cut, whole, final);
}

TEST(TilingParts, EveryTilingGivesTheTerrainOfTheWhole) {
  int cases = 0;
  for (const testing::CloudKind kind : testing::kCloudKinds)
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
      const auto points = testing::distinct(testing::make_cloud(kind, seed, 150 + 100 * seed, 9));
      if (convex_hull(points).size() < 3) continue;
      const WholeTerrain whole = testing::make_terrain(points, seed, seed == 0 ? 6 : 300);
      for (const int depth : {0, 2, 4}) {
        SCOPED_TRACE(std::string(testing::name_of(kind)) + " " + std::to_string(seed) + " " + std::to_string(depth));
        const testing::TemporaryFolder folder;
        PipelineOptions options = options_in(folder);
        options.pits.outlets = cases % 2 == 0 ? OutletPolicy::hull : OutletPolicy::lowest;
        if (cases % 5 == 4) options.pits.method = PitMethod::none;
        if (cases % 3 == 2) options.output.dem.max_edge_m = 0.12;
        options.output.mesh_ply = cases % 4 != 3;
        expect_same_as_whole(whole, options, seed + static_cast<std::uint64_t>(depth), depth);
        ++cases;
      }
    }
  EXPECT_GT(cases, 60);
}

TEST(TilingParts, SameBytesWhateverTheOrderOfTrianglesInTheFiles) {
  const WholeTerrain whole = testing::make_terrain(testing::random_points(4, 3000, 600), 4, 50);
  const testing::TemporaryFolder folder;
  const CutTerrain cut = testing::cut_terrain(whole, options_in(folder), kLattice, 9, 2);
  testing::run_parts(cut.context);
  const std::string before = testing::read_text(cut.context.layout.terrain(0));
  // All triangles of tile 0 in its seam file, in reverse.
  const Part part = load_part(cut.context, 0);
  std::vector<std::uint32_t> triangle;
  for (std::size_t i = part.triangle.size(); i > 0; --i) triangle.push_back(part.triangle[i - 1]);
  for (std::size_t i = 0; i < triangle.size(); i += 3) std::swap(triangle[i], triangle[i + 1]);
  for (std::uint32_t& v : triangle) v = cut.owned[PointId(part.point[v]).tile()][PointId(part.point[v]).index()];
  testing::write_triangle_file(cut, whole, 0, Phase::triangulate, {});
  testing::write_triangle_file(cut, whole, 0, Phase::seam, triangle);
  testing::run_parts(cut.context);
  EXPECT_EQ(testing::read_text(cut.context.layout.terrain(0)), before);
}

TEST(TilingParts, DisabledDemLeavesTheMarkerOnly) {
  const WholeTerrain whole = testing::make_terrain(testing::random_points(5, 100, 80), 5, 50);
  const testing::TemporaryFolder folder;
  PipelineOptions options = options_in(folder);
  options.output.dem.enabled = false;
  const CutTerrain cut = testing::cut_terrain(whole, options, kLattice, 5, 1);
  testing::run_parts(cut.context);
  EXPECT_EQ(store::Reader(cut.context.layout.unit(Phase::raster, 0)).integer("cells"), 0);
  EXPECT_FALSE(std::filesystem::exists(cut.context.layout.dem_tile(0)));
}

TEST(TilingParts, RastersBeyondTheBudgetAreRefused) {
  const WholeTerrain whole = testing::make_terrain(testing::random_points(6, 100, 80), 6, 50);
  const testing::TemporaryFolder folder;
  CutTerrain cut = testing::cut_terrain(whole, options_in(folder), kLattice, 6, 0);
  testing::run_parts(cut.context);
  cut.context.options.output.dem.cell_m = 1e-6;
  EXPECT_THROW(rasterize_tile(cut.context, 0), Error);
}

// Each fault in a part's input must be told apart from a terrain.
TEST(TilingParts, DamagedInputsAreNamed) {
  const WholeTerrain whole = testing::make_terrain(testing::random_points(9, 200, 120), 9, 50);
  const testing::TemporaryFolder folder;
  const CutTerrain cut = testing::cut_terrain(whole, options_in(folder), kLattice, 9, 2);
  ASSERT_GT(cut.owned.size(), 1U);
  ASSERT_NO_THROW(static_cast<void>(load_part(cut.context, 0)));
  const std::string path = cut.context.layout.unit(Phase::triangulate, 0);
  struct Arrays {
    std::vector<std::uint32_t> triangle;
    std::vector<std::uint64_t> foreign, hull;
    std::vector<std::int32_t> xyz;
  };
  const store::Reader in(path);
  const Arrays good{in.read<std::uint32_t>("triangle"), in.read<std::uint64_t>("foreign_point"),
                    in.read<std::uint64_t>("hull_edge"), in.read<std::int32_t>("foreign_xyz")};
  ASSERT_FALSE(good.foreign.empty());
  ASSERT_FALSE(good.hull.empty());
  const auto expect_refused = [&](auto damage) {
    Arrays a = good;
    damage(a);
    {
      store::Writer out(path);
      out.append("triangle", a.triangle);
      out.append("foreign_point", a.foreign);
      out.append("foreign_xyz", a.xyz);
      out.append("hull_edge", a.hull);
      out.commit();
    }
    try {
      static_cast<void>(load_part(cut.context, 0));
      ADD_FAILURE() << "accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::storage);
      EXPECT_NE(std::string(error.what()).find("/000000.h5"), std::string::npos) << error.what();
    }
  };
  expect_refused([](Arrays& a) { a.triangle[0] = 1U << 30; });
  expect_refused([](Arrays& a) { a.triangle.pop_back(); });
  expect_refused([](Arrays& a) { std::swap(a.triangle[0], a.triangle[1]); });
  expect_refused([](Arrays& a) { a.triangle[1] = a.triangle[0]; });
  expect_refused([](Arrays& a) { a.foreign[0] = PointId(999, 0).value; });
  expect_refused([](Arrays& a) { a.foreign[0] |= 0xffffffffU; });
  expect_refused([](Arrays& a) { a.xyz.pop_back(); });
  expect_refused([](Arrays& a) { std::swap(a.hull[0], a.hull[1]); });
  expect_refused([](Arrays& a) { a.hull.pop_back(); });
}

}  // namespace
}  // namespace hydrotin
