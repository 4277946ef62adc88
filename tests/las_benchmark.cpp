#include <benchmark/benchmark.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "hydrotin/las.h"
#include "plain_delaunay.h"

// Points decoded per second, from a file in the page cache: x, y, z, class and flags ("points"), or whole records. B'
// of a million points (plain_delaunay.h) is measured just before each file. Counters: plain_B' is it, at_B'_2M the rate
// as it would be where B' is 2 M points/s, times_one_thread the gain by threads. Run it from a release build:
//   cmake --preset release && cmake --build --preset release --target las_benchmark &&
//   build/release/tests/las_benchmark

namespace {

void decode_all(const hydrotin::LasFile& file, hydrotin::PointFields fields, int num_threads) {
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    hydrotin::PointBatch batch;
    for (std::size_t chunk = next++; chunk < file.num_chunks(); chunk = next++) {
      file.decode(chunk, batch, fields);
      benchmark::DoNotOptimize(batch.x.data());
    }
  };
  std::vector<std::thread> threads;
  for (int i = 1; i < num_threads; ++i) threads.emplace_back(work);
  work();
  for (auto& thread : threads) thread.join();
}

// B' before the first benchmark of a file; points per second of one thread.
struct Yardstick {
  double plain = 0, one_thread = 0;
};

Yardstick& yardstick(const std::string& path) {
  static std::map<std::string, Yardstick> known;
  Yardstick& y = known[path];
  if (y.plain == 0) y.plain = hydrotin::testing::plain_delaunay_rate();
  return y;
}

void points(benchmark::State& state, const std::string& path) {
  if (!std::filesystem::exists(path)) {
    state.SkipWithError("no ../shared");
    return;
  }
  const hydrotin::LasFile file(path);
  const auto num_threads = static_cast<int>(state.range(0));
  Yardstick& y = yardstick(path);
  const auto start = std::chrono::steady_clock::now();
  for (auto _ : state) decode_all(file, {}, num_threads);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const double decoded = static_cast<double>(state.iterations()) * static_cast<double>(file.header().point_count);
  const double rate = decoded / seconds;
  if (num_threads == 1) y.one_thread = rate;
  state.SetItemsProcessed(static_cast<std::int64_t>(decoded));
  state.counters["plain_B'"] = y.plain;
  state.counters["at_B'_2M"] = rate * 2e6 / y.plain;
  if (y.one_thread > 0) state.counters["times_one_thread"] = rate / y.one_thread;
}

void records(benchmark::State& state, const std::string& path) {
  if (!std::filesystem::exists(path)) {
    state.SkipWithError("no ../shared");
    return;
  }
  const hydrotin::LasFile file(path);
  std::vector<std::byte> chunk;
  for (auto _ : state)
    for (std::size_t i = 0; i < file.num_chunks(); ++i) file.decode_records(i, chunk);
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * file.header().point_count));
}

}  // namespace

int main(int argc, char** argv) {
  const std::string data = std::string(HYDROTIN_SHARED) + "/data/";
  struct Case {
    const char* name;
    const char* file;
  };
  for (const Case& c : {Case{"format_1_pointwise", "tiles_bcts/bcts_3.laz"},
                        Case{"format_0_pointwise", "tiles_farm_a_normalised/PRJ_A_207340_7357280_g_c_d_n_u.laz"},
                        Case{"format_3_pointwise", "quickstart/Blanca_in_Pozo_USGS_UTM11_NAD83_all_color_cl2_SC12.laz"},
                        Case{"format_6_layered", "lidar_river_ign/test_semis_2023_0292_6833_LA93_IGN69.laz"},
                        Case{"format_6_copc", "formats/lone-star.copc.laz"},
                        Case{"format_8_layered", "formats/las_with_several_extra_byte_bloc.laz"},
                        Case{"format_7_plain", "formats/autzen_trim_7.las"}}) {
    const std::string path = data + c.file;
    benchmark::RegisterBenchmark((std::string(c.name) + "/points").c_str(), points, path)
        ->Arg(1)
        ->Arg(2)
        ->UseRealTime()
        ->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark((std::string(c.name) + "/records").c_str(), records, path)
        ->Unit(benchmark::kMillisecond);
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
