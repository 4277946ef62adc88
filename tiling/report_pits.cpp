#include "report_pits.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "hydrotin/lake_bound.h"
#include "hydrotin/lifting.h"
#include "hydrotin/pit_layers.h"
#include "path_members.h"
#include "pit_options.h"
#include "store.h"

namespace hydrotin {
namespace {

using nlohmann::json;

constexpr Phase kEditPhases[] = {Phase::members, Phase::settle};

// Reads an array from front to back in pieces.
template <class T>
class Sequence {
 public:
  Sequence(const store::Reader& in, std::string name)
      : path_(in.path()), name_(std::move(name)), size_(in.size(name_)) {}

  void read(std::uint64_t begin, std::uint64_t count, std::vector<T>& out) {
    if (begin < first_ || begin + count > first_ + buffer_.size()) {
      if (begin + count > size_)
        throw Error(ErrorKind::storage, path_ + ": the array '" + name_ + "' is cut; delete the file and run again");
      first_ = begin;
      buffer_ = store::Reader(path_).read_range<T>(name_, begin,
                                                   std::max(count, std::min<std::uint64_t>(kPiece, size_ - begin)));
    }
    const auto from = buffer_.begin() + static_cast<std::ptrdiff_t>(begin - first_);
    out.assign(from, from + static_cast<std::ptrdiff_t>(count));
  }

 private:
  static constexpr std::uint64_t kPiece = 65536;
  std::string path_, name_;  // opened anew for each piece: there may be more files than a process may hold open
  std::uint64_t size_, first_ = 0;
  std::vector<T> buffer_;
};

// Features of all files ascending by their keys, which are distinct: those of each file ascend already.
struct FeaturePlace {
  LatticePoint key;
  std::uint32_t file, index;
};

std::vector<FeaturePlace> features_in_order(std::span<const std::string> files, const std::string& key) {
  std::vector<FeaturePlace> out;
  for (std::uint32_t f = 0; f < files.size(); ++f) {
    const auto xy = store::Reader(files[f]).read<std::int32_t>(key);
    for (std::uint32_t i = 0; i < xy.size() / 2; ++i)
      out.push_back({{xy[2 * std::size_t{i}], xy[2 * std::size_t{i} + 1]}, f, i});
  }
  std::sort(out.begin(), out.end(), [](const FeaturePlace& a, const FeaturePlace& b) { return a.key < b.key; });
  return out;
}

// One file's arrays of lifted regions.
struct RegionFile {
  std::vector<std::int32_t> level, lowest;
  std::vector<std::uint64_t> vertices, region_ring_begin, ring_begin;
  std::vector<std::int64_t> displacement;
  std::vector<double> volume;
  Sequence<std::int32_t> ring_xy;

  explicit RegionFile(const store::Reader& in)
      : level(in.read<std::int32_t>("region_level")),
        lowest(in.read<std::int32_t>("region_lowest")),
        vertices(in.read<std::uint64_t>("region_vertices")),
        region_ring_begin(in.read<std::uint64_t>("region_ring_begin")),
        ring_begin(in.read<std::uint64_t>("ring_begin")),
        displacement(in.read<std::int64_t>("region_displacement")),
        volume(in.read<double>("region_volume")),
        ring_xy(in, "ring_xy") {
    const std::size_t n = level.size();
    if (lowest.size() != 3 * n || vertices.size() != n || region_ring_begin.size() != n + 1 ||
        displacement.size() != n || volume.size() != n || region_ring_begin.back() + 1 != ring_begin.size() ||
        !std::is_sorted(region_ring_begin.begin(), region_ring_begin.end()) ||
        !std::is_sorted(ring_begin.begin(), ring_begin.end()))
      throw Error(ErrorKind::storage,
                  in.path() + ": its lifted regions contradict each other; delete it and run again");
  }
};

struct BreachFile {
  std::vector<std::int32_t> pit, depth;
  std::vector<std::uint64_t> lowered, begin;
  std::vector<std::int64_t> displacement;
  std::vector<double> length, volume;
  Sequence<std::int32_t> xyz;

  explicit BreachFile(const store::Reader& in)
      : pit(in.read<std::int32_t>("breach_pit")),
        depth(in.read<std::int32_t>("breach_depth")),
        lowered(in.read<std::uint64_t>("breach_lowered")),
        begin(in.read<std::uint64_t>("breach_begin")),
        displacement(in.read<std::int64_t>("breach_displacement")),
        length(in.read<double>("breach_length")),
        volume(in.read<double>("breach_volume")),
        xyz(in, "breach_xyz") {
    const std::size_t n = depth.size();
    if (pit.size() != 3 * n || lowered.size() != n || begin.size() != n + 1 || displacement.size() != n ||
        length.size() != n || volume.size() != n || !std::is_sorted(begin.begin(), begin.end()))
      throw Error(ErrorKind::storage, in.path() + ": its breaches contradict each other; delete it and run again");
  }
};

std::vector<std::string> edit_files(const RunContext& context) {
  std::vector<std::string> files;
  for (const Phase phase : kEditPhases)
    for (std::uint32_t t = 0; t < context.plan.num_tiles(); ++t) files.push_back(context.layout.unit(phase, t));
  return files;
}

void write_lifted(const RunContext& context, std::span<const std::string> files, GeoPackageWriter& out) {
  LiftedLayer layer(context.plan.lattice, out);
  const auto order = features_in_order(files, "region_key");
  std::vector<RegionFile> region;
  for (const std::string& path : files) region.emplace_back(store::Reader(path));
  std::vector<std::int32_t> xy;
  for (const FeaturePlace& f : order) {
    RegionFile& r = region[f.file];
    const std::size_t i = f.index;
    layer.begin({r.level[i], r.lowest[3 * i + 2], r.vertices[i], r.displacement[i], r.volume[i]});
    for (std::uint64_t k = r.region_ring_begin[i]; k < r.region_ring_begin[i + 1]; ++k) {
      r.ring_xy.read(2 * r.ring_begin[k], 2 * (r.ring_begin[k + 1] - r.ring_begin[k]), xy);
      layer.add_ring(xy);
    }
    layer.end();
  }
}

void write_breaches(const RunContext& context, std::span<const std::string> files, GeoPackageWriter& out) {
  BreachLayer layer(context.plan.lattice, context.options.pits.measure, out);
  const auto order = features_in_order(files, "breach_key");
  std::vector<BreachFile> breach;
  for (const std::string& path : files) breach.emplace_back(store::Reader(path));
  std::vector<std::int32_t> xyz;
  for (const FeaturePlace& f : order) {
    BreachFile& b = breach[f.file];
    const std::size_t i = f.index;
    b.xyz.read(3 * b.begin[i], 3 * (b.begin[i + 1] - b.begin[i]), xyz);
    layer.add({b.pit[3 * i + 2], b.depth[i], b.lowered[i], b.displacement[i], b.length[i], b.volume[i]}, xyz);
  }
}

std::string number(double value, const char* unit) {
  char text[64];
  std::snprintf(text, sizeof text, "%.3f%s", value, unit);
  return text;
}

}  // namespace

PitFigures collect_pit_figures(const RunContext& context) {
  PitFigures out;
  const PitMethod method = context.options.pits.method;
  if (method == PitMethod::none) return out;
  const store::Reader drain(context.layout.unit(Phase::drain, 0));
  for (const std::string& path : edit_files(context)) {
    const store::Reader in(path);
    out.change.add(read_change_figures(in));
    out.regions += static_cast<std::int64_t>(in.size("region_level"));
    out.breaches += static_cast<std::int64_t>(in.size("breach_depth"));
    if (in.has_attribute("cut")) out.cut += in.integer("cut");  // of groups inside one tile
  }
  if (method == PitMethod::lift) {
    out.change.raised += drain.integer("rim_lifted");
    out.change.raise_total += drain.integer("rim_lift_total");
    out.change.raise_max = std::max(out.change.raise_max, drain.integer("rim_lift_max"));
  }
  const store::Reader groups(context.layout.unit(Phase::groups, 0));
  out.largest_group = groups.integer("largest_group");
  out.undrawn = groups.integer("undrawn");
  out.cut += groups.integer("cut");
  if (method != PitMethod::lift) out.undrawn += store::Reader(context.layout.unit(Phase::lakes, 0)).integer("filled");
  for (std::uint32_t t = 0; t < context.plan.num_tiles(); ++t) {
    out.deepest = std::max(out.deepest, store::Reader(context.layout.unit(Phase::pools, t)).integer("deepest"));
    for (const Phase phase : {Phase::pools, Phase::breach}) {
      if (method == PitMethod::lift && phase == Phase::breach) continue;
      const store::Reader in(context.layout.unit(phase, t));
      out.unbreached += in.integer("pits_unbreached");
      out.unfinished += in.integer("pits_unfinished");
      out.dearest = std::max(out.dearest, in.integer("dearest_breach"));
      out.bound += read_bound(in);
    }
  }
  return out;
}

namespace {

// What all lakes cost together at least, in lattice units.
double bound_of_lakes(ChangeMeasure measure, const PitFigures& f) {
  if (measure == ChangeMeasure::volume) return static_cast<double>(f.bound) / kBoundShares;
  return static_cast<double>((f.bound + kBoundShares - 1) / kBoundShares);  // costs are integers
}

}  // namespace

PitVerdict judge_pits(const RunContext& context, const PitFigures& f) {
  const ChangeMeasure measure = context.options.pits.measure;
  const double unit = unit_of(measure, context.plan.lattice);
  const ChangeFigures& c = f.change;
  double cost = 0;
  switch (measure) {
    case ChangeMeasure::total:
      cost = static_cast<double>(c.raise_total + c.lower_total);
      break;
    case ChangeMeasure::max:
      cost = static_cast<double>(std::max(c.raise_max, c.lower_max));
      break;
    case ChangeMeasure::count:
      cost = static_cast<double>(c.raised + c.lowered);
      break;
    case ChangeMeasure::volume:
      cost = c.volume.value();
      break;
  }
  // Lifting is the best of what only raises. Of all else, some way out of the deepest pool must be opened: the pool's
  // rise and the fall of its sill add up to its depth. Where nothing may be raised, no pit is cheaper than by itself.
  double bound = 0;
  const bool lowers_only =
      context.options.pits.method == PitMethod::breach || context.options.pits.method == PitMethod::greedy_breach;
  if (context.options.pits.method == PitMethod::lift || context.options.pits.method == PitMethod::none)
    bound = cost;
  else if (measure == ChangeMeasure::max)
    bound = static_cast<double>((f.deepest + 1) / 2);
  else if (measure == ChangeMeasure::total)
    bound = static_cast<double>(f.deepest);
  else
    bound = f.deepest > 0 ? 1 : 0;
  bound = std::max(bound, bound_of_lakes(measure, f));
  if (lowers_only && f.unbreached == 0 && f.unfinished == 0 && f.cut == 0)
    bound = std::max(bound, static_cast<double>(f.dearest));
  return {cost * unit, std::min(bound, cost) * unit, bound >= cost};
}

std::string pits_json(const RunContext& context, const PitFigures& f) {
  const PitOptions& pits = context.options.pits;
  const Lattice& l = context.plan.lattice;
  const ChangeFigures& c = f.change;
  const PitVerdict verdict = judge_pits(context, f);
  json out = {{"method", pit_method(pits)},
              {"measure", name_of(pits.measure)},
              {"pits_before", f.before},
              {"pits_kept", f.kept},
              {"pits_left", f.left},
              {"vertices_moved", c.raised + c.lowered},
              {"vertices_raised", c.raised},
              {"vertices_lowered", c.lowered},
              {"total_displacement_m", static_cast<double>(c.raise_total + c.lower_total) * l.scale_z},
              {"raised_m", static_cast<double>(c.raise_total) * l.scale_z},
              {"lowered_m", static_cast<double>(c.lower_total) * l.scale_z},
              {"max_displacement_m", static_cast<double>(std::max(c.raise_max, c.lower_max)) * l.scale_z},
              {"volume_m3", c.volume.value() / 6 * l.scale_xy * l.scale_xy * l.scale_z},
              {"lifted_regions", f.regions},
              {"breaches", f.breaches},
              {"lifted_for_want_of_a_breach", f.unbreached},
              {"groups_cut", f.cut},
              {"cost", verdict.cost},
              {"bound", verdict.bound},
              {"optimal", verdict.optimal}};
  if (f.undrawn > 0) out["regions_not_drawn"] = f.undrawn;
  if (pits.method == PitMethod::greedy_breach) out["groups_without_guarantee"] = c.unguaranteed;
  return out.dump();
}

std::vector<std::pair<std::string, std::string>> pit_rows(const RunContext& context, const PitFigures& f) {
  const PitOptions& pits = context.options.pits;
  const Lattice& l = context.plan.lattice;
  const ChangeFigures& c = f.change;
  std::vector<std::pair<std::string, std::string>> rows;
  const auto row = [&](const std::string& label, const std::string& value) { rows.emplace_back("  " + label, value); };
  row("method", pit_method(pits) + (pits.method == PitMethod::none ? "" : ", least " + name_of(pits.measure)));
  row("before", std::to_string(f.before));
  if (f.kept > 0) row("kept", std::to_string(f.kept));
  row("left", std::to_string(f.left));
  row("vertices raised", std::to_string(c.raised));
  row("vertices lowered", std::to_string(c.lowered));
  row("lifted regions", std::to_string(f.regions));
  row("breaches", std::to_string(f.breaches));
  row("total displacement", number(static_cast<double>(c.raise_total + c.lower_total) * l.scale_z, " m"));
  row("largest displacement", number(static_cast<double>(std::max(c.raise_max, c.lower_max)) * l.scale_z, " m"));
  row("volume of change", number(c.volume.value() / 6 * l.scale_xy * l.scale_xy * l.scale_z, " m3"));
  if (pits.method == PitMethod::none) return rows;
  const PitVerdict verdict = judge_pits(context, f);
  row("cost", number(verdict.cost, ""));
  row("bound", number(verdict.bound, verdict.optimal ? " (met: optimal)" : " (not met)"));
  return rows;
}

void write_edit_layers(const RunContext& context, GeoPackageWriter& out) {
  if (context.options.pits.method == PitMethod::none) return;
  const std::vector<std::string> files = edit_files(context);
  write_lifted(context, files, out);
  write_breaches(context, files, out);
}

}  // namespace hydrotin
