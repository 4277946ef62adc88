#include "small_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <numeric>

#include "hydrotin/csv_points.h"
#include "hydrotin/dem_points.h"
#include "hydrotin/error.h"
#include "hydrotin/hilbert.h"
#include "hydrotin/las.h"

namespace hydrotin::app {
namespace {

constexpr std::uint64_t kMaxPoints = 100'000'000;
constexpr double kSpan = 4294967295.0;  // lattice steps between the ends of 32 bits

/// 10^-decimals, also for negative decimals, as the nearest double.
double step(int decimals) {
  return decimals >= 0 ? 1 / std::pow(10.0, decimals) : std::pow(10.0, -decimals);
}

/// The value as a whole number of steps; exact when the value has at most `decimals` decimals and fits 64 bits.
std::int64_t in_steps(double value, int decimals) {
  const long double factor = std::pow(10.0L, static_cast<long double>(std::abs(decimals)));
  return std::llround(decimals >= 0 ? static_cast<long double>(value) * factor
                                    : static_cast<long double>(value) / factor);
}

/// As many of the wanted decimals as 32 bits (and exact integers on the way) allow.
int affordable_decimals(int wanted, std::initializer_list<const std::vector<double>*> axes) {
  for (int decimals = std::min(wanted, 300);; --decimals) {
    bool fits = true;
    for (const auto* values : axes) {
      const auto [low, high] = std::minmax_element(values->begin(), values->end());
      const double factor = 1 / step(decimals);
      fits = fits && (*high - *low) * factor < kSpan - 2 && std::max(std::abs(*low), std::abs(*high)) * factor < 9e15;
    }
    if (fits) return decimals;
  }
}

/// Base that brings the steps of one axis into 32 bits.
std::int64_t base_of(const std::vector<std::int64_t>& steps) {
  const auto [low, high] = std::minmax_element(steps.begin(), steps.end());
  return *low + (*high - *low) / 2;
}

struct RawPoints {
  std::vector<LatticePoint> position;
  std::vector<std::int32_t> height;
  std::vector<std::uint32_t> row;
};

/// Takes the values of both files into one array: one lattice serves them.
CsvPoints read_csv_files(const std::string& path, const std::string& reference, std::size_t& num_points) {
  CsvPoints csv = read_csv_points(path);
  num_points = csv.x.size();
  if (reference.empty()) return csv;
  const CsvPoints more = read_csv_points(reference);
  csv.x.insert(csv.x.end(), more.x.begin(), more.x.end());
  csv.y.insert(csv.y.end(), more.y.begin(), more.y.end());
  csv.z.insert(csv.z.end(), more.z.begin(), more.z.end());
  csv.decimals_xy = std::max(csv.decimals_xy, more.decimals_xy);
  csv.decimals_z = std::max(csv.decimals_z, more.decimals_z);
  return csv;
}

RawPoints read_csv(const std::string& path, const std::string& reference, SmallPoints& points) {
  std::size_t num_points = 0;
  const CsvPoints csv = read_csv_files(path, reference, num_points);
  points.num_rows = num_points;
  RawPoints raw;
  if (csv.x.empty()) return raw;
  if (csv.x.size() > kMaxPoints)
    throw Error(ErrorKind::input, path + ": more than " + std::to_string(kMaxPoints) + " points (use hydrotin run)");
  const int decimals_xy = affordable_decimals(csv.decimals_xy, {&csv.x, &csv.y});
  const int decimals_z = affordable_decimals(csv.decimals_z, {&csv.z});
  if (decimals_xy < csv.decimals_xy)
    points.notes.push_back(fmt::format("x and y are rounded to {:g}: 32 bits hold no more", step(decimals_xy)));
  if (decimals_z < csv.decimals_z)
    points.notes.push_back(fmt::format("z is rounded to {:g}: 32 bits hold no more", step(decimals_z)));
  std::array<std::vector<std::int64_t>, 3> steps;
  const std::array<const std::vector<double>*, 3> axes{&csv.x, &csv.y, &csv.z};
  std::array<std::int64_t, 3> base{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double value : *axes[axis]) steps[axis].push_back(in_steps(value, axis == 2 ? decimals_z : decimals_xy));
    base[axis] = base_of(steps[axis]);
  }
  points.lattice = {.scale_xy = step(decimals_xy),
                    .scale_z = step(decimals_z),
                    .base_x = base[0],
                    .base_y = base[1],
                    .base_z = base[2]};
  for (std::size_t i = 0; i < csv.x.size(); ++i) {
    const LatticePoint position{static_cast<std::int32_t>(steps[0][i] - base[0]),
                                static_cast<std::int32_t>(steps[1][i] - base[1])};
    const auto height = static_cast<std::int32_t>(steps[2][i] - base[2]);
    if (i >= num_points) {
      points.reference_position.push_back(position);
      points.reference_height.push_back(height);
      continue;
    }
    raw.position.push_back(position);
    raw.height.push_back(height);
    raw.row.push_back(static_cast<std::uint32_t>(i));
  }
  return raw;
}

void require_small(const std::string& path, const LasHeader& header) {
  if (header.scale[0] != header.scale[1])
    throw Error(ErrorKind::input,
                fmt::format("{}: x and y have different scales, {} and {} (rewrite the file with one scale)", path,
                            header.scale[0], header.scale[1]));
  if (header.point_count > kMaxPoints)
    throw Error(ErrorKind::input, path + ": more than " + std::to_string(kMaxPoints) + " points (use hydrotin run)");
}

/// All points that are not withheld.
RawPoints decode_las(const LasFile& file) {
  RawPoints raw;
  PointBatch batch;
  for (std::size_t chunk = 0; chunk < file.num_chunks(); ++chunk) {
    file.decode(chunk, batch);
    const auto first = static_cast<std::uint32_t>(file.chunk_first_point(chunk));
    for (std::size_t i = 0; i < batch.size(); ++i) {
      if ((batch.flags[i] & PointFlag::withheld) != 0) continue;
      raw.position.push_back({batch.x[i], batch.y[i]});
      raw.height.push_back(batch.z[i]);
      raw.row.push_back(first + static_cast<std::uint32_t>(i));
    }
  }
  return raw;
}

void read_las_reference(const std::string& path, const LasHeader& header, SmallPoints& points) {
  const LasFile file(path);
  require_small(path, file.header());
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (file.header().scale[axis] != header.scale[axis] || file.header().offset[axis] != header.offset[axis])
      throw Error(ErrorKind::input, path + ": its scale and offset are not those of the points (rewrite it with them)");
  RawPoints raw = decode_las(file);
  points.reference_position = std::move(raw.position);
  points.reference_height = std::move(raw.height);
}

RawPoints read_las(const std::string& path, const std::string& reference, SmallPoints& points) {
  const LasFile file(path);
  const LasHeader& header = file.header();
  require_small(path, header);
  points.num_rows = header.point_count;
  points.crs_wkt = header.crs_wkt;
  points.lattice = {.scale_xy = header.scale[0],
                    .scale_z = header.scale[2],
                    .offset_x = header.offset[0],
                    .offset_y = header.offset[1],
                    .offset_z = header.offset[2]};
  RawPoints raw = decode_las(file);
  if (raw.row.size() < points.num_rows)
    points.notes.push_back(fmt::format("{} points are withheld and left out", points.num_rows - raw.row.size()));
  if (!reference.empty()) read_las_reference(reference, header, points);
  return raw;
}

/// Cells of a raster with heights, in quanta.
struct DemCells {
  std::array<std::vector<std::int64_t>, 3> xyz;
  std::vector<std::uint32_t> cell;
  std::uint64_t num_cells = 0;
  std::string crs_wkt;
};

DemCells read_dem_cells(const std::string& path, SmallPoints& points) {
  DemFile dem(path);
  DemCells out;
  out.num_cells = dem.header().num_cells();
  out.crs_wkt = dem.header().crs_wkt;
  if (out.num_cells > kMaxPoints)
    throw Error(ErrorKind::input, path + ": more than " + std::to_string(kMaxPoints) + " cells (use hydrotin run)");
  const DemSkips skips = dem.read(0, dem.header().num_rows, [&](const DemBatch& batch) {
    out.xyz[0].insert(out.xyz[0].end(), batch.x.begin(), batch.x.end());
    out.xyz[1].insert(out.xyz[1].end(), batch.y.begin(), batch.y.end());
    out.xyz[2].insert(out.xyz[2].end(), batch.z.begin(), batch.z.end());
    for (const std::uint64_t cell : batch.cell) out.cell.push_back(static_cast<std::uint32_t>(cell));
  });
  if (skips.nodata + skips.not_finite > 0)
    points.notes.push_back(fmt::format("{} cells have no height and are left out", skips.nodata + skips.not_finite));
  points.notes.push_back(fmt::format("cell centres and heights are multiples of {:g}", DemReading{}.quantum));
  return out;
}

/// The cells of two rasters share one lattice, so the bases of the first and the span of both count.
RawPoints read_dem(const std::string& path, const std::string& reference, SmallPoints& points) {
  const DemCells cells = read_dem_cells(path, points);
  const DemCells more = reference.empty() ? DemCells{} : read_dem_cells(reference, points);
  points.num_rows = cells.num_cells;
  points.crs_wkt = cells.crs_wkt;
  RawPoints raw;
  if (cells.cell.empty()) return raw;
  std::array<std::int64_t, 3> base{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    base[axis] = base_of(cells.xyz[axis]);
    for (const DemCells* some : {&cells, &more})
      for (const std::int64_t v : some->xyz[axis])
        if (std::abs(v - base[axis]) >= std::numeric_limits<std::int32_t>::max())
          throw Error(ErrorKind::input, fmt::format(
                                            "{}: {} spans more than 32 bits hold at a unit of {:g} (use hydrotin "
                                            "run with a larger input.dem_quantum_m)",
                                            some == &cells ? path : reference, "xyz" [axis], DemReading {}.quantum));
  }
  const auto at = [&](const DemCells& some, std::size_t axis, std::size_t i) {
    return static_cast<std::int32_t>(some.xyz[axis][i] - base[axis]);
  };
  points.lattice = {.scale_xy = DemReading{}.quantum,
                    .scale_z = DemReading{}.quantum,
                    .base_x = base[0],
                    .base_y = base[1],
                    .base_z = base[2]};
  for (std::size_t i = 0; i < cells.cell.size(); ++i) {
    raw.position.push_back({at(cells, 0, i), at(cells, 1, i)});
    raw.height.push_back(at(cells, 2, i));
    raw.row.push_back(cells.cell[i]);
  }
  for (std::size_t i = 0; i < more.cell.size(); ++i) {
    points.reference_position.push_back({at(more, 0, i), at(more, 1, i)});
    points.reference_height.push_back(at(more, 2, i));
  }
  return raw;
}

/// Of the points at one place the lowest stays, of equal ones the first; the rest in curve order.
void keep_distinct(const RawPoints& raw, SmallPoints& points) {
  std::vector<std::uint32_t> order(raw.row.size());
  std::iota(order.begin(), order.end(), 0U);
  std::vector<std::uint64_t> key;
  key.reserve(order.size());
  for (const LatticePoint p : raw.position) key.push_back(hilbert_key(p));
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple(key[a], raw.height[a], raw.row[a]) < std::tuple(key[b], raw.height[b], raw.row[b]);
  });
  for (const std::uint32_t i : order) {
    if (!points.position.empty() && points.position.back() == raw.position[i]) {
      points.duplicates.emplace_back(raw.row[i], points.row.back());
      continue;
    }
    points.position.push_back(raw.position[i]);
    points.height.push_back(raw.height[i]);
    points.row.push_back(raw.row[i]);
  }
  std::sort(points.duplicates.begin(), points.duplicates.end());
}

bool is_las(const std::string& path) {
  if (path.starts_with("/vsi")) return path.ends_with(".las") || path.ends_with(".laz");
  char magic[4] = {};
  std::ifstream(path, std::ios::binary).read(magic, sizeof magic);
  return std::string_view(magic, sizeof magic) == "LASF";
}

enum class Kind : std::uint8_t { csv, las, dem };

Kind kind_of_file(const std::string& path) {
  return is_las(path) ? Kind::las : is_raster(path) ? Kind::dem : Kind::csv;
}

}  // namespace

SmallPoints load_small_points(const std::string& path, const std::string& reference) {
  SmallPoints points;
  const Kind kind = kind_of_file(path);
  if (!reference.empty() && kind_of_file(reference) != kind)
    throw Error(ErrorKind::input, reference +
                                      ": points and reference points must both be CSV, both LAS or LAZ, or both "
                                      "rasters (convert one of them)");
  keep_distinct(kind == Kind::las   ? read_las(path, reference, points)
                : kind == Kind::dem ? read_dem(path, reference, points)
                                    : read_csv(path, reference, points),
                points);
  return points;
}

SmallPoints load_and_note(const std::string& path, const std::string& reference) {
  SmallPoints points = load_small_points(path, reference);
  for (const auto& note : points.notes) fmt::print(stderr, "{}: {}\n", path, note);
  if (!points.duplicates.empty())
    fmt::print(stderr, "{}: {} points lie where a lower or earlier one lies, and are dropped\n", path,
               points.duplicates.size());
  return points;
}

}  // namespace hydrotin::app
