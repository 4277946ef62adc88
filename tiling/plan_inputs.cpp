#include "plan_inputs.h"

#include <glob.h>

#include <algorithm>
#include <set>

#include "hydrotin/dem_points.h"
#include "hydrotin/error.h"
#include "hydrotin/las.h"
#include "hydrotin/raster_names.h"

namespace hydrotin {
namespace {

std::vector<std::string> glob_paths(const std::string& pattern, const std::string& key) {
  glob_t found{};
  const int status = ::glob(pattern.c_str(), GLOB_TILDE | GLOB_BRACE, nullptr, &found);
  std::vector<std::string> out;
  if (status == 0)
    for (std::size_t i = 0; i < found.gl_pathc; ++i) out.emplace_back(found.gl_pathv[i]);
  ::globfree(&found);
  if (status != 0)
    throw Error(ErrorKind::input,
                key + ": nothing matches '" + pattern + "'; check the path, relative to the config file");
  return out;
}

// Glob patterns of plain paths are expanded, also inside names of subdatasets; /vsi paths are taken as they are.
std::vector<std::string> expand(const std::vector<std::string>& patterns, const std::string& key) {
  std::set<std::string> paths;
  for (const std::string& pattern : patterns) {
    const auto subdataset = key == "input.dem" ? parse_subdataset(pattern) : std::nullopt;
    if (pattern.starts_with("/vsi") || (subdataset && subdataset->file.starts_with("/vsi"))) {
      paths.insert(pattern);
    } else if (subdataset) {
      for (const std::string& path : glob_paths(subdataset->file, key)) paths.insert(subdataset->with(path));
    } else {
      for (const std::string& path : glob_paths(pattern, key)) paths.insert(path);
    }
  }
  return {paths.begin(), paths.end()};
}

PlanInput open_cloud(const std::string& path, bool is_reference) {
  const LasFile las(path);  // opening checks that all points are there
  const LasHeader& h = las.header();
  PlanInput out;
  out.lattice = {path, h.scale, h.offset, h.min, h.max};
  out.crs_wkt = h.crs_wkt;
  out.points = h.point_count;
  out.bytes = h.file_bytes;
  out.files = {path};
  out.is_reference = is_reference;
  return out;
}

PlanInput open_dem(const std::string& path, const InputOptions& options) {
  const DemFile dem(path, {options.dem_band, options.dem_nodata, options.dem_quantum_m});
  const DemHeader& h = dem.header();
  const auto box = h.bounds(0, h.num_rows);
  const double q = options.dem_quantum_m;
  PlanInput out;
  // Heights are known when they are read; 32 bits hold them around 0.
  out.lattice = {path, {q, q, q}, {0, 0, 0}, {box[0], box[1], 0}, {box[2], box[3], 0}};
  out.crs_wkt = h.crs_wkt;
  out.points = h.num_cells();
  out.files = h.files;
  if (const auto subdataset = parse_subdataset(path)) out.files.push_back(subdataset->file);  // not all drivers say
  out.is_dem = true;
  out.num_columns = h.num_columns;
  out.num_rows = h.num_rows;
  out.block_rows = std::max(1U, h.block_rows);
  out.first_y = h.center[1];
  out.step_y = h.step[1];
  return out;
}

}  // namespace

std::array<double, 4> PlanInput::bounds(std::uint64_t first_row, std::uint64_t rows) const {
  std::array<double, 4> box{lattice.min[0], lattice.min[1], lattice.max[0], lattice.max[1]};
  if (is_dem) {
    const double from = first_y + step_y * static_cast<double>(first_row);
    const double to = from + step_y * (static_cast<double>(rows) - 1);
    box[1] = std::min(from, to);
    box[3] = std::max(from, to);
  }
  return box;
}

std::vector<PlanInput> open_inputs(const PipelineOptions& options) {
  std::vector<PlanInput> out;
  for (const std::string& path : expand(options.input.dem, "input.dem")) out.push_back(open_dem(path, options.input));
  for (const std::string& path : expand(options.input.points, "input.points")) out.push_back(open_cloud(path, false));
  if (out.empty())
    throw Error(ErrorKind::config,
                "input.points: no file is named; give at least one LAS or LAZ file, or a raster as input.dem");
  for (const std::string& path : expand(options.triangulation.reference, "triangulation.reference"))
    out.push_back(open_cloud(path, true));
  return out;
}

}  // namespace hydrotin
