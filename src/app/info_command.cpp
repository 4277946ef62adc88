#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "commands.h"
#include "hydrotin/crs.h"
#include "hydrotin/dem_points.h"
#include "hydrotin/error.h"
#include "hydrotin/las_summary.h"

namespace hydrotin::app {
namespace {

using Json = nlohmann::ordered_json;

Json text_or_null(const std::string& text) {
  return text.empty() ? Json(nullptr) : Json(text);
}

Json classes_json(const LasTally& tally) {
  Json classes = Json::object();
  for (std::size_t c = 0; c < tally.classes().size(); ++c)
    if (tally.classes()[c] > 0) classes[std::to_string(c)] = tally.classes()[c];
  return classes;
}

Json describe(const std::string& path, const LasSummary& summary, bool with_checksum) {
  const LasHeader& header = summary.header;
  const bool has_points = summary.tally.points() > 0;
  Json json = {{"path", path},
               {"version", fmt::format("{}.{}", header.version_major, header.version_minor)},
               {"point_format", header.point_format},
               {"points", header.point_count},
               {"compressed", header.compressed},
               {"scale", header.scale},
               {"offset", header.offset},
               {"min", has_points ? Json(summary.min) : Json(nullptr)},
               {"max", has_points ? Json(summary.max) : Json(nullptr)},
               {"crs", text_or_null(header.crs)},
               {"classes", classes_json(summary.tally)},
               {"withheld", summary.tally.withheld()},
               {"complete", summary.complete},
               {"problem", text_or_null(summary.problem)}};
  if (with_checksum) json["checksum"] = text_or_null(summary.checksum);
  return json;
}

/// A raster as points: every cell is read.
Json describe_raster(const std::string& path) {
  DemFile dem(path);
  const DemHeader& h = dem.header();
  std::uint64_t points = 0;
  constexpr auto kMost = std::numeric_limits<std::int64_t>::max();
  std::array<std::int64_t, 3> low{kMost, kMost, kMost}, high{-kMost, -kMost, -kMost};
  const DemSkips skips = dem.read(0, h.num_rows, [&](const DemBatch& batch) {
    points += batch.size();
    const std::array axes{&batch.x, &batch.y, &batch.z};
    for (std::size_t a = 0; a < 3; ++a)
      for (const std::int64_t v : *axes[a]) {
        low[a] = std::min(low[a], v);
        high[a] = std::max(high[a], v);
      }
  });
  const auto place = [&](const std::array<std::int64_t, 3>& steps) {
    if (points == 0) return Json(nullptr);
    Json out = Json::array();
    for (const std::int64_t v : steps) out.push_back(static_cast<double>(v) * DemReading{}.quantum);
    return out;
  };
  return {{"path", path},
          {"raster", h.driver},
          {"type", h.type},
          {"bands", h.num_bands},
          {"columns", h.num_columns},
          {"rows", h.num_rows},
          {"cell", h.step},
          {"points", points},
          {"cells_nodata", skips.nodata},
          {"cells_not_finite", skips.not_finite},
          {"nodata", h.nodata && std::isfinite(*h.nodata) ? Json(*h.nodata) : Json(nullptr)},
          {"min", place(low)},
          {"max", place(high)},
          {"crs", text_or_null(crs_from_wkt(h.crs_wkt, path).name)},
          {"complete", true},
          {"problem", nullptr}};
}

/// A file whose header says nothing.
Json describe_unreadable(const std::string& path, const std::string& problem) {
  Json json = {{"path", path}};
  for (const char* key : {"version", "point_format", "points", "compressed", "scale", "offset", "min", "max", "crs",
                          "classes", "withheld"})
    json[key] = nullptr;
  json["complete"] = false;
  json["problem"] = problem;
  return json;
}

void print_text(const Json& file) {
  fmt::print("{}\n", file["path"].get<std::string>());
  for (const auto& [key, value] : file.items())
    if (key != "path" && !value.is_null())
      fmt::print("  {:<13} {}\n", key, value.is_string() ? value.get<std::string>() : value.dump());
}

}  // namespace

void add_info_command(CLI::App& program, Action& action) {
  struct Arguments {
    std::vector<std::string> files;
    bool json = false, checksum = false;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = program.add_subcommand(
      "info", "header, bounds, CRS, classes and completeness of LAS or LAZ files; rasters as points");
  command->add_option("files", arguments->files, "LAS or LAZ files or rasters; every point is decoded")
      ->required()
      ->type_name("FILE");
  command->add_flag("--json", arguments->json, "print JSON");
  command->add_flag("--checksum", arguments->checksum, "a checksum of all records, equal for a LAS file and its LAZ");
  command->callback([arguments, &action] {
    action = [arguments] {
      Json files = Json::array();
      bool all_good = true;
      for (const auto& path : arguments->files) {
        try {
          files.push_back(is_raster(path)
                              ? describe_raster(path)
                              : describe(path, summarize_las(path, arguments->checksum), arguments->checksum));
        } catch (const Error& error) {  // this file's answer, not the end of the command
          files.push_back(describe_unreadable(path, error.what()));
        }
        const Json& file = files.back();
        if (file["complete"] == false) {
          all_good = false;
          std::fflush(stdout);
          fmt::print(stderr, "hydrotin: {}\n", file["problem"].get<std::string>());
        }
        if (!arguments->json) print_text(file);
      }
      if (arguments->json)
        fmt::print("{}\n", Json{{"files", files}}.dump(2, ' ', false, Json::error_handler_t::replace));
      return all_good ? 0 : static_cast<int>(ErrorKind::input);
    };
  });
}

}  // namespace hydrotin::app
