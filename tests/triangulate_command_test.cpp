#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "csv_text.h"
#include "hydrotin/mesh.h"
#include "program_call.h"

namespace hydrotin {
namespace {

using nlohmann::json;
using testing::call;
using testing::csv_of;
using testing::Outcome;
using testing::random_points;
using testing::read_text;
using testing::TemporaryFolder;
using testing::write_text;
using Triples = std::set<std::array<int, 3>>;
using Quadruples = std::set<std::array<int, 4>>;

/// Twice the signed area.
double area(const std::array<double, 3>& a, const std::array<double, 3>& b, const std::array<double, 3>& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// Points strictly inside the circumcircle, by distances; fit for random points only.
int order_of(const std::vector<std::array<double, 3>>& points, const std::array<int, 3>& t) {
  const auto &a = points[static_cast<std::size_t>(t[0])], &b = points[static_cast<std::size_t>(t[1])],
             &c = points[static_cast<std::size_t>(t[2])];
  const double bx = b[0] - a[0], by = b[1] - a[1], cx = c[0] - a[0], cy = c[1] - a[1], d = 2 * (bx * cy - by * cx);
  const double ux = (cy * (bx * bx + by * by) - by * (cx * cx + cy * cy)) / d;
  const double uy = (bx * (cx * cx + cy * cy) - cx * (bx * bx + by * by)) / d;
  int inside = 0;
  for (const auto& p : points)
    if (std::hypot(p[0] - a[0] - ux, p[1] - a[1] - uy) < std::hypot(ux, uy) - 1e-9) ++inside;
  return inside;
}

TEST(App, Triangulate_Order0_IsDelaunay) {
  const TemporaryFolder folder;
  for (std::uint32_t seed = 0; seed < 5; ++seed) {
    SCOPED_TRACE(seed);
    const auto points = random_points(seed, 60);
    write_text(folder / "p.csv", csv_of(points));
    const Outcome outcome = call(folder, "triangulate p.csv --order 0 --objective delaunay --json --out t.ply");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json result = json::parse(outcome.out);
    std::set<std::array<int, 3>> expected;
    for (int a = 0; a < 60; ++a)
      for (int b = a + 1; b < 60; ++b)
        for (int c = b + 1; c < 60; ++c)
          if (order_of(points, {a, b, c}) == 0) expected.insert({a, b, c});
    EXPECT_EQ(result.at("triangles").get<Triples>(), expected);
    EXPECT_EQ(result.at("max_triangle_order"), 0);
    EXPECT_EQ(result.at("points"), 60);
    const Mesh mesh = read_mesh(folder / "t.ply");
    EXPECT_EQ(mesh.vertex.size(), 60U);
    EXPECT_EQ(mesh.triangle.size(), expected.size());
    for (std::size_t v = 0; v < 60; ++v)
      for (std::size_t axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(mesh.vertex[v][axis], points[v][axis], 1e-9) << "vertex i is row i";
    Triples written;
    for (const auto& t : mesh.triangle) {
      std::array<int, 3> rows{static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])};
      std::sort(rows.begin(), rows.end());
      written.insert(rows);
    }
    EXPECT_EQ(written, expected);
  }
}

TEST(App, Triangulate_KeepsItsOrderAndBounds) {
  const TemporaryFolder folder;
  const auto points = random_points(11, 400);
  write_text(folder / "p.csv", csv_of(points));
  std::map<std::pair<std::string, int>, double> values;
  for (const std::string objective : {"min-weight", "local-minima"})
    for (int order = 0; order <= 4; order += 2) {
      SCOPED_TRACE(objective + " " + std::to_string(order));
      const Outcome outcome =
          call(folder, "triangulate p.csv --order " + std::to_string(order) + " --objective " + objective + " --json");
      ASSERT_EQ(outcome.code, 0) << outcome.err;
      const json result = json::parse(outcome.out);
      int most = 0;
      double total = 0;
      std::map<std::pair<int, int>, int> edges;
      for (const auto& triangle : result.at("triangles").get<std::vector<std::array<int, 3>>>()) {
        most = std::max(most, order_of(points, triangle));
        total +=
            std::abs(area(points[static_cast<std::size_t>(triangle[0])], points[static_cast<std::size_t>(triangle[1])],
                          points[static_cast<std::size_t>(triangle[2])]));
        for (const auto& [a, b] : {std::pair{0, 1}, {1, 2}, {0, 2}})
          ++edges[{triangle[static_cast<std::size_t>(a)], triangle[static_cast<std::size_t>(b)]}];
      }
      EXPECT_LE(most, order);
      EXPECT_EQ(result.at("max_triangle_order"), most);
      static double hull = 0;
      if (order == 0) hull = total;
      EXPECT_NEAR(total, hull, 1e-6) << "the same hull is covered";
      const double value = result.at("value"), bound = result.at("bound");
      EXPECT_LE(bound, value + 1e-9);
      if (order > 0) {
        EXPECT_LE(value, (values[{objective, order - 2}]) + 1e-9) << "more freedom is never worse";
      }
      values[{objective, order}] = value;
      if (objective == "min-weight") {
        double length = 0;
        for (const auto& [edge, count] : edges) {
          const auto &a = points[static_cast<std::size_t>(edge.first)],
                     &b = points[static_cast<std::size_t>(edge.second)];
          length += std::hypot(a[0] - b[0], a[1] - b[1]);
        }
        EXPECT_NEAR(value, length, 1e-6);
      } else {
        EXPECT_EQ(result.at("local_minima").get<double>(), value);
      }
    }
}

TEST(App, Triangulate_RefusesWhatItCannotDo) {
  const TemporaryFolder folder;
  write_text(folder / "p.csv", "x,y,z\n0,0,1\n1,0,1\n0,1,1\n");
  for (const char* arguments : {"--order 21", "--order -1", "--objective best", "--order two"})
    EXPECT_EQ(call(folder, "triangulate p.csv " + std::string(arguments)).code, 2) << arguments;
  EXPECT_EQ(call(folder, "triangulate p.csv").code, 0);
}

TEST(App, Triangulate_PolygonsAndReferencesAreChecked) {
  const TemporaryFolder folder;
  write_text(folder / "p.csv", "x,y,z\n0,0,5\n10,0,4\n10,10,3\n0,10,1\n5,4,2\n");
  write_text(folder / "comb.csv", "x,y,z\n6,5,0\n19,5,0\n16,15,0\n14,14,0\n16,18,0\n14,17,0\n3,14,0\n");
  write_text(folder / "bow.csv", "x,y,z\n0,0,0\n4,4,0\n4,0,0\n0,4,0\n");
  write_text(folder / "e.csv", "a,b\n0,4\n");
  write_text(folder / "bad.csv", "a,b\n0,9\n");
  write_text(folder / "r.csv", "x,y,z\n5.5,2,3.25\n90,90,1\n0,0,7\n");
  const auto code = [&](const std::string& arguments) { return call(folder, "triangulate " + arguments).code; };
  const auto says = [&](const std::string& arguments, const std::string& what) {
    const Outcome outcome = call(folder, "triangulate " + arguments);
    EXPECT_NE(outcome.code, 0) << arguments;
    EXPECT_NE(outcome.err.find(what), std::string::npos) << outcome.err;
  };
  for (const char* arguments :
       {"p.csv --edges e.csv", "p.csv --boundary 4", "p.csv --objective min-max-error", "p.csv --max-error 1",
        "p.csv --objective min-weight,min-weight", "p.csv --objective delaunay,min-weight", "p.csv --method best",
        "p.csv --method hull --objective min-weight", "p.csv --reference r.csv --max-error -1",
        "p.csv --polygon --boundary 9", "p.csv --polygon --order -1"})
    EXPECT_EQ(code(arguments), 2) << arguments;
  EXPECT_EQ(code("bow.csv --polygon"), 3);
  EXPECT_EQ(code("p.csv --polygon --boundary 4 --edges bad.csv"), 3);
  EXPECT_EQ(code("p.csv --polygon --boundary 4 --edges e.csv"), 0);
  says("comb.csv --polygon --order 0", "the smallest order that has one is 1");
  says("bow.csv --polygon", "bow.csv: the edges (");
  says("p.csv --polygon --boundary 4 --edges bad.csv", "bad.csv:2:");
  const auto printed = nlohmann::json::parse(
      call(folder, "triangulate p.csv --order 2 --objective min-max-error,min-weight --reference r.csv --json").out);
  EXPECT_EQ(printed["objective"], "min-max-error,min-weight");
  EXPECT_EQ(printed["values"].size(), 2U);
  EXPECT_EQ(printed["reference"]["points"], 3);
  EXPECT_EQ(printed["reference"]["outside"], 1);
  EXPECT_EQ(printed["reference"]["at_vertices"], 1);
  EXPECT_EQ(printed["reference"]["max_error"], 2.0) << "the point at the corner is two above it";
  const auto polygon = nlohmann::json::parse(
      call(folder, "triangulate p.csv --polygon --boundary 4 --order 3 --objective max-min-angle --json").out);
  EXPECT_EQ(polygon["triangles"].size(), 4U);
  EXPECT_EQ(polygon["local_minima"], 1);
}

TEST(App, Orders_AreThoseOfTheDefinition) {
  const TemporaryFolder folder;
  auto points = random_points(3, 40);
  points.push_back(points[5]);  // a duplicate, not lower
  write_text(folder / "p.csv", csv_of(points));
  points.pop_back();
  const Outcome outcome = call(folder, "orders p.csv --order 3 --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const json result = json::parse(outcome.out);
  EXPECT_EQ(result.at("points"), 41);
  EXPECT_EQ(result.at("duplicates"), json::parse("[[40, 5]]"));
  std::set<std::pair<int, int>> useful;
  for (const auto& edge : result.at("useful_edges").get<std::vector<std::array<int, 3>>>())
    useful.insert({edge[0], edge[1]});
  std::set<std::array<int, 4>> expected;
  for (int a = 0; a < 40; ++a)
    for (int b = a + 1; b < 40; ++b)
      for (int c = b + 1; c < 40; ++c) {
        const int order = order_of(points, {a, b, c});
        if (order > 3 || !useful.contains({a, b}) || !useful.contains({b, c}) || !useful.contains({a, c})) continue;
        bool is_empty = true;
        for (int p = 0; p < 40 && is_empty; ++p) {
          if (p == a || p == b || p == c) continue;
          const auto at = [&](int i) { return points[static_cast<std::size_t>(i)]; };
          const bool left = area(at(a), at(b), at(p)) > 0, middle = area(at(b), at(c), at(p)) > 0,
                     right = area(at(c), at(a), at(p)) > 0;
          is_empty = !(left == middle && middle == right);
        }
        if (is_empty) expected.insert({a, b, c, order});
      }
  EXPECT_EQ(result.at("order_k_triangles").get<Quadruples>(), expected);
  std::size_t size = 0;
  for (const json& polygon : result.at("polygons")) size += polygon.at("size").get<std::size_t>();
  EXPECT_EQ(size, result.at("delaunay_triangles").size());
}
// The TIN passes every row that is no vertex within the limit, by the definition of a plane.
TEST(TriangulateCommand, Thin_KeepsAllRowsWithinTheLimit) {
  const TemporaryFolder folder;
  std::string csv = "x,y,z\n";
  std::vector<std::array<double, 3>> row;
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j) {
      const double z = std::round(100 * (3 * std::sin(i * 0.21) + 2 * std::cos(j * 0.17) + 0.05 * (i * 7 % 5))) / 100;
      row.push_back({1000.0 + i, 2000.0 + j, z});
      csv += std::to_string(1000 + i) + "," + std::to_string(2000 + j) + "," + std::to_string(z) + "\n";
    }
  write_text(folder / "p.csv", csv);
  for (const std::string order : {"0", "3"}) {
    const Outcome outcome = call(folder, "triangulate p.csv --json --thin 0.25 --thin-cell 6 --order " + order);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json got = json::parse(outcome.out);
    const json& thinning = got.at("thinning");
    EXPECT_EQ(thinning.at("kept").get<int>() + thinning.at("removed").get<int>(), 1600);
    EXPECT_GT(thinning.at("removed"), 800);
    EXPECT_EQ(got.at("reference").at("points"), thinning.at("removed"));
    double worst = 0;
    for (const auto& p : row) {
      double error = 1e9;
      for (const auto& t : got.at("triangles")) {
        const auto &a = row[t[0].get<std::size_t>()], &b = row[t[1].get<std::size_t>()],
                   &c = row[t[2].get<std::size_t>()];
        const auto area = [](const auto& u, const auto& v, const auto& w) {
          return (v[0] - u[0]) * (w[1] - u[1]) - (v[1] - u[1]) * (w[0] - u[0]);
        };
        const double all = area(a, b, c), at_a = area(p, b, c) / all, at_b = area(a, p, c) / all,
                     at_c = area(a, b, p) / all;
        if (std::min({at_a, at_b, at_c}) < 0) continue;
        error = std::min(error, std::abs(at_a * a[2] + at_b * b[2] + at_c * c[2] - p[2]));
      }
      worst = std::max(worst, error);
    }
    EXPECT_LE(worst, 0.25 + 1e-9);
    EXPECT_NEAR(worst, thinning.at("max_error"), 1e-9);
  }
  EXPECT_EQ(call(folder, "triangulate p.csv --thin -1").code, 2);
  EXPECT_EQ(call(folder, "triangulate p.csv --thin-cell 3").code, 2);
  EXPECT_EQ(call(folder, "triangulate p.csv --thin 0.1 --method hull").code, 2);
  EXPECT_EQ(call(folder, "triangulate p.csv --thin 0.1 --polygon").code, 2);
}

}  // namespace
}  // namespace hydrotin
