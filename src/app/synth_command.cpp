#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "commands.h"
#include "hydrotin/crs.h"
#include "hydrotin/error.h"
#include "hydrotin/las_writer.h"
#include "hydrotin/synthetic.h"
#include "hydrotin/vector.h"

namespace hydrotin::app {
namespace {

constexpr const char* kCrs = "EPSG:32631";
constexpr std::uint8_t kGround = 2;

struct SynthArguments {
  std::string dir, kind = "fluvial", tiles = "1x1";
  double points = 1e6;
  std::uint64_t seed = 1;
  double noise = 0;
  bool voids = false, rivers = false;
};

[[noreturn]] void refuse(const std::string& option, const std::string& text, const std::string& allowed) {
  throw Error(ErrorKind::config, option + ": '" + text + "' is not possible (allowed: " + allowed + ")");
}

/// "AxB": columns and rows.
std::pair<std::uint32_t, std::uint32_t> parse_tiles(const std::string& text) {
  constexpr std::uint32_t kMost = 10'000;
  std::uint32_t columns = 0, rows = 0;
  const char* end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, columns);
  const bool has_x = first.ec == std::errc{} && first.ptr != end && *first.ptr == 'x';
  const auto second =
      has_x ? std::from_chars(first.ptr + 1, end, rows) : std::from_chars_result{end, std::errc::invalid_argument};
  if (second.ec != std::errc{} || second.ptr != end || columns < 1 || rows < 1 || columns > kMost || rows > kMost)
    refuse("--tiles", text, "columns x rows, for example 2x2, at most 10000x10000");
  return {columns, rows};
}

SyntheticOptions checked_options(const SynthArguments& arguments) {
  SyntheticOptions options;
  if (arguments.kind == "fluvial") {
    options.kind = SyntheticKind::fluvial;
  } else if (arguments.kind == "urban") {
    options.kind = SyntheticKind::urban;
  } else if (arguments.kind == "lattice") {
    options.kind = SyntheticKind::lattice;
  } else if (arguments.kind == "scanline") {
    options.kind = SyntheticKind::scanline;
  } else {
    refuse("--kind", arguments.kind, "fluvial, urban, lattice, scanline");
  }
  if (!(arguments.points >= 16 && arguments.points <= static_cast<double>(kMaxSyntheticPoints)))
    refuse("--points", fmt::format("{}", arguments.points), fmt::format("a number from 16 to {}", kMaxSyntheticPoints));
  if (!(arguments.noise >= 0 && arguments.noise <= 100))
    refuse("--noise", fmt::format("{}", arguments.noise), "metres from 0 to 100");
  if (arguments.rivers && options.kind != SyntheticKind::fluvial)
    refuse("--rivers", arguments.kind, "only with --kind fluvial");
  options.num_points = static_cast<std::uint64_t>(arguments.points);
  options.seed = arguments.seed;
  options.noise = arguments.noise;
  options.voids = arguments.voids;
  return options;
}

/// Writes one tile; returns its number of points. A tile without points gets no file.
std::uint64_t write_tile(const SyntheticTerrain& terrain, const LatticeBox& box, const std::filesystem::path& path) {
  std::unique_ptr<LasWriter> writer;
  std::vector<std::int32_t> x, y, z;
  std::vector<std::uint8_t> classes;
  std::uint64_t count = 0;
  terrain.points_in(box, [&](std::span<const SyntheticPoint> batch) {
    if (!writer) {
      const LasWriterOptions options{.point_format = 6,
                                     .scale = {kSyntheticScale, kSyntheticScale, kSyntheticScale},
                                     .offset = {0, 0, 0},
                                     .crs = kCrs};
      writer = std::make_unique<LasWriter>(path.string(), options);
    }
    x.clear();
    y.clear();
    z.clear();
    for (const SyntheticPoint& point : batch) {
      x.push_back(point.x);
      y.push_back(point.y);
      z.push_back(point.z);
    }
    classes.assign(batch.size(), kGround);
    LasPoints points;
    points.x = x;
    points.y = y;
    points.z = z;
    points.classification = classes;
    writer->write(points);
    count += batch.size();
  });
  if (writer) writer->close();
  return count;
}

std::size_t write_rivers(const SyntheticTerrain& terrain, const std::filesystem::path& path) {
  const VectorField fields[] = {
      {"id", FieldType::integer}, {"strahler", FieldType::integer}, {"catchment_m2", FieldType::real}};
  GeoPackageWriter writer(path, parse_crs(kCrs, "crs").wkt);
  const int layer = writer.add_layer("rivers", VectorGeometry::line, true, fields);
  const auto rivers = terrain.rivers();
  std::vector<VectorPoint> line;
  for (std::size_t i = 0; i < rivers.size(); ++i) {
    line.clear();
    for (const auto& point : rivers[i].line) line.push_back({point[0], point[1], point[2]});
    const FieldValue values[] = {static_cast<std::int64_t>(i), std::int64_t{rivers[i].strahler},
                                 rivers[i].catchment_m2};
    writer.add_line(layer, line, values);
  }
  writer.finish();
  return rivers.size();
}

int synthesize(const SynthArguments& arguments) {
  const SyntheticOptions options = checked_options(arguments);
  const auto [columns, rows] = parse_tiles(arguments.tiles);
  const std::filesystem::path dir = arguments.dir;
  std::error_code problem;
  std::filesystem::create_directories(dir, problem);
  if (problem) throw Error(ErrorKind::storage, dir.string() + ": cannot make this folder: " + problem.message());
  const SyntheticTerrain terrain(options);
  std::uint64_t points = 0, files = 0;
  for (std::uint32_t row = 0; row < rows; ++row)
    for (std::uint32_t column = 0; column < columns; ++column) {
      const auto path = dir / fmt::format("tile_{}_{}.las", column, row);
      const std::uint64_t count = write_tile(terrain, terrain.tile(column, columns, row, rows), path);
      if (count == 0) {
        std::filesystem::remove(path, problem);  // of another terrain made here before
        fmt::print(stderr, "{}: no point lies in this tile, no file\n", path.string());
        continue;
      }
      points += count;
      ++files;
    }
  fmt::print("files   {}\npoints  {}\n", files, points);
  if (arguments.rivers) fmt::print("rivers  {}\n", write_rivers(terrain, dir / "rivers.gpkg"));
  return 0;
}

}  // namespace

void add_synth_command(CLI::App& program, Action& action) {
  auto arguments = std::make_shared<SynthArguments>();
  CLI::App* command = program.add_subcommand("synth", "make seeded synthetic terrain: LAS tiles and river lines");
  command->add_option("dir", arguments->dir, "folder for tile_COLUMN_ROW.las and rivers.gpkg")
      ->required()
      ->type_name("DIR");
  command->add_option("--kind", arguments->kind, "fluvial, urban, lattice or scanline")->capture_default_str();
  command->add_option("--points", arguments->points, "about so many points, one per square metre")
      ->capture_default_str();
  command->add_option("--tiles", arguments->tiles, "columns x rows of files")->capture_default_str()->type_name("AxB");
  command->add_option("--seed", arguments->seed, "another seed, another terrain")->capture_default_str();
  command->add_option("--noise", arguments->noise, "standard deviation of white noise on heights [m]")
      ->capture_default_str();
  command->add_flag("--voids", arguments->voids, "leave lakes out");
  command->add_flag("--rivers", arguments->rivers, "write the river lines (fluvial)");
  command->callback([arguments, &action] { action = [arguments] { return synthesize(*arguments); }; });
}

}  // namespace hydrotin::app
