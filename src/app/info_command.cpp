#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "commands.h"
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
  CLI::App* command =
      program.add_subcommand("info", "header, bounds, CRS, classes and completeness of LAS or LAZ files");
  command->add_option("files", arguments->files, "LAS or LAZ files; every point is decoded")
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
          files.push_back(describe(path, summarize_las(path, arguments->checksum), arguments->checksum));
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
