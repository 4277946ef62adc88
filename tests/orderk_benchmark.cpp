#include <linux/perf_event.h>
#include <malloc.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <numeric>
#include <string>
#include <thread>
#include <vector>

#include "clouds.h"
#include "hydrotin/hilbert.h"
#include "hydrotin/polygon_batch.h"
#include "hydrotin/synthetic.h"
#include "plain_delaunay.h"

// Time, instructions and memory of what follows the Delaunay triangulation, stage by stage, one thread. Clouds:
// `uniform`; `scanlines`, two strips whose lines grow with the cloud, as sqrt(n); `swaths`, lines of 250 m however
// large the cloud is, as an aircraft leaves them: with these and `uniform` n alone grows, with `scanlines` the polygons
// do as well.

namespace {

// Bytes in use and their peak, of everything that is allocated through new.
std::atomic<std::size_t> bytes_in_use = 0, bytes_at_peak = 0;

void* counted(std::size_t size) {
  void* p = std::malloc(size);
  if (!p) throw std::bad_alloc();
  const std::size_t now = bytes_in_use += malloc_usable_size(p);
  for (std::size_t peak = bytes_at_peak; now > peak && !bytes_at_peak.compare_exchange_weak(peak, now);) {
  }
  return p;
}

void discount(void* p) {
  if (p) bytes_in_use -= malloc_usable_size(p);
  std::free(p);
}

}  // namespace

void* operator new(std::size_t size) {
  return counted(size);
}
void* operator new[](std::size_t size) {
  return counted(size);
}
void operator delete(void* p) noexcept {
  discount(p);
}
void operator delete[](void* p) noexcept {
  discount(p);
}
void operator delete(void* p, std::size_t) noexcept {
  discount(p);
}
void operator delete[](void* p, std::size_t) noexcept {
  discount(p);
}

namespace hydrotin::testing {
namespace {

// Instructions of this thread in user mode; always 0 where the machine does not tell.
class InstructionCounter {
 public:
  InstructionCounter() {
    perf_event_attr what{};
    what.type = PERF_TYPE_HARDWARE;
    what.size = sizeof what;
    what.config = PERF_COUNT_HW_INSTRUCTIONS;
    what.exclude_kernel = 1;
    what.exclude_hv = 1;
    file_ = static_cast<int>(syscall(SYS_perf_event_open, &what, 0, -1, -1, 0));
  }
  ~InstructionCounter() {
    if (file_ >= 0) close(file_);
  }
  InstructionCounter(const InstructionCounter&) = delete;
  InstructionCounter& operator=(const InstructionCounter&) = delete;

  [[nodiscard]] double read() const {
    std::uint64_t count = 0;
    if (file_ < 0 || ::read(file_, &count, sizeof count) != sizeof count) return 0;
    return static_cast<double>(count);
  }

 private:
  int file_ = -1;
};

struct Cost {
  double seconds = 0, instructions = 0;
};

// Stops stages one after the other.
class Laps {
 public:
  Cost lap() {
    const auto now = std::chrono::steady_clock::now();
    const double count = counter_.read();
    const Cost cost{std::chrono::duration<double>(now - time_).count(), count - count_};
    count_ = counter_.read();
    time_ = std::chrono::steady_clock::now();
    return cost;
  }

 private:
  InstructionCounter counter_;
  std::chrono::steady_clock::time_point time_ = std::chrono::steady_clock::now();
  double count_ = counter_.read();
};

struct Cloud {
  std::vector<LatticePoint> position;
  std::vector<std::int32_t> height;
};

constexpr const char* kSwaths = "swaths";

std::vector<LatticePoint> swath_points(std::size_t n) {
  SyntheticOptions options;
  options.kind = SyntheticKind::scanline;
  options.num_points = n;
  const SyntheticTerrain terrain(options);
  std::vector<LatticePoint> position;
  position.reserve(n + n / 8);
  terrain.points_in(terrain.box(), [&](std::span<const SyntheticPoint> batch) {
    for (const SyntheticPoint& point : batch) position.push_back({point.x, point.y});
  });
  const LatticePoint corner = terrain.box().min;
  for (LatticePoint& p : position) p = {p.x - corner.x, p.y - corner.y};
  return position;
}

Cloud make(const std::string& name, std::size_t n) {
  Cloud cloud;
  for (const CloudKind kind : {CloudKind::uniform, CloudKind::scanlines})
    if (name == name_of(kind)) cloud.position = distinct(make_cloud(kind, 1, n, 300));
  if (name == kSwaths) cloud.position = distinct(swath_points(n));
  std::vector<std::pair<std::uint64_t, LatticePoint>> order;
  for (const LatticePoint p : cloud.position) order.emplace_back(hilbert_key(p), p);
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < order.size(); ++i) cloud.position[i] = order[i].second;
  cloud.height = relief_heights(1, cloud.position, 100000, 30000, 20);
  return cloud;
}

double plain_seconds(const Cloud& cloud) {
  std::vector<PlainPoint> plain;
  for (const LatticePoint p : cloud.position) plain.push_back({p.x, p.y});
  shuffle(1, plain);
  std::vector<double> seconds(3);
  for (double& s : seconds) s = seconds_of_plain_delaunay(plain);
  std::sort(seconds.begin(), seconds.end());
  return seconds[1];
}

struct Report {
  std::vector<std::pair<const char*, Cost>> stages;
  double bytes = 0;
  std::uint32_t edges = 0, triangles = 0, polygons = 0, solved = 0;
  std::uint64_t checksum = 0;  // of the answer, in its order
};

std::uint64_t checksum_of(std::span<const std::array<VertexId, 3>> triangles) {
  std::uint64_t sum = 0xcbf29ce484222325U;
  for (const auto& t : triangles)
    for (const VertexId v : t) sum = (sum ^ v.value) * 0x100000001b3U;
  return sum;
}

// Some threads that take parts as they come.
Executor on_threads(int num_workers) {
  return [num_workers](std::uint32_t count, const std::function<void(std::uint32_t)>& work) {
    std::atomic<std::uint32_t> following{0};
    const auto share = [&] {
      for (std::uint32_t i; (i = following++) < count;) work(i);
    };
    std::vector<std::thread> others;
    for (int i = 1; i < num_workers; ++i) others.emplace_back(share);
    share();
    for (std::thread& other : others) other.join();
  };
}

struct Tools {
  PolygonExtractor extractor;
  PolygonSolver solver;
};

Pool<Tools> tools_for(const PolygonSource& source) {
  return Pool<Tools>([&source] {
    return std::make_unique<Tools>(Tools{PolygonExtractor(source), PolygonSolver(PolygonOptions{})});
  });
}

// Polygons with components go apart: what they cost depends on how few or many there are.
void solve_plain(const PolygonSource& source, std::span<const std::uint8_t> to_solve, const UsefulEdges& edges,
                 const EdgesByPolygon& edges_of, const Executor& executor, std::span<std::array<VertexId, 3>> answer) {
  Pool<Tools> pool = tools_for(source);
  for_ranges(executor, source.subdivision.size(), 512, [&](std::uint32_t begin, std::uint32_t end) {
    const auto tools = pool.lend();
    solve_polygons(source, to_solve, edges, edges_of, begin, end, tools->extractor, tools->solver, answer);
  });
}

// One by one, the largest first: a few of them may hold most of the work.
void solve_hard(const PolygonSource& source, std::span<const std::uint8_t> to_solve, const UsefulEdges& edges,
                const EdgesByPolygon& edges_of, const Executor& executor, std::span<std::array<VertexId, 3>> answer) {
  std::vector<std::uint32_t> polygon;
  for (std::uint32_t f = 0; f < to_solve.size(); ++f)
    if (to_solve[f]) polygon.push_back(f);
  std::stable_sort(polygon.begin(), polygon.end(), [&](std::uint32_t f, std::uint32_t g) {
    return source.subdivision.triangles_of(f).size() > source.subdivision.triangles_of(g).size();
  });
  Pool<Tools> pool = tools_for(source);
  executor(static_cast<std::uint32_t>(polygon.size()), [&](std::uint32_t i) {
    const auto tools = pool.lend();
    const std::uint32_t f = polygon[i];
    solve_polygons(source, to_solve, edges, edges_of, f, f + 1, tools->extractor, tools->solver, answer);
  });
}

Report run(const TriangulationView& tri, const VertexLinks& links, std::span<const std::int32_t> height, int k,
           int num_workers) {
  Report report;
  const std::size_t before = bytes_in_use;
  bytes_at_peak = before;
  Laps laps;
  const auto done = [&](const char* stage) { report.stages.emplace_back(stage, laps.lap()); };
  const Executor executor = on_threads(num_workers);
  const UsefulEdges edges = useful_edges(tri, links, k, executor);
  done("edges");
  Crossings crossings = find_crossings(tri, edges, executor);
  done("crossings");
  const Subdivision subdivision = subdivide(tri, crossings.crossed, executor);
  done("subdivide");
  const MinimaAssignment assignment = assign_minima(tri, links, edges, crossings, height, executor);
  std::vector<HalfedgeId>().swap(crossings.exit);
  done("minima");
  auto to_solve =
      polygons_to_solve(tri, links, height, crossings, subdivision, Objective::local_minima, &assignment, executor);
  done("choose");
  const EdgesByPolygon polygon_edges = edges_by_polygon(subdivision, edges, to_solve);
  done("edge lists");
  const OrderKTriangles no_triangles;
  const PolygonCandidates no_candidates;
  const PolygonSource source{tri, height, crossings, subdivision, no_triangles, no_candidates, &assignment};
  std::vector<std::array<VertexId, 3>> answer(tri.num_triangles());
  std::vector<std::uint8_t> hard(subdivision.size());
  for (std::uint32_t f = 0; f < subdivision.size(); ++f)
    if (to_solve[f] && subdivision.components[f] > 0) std::swap(hard[f], to_solve[f]);
  solve_plain(source, to_solve, edges, polygon_edges, executor, answer);
  done("polygons");
  solve_hard(source, hard, edges, polygon_edges, executor, answer);
  done("components");
  report.solved = static_cast<std::uint32_t>(std::count(to_solve.begin(), to_solve.end(), 1) +
                                             std::count(hard.begin(), hard.end(), 1));
  report.bytes = static_cast<double>(bytes_at_peak - before);
  report.edges = edges.size();
  report.polygons = subdivision.size();
  report.checksum = checksum_of(answer);
  laps.lap();
  report.triangles = order_k_triangles(tri, edges).size();
  done("(all triangles)");
  return report;
}

// Without what was done for comparison only.
double total(const Report& report) {
  double sum = 0;
  for (const auto& [stage, cost] : report.stages)
    if (stage[0] != '(') sum += cost.seconds;
  return sum;
}

void measure(const std::string& name, std::size_t n, const std::vector<int>& orders, int repeats, int num_workers) {
  const Cloud cloud = make(name, n);
  n = cloud.position.size();
  const double plain = plain_seconds(cloud), per = 1e6 / static_cast<double>(n);
  const Triangulation owner = delaunay(cloud.position);
  const TriangulationView tri = owner.view();
  const VertexLinks links = vertex_links(tri);
  std::printf("%s, %zu points, B' %.3f us a vertex\n", name.c_str(), n, plain * per);
  for (const int k : orders) {
    std::vector<Report> reports;
    for (int i = 0; i < repeats; ++i) reports.push_back(run(tri, links, cloud.height, k, num_workers));
    std::sort(reports.begin(), reports.end(), [](const Report& a, const Report& b) { return total(a) < total(b); });
    const Report& r = reports[reports.size() / 2];
    double instructions = 0;
    for (const auto& [stage, cost] : r.stages)
      if (stage[0] != '(') instructions += cost.instructions;
    const double each = 1 / static_cast<double>(n);
    std::printf(
        "k %d: %.3f us a vertex, %.2f x B', %.0f instructions, %.1f bytes; edges %.3f triangles %.3f polygons %.3f, "
        "%.3f solved, answer %016llx\n",
        k, total(r) * per, total(r) / plain, instructions * each, r.bytes * each, r.edges * each, r.triangles * each,
        r.polygons * each, r.solved * each, static_cast<unsigned long long>(r.checksum));
    for (const auto& [stage, cost] : r.stages)
      std::printf("      %-15s %.3f us %6.0f instructions\n", stage, cost.seconds * per, cost.instructions * each);
  }
}

}  // namespace
}  // namespace hydrotin::testing

int main(int argc, char** argv) {
  using namespace hydrotin::testing;
  double n = 1e6;
  int repeats = 3, workers = 1;
  std::vector<int> orders{1, 2, 3, 4};
  std::vector<std::string> clouds{"uniform", "scanlines", "swaths"};
  for (int i = 1; i + 1 < argc; i += 2) {
    if (!std::strcmp(argv[i], "--points")) n = std::atof(argv[i + 1]);
    if (!std::strcmp(argv[i], "--repeats")) repeats = std::atoi(argv[i + 1]);
    if (!std::strcmp(argv[i], "--workers")) workers = std::atoi(argv[i + 1]);
    if (!std::strcmp(argv[i], "--order")) orders = {std::atoi(argv[i + 1])};
    if (!std::strcmp(argv[i], "--cloud"))
      std::erase_if(clouds, [&](const std::string& name) { return name != argv[i + 1]; });
  }
  for (const std::string& name : clouds) measure(name, static_cast<std::size_t>(n), orders, repeats, workers);
  return 0;
}
