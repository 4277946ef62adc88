#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "clouds.h"
#include "hydrotin/error.h"
#include "hydrotin/hilbert.h"
#include "hydrotin/las.h"
#include "hydrotin/subdivision.h"
#include "thesis_tables_ch3.h"

// Section 3.4 of the thesis: how the fixed edges cut random and real point sets into polygons.

namespace hydrotin {
namespace {

using Points = std::vector<LatticePoint>;
using thesis::AverageAndMost;

void sort_along_curve(Points& points) {
  std::sort(points.begin(), points.end(),
            [](LatticePoint a, LatticePoint b) { return hilbert_key(a) < hilbert_key(b); });
  points.erase(std::unique(points.begin(), points.end()), points.end());
}

// One point set at all orders.
struct Structure {
  std::array<AverageAndMost, thesis::kOrders> components{}, size{};
};

struct Cut {
  Triangulation triangulation;
  std::vector<std::uint8_t> crossed;
  Subdivision subdivision;
};

Cut cut(const Points& points, int k) {
  Cut out{delaunay(points), {}, {}};
  const TriangulationView tri = out.triangulation.view();
  const VertexLinks links = vertex_links(tri);
  out.crossed = find_crossings(tri, useful_edges(tri, links, k)).crossed;
  out.subdivision = subdivide(tri, out.crossed);
  return out;
}

Structure measure(const Points& points) {
  Structure out;
  for (int k = 1; k <= thesis::kOrders; ++k) {
    const Subdivision polygons = cut(points, k).subdivision;
    auto &components = out.components[static_cast<std::size_t>(k - 1)],
         &size = out.size[static_cast<std::size_t>(k - 1)];
    for (std::uint32_t f = 0; f < polygons.size(); ++f) {
      components.average += polygons.components[f];
      components.most = std::max<double>(components.most, polygons.components[f]);
      size.average += polygons.begin[f + 1] - polygons.begin[f];
      size.most = std::max<double>(size.most, polygons.begin[f + 1] - polygons.begin[f]);
    }
    components.average /= std::max(1U, polygons.size());
    size.average /= std::max(1U, polygons.size());
  }
  return out;
}

// Means over all sets, in their order, whichever thread measured them.
Structure mean_over(std::size_t count, unsigned workers, const std::function<Points(std::size_t)>& make) {
  std::vector<Structure> runs(count);
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) runs[i] = measure(make(i));
  };
  std::vector<std::thread> threads;
  for (unsigned w = 1; w < workers; ++w) threads.emplace_back(work);
  work();
  for (auto& thread : threads) thread.join();
  Structure mean;
  for (const Structure& run : runs)
    for (std::size_t k = 0; k < thesis::kOrders; ++k) {
      mean.components[k].average += run.components[k].average / static_cast<double>(count);
      mean.components[k].most += run.components[k].most / static_cast<double>(count);
      mean.size[k].average += run.size[k].average / static_cast<double>(count);
      mean.size[k].most += run.size[k].most / static_cast<double>(count);
    }
  return mean;
}

void print_row(const char* what, int n, int k, AverageAndMost measured, const AverageAndMost* printed) {
  std::printf("%-10s %5d %3d  %9.2f %9.2f", what, n, k, measured.average, measured.most);
  if (printed != nullptr) {
    std::printf("   %9.2f %9.2f", printed->average, printed->most);
    if (printed->average > 0.1) std::printf("   %+6.1f %%", 100 * (measured.average / printed->average - 1));
    if (printed->average <= 0.1) std::printf("   %8s", "");
    if (printed->most > 0.1) std::printf(" %+6.1f %%", 100 * (measured.most / printed->most - 1));
  }
  std::printf("\n");
}

void print_tables(const std::vector<int>& sizes, const std::vector<Structure>& measured, bool beside_thesis) {
  for (const bool components : {true, false}) {
    std::printf("\n%s\n%-10s %5s %3s  %9s %9s",
                components ? "Table 3.1: components per polygon" : "Table 3.2: Delaunay triangles per polygon", "", "n",
                "k", "average", "largest");
    if (beside_thesis) std::printf("   %9s %9s   %8s %8s", "thesis", "thesis", "average", "largest");
    std::printf("\n");
    for (std::size_t s = 0; s < sizes.size(); ++s)
      for (std::size_t k = 0; k < thesis::kOrders; ++k) {
        const auto column = std::find(thesis::kSizes.begin(), thesis::kSizes.end(), sizes[s]) - thesis::kSizes.begin();
        const auto& table = components ? thesis::kComponents : thesis::kPolygonSizes;
        print_row("", sizes[s], static_cast<int>(k) + 1, components ? measured[s].components[k] : measured[s].size[k],
                  beside_thesis ? &table[k][static_cast<std::size_t>(column)] : nullptr);
      }
  }
}

// Square-ish parts of about n points each: halved at the median of the longer side.
void halve(Points points, std::size_t n, std::vector<Points>& parts) {
  if (points.size() < 3 * n / 2) {
    if (points.size() > n / 2) parts.push_back(std::move(points));
    return;
  }
  LatticeBox box;
  for (const LatticePoint p : points) box.extend(p);
  const bool by_x = std::int64_t{box.max.x} - box.min.x > std::int64_t{box.max.y} - box.min.y;
  const auto middle = points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2);
  std::nth_element(points.begin(), middle, points.end(), [&](LatticePoint a, LatticePoint b) {
    return by_x ? std::pair{a.x, a.y} < std::pair{b.x, b.y} : std::pair{a.y, a.x} < std::pair{b.y, b.x};
  });
  halve(Points(points.begin(), middle), n, parts);
  halve(Points(middle, points.end()), n, parts);
}

Points read_ground(const std::string& path) {
  const LasFile file(path);
  Points out;
  PointBatch batch;
  for (std::size_t c = 0; c < file.num_chunks(); ++c) {
    file.decode(c, batch, {.classification = true, .flags = true});
    for (std::size_t i = 0; i < batch.size(); ++i)
      if (batch.classification[i] == 2 && (batch.flags[i] & PointFlag::withheld) == 0)
        out.push_back({batch.x[i], batch.y[i]});
  }
  sort_along_curve(out);
  return out;
}

// Fixed edges of one set, the polygon with most components filled; like Figure 3.6.
void draw(std::ofstream& svg, const Points& points, int k, double left, double side) {
  const Cut c = cut(points, k);
  const TriangulationView tri = c.triangulation.view();
  LatticeBox box;
  for (const LatticePoint p : points) box.extend(p);
  const double extent =
      std::max(static_cast<double>(box.max.x) - box.min.x, static_cast<double>(box.max.y) - box.min.y);
  const auto x = [&](LatticePoint p) { return left + (static_cast<double>(p.x) - box.min.x) / extent * side; };
  const auto y = [&](LatticePoint p) { return 30 + side - (static_cast<double>(p.y) - box.min.y) / extent * side; };
  std::uint32_t most = 0;
  for (std::uint32_t f = 0; f < c.subdivision.size(); ++f)
    if (c.subdivision.components[f] > c.subdivision.components[most]) most = f;
  svg << "<text x='" << left << "' y='20'>k = " << k << ": " << c.subdivision.components[most] << " components in "
      << c.subdivision.begin[most + 1] - c.subdivision.begin[most] << " triangles</text>\n<path fill='#f4c542' d='";
  for (const TriangleId t : c.subdivision.triangles_of(most)) {
    const HalfedgeId h = first_halfedge(t);
    const LatticePoint p = tri.position[tri.origin[h]], q = tri.position[tri.target(h)], r = tri.position[tri.apex(h)];
    svg << 'M' << x(p) << ' ' << y(p) << 'L' << x(q) << ' ' << y(q) << ' ' << x(r) << ' ' << y(r) << 'Z';
  }
  svg << "'/>\n<path fill='none' stroke='#333' stroke-width='0.6' d='";
  for (HalfedgeId h{0}; h.value < tri.origin.size(); ++h.value) {
    if (c.crossed[h.value] || (!tri.twin[h].is_none() && tri.twin[h] < h)) continue;
    const LatticePoint p = tri.position[tri.origin[h]], q = tri.position[tri.target(h)];
    svg << 'M' << x(p) << ' ' << y(p) << 'L' << x(q) << ' ' << y(q);
  }
  svg << "'/>\n";
}

void draw_figure(const std::string& path, const Points& points) {
  constexpr double kSide = 420;
  const std::string temporary = path + ".part";
  {
    std::ofstream svg(temporary);
    svg.precision(6);
    svg << "<svg xmlns='http://www.w3.org/2000/svg' width='" << 4 * (kSide + 20) << "' height='" << kSide + 40
        << "' font-family='sans-serif' font-size='14'>\n<rect width='100%' height='100%' fill='white'/>\n";
    for (int i = 0; i < 4; ++i) draw(svg, points, 5 + i, 10 + i * (kSide + 20), kSide);
    svg << "</svg>\n";
    if (!svg.flush()) throw Error(ErrorKind::storage, path + ": cannot be written (is there room?)");
  }
  std::filesystem::rename(temporary, path);
}

struct Arguments {
  std::vector<std::string> clouds;
  std::string figures = ".";
  std::size_t runs = 200;
  unsigned workers = std::max(1U, std::thread::hardware_concurrency());
};

void random_sets(const Arguments& arguments) {
  std::printf("Random points, %zu runs: means of the averages over polygons of each run, and of its largest polygon.\n",
              arguments.runs);
  std::vector<Structure> measured;
  const auto make = [](std::size_t seed, int n) {
    Points points = testing::random_points(seed, static_cast<std::size_t>(n), 1 << 26);
    sort_along_curve(points);
    return points;
  };
  for (const int n : thesis::kSizes) {
    std::fprintf(stderr, "random points: n = %d\n", n);
    measured.push_back(mean_over(arguments.runs, arguments.workers,
                                 [&](std::size_t i) { return make(i + static_cast<std::size_t>(n) * 1000, n); }));
  }
  print_tables({thesis::kSizes.begin(), thesis::kSizes.end()}, measured, true);
  draw_figure(arguments.figures + "/fixed-edges-random.svg", make(1, 1000));
}

void real_sets(const Arguments& arguments, const std::string& path) {
  const Points cloud = read_ground(path);
  const std::string name = std::filesystem::path(path).stem().string();
  std::printf("\n%s: %zu ground points, in parts of about n\n", name.c_str(), cloud.size());
  std::vector<int> sizes;
  std::vector<Structure> measured;
  std::optional<Points> shown;
  for (const int n : thesis::kSizes) {
    std::vector<Points> parts;
    halve(cloud, static_cast<std::size_t>(n), parts);
    if (parts.empty()) continue;
    if (parts.size() > arguments.runs) parts.resize(arguments.runs);
    std::fprintf(stderr, "%s: %zu parts of about %d points\n", name.c_str(), parts.size(), n);
    if (!shown) {
      shown = parts[parts.size() / 2];
      sort_along_curve(*shown);
    }
    sizes.push_back(n);
    measured.push_back(mean_over(parts.size(), arguments.workers, [&](std::size_t i) {
      sort_along_curve(parts[i]);
      return parts[i];
    }));
  }
  print_tables(sizes, measured, false);
  if (shown) draw_figure(arguments.figures + "/fixed-edges-" + name + ".svg", *shown);
}

}  // namespace
}  // namespace hydrotin

int main(int argc, char** argv) {
  hydrotin::Arguments arguments;
  CLI::App program("Tables 3.1 and 3.2 of the thesis, for random and for real point sets");
  program.add_option("clouds", arguments.clouds, "LAS or LAZ files, whose ground points are cut into parts");
  program.add_option("--runs", arguments.runs, "random sets, and parts of a cloud, per size")->capture_default_str();
  program.add_option("--workers", arguments.workers, "threads")->capture_default_str();
  program.add_option("--figures", arguments.figures, "folder for the figures (SVG)")->capture_default_str();
  CLI11_PARSE(program, argc, argv);
  try {
    std::filesystem::create_directories(arguments.figures);
    hydrotin::random_sets(arguments);
    for (const auto& path : arguments.clouds) hydrotin::real_sets(arguments, path);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "reproduce_ch3: %s\n", error.what());
    return 1;
  }
  return 0;
}
