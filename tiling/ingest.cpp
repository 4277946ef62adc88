#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bitset>
#include <limits>
#include <numeric>

#include "hydrotin/dem_points.h"
#include "hydrotin/las.h"
#include "hydrotin/raster_names.h"
#include "phases.h"
#include "store.h"

namespace hydrotin {
namespace {

constexpr std::size_t kChunksAtOnce = 8;
constexpr std::size_t kBatchPoints = 1U << 20;

// Points of one file on the common lattice.
struct Batch {
  std::vector<LatticePoint> position;
  std::vector<std::int32_t> height;
};

class Selector {
 public:
  explicit Selector(const InputOptions& options) : all_classes_(options.classes.empty()) {
    for (const std::uint8_t c : options.classes) wanted_.set(c);
    if (!options.withheld) unwanted_flags_ |= PointFlag::withheld;
    if (!options.synthetic) unwanted_flags_ |= PointFlag::synthetic;
  }
  [[nodiscard]] bool takes(std::uint8_t classification, std::uint8_t flags) const {
    return (all_classes_ || wanted_[classification]) && (flags & unwanted_flags_) == 0;
  }

 private:
  bool all_classes_;
  std::bitset<256> wanted_;
  unsigned unwanted_flags_ = 0;
};

std::int32_t place(const PlanFile& file, std::size_t axis, std::int64_t value) {
  __extension__ using Wide = __int128;
  const Wide v = static_cast<Wide>(value) * file.map.factor[axis] + file.map.shift[axis];
  // The ends of the range mean "none" and "no level".
  if (v <= std::numeric_limits<std::int32_t>::min() || v >= std::numeric_limits<std::int32_t>::max())
    throw Error(
        ErrorKind::input,
        file.path + (file.is_dem ? ": a cell" : ": a point") + " with " + "xyz"[axis] + " = " + std::to_string(value) +
            (file.is_dem ? " quanta is more than 32 bits hold; raise input.dem_quantum_m, or set input.dem_nodata "
                           "if it means that there is no height"
                         : " (before scaling) lies far outside the bounds that the headers declare; repair "
                           "the header or remove the point"));
  return static_cast<std::int32_t>(v);
}

Batch select(const PointBatch& in, const Selector& selector, const PlanFile& file) {
  Batch out;
  for (std::size_t i = 0; i < in.size(); ++i) {
    if (!selector.takes(in.classification[i], in.flags[i])) continue;
    out.position.push_back({place(file, 0, in.x[i]), place(file, 1, in.y[i])});
    out.height.push_back(place(file, 2, in.z[i]));
  }
  return out;
}

// Appends points grouped by tile: a run (tile, first, count) for each tile that a batch touches.
class Buckets {
 public:
  Buckets(const Plan& plan, store::Writer& out) : plan_(plan), out_(out) {}

  void add(const Batch& batch) {
    for (std::size_t i = 0; i < batch.position.size(); ++i) {
      position_.push_back(batch.position[i]);
      height_.push_back(batch.height[i]);
      tile_.push_back(plan_.tile_of(batch.position[i]));
      if (position_.size() == kBatchPoints) flush();
    }
  }

  void finish() {
    flush();
    std::stable_sort(runs_.begin(), runs_.end(), [](const Run& a, const Run& b) { return a.tile < b.tile; });
    const auto write = [&](const char* name, auto member, const char* meaning) {
      std::vector<std::remove_cvref_t<decltype(runs_[0].*member)>> column;
      column.reserve(runs_.size());
      for (const Run& run : runs_) column.push_back(run.*member);
      out_.append(name, column, meaning);
    };
    write("run_tile", &Run::tile, "tile of a run, ascending");
    write("run_first", &Run::first, "its first point");
    write("run_count", &Run::count, "its points");
    out_.append<std::int32_t>("x", std::span<const std::int32_t>(), "lattice");
    out_.append<std::int32_t>("y", std::span<const std::int32_t>(), "lattice");
    out_.append<std::int32_t>("z", std::span<const std::int32_t>(), "z lattice");
    out_.set("points", static_cast<std::int64_t>(written_));
  }

 private:
  struct Run {
    std::uint32_t tile, count;
    std::uint64_t first;
  };

  void flush() {
    std::vector<std::uint32_t> order(position_.size());
    std::iota(order.begin(), order.end(), 0U);
    if (!std::is_sorted(tile_.begin(), tile_.end()))
      std::stable_sort(order.begin(), order.end(),
                       [&](std::uint32_t a, std::uint32_t b) { return tile_[a] < tile_[b]; });
    std::vector<std::int32_t> column(order.size());
    const auto write = [&](const char* name, auto value) {
      for (std::size_t i = 0; i < order.size(); ++i) column[i] = value(order[i]);
      out_.append(name, column);
    };
    write("x", [&](std::uint32_t i) { return position_[i].x; });
    write("y", [&](std::uint32_t i) { return position_[i].y; });
    write("z", [&](std::uint32_t i) { return height_[i]; });
    for (std::size_t i = 0; i < order.size();) {
      std::size_t end = i;
      while (end < order.size() && tile_[order[end]] == tile_[order[i]]) ++end;
      runs_.push_back({tile_[order[i]], static_cast<std::uint32_t>(end - i), written_ + i});
      i = end;
    }
    written_ += order.size();
    position_.clear();
    height_.clear();
    tile_.clear();
  }

  const Plan& plan_;
  store::Writer& out_;
  std::vector<LatticePoint> position_;
  std::vector<std::int32_t> height_;
  std::vector<std::uint32_t> tile_;
  std::vector<Run> runs_;
  std::uint64_t written_ = 0;
};

void ingest_cloud(const RunContext& context, const PlanFile& file, Buckets& buckets) {
  const LasFile las(file.path);
  const Selector selector(context.options.input);
  std::vector<Batch> batch(kChunksAtOnce);
  for (std::size_t first = 0; first < las.num_chunks(); first += kChunksAtOnce) {
    const std::size_t count = std::min(kChunksAtOnce, las.num_chunks() - first);
    const auto decode = [&](std::size_t i) {
      PointBatch points;
      las.decode(first + i, points);
      batch[i] = select(points, selector, file);
    };
    if (las.header().sequential) {
      for (std::size_t i = 0; i < count; ++i) decode(i);
    } else {
      tbb::parallel_for(std::size_t{0}, count, decode);
    }
    for (std::size_t i = 0; i < count; ++i) buckets.add(batch[i]);
  }
}

DemSkips ingest_dem(const RunContext& context, const PlanFile& file, Buckets& buckets) {
  const InputOptions& input = context.options.input;
  std::unique_lock<std::recursive_mutex> alone;
  if (reads_through_hdf5(file.path)) alone = store::lock_library();
  DemFile dem(file.path, {input.dem_band, input.dem_nodata, input.dem_quantum_m});
  Batch batch;
  return dem.read(file.first_row, file.num_rows, [&](const DemBatch& cells) {
    batch.position.clear();
    batch.height.clear();
    for (std::size_t i = 0; i < cells.size(); ++i) {
      batch.position.push_back({place(file, 0, cells.x[i]), place(file, 1, cells.y[i])});
      batch.height.push_back(place(file, 2, cells.z[i]));
    }
    buckets.add(batch);
  });
}

}  // namespace

void ingest_file(const RunContext& context, std::uint32_t number) {
  const PlanFile& file = context.plan.files[number];
  store::Writer out(context.layout.unit(Phase::ingest, number));
  out.set("recipe", context.recipe(Phase::ingest));
  Buckets buckets(context.plan, out);
  if (file.is_dem) {
    const DemSkips skips = ingest_dem(context, file, buckets);
    out.set("cells_nodata", static_cast<std::int64_t>(skips.nodata));
    out.set("cells_not_finite", static_cast<std::int64_t>(skips.not_finite));
  } else {
    ingest_cloud(context, file, buckets);
  }
  buckets.finish();
  out.commit();
}

}  // namespace hydrotin
