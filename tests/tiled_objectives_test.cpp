#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "hydrotin/error.h"
#include "hydrotin/measure.h"
#include "hydrotin/point_set.h"
#include "hydrotin/subdivision.h"
#include "hydrotin/useful_edges.h"
#include "mend.h"
#include "monolith.h"
#include "part.h"
#include "part_value.h"
#include "plan.h"
#include "polygon_figures.h"
#include "report.h"
#include "tiling_fixture.h"
#include "tiling_parts.h"

/// Every objective in tiles is what `triangulate` makes of all points in memory: triangles, repaired local minima,
/// values and counts. Here with clouds of some hundred points and tiles of some dozens, so that most polygons and most
/// conflicts cross borders.

namespace hydrotin {
namespace {

using testing::CloudKind;
using testing::CutTerrain;
using testing::TemporaryFolder;
using testing::WholeTerrain;

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

Triangles canonical(Triangles triangles) {
  for (auto& t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

/// What all tiles say together.
struct Tiled {
  Triangles triangles;  ///< over the vertices of the whole terrain
  PolygonFigures figures;
  std::vector<ObjectiveValue> values;
  std::int64_t useful_edges = 0, fixed_edges = 0, minima = 0, minima_bound = 0;
  std::int64_t mended = 0;           ///< polygons whose triangles the repair changed
  std::size_t across = 0;            ///< mended polygons with a vertex that another tile's polygon left
  std::set<std::uint64_t> unserved;  ///< vertices left at first
};

void run_until_drain(const RunContext& context) {
  const std::uint32_t tiles = context.plan.num_tiles();
  for (std::uint32_t t = 0; t < tiles; ++t) triangulate_tile(context, t);
  join_pieces(context);
  for (std::uint32_t t = 0; t < tiles; ++t) solve_seams(context, t);
  mend_minima(context);
  for (std::uint32_t t = 0; t < tiles; ++t) reduce_tile(context, t);
  drain_tiles(context);
}

void add_repair(const RunContext& context, Tiled& out) {
  std::vector<std::set<std::uint64_t>> left(context.plan.num_tiles());
  for (std::uint32_t t = 0; t < left.size(); ++t)
    for (const Phase phase : {Phase::triangulate, Phase::seam})
      for (const std::uint64_t p : store::Reader(context.layout.unit(phase, t)).read<std::uint64_t>("unserved")) {
        left[t].insert(p);
        out.unserved.insert(p);
      }
  out.mended = store::Reader(context.layout.unit(Phase::mend, 0)).integer("changed");
  for (std::uint32_t t = 0; t < left.size(); ++t) {
    const Mending mending = read_mended_triangles(context, t);
    const auto point = store::Reader(context.layout.unit(Phase::seam, t)).read<std::uint64_t>("point");
    for (const std::uint32_t v : mending.triangle)
      out.across += out.unserved.contains(point[v]) && !left[t].contains(point[v]);
  }
}

Tiled run_tiled(const CutTerrain& cut) {
  const RunContext& context = cut.context;
  run_until_drain(context);
  Tiled out;
  out.values.resize(context.options.triangulation.objectives.size());
  const MendedResults mended = read_mended_results(context);
  for (std::uint32_t t = 0; t < context.plan.num_tiles(); ++t) {
    const store::Reader triangulated(context.layout.unit(Phase::triangulate, t));
    out.figures.add(read_figures(triangulated));
    out.figures.add(mended.figures(context, t));
    out.useful_edges += triangulated.integer("useful_edges");
    out.fixed_edges += triangulated.integer("fixed_edges");
    out.minima_bound += triangulated.integer("minima_bound");
    const auto values = read_values(store::Reader(context.layout.unit(Phase::spill, t)), out.values.size());
    for (std::size_t i = 0; i < values.size(); ++i) out.values[i].add(values[i]);
    const Part part = load_part(context, t);
    for (std::size_t i = 0; i < part.triangle.size(); i += 3) {
      std::array<std::uint32_t, 3> corner{};
      for (std::size_t j = 0; j < 3; ++j) {
        const PointId id(part.point[part.triangle[i + j]]);
        corner[j] = cut.owned[id.tile()][id.index()];
      }
      out.triangles.push_back(corner);
    }
  }
  out.minima = store::Reader(context.layout.unit(Phase::drain, 0)).integer("minima_before");
  add_repair(context, out);
  return out;
}

/// Counts from the definitions, over all points at once.
struct Counts {
  std::int64_t useful = 0, fixed = 0;
  std::array<std::uint64_t, PolygonFigures::kNumSizes> sizes{};
};

Counts count_whole(const std::vector<LatticePoint>& position, int k) {
  const Triangulation dt = delaunay(position);
  const VertexLinks links = vertex_links(dt.view());
  const UsefulEdges edges = useful_edges(dt.view(), links, k);
  const Crossings crossings = find_crossings(dt.view(), edges);
  const Subdivision subdivision = subdivide(dt.view(), crossings.crossed);
  Counts out;
  out.useful = edges.size();
  for (std::uint32_t h = 0; h < dt.twin.size(); ++h) {
    if (!dt.twin[h].is_none() && dt.twin[h].value < h) continue;
    ++out.useful;
    out.fixed += !crossings.crossed[h];
  }
  for (std::uint32_t f = 0; f < subdivision.size(); ++f) {
    const std::size_t size = subdivision.triangles_of(f).size();
    std::size_t bucket = 0;
    for (std::size_t most = 1; most < size; most *= 2) ++bucket;
    ++out.sizes[bucket];
  }
  return out;
}

WholeTerrain terrain_of(CloudKind kind, std::uint64_t seed, std::size_t n, std::int32_t levels) {
  return testing::make_terrain(testing::make_cloud(kind, seed, n, seed % 2 ? 6 : 200), seed, levels);
}

PipelineOptions options_with(const Objectives& objectives, int k, const std::string& out) {
  PipelineOptions options = testing::options_for({}, out);
  options.triangulation.order = k;
  options.triangulation.objectives = objectives;
  options.run.workers = 1;
  return options;
}

/// Cuts a terrain into several tilings and demands of each what `triangulate` gives. Returns the last of them.
Tiled expect_monolith(const WholeTerrain& whole, const Objectives& objectives, int k, std::uint64_t seed,
                      const std::vector<int>& depths, const PolygonBudget& budget = {}) {
  const PointSetTriangulation expected =
      triangulate(whole.position, whole.height,
                  PointSetOptions{.order = k, .polygon = {.objectives = objectives, .budget = budget}});
  const Counts counts = count_whole(whole.position, k);
  const Triangles triangles = canonical(expected.triangles);
  std::optional<Tiled> first;
  Tiled got;
  for (const int depth : depths) {
    SCOPED_TRACE(::testing::Message() << "k " << k << " objectives " << name(objectives) << " seed " << seed
                                      << " depth " << depth);
    const TemporaryFolder folder;
    PipelineOptions options = options_with(objectives, k, folder / "out");
    options.triangulation.budget = budget;
    const CutTerrain cut = testing::cut_terrain(whole, options, Lattice{}, seed + 1, depth);
    got = run_tiled(cut);
    EXPECT_EQ(canonical(got.triangles), triangles);
    EXPECT_EQ(got.figures.polygons, expected.polygons);
    EXPECT_EQ(got.figures.max_polygon, expected.max_polygon);
    EXPECT_EQ(got.figures.components, expected.components);
    EXPECT_EQ(got.figures.max_components, expected.max_components);
    EXPECT_EQ(got.figures.fallbacks, expected.fallbacks);
    EXPECT_EQ(got.figures.limit_missed, 0U);
    EXPECT_EQ(got.figures.max_order, expected.max_order);
    EXPECT_EQ(got.figures.sizes, counts.sizes);
    EXPECT_EQ(got.useful_edges, counts.useful);
    EXPECT_EQ(got.fixed_edges, counts.fixed);
    for (std::size_t i = 0; i < objectives.size(); ++i) {
      const double value = objectives[i] == Objective::local_minima    ? static_cast<double>(got.minima)
                           : objectives[i] == Objective::min_max_order ? static_cast<double>(got.figures.max_order)
                           : objectives[i] == Objective::delaunay      ? 0
                                                                       : total(objectives[i], got.values[i]);
      EXPECT_NEAR(value, expected.values[i], 1e-9 * std::abs(expected.values[i])) << name(objectives[i]);
    }
    if (objectives.front() == Objective::local_minima) {
      EXPECT_EQ(static_cast<double>(got.minima_bound), expected.bound);
      EXPECT_EQ(got.minima == got.minima_bound, expected.optimal);
    } else {
      EXPECT_EQ(got.figures.not_optimal == 0, expected.optimal);
    }
    if (!first) first = got;
    EXPECT_EQ(got.values, first->values) << "sums and bottlenecks to the last bit";
    EXPECT_EQ(got.figures, first->figures);
  }
  return got;
}

const std::vector<Objectives> kLists = {{Objective::delaunay},
                                        {Objective::min_weight},
                                        {Objective::local_minima},
                                        {Objective::min_max_edge},
                                        {Objective::max_min_angle},
                                        {Objective::min_max_angle},
                                        {Objective::min_max_circumradius},
                                        {Objective::min_max_enclosing_circle},
                                        {Objective::min_max_area},
                                        {Objective::max_min_area},
                                        {Objective::max_sum_inradius},
                                        {Objective::min_sum_inradius},
                                        {Objective::min_max_order},
                                        {Objective::local_minima, Objective::min_weight},
                                        {Objective::local_minima, Objective::max_min_angle, Objective::min_weight},
                                        {Objective::min_max_edge, Objective::local_minima},
                                        {Objective::min_weight, Objective::local_minima, Objective::max_min_area}};

TEST(TiledObjectives, EqualTriangulateForEveryTiling) {
  constexpr std::array kKinds{CloudKind::uniform, CloudKind::lattice, CloudKind::scanlines, CloudKind::clustered};
  for (std::size_t list = 0; list < kLists.size(); ++list)
    for (const int k : list % 2 == 0 ? std::array{1, 3} : std::array{2, 5}) {
      const std::uint64_t seed = 100 * list + static_cast<std::uint64_t>(k);
      const CloudKind kind = kKinds[(list / 2 + static_cast<std::size_t>(k)) % kKinds.size()];
      (void)expect_monolith(terrain_of(kind, seed, 160, 40), kLists[list], k, seed, {k == 3 ? 0 : 2, 4});
      if (HasFailure()) return;
    }
}

/// Clouds in which a polygon saves a vertex that another one left, found by trying thousands.
struct Conflict {
  CloudKind kind;
  std::uint64_t seed;
  int k;
  std::int32_t levels;
};

constexpr Conflict kConflicts[] = {
    {CloudKind::uniform, 285, 3, 10},  {CloudKind::uniform, 26, 4, 10},   {CloudKind::uniform, 26, 5, 10},
    {CloudKind::uniform, 26, 6, 10},   {CloudKind::scanlines, 270, 3, 2}, {CloudKind::scanlines, 29, 4, 10},
    {CloudKind::scanlines, 29, 5, 10}, {CloudKind::scanlines, 29, 6, 10}, {CloudKind::clustered, 114, 3, 2},
    {CloudKind::clustered, 114, 4, 2}, {CloudKind::clustered, 14, 5, 2},  {CloudKind::clustered, 13, 6, 5}};

TEST(TiledMinima, AreRepairedAcrossBorders) {
  std::size_t across = 0;
  for (const Conflict& at : kConflicts) {
    SCOPED_TRACE(::testing::Message() << testing::name_of(at.kind) << " seed " << at.seed);
    const WholeTerrain whole = terrain_of(at.kind, at.seed, 250, at.levels);
    for (const std::uint64_t cut : {1, 2, 3}) {
      const Tiled got = expect_monolith(whole, {Objective::local_minima}, at.k, cut, {4});
      EXPECT_GT(got.mended, 0);
      EXPECT_LT(static_cast<std::size_t>(got.minima - got.minima_bound), got.unserved.size()) << "some were saved";
      across += got.across;
    }
    if (HasFailure()) return;
  }
  EXPECT_GT(across, 10U);
}

// An objective before the minima leaves many vertices, and a bottleneck leaves polygons the freedom to save them.
TEST(TiledMinima, AreRepairedAfterOtherObjectives) {
  std::int64_t mended = 0;
  std::size_t across = 0, left = 0;
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    const int k = 2 + static_cast<int>(seed % 4);
    const Objectives objectives = seed % 4 == 0   ? Objectives{Objective::min_weight, Objective::local_minima}
                                  : seed % 4 == 1 ? Objectives{Objective::local_minima, Objective::max_sum_inradius}
                                                  : Objectives{Objective::max_min_angle, Objective::local_minima};
    const CloudKind kind = seed % 3 == 0 ? CloudKind::scanlines : CloudKind::uniform;
    const Tiled got = expect_monolith(terrain_of(kind, seed, 250, 1 + static_cast<std::int32_t>(seed) * 3), objectives,
                                      k, seed, {2, 4});
    mended += got.mended;
    across += got.across;
    left += got.unserved.size();
    if (HasFailure()) return;
  }
  EXPECT_GT(left, 20U);
  EXPECT_GT(mended, 5);
  EXPECT_GT(across, 10U);
}

TEST(TiledMinima, NothingIsMendedWhereNothingIsLeft) {
  const TemporaryFolder folder;
  const WholeTerrain whole = terrain_of(CloudKind::uniform, 2, 300, 1'000'000);
  const CutTerrain cut =
      testing::cut_terrain(whole, options_with({Objective::min_weight}, 3, folder / "out"), Lattice{}, 3, 3);
  const Tiled got = run_tiled(cut);
  EXPECT_TRUE(got.unserved.empty());
  const store::Reader mend(cut.context.layout.unit(Phase::mend, 0));
  EXPECT_EQ(mend.size("polygon"), 0U);
  EXPECT_EQ(mend.size("position"), 0U);
  EXPECT_EQ(mend.integer("changed"), 0);
}

TEST(TiledObjectives, BudgetsAreTheSameForEveryTiling) {
  for (const auto kind : {CloudKind::uniform, CloudKind::scanlines})
    for (const Objective objective : {Objective::min_weight, Objective::local_minima, Objective::max_min_angle}) {
      const Tiled got =
          expect_monolith(terrain_of(kind, 61, 1'500, 40), {objective}, 3, 61, {0, 2}, {.max_triangles = 20});
      EXPECT_GT(got.figures.fallbacks, 0U);
    }
}

nlohmann::json report_of(const PipelineOptions& options) {
  const DatasetSummary summary = testing::run(options);
  EXPECT_TRUE(summary.ok);
  return nlohmann::json::parse(testing::bytes_of(options.output.dir + "/report.json")).at("triangulation");
}

// A whole run: the report says the same for every tiling, and what it says of tiles adds up.
TEST(TiledReport, SaysTheSameForEveryTiling) {
  const TemporaryFolder folder;
  const auto position = testing::distinct(testing::make_cloud(CloudKind::clustered, 3, 6'000, 100));
  const auto height = testing::random_heights(3, position.size(), 300);
  const auto files = testing::write_files(folder, position, height, 2);
  for (const Objectives& objectives :
       {Objectives{Objective::local_minima}, Objectives{Objective::min_weight, Objective::local_minima},
        Objectives{Objective::max_min_angle, Objective::min_weight}, Objectives{Objective::delaunay}}) {
    SCOPED_TRACE(name(objectives));
    const Objective first = objectives.front();
    const PointSetTriangulation expected =
        triangulate(position, height, PointSetOptions{.order = 3, .polygon = {.objectives = objectives}});
    const Counts counts = count_whole(position, 3);
    nlohmann::json totals;
    for (const std::uint64_t target : {1'000'000, 1'000}) {
      PipelineOptions options = testing::options_for(files, folder / "out");
      options.triangulation.order = 3;
      options.triangulation.objectives = objectives;
      options.tiles.target_points = target;
      nlohmann::json got = report_of(options);
      const nlohmann::json tiles = got.at("per_tile");
      got.erase("per_tile");
      if (totals.is_null()) totals = got;
      EXPECT_EQ(got, totals);
      EXPECT_EQ(tiles.size() == 1, target > 1'000);
      EXPECT_EQ(got.at("order"), 3);
      EXPECT_EQ(got.at("max_order"), expected.max_order);
      EXPECT_EQ(got.at("objective"), name(objectives));
      EXPECT_EQ(got.at("useful_edges"), counts.useful);
      EXPECT_EQ(got.at("fixed_edges"), counts.fixed);
      EXPECT_EQ(got.at("polygons"), expected.polygons);
      EXPECT_EQ(got.at("largest_polygon"), expected.max_polygon);
      EXPECT_EQ(got.at("components"), expected.components);
      EXPECT_EQ(got.at("most_components"), expected.max_components);
      EXPECT_EQ(got.at("fallbacks"), expected.fallbacks);
      EXPECT_EQ(got.at("limit_missed"), 0);
      EXPECT_EQ(got.at("local_minima"), count_minima(position, height, expected.triangles));
      EXPECT_EQ(got.at("optimal"), expected.optimal);
      for (std::size_t b = 0; b < got.at("polygon_sizes").size(); ++b)
        EXPECT_EQ(got.at("polygon_sizes")[b], counts.sizes[b]);
      if (first == Objective::delaunay) {
        EXPECT_FALSE(got.contains("value"));
      } else {
        const Lattice lattice = make_plan(options).lattice;
        const double unit = unit_of(first, lattice);
        EXPECT_NEAR(got.at("value"), expected.value() * unit, 1e-9 * std::abs(expected.value() * unit));
        EXPECT_NEAR(got.at("bound"), expected.bound * unit, 1e-9 * std::abs(expected.bound * unit));
        for (std::size_t i = 0; i < objectives.size(); ++i)
          EXPECT_NEAR(got.at("values").at(std::string(name(objectives[i]))),
                      expected.values[i] * unit_of(objectives[i], lattice), 1e-9 * std::abs(expected.values[i]));
      }
      for (const char* key : {"useful_edges", "fixed_edges", "polygons", "components", "fallbacks", "local_minima"}) {
        std::int64_t sum = 0;
        for (const auto& tile : tiles) sum += tile.at(key).get<std::int64_t>();
        EXPECT_EQ(got.at(key), sum) << key;
      }
      if (kind_of(first) == ObjectiveKind::sum || kind_of(first) == ObjectiveKind::minima) {
        double sum = 0;
        for (const auto& tile : tiles) sum += tile.at("value").get<double>();
        EXPECT_NEAR(got.at("value"), sum, 1e-9 * sum);
      }
      const std::string text = report_text(options);
      EXPECT_NE(text.find("useful edges" + std::string(14, ' ') + std::to_string(counts.useful)), std::string::npos)
          << text;
      EXPECT_NE(text.find("\nTiles\n"), std::string::npos);
      std::filesystem::remove_all(folder / "out");
    }
  }
}

/// Vertices, and points between them, at them, on their edges and beyond their hull.
struct ReferenceSurvey {
  testing::Cloud vertices, reference;
  std::vector<std::string> files, reference_files;
};

ReferenceSurvey reference_survey(const TemporaryFolder& folder, CloudKind kind, std::uint64_t seed) {
  ReferenceSurvey out;
  testing::Random random(seed);
  // Narrow, so that many points lie on edges and at vertices.
  for (const LatticePoint p : testing::make_cloud(kind, seed, 9'000, 8)) {
    const LatticePoint moved{p.x + 200, p.y + 200};
    const std::int32_t height = testing::relief_at(seed, p, 200, 400, 12);
    auto& to = random.below(3) == 0 ? out.vertices : out.reference;
    to.position.push_back(moved);
    to.height.push_back(height);
  }
  for (int i = 0; i < 150; ++i) {  // some of them outside, some at places of others
    const std::size_t some = random.below(out.vertices.position.size());
    out.reference.position.push_back(random.below(2) == 0
                                         ? LatticePoint{random.between(0, 1'200), random.between(0, 1'200)}
                                         : out.vertices.position[some]);
    out.reference.height.push_back(out.vertices.height[some] + random.between(-30, 30));
  }
  out.files = testing::write_files(folder, out.vertices.position, out.vertices.height, 2);
  out.reference_files = testing::write_files(folder, out.reference.position, out.reference.height, 3, "removed_");
  return out;
}

// Errors of reference points and the limit on them are those of `triangulate`, for every tiling.
TEST(TiledReference, EqualsTriangulate) {
  struct Case {
    Objectives objectives;
    std::optional<double> limit_m;
    int k;
    CloudKind kind;
  };
  const Case cases[] = {{{Objective::local_minima, Objective::min_squared_error}, 0.4, 3, CloudKind::voided},
                        {{Objective::min_squared_error}, std::nullopt, 2, CloudKind::clustered},
                        {{Objective::min_absolute_error, Objective::local_minima}, 0.25, 4, CloudKind::uniform},
                        {{Objective::min_max_error}, std::nullopt, 3, CloudKind::scanlines},
                        {{Objective::min_max_error, Objective::min_squared_error}, 0.3, 2, CloudKind::lattice},
                        {{Objective::local_minima}, 0.2, 4, CloudKind::uniform},
                        {{Objective::delaunay}, std::nullopt, 2, CloudKind::voided},
                        {{Objective::max_min_angle}, 0.5, 3, CloudKind::l_shaped}};
  std::uint64_t seed = 40;
  std::uint64_t missed = 0, hopeless = 0;
  for (const Case& c : cases) {
    SCOPED_TRACE(::testing::Message() << name(c.objectives) << " k " << c.k << " " << testing::name_of(c.kind));
    const TemporaryFolder folder;
    const ReferenceSurvey survey = reference_survey(folder, c.kind, ++seed);
    std::optional<testing::Monolith> expected;
    nlohmann::json totals;
    for (const std::uint64_t target : {1'000'000, 1'000}) {
      PipelineOptions options = testing::options_for(survey.files, folder / "out");
      options.triangulation.order = c.k;
      options.triangulation.objectives = c.objectives;
      options.triangulation.reference = survey.reference_files;
      options.triangulation.max_error_m = c.limit_m;
      options.tiles.target_points = target;
      const Lattice lattice = make_plan(options).lattice;
      std::optional<ErrorLimit> limit;
      if (c.limit_m) limit = ErrorLimit{std::llround(*c.limit_m / lattice.scale_z * 1e6)};
      if (!expected)
        expected = testing::run_monolith(
            survey.vertices.position, survey.vertices.height, c.k, c.objectives, true,
            {static_cast<std::int32_t>(lattice.base_x), static_cast<std::int32_t>(lattice.base_y)},
            static_cast<std::int32_t>(lattice.base_z), survey.reference, limit);
      const PointSetTriangulation& whole = expected->figures;
      nlohmann::json got = report_of(options);
      EXPECT_EQ(read_report(options.output.dir + "/report.json").fingerprint, expected->fingerprint);
      const nlohmann::json tiles = got.at("per_tile");
      EXPECT_EQ(tiles.size() > 4, target == 1'000);
      got.erase("per_tile");
      if (totals.is_null()) totals = got;
      EXPECT_EQ(got, totals) << "to the last bit";
      const nlohmann::json& reference = got.at("reference");
      const std::uint64_t points = survey.reference.position.size();
      EXPECT_EQ(reference.at("points"), points);
      EXPECT_EQ(reference.at("outside"), whole.reference_outside);
      EXPECT_EQ(reference.at("at_vertices"), whole.reference_at_vertices);
      EXPECT_EQ(reference.at("limit_missed"), whole.limit_missed);
      EXPECT_EQ(reference.at("vertices_beyond_limit"), whole.vertices_beyond_limit);
      EXPECT_GT(whole.reference_outside, 0U);
      EXPECT_GT(whole.reference_at_vertices, 50U);
      EXPECT_NEAR(reference.at("max_error"), whole.error.largest * lattice.scale_z, 1e-9);
      const double rms = std::sqrt(whole.error.squared.value() / static_cast<double>(points - whole.reference_outside));
      EXPECT_NEAR(reference.at("rms"), rms * lattice.scale_z, 1e-9 * rms);
      EXPECT_EQ(got.at("optimal"), whole.optimal);
      EXPECT_EQ(got.at("max_order"), whole.max_order);
      for (std::size_t i = 0; i < c.objectives.size() && c.objectives[0] != Objective::delaunay; ++i) {
        const double unit = unit_of(c.objectives[i], lattice);
        EXPECT_NEAR(got.at("values").at(std::string(name(c.objectives[i]))), whole.values[i] * unit,
                    1e-9 * std::abs(whole.values[i] * unit));
      }
      if (c.objectives[0] != Objective::delaunay) {
        const double bound = whole.bound * unit_of(c.objectives[0], lattice);
        EXPECT_NEAR(got.at("bound"), bound, 1e-9 * std::abs(bound));
      }
      for (const char* key : {"points", "outside", "at_vertices", "limit_missed", "vertices_beyond_limit"}) {
        std::uint64_t sum = 0;
        for (const auto& tile : tiles) sum += tile.at("reference").at(key).get<std::uint64_t>();
        EXPECT_EQ(reference.at(key), sum) << key;
      }
      missed += whole.limit_missed;
      if (c.limit_m && c.objectives[0] == Objective::local_minima) hopeless += got.at("bound").get<std::uint64_t>();
      std::filesystem::remove_all(folder / "out");
    }
    if (HasFailure()) return;
  }
  EXPECT_GT(missed, 0U);
  EXPECT_GT(hopeless, 0U);
}

TEST(TiledReference, ALimitNeedsReferencePoints) {
  PipelineOptions options = testing::options_for({"none.las"}, "nowhere");
  options.triangulation.max_error_m = 0.1;
  EXPECT_THROW((void)plan_run(options), Error);
  const TemporaryFolder folder;
  const ReferenceSurvey survey = reference_survey(folder, CloudKind::uniform, 1);
  options = testing::options_for(survey.files, folder / "out");
  options.triangulation.reference = {folder / "nothing*.las"};
  try {
    (void)plan_run(options);
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_EQ(std::string(error.what()).find("triangulation.reference: nothing matches"), 0U) << error.what();
  }
}

TEST(ExactSums, DoNotDependOnGrouping) {
  testing::Random random(1);
  ExactSum all, left, right;
  long double plain = 0;
  for (int i = 0; i < 10'000; ++i) {
    const double term = std::ldexp(random.unit() - 0.25, static_cast<int>(random.below(60)) - 10);
    all.add(term);
    (random.below(2) == 0 ? left : right).add(term);
    plain += term;
  }
  right.add(left);
  EXPECT_EQ(all, right);
  EXPECT_EQ(all, ExactSum(all.high(), all.low()));
  EXPECT_NEAR(all.value(), static_cast<double>(plain), 1e-12 * static_cast<double>(plain));
  ExactSum negative;
  negative.add(-1.5);
  EXPECT_EQ(negative.value(), -1.5);
  EXPECT_EQ(ExactSum(negative.high(), negative.low()), negative);
}

TEST(ObjectionToRun, NamesWhatIsForPointSetsInMemory) {
  const auto is_possible = [](const Objectives& objectives, const std::vector<std::string>& reference = {}) {
    TriangulationOptions options;
    options.objectives = objectives;
    options.reference = reference;
    return !objection_to_run(options);
  };
  EXPECT_TRUE(is_possible({Objective::local_minima, Objective::min_weight}));
  EXPECT_FALSE(is_possible({}));
  EXPECT_FALSE(is_possible({Objective::local_minima, Objective::local_minima}));
  for (std::size_t i = 0; i < kObjectiveNames.size(); ++i) {
    const auto objective = static_cast<Objective>(i);
    const ObjectiveKind kind = kind_of(objective);
    const bool apart = kind == ObjectiveKind::none || kind == ObjectiveKind::sum || kind == ObjectiveKind::minima ||
                       kind == ObjectiveKind::bottleneck;
    EXPECT_EQ(is_possible({objective}, {"r.las"}), apart) << name(objective);
    EXPECT_EQ(is_possible({objective}), apart && !needs_reference(objective)) << name(objective);
  }
  PipelineOptions options = testing::options_for({"none.las"}, "nowhere");
  options.triangulation.objectives = {Objective::min_max_degree};
  try {
    (void)plan_run(options);
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::config);
    EXPECT_NE(std::string(error.what()).find("'min-max-degree' couples"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace hydrotin
