#include "leftovers.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "hydrotin/error.h"

namespace hydrotin {
namespace {

namespace fs = std::filesystem;

// N of tile_NNNNNN.*
std::optional<std::uint64_t> tile_of(const std::string& name) {
  constexpr std::string_view kPrefix = "tile_";
  if (!name.starts_with(kPrefix)) return std::nullopt;
  std::uint64_t number = 0;
  const char* const begin = name.data() + kPrefix.size();
  const auto [end, problem] = std::from_chars(begin, name.data() + name.size(), number);
  if (problem != std::errc() || end - begin < 6 || *end != '.') return std::nullopt;
  return number;
}

void remove_tiles_from(const fs::path& folder, std::uint64_t first) {
  std::vector<fs::path> leftover;
  std::error_code absent;
  for (fs::directory_iterator at(folder, absent), end; !absent && at != end; at.increment(absent)) {
    const auto tile = tile_of(at->path().filename().string());
    if (tile && *tile >= first) leftover.push_back(at->path());
  }
  for (const fs::path& path : leftover) remove_leftover(path);
}

}  // namespace

void remove_leftover(const fs::path& path) {
  std::error_code failed;
  fs::remove(path, failed);
  if (failed)
    throw Error(ErrorKind::storage, path.string() + ": a file of an earlier run cannot be removed (" +
                                        failed.message() + "); check permissions, then run again");
}

void remove_leftovers(const RunContext& context) {
  const Layout& layout = context.layout;
  const OutputOptions& wanted = context.options.output;
  const std::uint64_t tiles = context.plan.num_tiles();
  remove_tiles_from(fs::path(layout.terrain(0)).parent_path(), tiles);
  if (!context.has_rivers()) remove_leftover(layout.rivers());
  const PointsFile points = context.has_rivers() ? context.options.rivers.points_out : PointsFile::none;
  if (points != PointsFile::las) remove_leftover(layout.river_points("las"));
  if (points != PointsFile::gpkg) remove_leftover(layout.river_points("gpkg"));
  remove_tiles_from(fs::path(layout.mesh(0)).parent_path(), wanted.mesh_ply ? tiles : 0);
  const fs::path dem_folder = fs::path(layout.dem_tile(0)).parent_path();
  remove_tiles_from(dem_folder, wanted.dem.enabled ? tiles : 0);
  bool any = false;
  for (std::uint64_t t = 0; t < tiles && !any; ++t) any = fs::exists(layout.dem_tile(t));
  const fs::path change_folder = fs::path(layout.change_tile(0)).parent_path();
  const bool has_change = wants_change_raster(context.options);
  remove_tiles_from(change_folder, has_change ? tiles : 0);
  if (!has_change || !any) remove_leftover(change_folder / "mosaic.vrt");
  if (!has_change || !any || !wanted.dem.cog) remove_leftover(layout.change());
  if (!any || !(wanted.dem.cog || wanted.dem.hillshade)) remove_leftover(dem_folder / "mosaic.vrt");
  if (!any || !wanted.dem.cog) remove_leftover(layout.dem());
  if (any && wanted.dem.hillshade) return;
  remove_leftover(layout.hillshade());
  remove_leftover(layout.hillshade() + ".aux.xml");
  remove_leftover(fs::path(layout.hillshade()).replace_extension(".wld"));
}

void remove_other_profiles(const RunContext& context, const std::vector<std::string>& made) {
  std::vector<fs::path> leftover;
  std::error_code absent;
  for (fs::directory_iterator at(context.layout.profiles(), absent), end; !absent && at != end; at.increment(absent))
    if (at->path().extension() == ".svg" && std::find(made.begin(), made.end(), at->path().string()) == made.end())
      leftover.push_back(at->path());
  for (const fs::path& path : leftover) remove_leftover(path);
  if (made.empty()) fs::remove(context.layout.profiles(), absent);  // only if nothing else lies there
}

}  // namespace hydrotin
