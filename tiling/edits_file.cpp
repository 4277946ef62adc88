#include "edits_file.h"

#include <algorithm>

#include "hydrotin/edit_features.h"
#include "hydrotin/pit_edits.h"

namespace hydrotin {
namespace {

void write_regions(store::Writer& out, const RegionFeatures& f) {
  out.append("region_key", f.key, "smallest vertex by (x, y) of each lifted region");
  out.append("region_level", f.level, "z lattice: its final height");
  out.append("region_lowest", f.lowest, "its lowest vertex, as measured");
  out.append("region_vertices", f.vertices);
  out.append("region_displacement", f.displacement, "z lattice");
  out.append("region_volume", f.volume, "cubed lattice units");
  out.append("region_ring_begin", f.region_ring_begin, "offsets into ring_begin, one more than regions");
  out.append("ring_begin", f.ring_begin, "offsets into ring_xy in points, one more than rings");
  out.append("ring_xy", f.ring_xy, "rings around the triangles that changed: the outer one, then holes");
}

void write_breaches(store::Writer& out, const BreachFeatures& f) {
  out.append("breach_key", f.key, "first vertex of each breach");
  out.append("breach_pit", f.pit, "the pit that it drains: smallest vertex by (x, y), height; 2147483647: none");
  out.append("breach_displacement", f.displacement, "z lattice");
  out.append("breach_depth", f.depth, "z lattice: the most that a vertex of it was lowered");
  out.append("breach_lowered", f.lowered, "vertices of the line that were lowered, by it or by the one that it joins");
  out.append("breach_length", f.length, "lattice units, horizontally");
  out.append("breach_volume", f.volume, "cubed lattice units");
  out.append("breach_begin", f.begin, "offsets into breach_xyz in points, one more than breaches");
  out.append("breach_xyz", f.xyz, "the line with its new heights, from the pit to where it drains");
}

}  // namespace

void ChangeFigures::add(std::int64_t displacement, std::int64_t star) {
  if (displacement == 0) return;
  const std::int64_t size = displacement < 0 ? -displacement : displacement;
  (displacement > 0 ? raised : lowered) += 1;
  (displacement > 0 ? raise_total : lower_total) += size;
  std::int64_t& most = displacement > 0 ? raise_max : lower_max;
  most = std::max(most, size);
  volume.add(static_cast<double>(star) * static_cast<double>(size));
}

void ChangeFigures::add(const ChangeFigures& other) {
  raised += other.raised;
  lowered += other.lowered;
  raise_total += other.raise_total;
  lower_total += other.lower_total;
  raise_max = std::max(raise_max, other.raise_max);
  lower_max = std::max(lower_max, other.lower_max);
  volume.add(other.volume);
  groups += other.groups;
  unguaranteed += other.unguaranteed;
}

void write_figures(store::Writer& out, const ChangeFigures& f) {
  out.append(
      "change",
      std::vector<std::int64_t>{f.raised, f.lowered, f.raise_total, f.lower_total, f.raise_max, f.lower_max,
                                f.volume.high(), static_cast<std::int64_t>(f.volume.low()), f.groups, f.unguaranteed},
      "vertices raised, lowered; totals and maxima of both; sixfold volume (high, low); groups solved; of "
      "these too large for Algorithm 6.1");
}

ChangeFigures read_change_figures(const store::Reader& in) {
  const auto v = in.read<std::int64_t>("change");
  if (v.size() != 10)
    throw Error(ErrorKind::storage, in.path() + ": its figures are cut; delete the file and run again");
  ChangeFigures f{v[0], v[1], v[2], v[3], v[4], v[5], ExactSum(v[6], static_cast<std::uint64_t>(v[7])), v[8], v[9]};
  return f;
}

void write_edits(store::Writer& out, const ChangeableTerrain& terrain, std::span<const std::uint32_t> triangle,
                 const PitComponents& components, std::span<const std::int32_t> height,
                 std::span<const std::int64_t> star) {
  const PitEdits edits = find_edits(terrain, components, height, star);
  write_regions(out, region_features(terrain, triangle, edits));
  write_breaches(out, breach_features(terrain, edits, height));
}

}  // namespace hydrotin
