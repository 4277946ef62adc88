#pragma once

#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "clouds.h"
#include "hydrotin/las_writer.h"
#include "hydrotin/pipeline.h"

/// Data sets on disk for tests of the pipeline.

namespace hydrotin::testing {

/// A folder that goes away with the test.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "hydrotin-test-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] std::string operator/(const std::string& name) const { return path_ + "/" + name; }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

class Silent : public Progress {
 public:
  void phase_begins(Phase, std::uint64_t, std::uint64_t) override {}
  void unit_done(Phase, std::uint64_t, std::uint64_t, bool) override {}
  void phase_ends(Phase, double) override {}
  void note(std::string_view) override {}
};

inline DatasetSummary run(const PipelineOptions& options) {
  Silent silent;
  return run_pipeline(options, {}, silent);
}

inline std::string bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline LasWriterOptions cloud_header() {
  LasWriterOptions options;
  options.point_format = 1;
  options.offset = {500000, 4000000, 0};
  options.crs = "EPSG:32633";
  return options;
}

inline void write_cloud(const std::string& path, const std::vector<LatticePoint>& position,
                        const std::vector<std::int32_t>& height, const LasWriterOptions& options = cloud_header(),
                        std::vector<std::uint8_t> classification = {}) {
  std::vector<std::int32_t> x, y;
  for (const LatticePoint p : position) {
    x.push_back(p.x);
    y.push_back(p.y);
  }
  classification.resize(position.size(), 2);
  LasPoints points;
  points.x = x;
  points.y = y;
  points.z = height;
  points.classification = classification;
  LasWriter writer(path, options);
  writer.write(points);
  writer.close();
}

/// Splits a cloud into files whose boxes overlap, so that no file is a tile.
inline std::vector<std::string> write_files(const TemporaryFolder& folder, const std::vector<LatticePoint>& position,
                                            const std::vector<std::int32_t>& height, std::size_t num_files,
                                            const std::string& stem = "cloud_") {
  std::vector<std::string> paths;
  for (std::size_t f = 0; f < num_files; ++f) {
    std::vector<LatticePoint> p;
    std::vector<std::int32_t> z;
    for (std::size_t i = f; i < position.size(); i += num_files) {
      p.push_back(position[i]);
      z.push_back(height[i]);
    }
    paths.push_back(folder / (stem + std::to_string(f) + ".las"));
    write_cloud(paths.back(), p, z);
  }
  return paths;
}

inline PipelineOptions options_for(const std::vector<std::string>& files, const std::string& out) {
  PipelineOptions options;
  options.input.points = files;
  options.output.dir = out;
  options.output.dem.enabled = false;
  options.output.mesh_ply = false;
  return options;
}

}  // namespace hydrotin::testing
