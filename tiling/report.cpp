#include "report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "file_checksum.h"
#include "fingerprint.h"
#include "hydrotin/raster.h"
#include "hydrotin/vector.h"
#include "hydrotin/version.h"
#include "leftovers.h"
#include "reduced_store.h"
#include "schedule.h"
#include "terrain_file.h"
#include "whole_array.h"

namespace hydrotin {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct PitRow {
  LatticePoint place;
  std::int32_t height = 0, level = 0;
  std::uint64_t vertices = 0;
  friend auto operator<=>(const PitRow&, const PitRow&) = default;
};

struct TileRow {
  std::uint64_t points = 0, triangles = 0;
};

// Everything that the tiles' files say, added up.
struct Figures {
  DatasetSummary summary;
  std::vector<TileRow> tile;
  std::vector<PitRow> pits;  // before lifting
  std::int64_t polygons = 0, components = 0, max_components = 0, max_polygon = 0, fallbacks = 0;
  std::int64_t minima = 0, minima_bound = 0;
  std::int64_t lifted = 0, lift_total = 0, lift_max = 0;
};

void add_pits(const store::Reader& in, std::vector<PitRow>& rows) {
  const auto xyz = in.read<std::int32_t>("pit_xyz");
  const auto level = in.read<std::int32_t>("pit_level");
  const auto vertices = in.read<std::uint64_t>("pit_vertices");
  if (xyz.size() != 3 * level.size() || vertices.size() != level.size())
    throw Error(ErrorKind::storage, in.path() + ": its arrays of pits differ in length; delete the file and run again");
  for (std::size_t i = 0; i < level.size(); ++i)
    rows.push_back({{xyz[3 * i], xyz[3 * i + 1]}, xyz[3 * i + 2], level[i], vertices[i]});
}

void add_polygons(const store::Reader& in, Figures& f) {
  f.polygons += in.integer("polygons");
  f.components += in.integer("components");
  f.max_components = std::max(f.max_components, in.integer("max_components"));
  f.max_polygon = std::max(f.max_polygon, in.integer("max_polygon"));
  f.fallbacks += in.integer("fallbacks");
  f.summary.max_triangle_order = std::max(f.summary.max_triangle_order, static_cast<int>(in.integer("max_order")));
}

Figures collect(const RunContext& context) {
  Figures f;
  Fingerprint fingerprint;
  std::vector<PlateauSummary> open;
  for (std::uint32_t t = 0; t < context.plan.num_tiles(); ++t) {
    const store::Reader triangulated(context.layout.unit(Phase::triangulate, t));
    add_polygons(triangulated, f);
    f.minima_bound += triangulated.integer("minima_bound");
    add_polygons(store::Reader(context.layout.unit(Phase::seam, t)), f);
    const store::Reader terrain(context.layout.terrain(t));
    add_pits(terrain, f.pits);
    const auto part = Fingerprint::parse(terrain.text("fingerprint"));
    if (!part)
      throw Error(ErrorKind::storage,
                  terrain.path() + ": its fingerprint is unreadable; delete the file and run again");
    fingerprint.add(*part);
    f.tile.push_back({static_cast<std::uint64_t>(terrain.integer("points")),
                      static_cast<std::uint64_t>(terrain.integer("triangles"))});
    f.summary.triangles += f.tile.back().triangles;
    f.summary.pits += read_pits(terrain, "final_").size();
    open.push_back(read_open_plateaus(terrain, "final_"));
    f.lifted += terrain.integer("inner_lifted");
    f.lift_total += terrain.integer("inner_lift_total");
    f.lift_max = std::max(f.lift_max, terrain.integer("inner_lift_max"));
  }
  f.summary.pits += resolve_plateaus(open).size();
  const store::Reader drain(context.layout.unit(Phase::drain, 0));
  add_pits(drain, f.pits);
  std::sort(f.pits.begin(), f.pits.end());
  f.minima = drain.integer("minima_before");
  f.lifted += drain.integer("rim_lifted");
  f.lift_total += drain.integer("rim_lift_total");
  f.lift_max = std::max(f.lift_max, drain.integer("rim_lift_max"));
  DatasetSummary& s = f.summary;
  s.points = context.outline.points;
  s.vertices = context.outline.vertices;
  s.duplicates = context.outline.duplicates;
  s.order = context.options.triangulation.order;
  s.fingerprint = fingerprint.hex();
  if (context.options.pits.method != PitMethod::none && s.pits > 0)
    s.problems.push_back(std::to_string(s.pits) + " pits are left");
  s.ok = s.problems.empty();
  return f;
}

void write_layers(const RunContext& context, const Figures& figures) {
  const Lattice& l = context.plan.lattice;
  GeoPackageWriter out(context.layout.layers(), context.plan.crs_wkt);
  const std::vector<VectorField> tile_fields{
      {"tile", FieldType::integer}, {"points", FieldType::integer}, {"triangles", FieldType::integer}};
  const int tiles = out.add_layer("tiles", VectorGeometry::polygon, false, tile_fields);
  for (std::size_t t = 0; t < figures.tile.size(); ++t) {
    const LatticeBox& box = context.outline.box[t];
    if (box.is_empty()) continue;
    const std::vector<FieldValue> values{static_cast<std::int64_t>(t),
                                         static_cast<std::int64_t>(figures.tile[t].points),
                                         static_cast<std::int64_t>(figures.tile[t].triangles)};
    out.add_box(tiles, l.x(box.min.x), l.y(box.min.y), l.x(box.max.x), l.y(box.max.y), values);
  }
  const std::vector<VectorField> pit_fields{{"z_before", FieldType::real},
                                            {"z_level", FieldType::real},
                                            {"depth", FieldType::real},
                                            {"vertices", FieldType::integer}};
  const int pits = out.add_layer("pits", VectorGeometry::point, true, pit_fields);
  for (const PitRow& p : figures.pits) {
    const std::vector<FieldValue> values{l.z(p.height), l.z(p.level),
                                         (static_cast<double>(p.level) - p.height) * l.scale_z,
                                         static_cast<std::int64_t>(p.vertices)};
    out.add_point(pits, {l.x(p.place.x), l.y(p.place.y), l.z(p.height)}, values);
  }
  out.finish();
}

void write_rasters(const RunContext& context) {
  const DemOptions& dem = context.options.output.dem;
  if (!dem.enabled) return;
  std::vector<fs::path> tiles;
  for (std::uint32_t t = 0; t < context.plan.num_tiles(); ++t)
    if (fs::exists(context.layout.dem_tile(t))) tiles.emplace_back(context.layout.dem_tile(t));
  if (tiles.empty() || (!dem.cog && !dem.hillshade)) return;
  MosaicOptions options;
  options.num_threads = static_cast<int>(worker_count(context.options.run));
  options.cache_bytes = static_cast<std::int64_t>(
      std::min<std::uint64_t>(context.options.run.memory_bytes / 4, std::uint64_t{256} << 20));
  const std::string mosaic = context.layout.out() + "/dem/mosaic.vrt";
  write_virtual_mosaic(mosaic, tiles);
  if (dem.cog) write_cloud_optimized_geotiff(context.layout.dem(), tiles, options);
  if (dem.hillshade)
    write_hillshade(context.layout.hillshade(), dem.cog ? context.layout.dem() : mosaic, 4096, options);
}

json to_json(const RunContext& context, const Figures& f) {
  const DatasetSummary& s = f.summary;
  const double unit = context.plan.lattice.scale_z;
  const bool by_minima = context.options.triangulation.objective == Objective::local_minima;
  json triangulation = {{"order", s.order},
                        {"objective", name(context.options.triangulation.objective)},
                        {"local_minima", f.minima},
                        {"polygons", f.polygons},
                        {"largest_polygon", f.max_polygon},
                        {"components", f.components},
                        {"most_components", f.max_components},
                        {"fallbacks", f.fallbacks}};
  if (by_minima) {
    triangulation["bound"] = f.minima_bound;
    triangulation["optimal"] = f.minima == f.minima_bound;
  } else {
    triangulation["optimal"] = f.fallbacks == 0;
  }
  return {{"program", std::string("hydrotin ") + version()},
          {"crs", context.plan.crs},
          {"tiles", context.plan.num_tiles()},
          {"files", context.plan.files.size()},
          {"triangulation", triangulation},
          {"lifting",
           {{"pits_before", f.pits.size()},
            {"vertices_moved", f.lifted},
            {"total_displacement_m", static_cast<double>(f.lift_total) * unit},
            {"max_displacement_m", static_cast<double>(f.lift_max) * unit}}},
          {"ok", s.ok},
          {"points", s.points},
          {"vertices", s.vertices},
          {"duplicates", s.duplicates},
          {"triangles", s.triangles},
          {"max_triangle_order", s.max_triangle_order},
          {"order", s.order},
          {"pits", s.pits},
          {"river_edges", 0},
          {"invalid_river_edges", 0},
          {"problems", s.problems},
          {"fingerprint", s.fingerprint}};
}

std::string to_text(const RunContext& context, const Figures& f) {
  const DatasetSummary& s = f.summary;
  const double unit = context.plan.lattice.scale_z;
  std::ostringstream out;
  const auto row = [&](const std::string& label, const auto& value) {
    out << label << std::string(label.size() < 28 ? 28 - label.size() : 1, ' ') << value << '\n';
  };
  out << "hydrotin " << version() << "\n\nInput\n";
  row("  files", context.plan.files.size());
  row("  CRS", context.plan.crs.empty() ? "none" : context.plan.crs);
  row("  points kept", s.points);
  row("  duplicates in (x, y)", s.duplicates);
  out << "\nTriangulation\n";
  row("  tiles", context.plan.num_tiles());
  row("  vertices", s.vertices);
  row("  triangles", s.triangles);
  row("  order asked for", s.order);
  row("  highest order used", s.max_triangle_order);
  row("  objective", name(context.options.triangulation.objective));
  row("  polygons", f.polygons);
  row("  largest polygon", std::to_string(f.max_polygon) + " Delaunay triangles");
  row("  components inside polygons", f.components);
  row("  polygons that fell back", f.fallbacks);
  row("  local minima", f.minima);
  if (context.options.triangulation.objective == Objective::local_minima)
    row("  lower bound on them",
        std::to_string(f.minima_bound) + (f.minima == f.minima_bound ? " (met: optimal)" : " (not met)"));
  out << "\nPits\n";
  row("  before", f.pits.size());
  row("  left", s.pits);
  row("  vertices lifted", f.lifted);
  char text[64];
  std::snprintf(text, sizeof text, "%.3f m", static_cast<double>(f.lift_total) * unit);
  row("  total displacement", text);
  std::snprintf(text, sizeof text, "%.3f m", static_cast<double>(f.lift_max) * unit);
  row("  largest displacement", text);
  out << "\nResult\n";
  row("  fingerprint", s.fingerprint);
  row("  problems", s.problems.empty() ? "none" : s.problems.front());
  return out.str();
}

void write_file(const std::string& path, const std::string& text) {
  const std::string temporary = path + ".part";
  {
    std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
    out << text;
    out.flush();
    if (!out)
      throw Error(ErrorKind::storage, path + ": cannot be written; check free space and permissions, then run again");
  }
  std::error_code failed;
  fs::rename(temporary, path, failed);
  if (failed)
    throw Error(ErrorKind::storage,
                path + ": cannot be renamed into place (" + failed.message() + "); check permissions");
}

// Results besides the store, relative to the output folder, with their sizes.
std::vector<std::pair<std::string, std::uint64_t>> list_outputs(const RunContext& context) {
  std::vector<std::pair<std::string, std::uint64_t>> out;
  const fs::path root = context.layout.out();
  const auto add = [&](const fs::path& path) {
    if (fs::is_regular_file(path)) out.emplace_back(fs::relative(path, root).string(), fs::file_size(path));
  };
  for (std::uint32_t t = 0; t < context.plan.num_tiles(); ++t) {
    if (context.options.output.mesh_ply) add(context.layout.mesh(t));
    if (context.options.output.dem.enabled) add(context.layout.dem_tile(t));
  }
  if (context.options.output.dem.enabled && context.options.output.dem.cog) add(context.layout.dem());
  if (context.options.output.dem.enabled && context.options.output.dem.hillshade) add(context.layout.hillshade());
  for (const auto& path : {context.layout.layers(), context.layout.report_json(), context.layout.report_text()})
    add(path);
  return out;
}

void write_index(const RunContext& context, const Figures& f) {
  store::Writer out(context.layout.index());
  out.set("recipe", context.recipe(Phase::report));
  const DatasetSummary& s = f.summary;
  for (const auto& [key, value] : {std::pair{"points", s.points},
                                   {"vertices", s.vertices},
                                   {"duplicates", s.duplicates},
                                   {"triangles", s.triangles},
                                   {"pits", s.pits}})
    out.set(key, static_cast<std::int64_t>(value));
  out.set("tiles", std::int64_t{context.plan.num_tiles()});
  out.set("order", std::int64_t{s.order});
  out.set("fingerprint", s.fingerprint);
  const bool hull = context.options.pits.outlets == OutletPolicy::hull;
  out.set("outlets", std::string(context.options.pits.method == PitMethod::none ? "none" : hull ? "hull" : "lowest"));
  out.set("lowest_point", static_cast<std::int64_t>(context.outline.lowest.point.value));
  out.set("crs", context.plan.crs.size() < 60000 ? context.plan.crs : std::string());
  write_lattice(out, context.plan.lattice);
  out.append("tile_count", context.outline.count, "vertices that the tile owns");
  out.append("tile_box", flatten(context.outline.box), "tight boxes of them: min x, min y, max x, max y, lattice");
  std::vector<std::uint64_t> triangles;
  for (const TileRow& t : f.tile) triangles.push_back(t.triangles);
  out.append("tile_triangles", triangles, "triangles in terrain/tile_NNNNNN.h5");
  std::vector<std::uint64_t> checksum(context.plan.num_tiles());
  for_all(context, checksum.size(), [&](std::uint64_t t) { checksum[t] = file_checksum(context.layout.terrain(t)); });
  out.append("tile_checksum", checksum, "of all bytes of terrain/tile_NNNNNN.h5");
  std::vector<std::uint8_t> paths;
  std::vector<std::uint64_t> bytes;
  for (const auto& [path, size] : list_outputs(context)) {
    paths.insert(paths.end(), path.begin(), path.end());
    paths.push_back(0);
    bytes.push_back(size);
  }
  out.append("output_path", paths, "other results, zero-terminated, relative to the output folder");
  out.append("output_bytes", bytes, "their sizes");
  out.commit();
}

}  // namespace

void write_report(const RunContext& context) {
  const Figures figures = collect(context);
  write_rasters(context);
  write_layers(context, figures);
  write_file(context.layout.report_json(), to_json(context, figures).dump(2) + "\n");
  write_file(context.layout.report_text(), to_text(context, figures));
  remove_leftovers(context);
  write_index(context, figures);
}

DatasetSummary read_report(const std::string& path) {
  std::ifstream in(path);
  try {
    const json j = json::parse(in);
    DatasetSummary s;
    s.ok = j.at("ok");
    s.points = j.at("points");
    s.vertices = j.at("vertices");
    s.duplicates = j.at("duplicates");
    s.triangles = j.at("triangles");
    s.order = j.at("order");
    s.max_triangle_order = j.at("max_triangle_order");
    s.pits = j.at("pits");
    s.river_edges = j.at("river_edges");
    s.invalid_river_edges = j.at("invalid_river_edges");
    s.problems = j.at("problems").get<std::vector<std::string>>();
    s.fingerprint = j.at("fingerprint");
    return s;
  } catch (const json::exception&) {
    throw Error(ErrorKind::storage, path + ": the report is missing or unreadable; run again with --overwrite");
  }
}

bool outputs_are_present(const RunContext& context) {
  const store::Reader index(context.layout.index());
  const auto paths = index.read<std::uint8_t>("output_path");
  const auto bytes = index.read<std::uint64_t>("output_bytes");
  auto at = paths.begin();
  for (const std::uint64_t size : bytes) {
    const auto end = std::find(at, paths.end(), std::uint8_t{0});
    if (end == paths.end()) return false;
    const fs::path path = fs::path(context.layout.out()) / std::string(at, end);
    std::error_code missing;
    if (fs::file_size(path, missing) != size || missing) return false;
    at = end + 1;
  }
  return true;
}

}  // namespace hydrotin
