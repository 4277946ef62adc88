// Runs the pipeline and kills itself the hard way: after a given number of finished units and a delay, which lets the
// kill fall into the middle of the next units. Exits 0 if the run ended first.
//
//     dying_run EVENTS DELAY_US OUT ORDER TARGET_POINTS WORKERS MEMORY_BYTES CRS FILE...      (CRS: - for the files')

#include <csignal>
#include <cstdlib>
#include <thread>

#include "tiling_fixture.h"

namespace {

class Killer : public hydrotin::testing::Silent {
 public:
  Killer(long events, long delay_us) : left_(events), delay_(delay_us) {}
  void unit_done(hydrotin::Phase, std::uint64_t, std::uint64_t, bool) override {
    if (--left_ == 0)
      std::thread([delay = delay_] {
        std::this_thread::sleep_for(std::chrono::microseconds(delay));
        std::raise(SIGKILL);
      }).detach();
  }

 private:
  long left_, delay_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 10) return 2;
  hydrotin::PipelineOptions options = hydrotin::testing::options_for({argv + 9, argv + argc}, argv[3]);
  options.triangulation.order = std::atoi(argv[4]);
  options.tiles.target_points = static_cast<std::uint64_t>(std::atoll(argv[5]));
  options.run.workers = std::atoi(argv[6]);
  options.run.memory_bytes = static_cast<std::uint64_t>(std::atoll(argv[7]));
  if (std::string(argv[8]) != "-") options.input.crs = argv[8];
  Killer killer(std::atol(argv[1]), std::atol(argv[2]));
  (void)hydrotin::run_pipeline(options, {}, killer);
  return 0;
}
