#include "report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "dem_cells.h"
#include "file_checksum.h"
#include "fingerprint.h"
#include "hydrotin/measure.h"
#include "hydrotin/pit_layers.h"
#include "hydrotin/raster.h"
#include "hydrotin/vector.h"
#include "hydrotin/version.h"
#include "kept_pits.h"
#include "leftovers.h"
#include "mend.h"
#include "part_value.h"
#include "pit_options.h"
#include "polygon_figures.h"
#include "reduced_store.h"
#include "report_pits.h"
#include "report_rivers.h"
#include "report_thinning.h"
#include "schedule.h"
#include "terrain_file.h"
#include "tile_reference.h"
#include "whole_array.h"

namespace hydrotin {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// What was made of one tile, or of all.
struct TriangulationFigures {
  std::uint64_t points = 0, triangles = 0, useful_edges = 0, fixed_edges = 0;
  std::int64_t minima = 0, minima_bound = 0;
  PolygonFigures polygons;
  ReferenceFigures reference;
  std::vector<ObjectiveValue> value;  // of each objective

  void add(const TriangulationFigures& other) {
    points += other.points;
    triangles += other.triangles;
    useful_edges += other.useful_edges;
    fixed_edges += other.fixed_edges;
    minima += other.minima;
    minima_bound += other.minima_bound;
    polygons.add(other.polygons);
    reference.add(other.reference);
    value.resize(other.value.size());
    for (std::size_t i = 0; i < value.size(); ++i) value[i].add(other.value[i]);
  }
};

// Errors of all reference points inside the hull.
TriangleError errors_of(const TriangulationFigures& f) {
  TriangleError out = f.polygons.error;
  out.add(f.reference.vertex_error);
  return out;
}

// Of the first objective, in the unit of the coordinates.
struct Verdict {
  double value = 0, bound = 0;
  bool optimal = true;
};

// Everything that the tiles' files say, added up.
struct Figures {
  DatasetSummary summary;
  std::vector<TriangulationFigures> tile;
  TriangulationFigures all;
  PitTable pits;  // of the terrain as measured
  PitFigures pit;
  std::optional<ThinningFigures> thinning;
  std::optional<RiverFigures> rivers;
};

std::vector<TriangulationFigures> read_triangulations(const RunContext& context) {
  const std::uint32_t num_tiles = context.plan.num_tiles();
  std::vector<TriangulationFigures> tiles(num_tiles);
  const MendedResults mended = read_mended_results(context);
  const store::Reader drain(context.layout.unit(Phase::drain, 0));
  const auto rim_minima = context.rivers ? laid_rim_minima(context) : drain.read<std::uint64_t>("rim_minima");
  if (rim_minima.size() != num_tiles)
    throw Error(ErrorKind::storage, drain.path() + ": it does not fit the plan; delete the file and run again");
  for (std::uint32_t t = 0; t < num_tiles; ++t) {
    TriangulationFigures& tile = tiles[t];
    const store::Reader triangulated(context.layout.unit(Phase::triangulate, t));
    tile.useful_edges = static_cast<std::uint64_t>(triangulated.integer("useful_edges"));
    tile.fixed_edges = static_cast<std::uint64_t>(triangulated.integer("fixed_edges"));
    tile.minima_bound = triangulated.integer("minima_bound") + static_cast<std::int64_t>(mended.hopeless[t]);
    tile.reference = read_reference_figures(triangulated);
    tile.polygons = read_figures(triangulated);
    tile.polygons.add(mended.figures(context, t));
    const store::Reader spill(context.layout.unit(context.rivers ? Phase::lay : Phase::spill, t));
    tile.value = read_values(spill, context.options.triangulation.objectives.size());
    tile.minima += spill.integer("inner_minima") + static_cast<std::int64_t>(rim_minima[t]);
    // A minimum counts for the tile that owns the point.
    for (const std::uint64_t point : spill.read<std::uint64_t>("foreign_minima")) {
      if (PointId(point).tile() >= num_tiles)
        throw Error(ErrorKind::storage,
                    spill.path() + ": a minimum is of a tile that does not exist; delete the file and run again");
      --tile.minima;
      ++tiles[PointId(point).tile()].minima;
    }
  }
  return tiles;
}

double value_of(Objective objective, const TriangulationFigures& f, std::size_t i) {
  if (objective == Objective::min_max_order) return static_cast<double>(f.polygons.max_order);
  if (objective == Objective::min_squared_error) return errors_of(f).squared.value();
  if (objective == Objective::min_absolute_error) return errors_of(f).absolute.value();
  if (objective == Objective::min_max_error) return errors_of(f).largest;
  switch (kind_of(objective)) {
    case ObjectiveKind::minima:
      return static_cast<double>(f.minima);
    case ObjectiveKind::sum:
    case ObjectiveKind::bottleneck:
      return total(objective, f.value[i]);
    default:
      return 0;
  }
}

Verdict judge(const RunContext& context, const TriangulationFigures& f) {
  const Objective first = context.options.triangulation.objectives.front();
  const double unit = unit_of(first, context.plan.lattice);
  Verdict out{value_of(first, f, 0) * unit, 0, f.polygons.not_optimal == 0};
  switch (kind_of(first)) {
    case ObjectiveKind::minima:
      out.bound = static_cast<double>(f.minima_bound);
      out.optimal = f.minima == f.minima_bound;
      break;
    case ObjectiveKind::sum: {
      // Every inner edge was counted from both sides.
      const double gap = f.polygons.gap.value() * unit / (first == Objective::min_weight ? 2 : 1);
      out.bound = is_maximised(first) ? out.value + gap : out.value - gap;
      break;
    }
    case ObjectiveKind::bottleneck: {
      double score = f.polygons.bound;
      if (needs_reference(first)) score = std::max(score, f.reference.vertex_error.largest);
      out.bound = out.optimal ? out.value : measure_of_score(first, score) * unit;
      break;
    }
    default:
      break;
  }
  return out;
}

Figures collect(const RunContext& context) {
  Figures f;
  f.tile = read_triangulations(context);
  Fingerprint fingerprint;
  std::vector<PlateauSummary> open;
  for (std::uint32_t t = 0; t < context.plan.num_tiles(); ++t) {
    const store::Reader terrain(context.layout.terrain(t));
    const auto part = Fingerprint::parse(terrain.text("fingerprint"));
    if (!part)
      throw Error(ErrorKind::storage,
                  terrain.path() + ": its fingerprint is unreadable; delete the file and run again");
    fingerprint.add(*part);
    f.tile[t].points = static_cast<std::uint64_t>(terrain.integer("points"));
    f.tile[t].triangles = static_cast<std::uint64_t>(terrain.integer("triangles"));
    f.all.add(f.tile[t]);
    f.summary.pits += read_pits(terrain, "final_").size();
    open.push_back(read_open_plateaus(terrain, "final_"));
  }
  f.summary.pits += resolve_plateaus(open).size();
  f.pits = read_pit_table(store::Reader(context.layout.unit(Phase::choose, 0)));
  f.pit = collect_pit_figures(context);
  f.pit.before = f.pits.pit.size();
  f.pit.kept = static_cast<std::uint64_t>(std::count(f.pits.is_kept.begin(), f.pits.is_kept.end(), 1));
  f.pit.left = f.summary.pits;
  DatasetSummary& s = f.summary;
  s.triangles = f.all.triangles;
  s.max_triangle_order = static_cast<int>(f.all.polygons.max_order);
  s.points = context.outline.points;
  s.vertices = context.outline.vertices;
  s.duplicates = context.outline.duplicates;
  s.order = context.options.triangulation.order;
  s.fingerprint = fingerprint.hex();
  if (context.options.pits.method != PitMethod::none && s.pits > 0)
    s.problems.push_back(std::to_string(s.pits) + " pits are left");
  f.thinning = read_thinning(context);
  if (f.thinning)
    for (std::string& problem : problems_of(*f.thinning)) s.problems.push_back(std::move(problem));
  if (context.rivers) {
    f.rivers = collect_river_figures(context);
    s.river_edges = f.rivers->edges;
    s.invalid_river_edges = f.rivers->invalid.size();
    s.vertices += context.rivers->network.num_new;
    if (f.rivers->unexpected > 0)
      s.problems.push_back(std::to_string(f.rivers->unexpected) +
                           " river edges are invalid, though nothing speaks against them");
  }
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
  write_pit_layer(l, figures.pits.pit, figures.pits.is_kept, out);
  write_edit_layers(context, out);
  if (figures.rivers) write_river_layers(context, *figures.rivers, out);
  out.finish();
}

void write_rasters(const RunContext& context) {
  const DemOptions& dem = context.options.output.dem;
  if (!dem.enabled) return;
  std::vector<fs::path> tiles;
  for (std::uint32_t t = 0; t < context.plan.num_tiles(); ++t)
    if (fs::exists(context.layout.dem_tile(t))) tiles.emplace_back(context.layout.dem_tile(t));
  if (tiles.empty() || (!dem.cog && !dem.hillshade && !wants_change_raster(context.options))) return;
  MosaicOptions options;
  options.num_threads = static_cast<int>(worker_count(context.options.run));
  options.cache_bytes = static_cast<std::int64_t>(
      std::min<std::uint64_t>(context.options.run.memory_bytes / 4, std::uint64_t{256} << 20));
  const std::string mosaic = context.layout.out() + "/dem/mosaic.vrt";
  write_virtual_mosaic(mosaic, tiles);
  if (dem.cog) write_cloud_optimized_geotiff(context.layout.dem(), tiles, options);
  if (wants_change_raster(context.options)) {
    std::vector<fs::path> changes;
    for (std::uint32_t t = 0; t < context.plan.num_tiles(); ++t)
      if (fs::exists(context.layout.change_tile(t))) changes.emplace_back(context.layout.change_tile(t));
    write_virtual_mosaic(context.layout.out() + "/change/mosaic.vrt", changes);
    if (dem.cog) write_cloud_optimized_geotiff(context.layout.change(), changes, options);
  }
  if (dem.hillshade)
    write_hillshade(context.layout.hillshade(), dem.cog ? context.layout.dem() : mosaic, 4096, options);
}

std::int64_t num_files(const Plan& plan, bool is_reference) {
  return std::count_if(plan.files.begin(), plan.files.end(),
                       [&](const PlanFile& file) { return file.is_reference == is_reference && file.is_first(); });
}

// Of the points measured: those inside the hull, in all; of one tile, what its polygons and vertices measured.
double rms_of(const RunContext& context, const TriangulationFigures& f) {
  const std::uint64_t inside = f.reference.points - f.reference.outside;
  if (inside == 0) return 0;
  return std::sqrt(errors_of(f).squared.value() / static_cast<double>(inside)) * context.plan.lattice.scale_z;
}

json to_json(const RunContext& context, const TriangulationFigures& f) {
  const PolygonFigures& p = f.polygons;
  std::size_t num_sizes = PolygonFigures::kNumSizes;
  while (num_sizes > 0 && p.sizes[num_sizes - 1] == 0) --num_sizes;
  json out = {{"max_order", p.max_order},
              {"useful_edges", f.useful_edges},
              {"fixed_edges", f.fixed_edges},
              {"polygons", p.polygons},
              {"polygon_sizes", std::vector<std::uint64_t>(p.sizes.begin(), p.sizes.begin() + num_sizes)},
              {"largest_polygon", p.max_polygon},
              {"components", p.components},
              {"most_components", p.max_components},
              {"local_minima", f.minima},
              {"fallbacks", p.fallbacks},
              {"limit_missed", p.limit_missed}};
  if (context.has_reference())
    out["reference"] = {{"points", f.reference.points},
                        {"outside", f.reference.outside},
                        {"at_vertices", f.reference.at_vertices},
                        {"max_error", errors_of(f).largest * context.plan.lattice.scale_z},
                        {"rms", rms_of(context, f)},
                        {"limit_missed", p.limit_missed},
                        {"vertices_beyond_limit", f.reference.beyond_limit}};
  const Objectives& objectives = context.options.triangulation.objectives;
  json values = json::object();
  for (std::size_t i = 0; i < objectives.size(); ++i)
    if (kind_of(objectives[i]) != ObjectiveKind::none)
      values[std::string(name(objectives[i]))] =
          value_of(objectives[i], f, i) * unit_of(objectives[i], context.plan.lattice);
  const Verdict verdict = judge(context, f);
  out["values"] = values;
  if (kind_of(objectives.front()) != ObjectiveKind::none) {
    out["value"] = verdict.value;
    out["bound"] = verdict.bound;
  }
  out["optimal"] = verdict.optimal;
  return out;
}

json to_json(const RunContext& context, const Figures& f) {
  const DatasetSummary& s = f.summary;
  json triangulation = to_json(context, f.all);
  triangulation["order"] = s.order;
  triangulation["objective"] = name(context.options.triangulation.objectives);
  json tiles = json::array();
  for (std::size_t t = 0; t < f.tile.size(); ++t) {
    tiles.push_back(to_json(context, f.tile[t]));
    tiles.back()["tile"] = t;
    tiles.back()["points"] = f.tile[t].points;
    tiles.back()["triangles"] = f.tile[t].triangles;
  }
  if (context.options.triangulation.max_error_m)
    triangulation["max_error_m"] = *context.options.triangulation.max_error_m;
  for (json& tile : tiles)  // a point may be measured by a polygon of another tile
    if (tile.contains("reference")) tile["reference"].erase("rms");
  triangulation["per_tile"] = std::move(tiles);
  return {{"program", std::string("hydrotin ") + version()},
          {"crs", context.plan.crs},
          {"tiles", context.plan.num_tiles()},
          {"files", num_files(context.plan, false)},
          {"reference_files", num_files(context.plan, true)},
          {"cells_nodata", skipped_cells(context).nodata},
          {"cells_not_finite", skipped_cells(context).not_finite},
          {"triangulation", triangulation},
          {"thinning", f.thinning ? to_json(context, *f.thinning) : json()},
          {"pit_removal", json::parse(pits_json(context, f.pit))},
          {"ok", s.ok},
          {"points", s.points},
          {"vertices", s.vertices},
          {"duplicates", s.duplicates},
          {"triangles", s.triangles},
          {"max_triangle_order", s.max_triangle_order},
          {"order", s.order},
          {"pits", s.pits},
          {"rivers", f.rivers ? json::parse(rivers_json(context, *f.rivers)) : json()},
          {"river_edges", s.river_edges},
          {"invalid_river_edges", s.invalid_river_edges},
          {"problems", s.problems},
          {"fingerprint", s.fingerprint}};
}

std::string short_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", value);
  return text;
}

template <class Row>
void write_verdict(const RunContext& context, const TriangulationFigures& f, Row row) {
  if (kind_of(context.options.triangulation.objectives.front()) == ObjectiveKind::none) return;
  const Verdict verdict = judge(context, f);
  row("  value", short_number(verdict.value));
  row("  bound", short_number(verdict.bound) + (verdict.optimal ? " (met: optimal)" : " (not met)"));
}

// 1, 2, 3-4, 5-8, ...
std::string bucket_name(std::size_t bucket) {
  if (bucket < 2) return std::to_string(bucket + 1);
  return std::to_string((std::uint64_t{1} << (bucket - 1)) + 1) + "-" + std::to_string(std::uint64_t{1} << bucket);
}

void write_tiles(const RunContext& context, const Figures& f, std::ostream& out) {
  char line[256];
  const auto print = [&](auto... cells) {
    std::snprintf(line, sizeof line, "%6s %11s %11s %5s %12s %11s %10s %8s %10s %9s %16s %16s %s\n", cells...);
    out << line;
  };
  out << "\nTiles\n";
  print("tile", "points", "triangles", "order", "useful edges", "fixed", "polygons", "largest", "components",
        "fallbacks", "value", "bound", "optimal");
  const auto text = [](std::uint64_t n) { return std::to_string(n); };
  for (std::size_t t = 0; t < f.tile.size(); ++t) {
    const TriangulationFigures& tile = f.tile[t];
    const PolygonFigures& p = tile.polygons;
    const Verdict verdict = judge(context, tile);
    print(text(t).c_str(), text(tile.points).c_str(), text(tile.triangles).c_str(), text(p.max_order).c_str(),
          text(tile.useful_edges).c_str(), text(tile.fixed_edges).c_str(), text(p.polygons).c_str(),
          text(p.max_polygon).c_str(), text(p.components).c_str(), text(p.fallbacks).c_str(),
          short_number(verdict.value).c_str(), short_number(verdict.bound).c_str(), verdict.optimal ? "yes" : "no");
  }
}

std::string to_text(const RunContext& context, const Figures& f) {
  const DatasetSummary& s = f.summary;
  const double unit = context.plan.lattice.scale_z;
  std::ostringstream out;
  const auto row = [&](const std::string& label, const auto& value) {
    out << label << std::string(label.size() < 28 ? 28 - label.size() : 1, ' ') << value << '\n';
  };
  out << "hydrotin " << version() << "\n\nInput\n";
  row("  files", num_files(context.plan, false));
  if (num_files(context.plan, true) > 0) row("  files of reference points", num_files(context.plan, true));
  if (const SkippedCells skipped = skipped_cells(context); skipped.nodata + skipped.not_finite > 0)
    row("  raster cells without height", skipped.nodata + skipped.not_finite);
  row("  CRS", context.plan.crs.empty() ? "none" : context.plan.crs);
  row("  points kept", s.points);
  row("  duplicates in (x, y)", s.duplicates);
  out << "\nTriangulation\n";
  row("  tiles", context.plan.num_tiles());
  row("  vertices", s.vertices);
  row("  triangles", s.triangles);
  row("  order asked for", s.order);
  row("  highest order used", s.max_triangle_order);
  row("  objective", name(context.options.triangulation.objectives));
  write_verdict(context, f.all, row);
  row("  useful edges", f.all.useful_edges);
  row("  fixed edges", f.all.fixed_edges);
  row("  polygons", f.all.polygons.polygons);
  row("  largest polygon", std::to_string(f.all.polygons.max_polygon) + " Delaunay triangles");
  row("  components inside polygons", std::to_string(f.all.polygons.components) + ", at most " +
                                          std::to_string(f.all.polygons.max_components) + " in one");
  row("  polygons that fell back", f.all.polygons.fallbacks);
  row("  local minima", f.all.minima);
  out << "\nPolygons by Delaunay triangles\n";
  for (std::size_t b = 0; b < PolygonFigures::kNumSizes; ++b)
    if (f.all.polygons.sizes[b] > 0) row("  " + bucket_name(b), f.all.polygons.sizes[b]);
  out << "\nPits\n";
  for (const auto& [label, value] : pit_rows(context, f.pit)) row(label, value);
  if (context.has_reference()) {
    out << "\nReference points\n";
    row("  points", f.all.reference.points);
    row("  outside the hull", f.all.reference.outside);
    row("  at vertices", f.all.reference.at_vertices);
    row("  largest error", short_number(errors_of(f.all).largest * unit) + " m");
    row("  root mean square error", short_number(rms_of(context, f.all)) + " m");
    if (context.options.triangulation.max_error_m) {
      row("  limit", short_number(*context.options.triangulation.max_error_m) + " m");
      row("  polygons beyond it", f.all.polygons.limit_missed);
      row("  vertices beyond it", f.all.reference.beyond_limit);
    }
  }
  if (f.rivers) write_text(context, *f.rivers, out);
  if (f.thinning) write_text(context, *f.thinning, out);
  write_tiles(context, f, out);
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
    if (wants_change_raster(context.options)) add(context.layout.change_tile(t));
  }
  if (context.options.output.dem.enabled && context.options.output.dem.cog) add(context.layout.dem());
  if (wants_change_raster(context.options) && context.options.output.dem.cog) add(context.layout.change());
  if (context.options.output.dem.enabled && context.options.output.dem.hillshade) add(context.layout.hillshade());
  if (context.rivers) {
    add(context.layout.rivers());
    for (const char* extension : {"las", "gpkg"}) add(context.layout.river_points(extension));
    std::error_code absent;
    std::vector<fs::path> profiles;
    for (fs::directory_iterator at(context.layout.profiles(), absent), end; !absent && at != end; at.increment(absent))
      profiles.push_back(at->path());
    std::sort(profiles.begin(), profiles.end());
    for (const fs::path& path : profiles) add(path);
  }
  for (const auto& path :
       {context.layout.layers(), context.layout.pits_csv(), context.layout.report_json(), context.layout.report_text()})
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
  const bool removed = context.options.pits.method != PitMethod::none;
  out.set("outlets", removed ? outlet_policy(context.options.pits) : std::string("none"));
  out.set("pits_kept", static_cast<std::int64_t>(f.pit.kept));
  out.set("lowest_point", static_cast<std::int64_t>(context.outline.lowest.point.value));
  out.set("crs", context.plan.crs.size() < 60000 ? context.plan.crs : std::string());
  if (f.thinning) write_to_index(context, *f.thinning, out);
  if (f.rivers) write_to_index(context, *f.rivers, out);
  write_lattice(out, context.plan.lattice);
  out.append("tile_count", context.outline.count, "vertices that the tile owns");
  out.append("tile_box", flatten(context.outline.box), "tight boxes of them: min x, min y, max x, max y, lattice");
  std::vector<std::uint64_t> triangles;
  for (const TriangulationFigures& t : f.tile) triangles.push_back(t.triangles);
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
  const std::string folder = fs::path(context.layout.index()).parent_path().string();
  store::sync_folder(folder);  // whatever the index lists is there for good before the index is
  out.commit();
  store::sync_folder(folder);
}

}  // namespace

void write_report(const RunContext& context) {
  const Figures figures = collect(context);
  write_rasters(context);
  write_layers(context, figures);
  write_file(context.layout.pits_csv(), pits_csv(context.plan.lattice, figures.pits.pit, figures.pits.is_kept));
  write_file(context.layout.report_json(), to_json(context, figures).dump(2) + "\n");
  write_file(context.layout.report_text(), to_text(context, figures));
  if (context.rivers) {
    write_river_store(context);
    write_river_points(context, *figures.rivers);
  }
  remove_leftovers(context);
  remove_other_profiles(context,
                        figures.rivers ? write_river_profiles(context, *figures.rivers) : std::vector<std::string>());
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
