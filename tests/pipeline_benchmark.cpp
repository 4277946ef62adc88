#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "hydrotin/las.h"
#include "plain_delaunay.h"

// The whole program against B' (plain_delaunay.h) on synthetic scan lines: LAS in, store, mesh, DEM, COG and hillshade
// out. Two sizes, N / 4 and N, show whether memory grows with the input. Run it from a release build:
//   cmake --preset release && cmake --build --preset release --target pipeline_benchmark &&
//   build/release/tests/pipeline_benchmark --points 20e6
//
// Points are made, triangulated plainly and run through the pipeline by one process each, so that the peak of resident
// memory is that of the pipeline alone.

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Arguments {
  double points = 20e6, target_points = 1e6;
  int order = 2, workers = 2;
  std::string dir, objective = "local-minima", memory = "4GiB";
  bool keep = false, json = false, only_full = false;
  std::string plain_delaunay_of;  // what the child process does
  std::uint64_t most_points = 0;
};

struct ChildResult {
  double seconds = 0, cpu_seconds = 0;
  std::uint64_t peak_bytes = 0;
};

/// Runs a program to its end; its standard output goes to `output` or nowhere, its talk to standard error only if it
/// fails.
ChildResult run_child(const std::vector<std::string>& command, const fs::path& output = "/dev/null") {
  std::vector<char*> argv;
  for (const std::string& word : command) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  const auto start = std::chrono::steady_clock::now();
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error(std::string("cannot start a process: ") + std::strerror(errno));
  if (child == 0) {
    const int out = open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (out < 0 || dup2(out, STDOUT_FILENO) < 0) _exit(127);
    execv(argv[0], argv.data());
    _exit(127);
  }
  int status = 0;
  rusage usage{};
  while (wait4(child, &status, 0, &usage) < 0)
    if (errno != EINTR) throw std::runtime_error(std::string("cannot wait for a process: ") + std::strerror(errno));
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw std::runtime_error(fmt::format("{} {} failed (status {})", command[0], command[1], status));
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return {std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
          seconds(usage.ru_utime) + seconds(usage.ru_stime), static_cast<std::uint64_t>(usage.ru_maxrss) * 1024};
}

std::vector<fs::path> las_files(const fs::path& dir) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(dir)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// In the child: B' of the points of a folder, the first `most` of them.
int plain_delaunay(const fs::path& dir, std::uint64_t most) {
  std::vector<hydrotin::testing::PlainPoint> points;
  points.reserve(most);
  hydrotin::PointBatch batch;
  for (const fs::path& path : las_files(dir)) {
    const hydrotin::LasFile file(path.string());
    for (std::size_t chunk = 0; chunk < file.num_chunks(); ++chunk) {
      file.decode(chunk, batch);
      for (std::size_t i = 0; i < batch.size() && points.size() < most; ++i) points.push_back({batch.x[i], batch.y[i]});
    }
  }
  const double seconds = hydrotin::testing::seconds_of_plain_delaunay(points);
  fmt::print("{}\n", Json{{"points", points.size()}, {"seconds", seconds}}.dump());
  return 0;
}

std::uint64_t available_bytes() {
  std::ifstream in("/proc/meminfo");
  for (std::string key; in >> key;) {
    std::uint64_t kibibytes = 0;
    if (key == "MemAvailable:" && in >> kibibytes) return kibibytes << 10;
    in.ignore(256, '\n');
  }
  return 0;
}

Json read_json(const fs::path& path) {
  std::ifstream in(path);
  return Json::parse(in);
}

/// Makes the points; returns how many there are.
std::uint64_t make_points(const fs::path& dir, double points) {
  constexpr double kPointsPerFile = 2e6;
  const long side = std::max(1L, std::lround(std::sqrt(points / kPointsPerFile)));
  run_child({HYDROTIN_PROGRAM, "synth", dir.string(), "--kind", "scanline", "--points", fmt::format("{:.0f}", points),
             "--tiles", fmt::format("{}x{}", side, side)});
  std::uint64_t count = 0;
  for (const fs::path& path : las_files(dir)) count += hydrotin::LasFile(path.string()).header().point_count;
  return count;
}

/// B' for all points where memory allows, else for 5 M of them.
Json measure_plain(const fs::path& points, const fs::path& dir, std::uint64_t num_points) {
  constexpr std::uint64_t kBytesPerPoint = 200, kFewer = 5'000'000;
  const bool fits = num_points * kBytesPerPoint < available_bytes();
  const std::uint64_t most = fits ? num_points : std::min(num_points, kFewer);
  run_child({fs::read_symlink("/proc/self/exe").string(), "--plain-delaunay-of", points.string(), "--most-points",
             std::to_string(most)},
            dir / "plain.json");
  Json plain = read_json(dir / "plain.json");
  const double rate = plain["points"].get<double>() / plain["seconds"].get<double>();
  plain["points_per_second"] = rate;
  plain["seconds_for_all"] = static_cast<double>(num_points) / rate;
  return plain;
}

/// The pipeline with everything that users open switched on.
Json measure_pipeline(const Arguments& arguments, const fs::path& points, const fs::path& dir) {
  const fs::path config = dir / "run.yaml";
  std::ofstream(config) << "input: {points: [\"" << points.string() << "/*.las\"]}\n"
                        << "output: {dir: " << (dir / "out").string()
                        << ", dem: {cell_m: 1.0, format: COG, hillshade: true}, mesh: [ply]}\n"
                        << "tiles: {target_points: " << fmt::format("{:.0f}", arguments.target_points) << "}\n"
                        << "triangulation: {order: " << arguments.order << ", objective: " << arguments.objective
                        << "}\n"
                        << "run: {workers: " << arguments.workers << ", memory: " << arguments.memory
                        << ", scratch: " << (dir / "work").string() << "}\n";
  const ChildResult child = run_child({HYDROTIN_PROGRAM, "run", config.string(), "--json"}, dir / "summary.json");
  Json phases = Json::object();
  std::ifstream events(dir / "work" / "events.jsonl");
  for (std::string line; std::getline(events, line);) {
    const Json event = Json::parse(line);
    if (event["event"] == "phase_ends") phases[event["phase"].get<std::string>()] = event["seconds"];
  }
  return {{"seconds", child.seconds},
          {"cpu_seconds", child.cpu_seconds},
          {"peak_bytes", child.peak_bytes},
          {"phases", phases},
          {"summary", read_json(dir / "summary.json")}};
}

Json measure(const Arguments& arguments, const fs::path& root, double points) {
  const fs::path dir = root / fmt::format("{:.0f}", points), las = dir / "points";
  fs::create_directories(dir);
  for (const char* old : {"points", "out", "work"}) fs::remove_all(dir / old);
  const std::uint64_t count = make_points(las, points);
  Json result{{"points", count}};
  result["plain"] = measure_plain(las, dir, count);
  result["pipeline"] = measure_pipeline(arguments, las, dir);
  result["ratio"] = result["pipeline"]["seconds"].get<double>() / result["plain"]["seconds_for_all"].get<double>();
  if (!arguments.keep) fs::remove_all(dir);
  return result;
}

void print_row(const std::string& label, const Json& results, const std::string& target, auto value) {
  fmt::print("{:<26}", label);
  for (const Json& result : results) fmt::print("{:>12}", value(result));
  fmt::print("   {}\n", target);
}

void print_table(const Json& results) {
  constexpr double kGigabyte = 1e9;
  const auto seconds = [](const Json& j) { return fmt::format("{:.1f} s", j.get<double>()); };
  print_row("points", results, "",
            [](const Json& r) { return fmt::format("{:.2f} M", r["points"].get<double>() / 1e6); });
  for (const auto& [phase, unused] : results.back()["pipeline"]["phases"].items())
    print_row("  " + phase, results, "", [&](const Json& r) { return seconds(r["pipeline"]["phases"][phase]); });
  print_row("pipeline", results, "", [&](const Json& r) { return seconds(r["pipeline"]["seconds"]); });
  print_row("  CPU time", results, "of all threads: on a busy machine, what it would take",
            [&](const Json& r) { return seconds(r["pipeline"]["cpu_seconds"]); });
  print_row("B'", results, "", [](const Json& r) {
    return fmt::format("{:.2f} M/s", r["plain"]["points_per_second"].get<double>() / 1e6);
  });
  const bool scaled = results.back()["plain"]["points"] != results.back()["points"];
  print_row("B' for all points", results, scaled ? "scaled from 5 M points: memory is short" : "",
            [&](const Json& r) { return seconds(r["plain"]["seconds_for_all"]); });
  print_row("pipeline / B'", results, "target: 6.00",
            [](const Json& r) { return fmt::format("{:.2f}", r["ratio"].get<double>()); });
  const auto peak = [](const Json& r) { return r["pipeline"]["peak_bytes"].get<double>(); };
  print_row("peak memory", results, "target: 1.50 GB",
            [&](const Json& r) { return fmt::format("{:.2f} GB", peak(r) / kGigabyte); });
  if (results.size() > 1)
    fmt::print("{:<26}{:>24}   target: +10 %\n", "growth of the peak",
               fmt::format("{:+.1f} %", 100 * (peak(results.back()) / peak(results.front()) - 1)));
}

int run(const Arguments& arguments) {
  if (!arguments.plain_delaunay_of.empty()) return plain_delaunay(arguments.plain_delaunay_of, arguments.most_points);
  std::string root = arguments.dir;
  if (root.empty()) {
    root = (fs::temp_directory_path() / "hydrotin-benchmark-XXXXXX").string();
    if (mkdtemp(root.data()) == nullptr) throw std::runtime_error(root + ": cannot make this folder");
  }
  Json results = Json::array();
  if (!arguments.only_full) results.push_back(measure(arguments, fs::absolute(root), arguments.points / 4));
  results.push_back(measure(arguments, fs::absolute(root), arguments.points));
  if (arguments.dir.empty() && !arguments.keep) fs::remove_all(root);
  if (arguments.keep) fmt::print(stderr, "kept: {}\n", root);
  if (arguments.json)
    fmt::print("{}\n", results.dump(2));
  else
    print_table(results);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App program("times the whole pipeline on synthetic scan lines against a plain Delaunay triangulation");
  program.add_option("--points", arguments.points, "points of the larger run")->capture_default_str();
  program.add_option("--target-points", arguments.target_points, "points per tile")->capture_default_str();
  program.add_option("--order", arguments.order, "order of the triangulation")->capture_default_str();
  program.add_option("--objective", arguments.objective, "its objective")->capture_default_str();
  program.add_option("--workers", arguments.workers, "threads")->capture_default_str();
  program.add_option("--memory", arguments.memory, "memory budget")->capture_default_str();
  program.add_option("--dir", arguments.dir, "folder for points and results, instead of a temporary one");
  program.add_flag("--keep", arguments.keep, "keep points and results");
  program.add_flag("--json", arguments.json, "print JSON");
  program.add_flag("--only-full", arguments.only_full, "leave out the run with a quarter of the points");
  program.add_option("--plain-delaunay-of", arguments.plain_delaunay_of)->group("");
  program.add_option("--most-points", arguments.most_points)->group("");
  CLI11_PARSE(program, argc, argv);
  try {
    return run(arguments);
  } catch (const std::exception& error) {
    fmt::print(stderr, "pipeline_benchmark: {}\n", error.what());
    return 1;
  }
}
