#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hydrotin/drainage_problem.h"
#include "hydrotin/objective.h"
#include "hydrotin/polygon.h"
#include "hydrotin/river_constraints.h"
#include "hydrotin/river_matching.h"

/// What a run is asked to do: the checked content of a config, with the defaults that suit classified ground LiDAR in
/// metres. `app` fills it from YAML and `--set`; `tiling` splits it and hands each algorithm its own few numbers.

namespace hydrotin {

enum class OutletPolicy : std::uint8_t {
  hull,    ///< water may leave at the edge of the data
  lowest,  ///< only at the one lowest vertex (ties by (x, y))
  layer    ///< at the features of a file: PitOptions::outlet_layer
};
enum class PitMethod : std::uint8_t { none, lift, breach, greedy_breach, least_change };
enum class PointsFile : std::uint8_t { none, las, gpkg };
enum class RiverMethod : std::uint8_t {
  lp,  ///< the linear program
  dp,  ///< river vertices and outlet chains only, exact and strongly polynomial (Section 7.3)
};
enum class KeepWork : std::uint8_t { never, on_failure, always };

struct InputOptions {
  std::vector<std::string> points;       ///< LAS/LAZ files: absolute paths, globs or /vsi paths
  std::vector<std::string> dem;          ///< rasters whose cells are points, named in the same ways
  int dem_band = 1;                      ///< of each raster
  double dem_quantum_m = 0.001;          ///< cell centres and heights of rasters are multiples of it
  std::optional<double> dem_nodata;      ///< value that means "no height" besides what the rasters say
  std::vector<std::uint8_t> classes{2};  ///< classes used; empty: all
  std::string crs;                       ///< overrides the files' CRS; empty: theirs
  bool withheld = false;                 ///< use points flagged Withheld
  bool synthetic = true;                 ///< use points flagged Synthetic
};

struct DemOptions {
  bool enabled = true;
  double cell_m = 1.0;
  double max_edge_m = 100.0;  ///< triangles with a longer edge stay nodata; 0: no limit
  bool cog = true;            ///< one Cloud Optimized GeoTIFF beside the tiles
  bool hillshade = true;
  bool change = true;  ///< rasters of what rivers and pit removal changed, beside the DEM
};

struct OutputOptions {
  std::string dir;
  DemOptions dem;
  bool mesh_ply = true;
  KeepWork keep = KeepWork::on_failure;  ///< what becomes of the scratch folder
};

struct TileOptions {
  std::uint64_t target_points = 4'000'000;  ///< points a tile is planned for (1,000 or more)
};

/// Which points the TIN can do without.
struct ThinOptions {
  std::optional<double> vertical_error_m;  ///< no point removed is farther above or below the TIN; none: all are kept
  std::optional<double> cell_m;            ///< side of the grid's cells; none: some mean spacings
  bool prune = true;                       ///< remove what later points made superfluous
};

struct TriangulationOptions {
  int order = 2;                                   ///< 0..6
  Objectives objectives{Objective::local_minima};  ///< by priority; see objection_to_run
  std::vector<std::string> reference;  ///< LAS/LAZ files as in InputOptions::points, of points that are no vertices:
                                       ///< vertical errors are measured against them
  bool removed_reference = false;      ///< the points that thinning removed are reference points too; with thinning and
                                       ///< no other reference points they always are
  std::optional<double> max_error_m;   ///< limit on these errors, in the unit of z; none: that of thinning where its
                                       ///< points are reference points, else no limit
  PolygonBudget budget;

  [[nodiscard]] bool has_reference() const { return removed_reference || !reference.empty(); }
};

/// Pits to keep, whatever the method does with the others.
struct KeepPits {
  std::optional<double> deeper_than_m, larger_than_m2, volume_above_m3;  ///< of the water up to the spill level
  std::string inside;              ///< polygons: pits whose smallest vertex lies in one
  std::vector<std::uint64_t> ids;  ///< of the layer `pits` and of pits.csv of an earlier run on the same points
  bool all_conditions = false;     ///< true: all conditions that are given must hold; false: one is enough

  [[nodiscard]] bool any() const {
    return deeper_than_m || larger_than_m2 || volume_above_m3 || !inside.empty() || !ids.empty();
  }
};

struct PitOptions {
  PitMethod method = PitMethod::least_change;
  ChangeMeasure measure = ChangeMeasure::total;
  std::optional<double> max_breach_length_m;  ///< of one breach, horizontally; none: no limit
  std::optional<double> max_breach_depth_m;   ///< by which a vertex may be lowered; none: no limit
  std::uint64_t largest_lake = 200'000;       ///< vertices; larger lakes are raised, whatever the method
  std::uint64_t largest_group = 100'000;      ///< vertices that hang together around pits; larger groups are cut
  KeepPits keep;
  std::optional<std::uint64_t> cheapest;  ///< removes only so many, those that are cheapest to lift together
  OutletPolicy outlets = OutletPolicy::hull;
  std::string outlet_layer;  ///< points, lines or polygons
  bool voids_drain = false;  ///< water may leave at triangles with an edge longer than `void_edge_m`
  double void_edge_m = 100;
};

/// Rivers become valley edges (chapter 7).
struct RiverOptions {
  std::string lines;  ///< a vector file; empty: no rivers
  std::string lakes;  ///< polygons that become level; empty: none
  std::string crs;    ///< of lines and lakes whose file names none; empty: that of the data
  LineMatching matching;
  bool use_z = false;           ///< inserted vertices take the z of the lines
  std::string direction_field;  ///< attribute that says how a line was drawn
  std::vector<std::string> reversed_values{"-1", "reversed", "upstream", "against"};  ///< its values for upstream
  std::string name_field;                    ///< attribute that names rivers; empty: networks are numbered
  std::string lake_level_field;              ///< attribute with the level of a lake; empty: wherever is cheapest
  PointsFile points_out = PointsFile::none;  ///< river vertices as points beside the other results
  RiverMethod method = RiverMethod::lp;
  double time_limit = 0;            ///< seconds for the program of each group of rivers; 0: none
  std::string preserve_edges;       ///< lines along edges of the terrain whose type must not change; empty: none
  bool preserve_drainage = true;    ///< ridge, valley, transfluent
  bool preserve_curvature = false;  ///< convex, reflex
  RiverConstraints constraints;     ///< slopes as rise over run; without lakes, preserved edges and chains

  [[nodiscard]] bool are_given() const { return !lines.empty(); }
};

struct ExecutionOptions {
  int workers = 0;  ///< 0: all cores
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;
  std::string scratch;  ///< folder of the intermediate store; empty: <output.dir>/work
};

struct PipelineOptions {
  InputOptions input;
  OutputOptions output;
  TileOptions tiles;
  ThinOptions thin;
  TriangulationOptions triangulation;
  RiverOptions rivers;
  PitOptions pits;
  ExecutionOptions run;
};

/// Why a run cannot optimise what is asked, or nothing if it can: every list of decomposable objectives and
/// local-minima is possible. What looks at neighbouring polygons (degrees, pairs of triangles) is for point sets in
/// memory; errors need reference points.
[[nodiscard]] std::optional<std::string> objection_to_run(const TriangulationOptions& options);

}  // namespace hydrotin
