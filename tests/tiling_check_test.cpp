// check_dataset: accepts what the phases write, finds every fault that is planted.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <set>

#include "dataset.h"
#include "fingerprint.h"
#include "hydrotin/pipeline.h"
#include "hydrotin/pits.h"
#include "hydrotin/predicates.h"
#include "terrain_file.h"
#include "tiling_parts.h"

// HDF5 does not free everything when it gives up on a damaged object header.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libhdf5";
}

namespace hydrotin {
namespace {

using testing::CutTerrain;
using testing::WholeTerrain;

const Lattice kLattice{0.01, 0.01, 100.0, -50.0, 0.0, 3000, -4000, 0};

PipelineOptions options_in(const testing::TemporaryFolder& folder) {
  PipelineOptions options;
  options.output.dir = folder.path();
  options.output.dem.enabled = false;
  options.output.mesh_ply = false;
  options.triangulation.order = 0;
  options.pits.method = PitMethod::lift;
  return options;
}

Fingerprint sum_of_fingerprints(const CutTerrain& cut) {
  Fingerprint sum;
  for (std::uint32_t t = 0; t < cut.owned.size(); ++t)
    sum.add(*Fingerprint::parse(store::Reader(cut.context.layout.terrain(t)).text("fingerprint")));
  return sum;
}

struct IndexFacts {
  std::int64_t order = 0, pits = 0;
  std::string outlets, fingerprint;
};

void write_index(const CutTerrain& cut, const IndexFacts& facts) {
  const Outline& outline = cut.context.outline;
  store::Writer out(cut.context.layout.index());
  write_lattice(out, cut.context.plan.lattice);
  std::vector<std::uint64_t> triangles;
  std::int64_t sum = 0;
  for (std::uint32_t t = 0; t < outline.count.size(); ++t) {
    triangles.push_back(store::Reader(cut.context.layout.terrain(t)).size("triangle") / 3);
    sum += static_cast<std::int64_t>(triangles.back());
  }
  out.append("tile_count", outline.count);
  out.append("tile_box", flatten(outline.box));
  out.append("tile_triangles", triangles);
  out.set("tiles", static_cast<std::int64_t>(triangles.size()));
  out.set("points", static_cast<std::int64_t>(outline.points));
  out.set("vertices", static_cast<std::int64_t>(outline.vertices));
  out.set("duplicates", static_cast<std::int64_t>(outline.duplicates));
  out.set("triangles", sum);
  out.set("order", facts.order);
  out.set("pits", facts.pits);
  out.set("fingerprint", facts.fingerprint);
  out.set("outlets", facts.outlets);
  out.set("lowest_point", static_cast<std::int64_t>(outline.lowest.point.value));
  out.commit();
}

IndexFacts index_facts(const CutTerrain& cut, const WholeTerrain& whole) {
  const PitOptions& pits = cut.context.options.pits;
  const bool is_lifted = pits.method != PitMethod::none;
  const std::string policy = pits.outlets == OutletPolicy::hull ? "hull" : "lowest";
  const auto left = count_pits(whole.graph(), whole.height, testing::outlets_of(whole, pits.outlets));
  return {cut.context.options.triangulation.order, is_lifted ? 0 : static_cast<std::int64_t>(left),
          is_lifted ? policy : "none", sum_of_fingerprints(cut).hex()};
}

CutTerrain make_dataset(const WholeTerrain& whole, const PipelineOptions& options, std::uint64_t seed, int depth) {
  CutTerrain cut = testing::cut_terrain(whole, options, kLattice, seed, depth);
  testing::run_parts(cut.context);
  write_index(cut, index_facts(cut, whole));
  return cut;
}

int brute_force_max_order(const WholeTerrain& whole) {
  int most = 0;
  for (std::size_t i = 0; i < whole.triangle.size(); i += 3) {
    const std::uint32_t* v = &whole.triangle[i];
    int count = 0;
    for (std::uint32_t p = 0; p < whole.position.size(); ++p)
      if (p != v[0] && p != v[1] && p != v[2])
        count += in_circle(whole.position[v[0]], whole.position[v[1]], whole.position[v[2]], whole.position[p]);
    most = std::max(most, count);
  }
  return most;
}

// Flips some edges of convex quadrilaterals.
void disturb(WholeTerrain& whole, std::uint64_t seed, int flips) {
  testing::Random random(seed);
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> halfedge;
  const auto after = [](std::size_t h) { return h % 3 == 2 ? h - 2 : h + 1; };
  const auto put = [&](std::size_t t) {
    for (std::size_t h = 3 * t; h < 3 * t + 3; ++h) halfedge[{whole.triangle[h], whole.triangle[after(h)]}] = h;
  };
  for (std::size_t t = 0; t < whole.triangle.size() / 3; ++t) put(t);
  for (int i = 0; i < flips; ++i) {
    const std::size_t h = random.below(whole.triangle.size());
    const std::uint32_t a = whole.triangle[h], b = whole.triangle[after(h)], c = whole.triangle[after(after(h))];
    const auto twin = halfedge.find({b, a});
    if (twin == halfedge.end()) continue;
    const std::size_t g = twin->second;
    const std::uint32_t d = whole.triangle[after(after(g))];
    const auto& p = whole.position;
    if (orientation(p[a], p[d], p[c]) <= 0 || orientation(p[d], p[b], p[c]) <= 0) continue;
    halfedge.erase({a, b});
    halfedge.erase({b, a});
    const std::array<std::uint32_t, 6> fresh{a, d, c, d, b, c};
    std::copy_n(fresh.begin(), 3, &whole.triangle[h / 3 * 3]);
    std::copy_n(fresh.begin() + 3, 3, &whole.triangle[g / 3 * 3]);
    put(h / 3);
    put(g / 3);
  }
}

TEST(CheckDataset, AcceptsWhatThePhasesWrite) {
  int cases = 0;
  for (const testing::CloudKind kind : testing::kCloudKinds)
    for (std::uint64_t seed = 0; seed < 2; ++seed) {
      const auto points = testing::distinct(testing::make_cloud(kind, seed, 300, 9));
      if (convex_hull(points).size() < 3) continue;
      WholeTerrain whole = testing::make_terrain(points, seed, 40);
      if (seed == 1) disturb(whole, seed, 60);
      const int order = brute_force_max_order(whole);
      std::set<std::string> fingerprints;
      std::set<std::uint64_t> samples;
      for (const int depth : {0, 3}) {
        SCOPED_TRACE(std::string(testing::name_of(kind)) + " " + std::to_string(seed) + " " + std::to_string(depth));
        const testing::TemporaryFolder folder;
        PipelineOptions options = options_in(folder);
        options.triangulation.order = order;
        options.pits.outlets = seed == 0 ? OutletPolicy::hull : OutletPolicy::lowest;
        if (kind == testing::CloudKind::uniform) options.pits.method = PitMethod::none;
        const CutTerrain cut = make_dataset(whole, options, seed, depth);
        const DatasetSummary summary = check_dataset(options.output.dir, 0);
        EXPECT_TRUE(summary.ok);
        EXPECT_EQ(summary.problems, std::vector<std::string>{});
        EXPECT_EQ(summary.triangles, whole.triangle.size() / 3);
        EXPECT_EQ(summary.order_sample, summary.triangles);
        EXPECT_EQ(summary.vertices, whole.position.size());
        EXPECT_EQ(summary.order, order);
        EXPECT_EQ(summary.max_triangle_order, order);
        EXPECT_EQ(static_cast<std::int64_t>(summary.pits), index_facts(cut, whole).pits);
        fingerprints.insert(summary.fingerprint);
        const DatasetSummary sampled = check_dataset(options.output.dir, 100);
        EXPECT_TRUE(sampled.ok);
        EXPECT_LE(sampled.order_sample, 100U);
        if (summary.triangles > 100) {
          EXPECT_GT(sampled.order_sample, 50U);
        }
        samples.insert(sampled.order_sample);
        ++cases;
      }
      EXPECT_EQ(fingerprints.size(), 1U);
      EXPECT_EQ(samples.size(), 1U);
    }
  EXPECT_GT(cases, 30);
}

// A terrain file in memory, to be written again with faults.
struct TerrainArrays {
  std::map<std::string, std::vector<std::int32_t>> i32;
  std::map<std::string, std::vector<std::uint32_t>> u32;
  std::map<std::string, std::vector<std::uint64_t>> u64;
  std::map<std::string, std::vector<std::uint8_t>> u8;
  std::map<std::string, std::string> text;
  std::map<std::string, std::int64_t> number;
};

TerrainArrays read_arrays(const std::string& path) {
  const store::Reader in(path);
  TerrainArrays out;
  for (const char* name :
       {"x", "y", "z", "block_box", "height", "foreign_xyz", "foreign_height", "triangle_box", "pit_xyz", "pit_level",
        "final_pit_xy", "final_pit_height", "final_plateau_xy", "final_plateau_height"})
    out.i32[name] = in.read<std::int32_t>(name);
  for (const char* name : {"triangle", "final_plateau_inner", "final_plateau_rim_begin"})
    out.u32[name] = in.read<std::uint32_t>(name);
  for (const char* name : {"foreign_point", "hull_edge", "pit_vertices", "final_pit_vertex", "final_pit_vertices",
                           "final_plateau_vertex", "final_plateau_rim"})
    out.u64[name] = in.read<std::uint64_t>(name);
  out.u8["final_plateau_drains"] = in.read<std::uint8_t>("final_plateau_drains");
  for (const char* name : {"fingerprint", "outlets", "pit_method"}) out.text[name] = in.text(name);
  out.number["pits_removed"] = in.integer("pits_removed");
  return out;
}

void write_arrays(const TerrainArrays& arrays, const std::string& path) {
  store::Writer out(path);
  write_lattice(out, kLattice);
  for (const auto& [name, values] : arrays.i32) out.append(name, values);
  for (const auto& [name, values] : arrays.u32) out.append(name, values);
  for (const auto& [name, values] : arrays.u64) out.append(name, values);
  for (const auto& [name, values] : arrays.u8) out.append(name, values);
  for (const auto& [name, value] : arrays.text) out.set(name, value);
  for (const auto& [name, value] : arrays.number) out.set(name, value);
  out.commit();
}

class PlantedFault : public ::testing::Test {
 protected:
  PlantedFault()
      : whole_(testing::make_terrain(testing::random_points(16, 600, 200), 16, 60)),
        cut_(make_dataset(whole_, options_in(folder_), 16, 3)),
        path_(cut_.context.layout.terrain(0)),
        good_(read_arrays(path_)) {}

  void SetUp() override {
    ASSERT_GT(cut_.owned.size(), 2U);
    ASSERT_TRUE(check().ok);
    write_arrays(good_, path_);
    ASSERT_TRUE(check().ok);  // the faults below are in the change, not in writing the file again
  }

  [[nodiscard]] DatasetSummary check() const { return check_dataset(folder_.path(), 0); }

  // All problems, of which one has `words` and names the damaged file.
  std::vector<std::string> expect_problem(const std::string& words, const std::string& file = "tile_000000.h5") {
    const DatasetSummary summary = check();
    EXPECT_FALSE(summary.ok);
    EXPECT_TRUE(std::any_of(
        summary.problems.begin(), summary.problems.end(),
        [&](const std::string& p) { return p.find(words) != std::string::npos && p.find(file) != std::string::npos; }))
        << words << "\nnot in: " << ::testing::PrintToString(summary.problems);
    return summary.problems;
  }
  void expect_problem_after(const std::string& words, const std::function<void(TerrainArrays&)>& plant) {
    TerrainArrays bad = good_;
    plant(bad);
    write_arrays(bad, path_);
    expect_problem(words);
    write_arrays(good_, path_);
  }
  // States the fingerprints that the files now have, so that only other checks can find the fault.
  void forge_fingerprints(TerrainArrays arrays, IndexFacts facts) {
    const std::size_t num_own = arrays.i32["x"].size();
    const auto corner = [&](std::uint32_t v) {
      if (v < num_own) return Fingerprint::Corner{arrays.i32["x"][v], arrays.i32["y"][v], arrays.i32["height"][v]};
      const std::size_t f = v - num_own;
      return Fingerprint::Corner{arrays.i32["foreign_xyz"][3 * f], arrays.i32["foreign_xyz"][3 * f + 1],
                                 arrays.i32["foreign_height"][f]};
    };
    Fingerprint print;
    const auto& t = arrays.u32["triangle"];
    for (std::size_t i = 0; i < t.size(); i += 3) print.add({corner(t[i]), corner(t[i + 1]), corner(t[i + 2])});
    arrays.text["fingerprint"] = print.hex();
    write_arrays(arrays, path_);
    facts.fingerprint = sum_of_fingerprints(cut_).hex();
    write_index(cut_, facts);
  }

  testing::TemporaryFolder folder_;
  WholeTerrain whole_;
  CutTerrain cut_;
  std::string path_;
  TerrainArrays good_;
};

TEST_F(PlantedFault, TrianglesAndVertices) {
  expect_problem_after("not counter-clockwise", [](auto& a) { std::swap(a.u32["triangle"][0], a.u32["triangle"][1]); });
  expect_problem_after("two triangles lie on one side",
                       [](auto& a) { std::copy_n(a.u32["triangle"].begin(), 3, a.u32["triangle"].begin() + 3); });
  expect_problem_after("names a vertex twice", [](auto& a) { a.u32["triangle"][1] = a.u32["triangle"][0]; });
  expect_problem_after("not listed", [](auto& a) { a.u32["triangle"][4] = 1U << 31; });
  expect_problem_after("triangles that the index names", [](auto& a) { a.u32["triangle"].resize(6); });
  expect_problem_after("points that the index names", [](auto& a) { a.i32["y"].pop_back(); });
  expect_problem_after("block box", [](auto& a) { ++a.i32["block_box"][2]; });
  expect_problem_after("triangle box", [](auto& a) { ++a.i32["triangle_box"][0]; });
  expect_problem_after("hull edge that it lists",
                       [](auto& a) { std::swap(a.u64["hull_edge"][0], a.u64["hull_edge"][1]); });
  expect_problem_after("no triangle on its other side", [](auto& a) {
    a.u64["hull_edge"].pop_back();
    a.u64["hull_edge"].pop_back();
  });
  expect_problem_after("other outlets", [](auto& a) { a.text["outlets"] = "lowest"; });
  expect_problem_after("fingerprint", [](auto& a) { a.text["fingerprint"][5] ^= 1; });
  expect_problem_after("do not ascend",
                       [](auto& a) { std::swap(a.u64["foreign_point"][0], a.u64["foreign_point"][1]); });
  expect_problem_after("no point of another tile", [](auto& a) { a.u64["foreign_point"][0] = 0; });
  expect_problem_after("has other coordinates", [](auto& a) { ++a.i32["foreign_xyz"][2]; });
  expect_problem_after("lower than it was measured", [](auto& a) { a.i32["foreign_height"][0] = -5; });
  expect_problem_after("another height elsewhere", [](auto& a) { a.i32["foreign_height"][0] += 1; });
  expect_problem_after("used but has no height", [](auto& a) {
    for (auto& z : a.i32["height"]) z = kUnusedHeight;
  });
}

TEST_F(PlantedFault, FlippedEdgeHasTooHighAnOrder) {
  // Two triangles of one file over a convex quadrilateral.
  TerrainArrays bad = good_;
  auto& t = bad.u32["triangle"];
  const TerrainTile tile = load_terrain_tile(load_index(folder_.path()), 0);
  const auto& p = tile.position;
  bool is_flipped = false;
  for (std::size_t i = 0; i < t.size() && !is_flipped; i += 3)
    for (std::size_t j = i + 3; j < t.size() && !is_flipped; j += 3)
      for (std::size_t turn = 0; turn < 9 && !is_flipped; ++turn) {
        const std::uint32_t a = t[i + turn % 3], b = t[i + (turn + 1) % 3], c = t[i + (turn + 2) % 3];
        const std::size_t o = turn / 3;
        const std::uint32_t d = t[j + (o + 2) % 3];
        if (t[j + o] != b || t[j + (o + 1) % 3] != a) continue;
        if (orientation(p[a], p[d], p[c]) <= 0 || orientation(p[d], p[b], p[c]) <= 0) continue;
        const std::array<std::uint32_t, 6> fresh{a, d, c, d, b, c};
        std::copy_n(fresh.begin(), 3, t.begin() + static_cast<std::ptrdiff_t>(i));
        std::copy_n(fresh.begin() + 3, 3, t.begin() + static_cast<std::ptrdiff_t>(j));
        is_flipped = true;
      }
  ASSERT_TRUE(is_flipped);
  // Boxes of one run stay what they are: the file has fewer than 1024 triangles.
  ASSERT_LT(t.size(), std::size_t{3} * kRunTriangles);
  forge_fingerprints(bad, index_facts(cut_, whole_));
  const auto problems = expect_problem("has order");
  for (const std::string& text : problems)
    EXPECT_TRUE(text.find("has order") != std::string::npos || text.find("pit") != std::string::npos) << text;
}

TEST_F(PlantedFault, MissingTriangleLeavesAHole) {
  TerrainArrays bad = good_;
  bad.u32["triangle"].resize(bad.u32["triangle"].size() - 3);
  write_arrays(bad, path_);
  write_index(cut_, index_facts(cut_, whole_));  // which then counts one triangle less
  const auto problems = expect_problem("no triangle on its other side", "tile_");
  EXPECT_GE(problems.size(), 3U);
}

TEST_F(PlantedFault, OverlapOfAWholeFileIsFound) {
  // Tile 0 holds all of its triangles twice over: as its own and once more.
  TerrainArrays bad = good_;
  auto& t = bad.u32["triangle"];
  const std::vector<std::uint32_t> once = t;
  t.insert(t.end(), once.begin(), once.end());
  bad.i32["triangle_box"] = good_.i32["triangle_box"];
  write_arrays(bad, path_);
  write_index(cut_, index_facts(cut_, whole_));
  expect_problem("one side");
}

TEST_F(PlantedFault, PitsAreFound) {
  const testing::TemporaryFolder folder;
  PipelineOptions options = options_in(folder);
  options.pits.method = PitMethod::none;
  const CutTerrain cut = make_dataset(whole_, options, 12, 3);
  ASSERT_TRUE(check_dataset(options.output.dir).ok);
  const auto expected = index_facts(cut, whole_).pits;
  ASSERT_GT(expected, 25);
  for (std::uint32_t t = 0; t < cut.owned.size(); ++t) {
    TerrainArrays arrays = read_arrays(cut.context.layout.terrain(t));
    arrays.number["pits_removed"] = 1;
    write_arrays(arrays, cut.context.layout.terrain(t));
  }
  IndexFacts facts = index_facts(cut, whole_);
  facts.outlets = "hull";
  write_index(cut, facts);
  const DatasetSummary summary = check_dataset(options.output.dir);
  EXPECT_FALSE(summary.ok);
  EXPECT_EQ(summary.pits, static_cast<std::uint64_t>(expected));
  ASSERT_EQ(summary.problems.size(), 21U);
  EXPECT_NE(summary.problems.front().find("a pit of "), std::string::npos);
  EXPECT_NE(summary.problems.back().find(std::to_string(expected - 20) + " more"), std::string::npos);
}

TEST_F(PlantedFault, FewPitsAreFound) {
  // Raise all neighbours of a vertex in all files that have them: the vertex is a pit, and maybe others around.
  const auto graph = whole_.graph();
  std::vector<TerrainArrays> files;
  for (std::uint32_t t = 0; t < cut_.owned.size(); ++t) files.push_back(read_arrays(cut_.context.layout.terrain(t)));
  std::uint32_t bottom = 0;
  const auto on_hull = [&](std::uint32_t v) { return whole_.on_hull[v] != 0; };
  const auto near_hull = [&](std::uint32_t v) {
    return on_hull(v) || std::any_of(graph.neighbors(v).begin(), graph.neighbors(v).end(), on_hull);
  };
  while (near_hull(bottom)) ++bottom;
  auto height = lift(graph, whole_.height, whole_.on_hull);
  for (const std::uint32_t w : graph.neighbors(bottom)) {
    height[w] = 900;
    for (std::uint32_t t = 0; t < files.size(); ++t) {
      const PointId id = cut_.id[w];
      if (id.tile() == t && files[t].i32["height"][id.index()] != kUnusedHeight)
        files[t].i32["height"][id.index()] = 900;
      const auto& foreign = files[t].u64["foreign_point"];
      const auto at = std::find(foreign.begin(), foreign.end(), id.value);
      if (at != foreign.end()) files[t].i32["foreign_height"][static_cast<std::size_t>(at - foreign.begin())] = 900;
    }
  }
  for (std::uint32_t t = 0; t < files.size(); ++t) write_arrays(files[t], cut_.context.layout.terrain(t));
  expect_problem("a pit of 1 vertices is left", "tile_");
  EXPECT_EQ(check().pits, count_pits(graph, height, whole_.on_hull));
}

TEST_F(PlantedFault, WrongIndex) {
  const IndexFacts good = index_facts(cut_, whole_);
  IndexFacts facts = good;
  facts.fingerprint[7] = facts.fingerprint[7] == '0' ? '1' : '0';
  write_index(cut_, facts);
  expect_problem("fingerprint", "index.h5");
  facts = good;
  facts.pits = 3;
  write_index(cut_, facts);
  expect_problem("states 3 pits", "index.h5");
  facts = good;
  facts.outlets = "anywhere";
  write_index(cut_, facts);
  EXPECT_THROW(static_cast<void>(check()), Error);
  std::filesystem::remove(cut_.context.layout.index());
  EXPECT_THROW(static_cast<void>(check()), Error);
}

TEST_F(PlantedFault, MissingFileIsNamed) {
  std::filesystem::remove(path_);
  expect_problem("missing");
  std::ofstream(path_, std::ios::binary) << "not HDF5";
  expect_problem("not a readable HDF5 file");
}

// A flipped bit anywhere in the file is found, or it changed nothing that the file says.
TEST_F(PlantedFault, FlippedBits) {
  const std::string bytes = testing::bytes_of(path_);
  const DatasetSummary good = check();
  testing::Random random(5);
  int found = 0;
  constexpr int kFlips = 150;
  for (int i = 0; i < kFlips; ++i) {
    std::string bad = bytes;
    const std::size_t at = random.below(bad.size());
    bad[at] = static_cast<char>(bad[at] ^ (1 << random.below(8)));
    std::ofstream(path_, std::ios::binary) << bad;
    SCOPED_TRACE("byte " + std::to_string(at));
    DatasetSummary summary;
    ASSERT_NO_THROW(summary = check());
    found += summary.ok ? 0 : 1;
    if (summary.ok) {
      EXPECT_EQ(summary.fingerprint, good.fingerprint);
    }
  }
  // Most of so small a file is room that HDF5 keeps for more, where a flip means nothing.
  EXPECT_GT(found, kFlips / 5);
}

}  // namespace
}  // namespace hydrotin
