#include "plan.h"

#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "block_index.h"
#include "hydrotin/crs.h"
#include "hydrotin/error.h"
#include "plan_inputs.h"
#include "recipe.h"
#include "store.h"

namespace hydrotin {
namespace {

// One CRS for all inputs, in which x and y are lengths.
Crs common_crs(const std::vector<PlanInput>& inputs, const std::string& override_crs) {
  if (override_crs == "none") return {};
  Crs crs;
  std::string first;
  if (!override_crs.empty()) {
    crs = parse_crs(override_crs, "input.crs");
  } else {
    for (const PlanInput& input : inputs) {
      if (input.points == 0) continue;  // files without points are of no place
      if (input.crs_wkt.empty())
        throw Error(ErrorKind::input, input.path() +
                                          ": no CRS in the file; set input.crs (for instance EPSG:2154, or none "
                                          "for coordinates without one)");
      const Crs own = crs_from_wkt(input.crs_wkt, input.path());
      if (crs.is_unknown()) {
        crs = own;
        first = input.path();
      }
      if (!same_crs(crs, own))
        throw Error(ErrorKind::input, input.path() + ": its CRS " + own.name + " is not that of " + first + ", " +
                                          crs.name + "; reproject one of them, or set input.crs if a header is wrong");
    }
  }
  if (!crs.is_projected)
    throw Error(ErrorKind::input, inputs[0].path() + ": its CRS " + crs.name +
                                      " is not projected, but x and y have to be lengths; reproject the points, or set "
                                      "input.crs if the header is wrong");
  return crs;
}

// A file's points spread evenly over its box.
struct Spread {
  double x0, y0, x1, y1, points;
};

class TileCutter {
 public:
  TileCutter(std::vector<Spread> spreads, double target, Plan& plan) : target_(target), plan_(plan) {
    constexpr std::int32_t kLow = std::numeric_limits<std::int32_t>::min(),
                           kHigh = std::numeric_limits<std::int32_t>::max();
    LatticeBox data;
    for (const Spread& s : spreads) {
      data.extend(LatticePoint{static_cast<std::int32_t>(s.x0), static_cast<std::int32_t>(s.y0)});
      data.extend(LatticePoint{static_cast<std::int32_t>(s.x1), static_cast<std::int32_t>(s.y1)});
    }
    if (data.is_empty()) data = {{0, 0}, {0, 0}};
    plan_.data = data;
    cut(std::move(spreads), data, LatticeBox{{kLow, kLow}, {kHigh, kHigh}});
  }

 private:
  // `data` is the part of the data's box in the node, `core` the part of the lattice.
  std::uint32_t cut(std::vector<Spread> spreads, const LatticeBox& data, const LatticeBox& core) {
    const auto node = static_cast<std::uint32_t>(plan_.nodes.size());
    plan_.nodes.emplace_back();
    double points = 0;
    for (const Spread& s : spreads) points += s.points;
    const std::int64_t width = std::int64_t{data.max.x} - data.min.x, height = std::int64_t{data.max.y} - data.min.y;
    if (points <= target_ || std::max(width, height) < 2) {
      plan_.nodes[node].below = plan_.num_tiles();
      plan_.core.push_back(core);
      plan_.expected.push_back(static_cast<std::uint64_t>(std::llround(points)));
      return node;
    }
    const bool by_x = width >= height;
    const auto split = static_cast<std::int32_t>(
        (by_x ? std::int64_t{data.min.x} + data.max.x : std::int64_t{data.min.y} + data.max.y) / 2);
    LatticeBox below = data, above = data, core_below = core, core_above = core;
    (by_x ? below.max.x : below.max.y) = (by_x ? core_below.max.x : core_below.max.y) = split - 1;
    (by_x ? above.min.x : above.min.y) = (by_x ? core_above.min.x : core_above.min.y) = split;
    auto [low, high] = share(spreads, by_x, split);
    spreads.clear();
    spreads.shrink_to_fit();
    plan_.nodes[node].axis = by_x ? 0 : 1;
    plan_.nodes[node].split = split;
    const std::uint32_t child_below = cut(std::move(low), below, core_below);
    const std::uint32_t child_above = cut(std::move(high), above, core_above);
    plan_.nodes[node].below = child_below;
    plan_.nodes[node].above = child_above;
    return node;
  }

  static std::pair<std::vector<Spread>, std::vector<Spread>> share(const std::vector<Spread>& spreads, bool by_x,
                                                                   double split) {
    std::pair<std::vector<Spread>, std::vector<Spread>> out;
    for (const Spread& s : spreads) {
      const double from = by_x ? s.x0 : s.y0, to = (by_x ? s.x1 : s.y1) + 1;
      const double fraction = std::clamp((split - from) / (to - from), 0.0, 1.0);
      Spread low = s, high = s;
      low.points = s.points * fraction;
      high.points = s.points - low.points;
      (by_x ? low.x1 : low.y1) = std::min(by_x ? s.x1 : s.y1, split - 1);
      (by_x ? high.x0 : high.y0) = std::max(by_x ? s.x0 : s.y0, split);
      if (fraction > 0) out.first.push_back(low);
      if (fraction < 1) out.second.push_back(high);
    }
    return out;
  }

  double target_;
  Plan& plan_;
};

std::string plan_recipe(const std::vector<PlanInput>& inputs, const PipelineOptions& options) {
  RecipeHash hash;
  for (const PlanInput& input : inputs) {
    hash.add(input.path()).add(static_cast<std::int64_t>(input.bytes));
    for (const std::string& file : input.files) {
      struct stat info {};
      ::stat(file.c_str(), &info);
      hash.add(static_cast<std::int64_t>(info.st_mtime)).add(static_cast<std::int64_t>(info.st_size));
    }
    hash.add(std::int64_t{input.is_reference}).add(std::int64_t{input.is_dem});
  }
  for (const std::uint8_t c : options.input.classes) hash.add(std::int64_t{c});
  hash.add(options.input.crs).add(std::int64_t{options.input.withheld}).add(std::int64_t{options.input.synthetic});
  if (!options.input.dem.empty())
    hash.add(std::int64_t{options.input.dem_band})
        .add(options.input.dem_quantum_m)
        .add(options.input.dem_nodata.value_or(std::numeric_limits<double>::infinity()));
  hash.add(static_cast<std::int64_t>(options.tiles.target_points));
  return hash.hex();
}

// Clouds are read in one piece, rasters in ranges of rows of whole blocks.
std::vector<PlanFile> units_of(const PlanInput& input, const LatticeMap& map) {
  if (!input.is_dem) return {{input.path(), input.points, map, input.is_reference, false, 0, 0}};
  constexpr std::uint64_t kUnitCells = std::uint64_t{1} << 24;
  const std::uint64_t high = input.block_rows;
  const std::uint64_t rows = std::max<std::uint64_t>(1, kUnitCells / (high * input.num_columns)) * high;
  std::vector<PlanFile> out;
  for (std::uint64_t first = 0; first < input.num_rows; first += rows) {
    const std::uint64_t count = std::min<std::uint64_t>(rows, input.num_rows - first);
    out.push_back({input.path(), count * input.num_columns, map, false, true, first, count});
  }
  return out;
}

// The points of a unit, on the lattice.
Spread spread_of(const PlanFile& file, const PlanInput& input, const Lattice& l) {
  const auto at = [&](double v, double offset, std::int64_t base) {
    return std::clamp(std::floor((v - offset) / l.scale_xy) - static_cast<double>(base), -2147483000.0, 2147483000.0);
  };
  const auto box = input.bounds(file.first_row, file.num_rows);
  Spread s{at(box[0], l.offset_x, l.base_x), at(box[1], l.offset_y, l.base_y), at(box[2], l.offset_x, l.base_x),
           at(box[3], l.offset_y, l.base_y),
           static_cast<double>(file.points) / (file.is_reference ? kReferencePerPoint : 1)};
  if (s.x1 < s.x0) std::swap(s.x0, s.x1);
  if (s.y1 < s.y0) std::swap(s.y0, s.y1);
  return s;
}

}  // namespace

Plan make_plan(const PipelineOptions& options) {
  const std::vector<PlanInput> inputs = open_inputs(options);
  std::vector<FileLattice> with_points;
  bool has_points = false;
  for (const PlanInput& input : inputs) {
    if (input.points == 0) continue;
    has_points = has_points || !input.is_reference;
    with_points.push_back(input.lattice);
  }
  if (!has_points)
    throw Error(ErrorKind::input, inputs.front().path() + ": no point in any input; give files that have points");
  const Crs crs = common_crs(inputs, options.input.crs);
  Plan plan;
  plan.crs = crs.name;
  plan.crs_wkt = crs.wkt;
  plan.metres_per_unit = crs.metres_per_unit;

  const CommonLattice common = common_lattice(with_points);
  plan.lattice = common.lattice;
  std::vector<Spread> spreads;
  auto map = common.map.begin();
  for (const PlanInput& input : inputs) {
    const bool has_some = input.points > 0;
    for (const PlanFile& unit : units_of(input, has_some ? *map : LatticeMap{})) {
      if (has_some) spreads.push_back(spread_of(unit, input, plan.lattice));
      plan.files.push_back(unit);
    }
    if (has_some) ++map;
  }
  TileCutter(std::move(spreads), static_cast<double>(options.tiles.target_points), plan);
  plan.recipe = plan_recipe(inputs, options);
  return plan;
}

void save_plan(const Plan& plan, const std::string& path) {
  store::Writer out(path);
  out.set("recipe", plan.recipe);
  out.set("crs", plan.crs.size() < 60000 ? plan.crs : std::string());
  out.set("crs_wkt", plan.crs_wkt.size() < 60000 ? plan.crs_wkt : std::string());
  out.set("metres_per_unit", plan.metres_per_unit);
  const Lattice& l = plan.lattice;
  out.append("lattice_scale_offset", std::vector<double>{l.scale_xy, l.scale_z, l.offset_x, l.offset_y, l.offset_z},
             "scale of x and y, scale of z, offsets of x, y, z: coordinate = (base + integer) * scale + offset");
  out.append("lattice_base", std::vector<std::int64_t>{l.base_x, l.base_y, l.base_z}, "base of x, y, z");
  std::vector<std::uint8_t> names;
  std::vector<std::uint64_t> points;
  std::vector<std::int64_t> map;
  std::vector<std::uint8_t> is_reference, is_dem;
  std::vector<std::uint64_t> rows;
  for (const PlanFile& file : plan.files) {
    is_reference.push_back(file.is_reference);
    is_dem.push_back(file.is_dem);
    rows.insert(rows.end(), {file.first_row, file.num_rows});
    names.insert(names.end(), file.path.begin(), file.path.end());
    names.push_back(0);
    points.push_back(file.points);
    for (std::size_t a = 0; a < 3; ++a) map.insert(map.end(), {file.map.factor[a], file.map.shift[a]});
  }
  out.append("file_path", names, "zero-terminated paths");
  out.append("file_points", points);
  out.append("file_is_reference", is_reference, "1: its points are no vertices");
  out.append("file_is_dem", is_dem, "1: a raster, of which a range of rows is read");
  out.append("file_rows", rows, "first row and number of rows of a raster's range");
  out.append("file_map", map, "factor and shift of x, y, z for each file");
  std::vector<std::int64_t> nodes;
  for (const PlanNode& n : plan.nodes) nodes.insert(nodes.end(), {n.axis, n.split, n.below, n.above});
  out.append("node", nodes, "axis (2: leaf), split, below (of a leaf: tile), above");
  std::vector<std::int32_t> core;
  for (const LatticeBox& b : plan.core) core.insert(core.end(), {b.min.x, b.min.y, b.max.x, b.max.y});
  out.append("tile_core", core, "closed boxes: min x, min y, max x, max y");
  out.append("data_box", flatten(std::vector<LatticeBox>{plan.data}), "that the headers claim, lattice");
  out.append("tile_expected", plan.expected, "points expected");
  out.commit();
}

Plan load_plan(const std::string& path) {
  const store::Reader in(path);
  const auto damaged = [&]() -> Error {
    return Error(ErrorKind::storage, path + ": the plan contradicts itself; delete it and run again");
  };
  Plan plan;
  plan.recipe = in.text("recipe");
  plan.crs = in.text("crs");
  plan.crs_wkt = in.text("crs_wkt");
  plan.metres_per_unit = in.real("metres_per_unit");
  const auto scale = in.read<double>("lattice_scale_offset");
  const auto base = in.read<std::int64_t>("lattice_base");
  if (scale.size() != 5 || base.size() != 3) throw damaged();
  plan.lattice = {scale[0], scale[1], scale[2], scale[3], scale[4], base[0], base[1], base[2]};
  const auto names = in.read<std::uint8_t>("file_path");
  const auto points = in.read<std::uint64_t>("file_points");
  const auto map = in.read<std::int64_t>("file_map");
  const auto is_reference = in.read<std::uint8_t>("file_is_reference");
  const auto is_dem = in.read<std::uint8_t>("file_is_dem");
  const auto rows = in.read<std::uint64_t>("file_rows");
  if (is_reference.size() != points.size() || is_dem.size() != points.size() || rows.size() != 2 * points.size())
    throw damaged();
  auto at = names.begin();
  for (std::size_t f = 0; f < points.size(); ++f) {
    const auto end = std::find(at, names.end(), std::uint8_t{0});
    if (end == names.end() || map.size() != 6 * points.size()) throw damaged();
    PlanFile file{std::string(at, end), points[f],      {}, is_reference[f] != 0, is_dem[f] != 0,
                  rows[2 * f],          rows[2 * f + 1]};
    for (std::size_t a = 0; a < 3; ++a) {
      file.map.factor[a] = map[6 * f + 2 * a];
      file.map.shift[a] = map[6 * f + 2 * a + 1];
    }
    plan.files.push_back(std::move(file));
    at = end + 1;
  }
  const auto nodes = in.read<std::int64_t>("node");
  const auto core = in.read<std::int32_t>("tile_core");
  plan.expected = in.read<std::uint64_t>("tile_expected");
  const auto data = unflatten(in.read<std::int32_t>("data_box"));
  if (data.size() != 1) throw damaged();
  plan.data = data[0];
  const std::size_t tiles = plan.expected.size(), num_nodes = nodes.size() / 4;
  if (core.size() != 4 * tiles || tiles == 0 || num_nodes != 2 * tiles - 1) throw damaged();
  for (std::size_t i = 0; i < num_nodes; ++i) {
    const std::int64_t axis = nodes[4 * i], below = nodes[4 * i + 2], above = nodes[4 * i + 3];
    const auto child_ok = [&](std::int64_t child) {
      return child > static_cast<std::int64_t>(i) && child < static_cast<std::int64_t>(num_nodes);
    };
    const bool ok = axis == 2 ? below >= 0 && below < static_cast<std::int64_t>(tiles)
                              : (axis == 0 || axis == 1) && child_ok(below) && child_ok(above);
    if (!ok) throw damaged();
    plan.nodes.push_back({static_cast<std::uint32_t>(axis), static_cast<std::int32_t>(nodes[4 * i + 1]),
                          static_cast<std::uint32_t>(below), static_cast<std::uint32_t>(above)});
  }
  for (std::size_t t = 0; t < tiles; ++t)
    plan.core.push_back({{core[4 * t], core[4 * t + 1]}, {core[4 * t + 2], core[4 * t + 3]}});
  return plan;
}

}  // namespace hydrotin
