#include <algorithm>
#include <array>
#include <limits>

#include "block_index.h"
#include "hydrotin/hilbert.h"
#include "hydrotin/lifting.h"
#include "phases.h"
#include "store.h"

namespace hydrotin {
namespace {

struct RawPoints {
  std::vector<std::int32_t> x, y, z;
};

// Of the files of vertices, or of reference points.
RawPoints gather(const RunContext& context, std::uint32_t tile, bool is_reference) {
  RawPoints out;
  const Plan& plan = context.plan;
  for (const std::uint32_t f :
       context.ingest_index->files_of(tile, context.layout, plan.files.size(), plan.num_tiles())) {
    if (plan.files[f].is_reference != is_reference) continue;
    const store::Reader in(context.layout.unit(Phase::ingest, f));
    const auto run_tile = in.read<std::uint32_t>("run_tile");
    const auto [first, last] = std::equal_range(run_tile.begin(), run_tile.end(), tile);
    const auto begin = static_cast<std::uint64_t>(first - run_tile.begin());
    const auto num_runs = static_cast<std::uint64_t>(last - first);
    const auto run_first = in.read_range<std::uint64_t>("run_first", begin, num_runs);
    const auto run_count = in.read_range<std::uint32_t>("run_count", begin, num_runs);
    for (std::size_t r = 0; r < num_runs; ++r) {
      const std::size_t at = out.x.size(), count = run_count[r];
      for (const auto& [name, column] : {std::pair{"x", &out.x}, {"y", &out.y}, {"z", &out.z}}) {
        column->resize(at + count);
        in.read_range<std::int32_t>(name, run_first[r], std::span(*column).subspan(at));
      }
    }
  }
  return out;
}

struct Keyed {
  std::uint64_t key;
  std::uint32_t index;
};

// Least significant digit first, 11 bits at a time, skipping digits that all keys share.
void sort_by_key(std::vector<Keyed>& keys) {
  std::vector<Keyed> other(keys.size());
  for (int shift = 0; shift < 64; shift += 11) {
    std::array<std::uint32_t, 2049> begin{};
    const auto digit = [&](const Keyed& k) { return k.key >> shift & 2047U; };
    for (const Keyed& k : keys) ++begin[digit(k) + 1];
    if (std::find(begin.begin(), begin.end(), keys.size()) != begin.end()) continue;
    for (std::size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
    for (const Keyed& k : keys) other[begin[digit(k)]++] = k;
    keys.swap(other);
  }
}

struct CanonicalPoints {
  std::vector<LatticePoint> position;
  std::vector<std::int32_t> height;
  std::vector<std::uint32_t> rise;  // of points dropped for a lower one at their place, where not 0
};

// Curve order, one point per place: the lowest.
CanonicalPoints canonical(const RawPoints& raw) {
  std::vector<Keyed> keys(raw.x.size());
  for (std::uint32_t i = 0; i < keys.size(); ++i) keys[i] = {hilbert_key({raw.x[i], raw.y[i]}), i};
  if (!keys.empty()) sort_by_key(keys);
  CanonicalPoints out;
  std::vector<std::pair<std::uint32_t, std::int32_t>> dropped;  // place, height
  out.position.reserve(keys.size());
  out.height.reserve(keys.size());
  for (const auto& [key, i] : keys) {
    const LatticePoint p{raw.x[i], raw.y[i]};
    if (!out.position.empty() && out.position.back() == p) {
      const std::int32_t low = std::min(out.height.back(), raw.z[i]);
      dropped.emplace_back(static_cast<std::uint32_t>(out.height.size() - 1), std::max(out.height.back(), raw.z[i]));
      out.height.back() = low;
    } else {
      out.position.push_back(p);
      out.height.push_back(raw.z[i]);
    }
  }
  for (const auto& [at, z] : dropped)
    if (z != out.height[at]) out.rise.push_back(static_cast<std::uint32_t>(std::int64_t{z} - out.height[at]));
  std::sort(out.rise.begin(), out.rise.end());
  return out;
}

// Curve order, points of one place by height.
CanonicalPoints in_curve_order(const RawPoints& raw) {
  std::vector<std::uint64_t> key(raw.x.size());
  std::vector<std::uint32_t> order(raw.x.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    key[i] = hilbert_key({raw.x[i], raw.y[i]});
    order[i] = i;
  }
  std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
    return std::pair{key[i], raw.z[i]} < std::pair{key[j], raw.z[j]};
  });
  CanonicalPoints out;
  for (const std::uint32_t i : order) {
    out.position.push_back({raw.x[i], raw.y[i]});
    out.height.push_back(raw.z[i]);
  }
  return out;
}

void require_indices(const RawPoints& raw, std::uint32_t tile) {
  if (raw.x.size() >= std::numeric_limits<std::uint32_t>::max() / 8)
    throw Error(ErrorKind::resource, "tile " + std::to_string(tile) + " holds " + std::to_string(raw.x.size()) +
                                         " points, more than a tile can; lower tiles.target_points");
}

void write_reference(const RunContext& context, std::uint32_t tile, store::Writer& out) {
  const RawPoints raw = gather(context, tile, true);
  require_indices(raw, tile);
  const CanonicalPoints points = in_curve_order(raw);
  write_points(out, points.position, points.height, kReference);
}

}  // namespace

void arrange_tile(const RunContext& context, std::uint32_t tile) {
  const RawPoints raw = gather(context, tile, false);
  require_indices(raw, tile);
  const CanonicalPoints points = canonical(raw);
  store::Writer out(context.layout.unit(Phase::arrange, tile));
  out.set("recipe", context.recipe(Phase::arrange));
  out.set("points", static_cast<std::int64_t>(raw.x.size()));
  write_points(out, points.position, points.height);
  out.append("duplicate_rise", points.rise, "z lattice: of points dropped, above the one kept at their place; not 0");
  const std::vector<std::uint32_t> hull = convex_hull(points.position);
  out.append("hull", hull, "indices of the tile's convex hull");
  if (!points.position.empty())
    out.set("lowest", static_cast<std::int64_t>(lowest_vertex(points.height, points.position)));
  if (context.plan.has_reference()) write_reference(context, tile, out);
  out.commit();
}

}  // namespace hydrotin
