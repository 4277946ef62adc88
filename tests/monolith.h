#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fingerprint.h"
#include "hydrotin/hilbert.h"
#include "hydrotin/las.h"
#include "hydrotin/options.h"
#include "hydrotin/pit_removal.h"
#include "hydrotin/pits.h"
#include "hydrotin/point_set.h"
#include "hydrotin/vertex_graph.h"

/// The pipeline without tiles: all points in memory, one triangulation, one flood. What every tiling has to equal.

namespace hydrotin::testing {

struct Monolith {
  std::string fingerprint;
  std::uint64_t vertices = 0, duplicates = 0, triangles = 0, pits_before = 0;
  PointSetTriangulation figures;  ///< without its triangles; values in lattice units
};

/// The points in (x, y) order, one for each place: the lowest.
inline std::vector<std::pair<LatticePoint, std::int32_t>> lowest_points(const std::vector<LatticePoint>& position,
                                                                        const std::vector<std::int32_t>& height) {
  std::vector<std::pair<LatticePoint, std::int32_t>> points;
  for (std::size_t i = 0; i < position.size(); ++i) points.emplace_back(position[i], height[i]);
  std::sort(points.begin(), points.end());
  points.erase(
      std::unique(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.first == b.first; }),
      points.end());
  return points;
}

struct Cloud {
  std::vector<LatticePoint> position;
  std::vector<std::int32_t> height;
};

/// @param base       lattice point that the data set's lattice has as origin
/// @param reference  points that are no vertices  @param limit  on their errors
inline Monolith run_monolith(const std::vector<LatticePoint>& position, const std::vector<std::int32_t>& height, int k,
                             const Objectives& objectives, bool hull_outlets, LatticePoint base, std::int32_t base_z,
                             Cloud reference = {}, std::optional<ErrorLimit> limit = std::nullopt) {
  auto points = lowest_points(position, height);
  std::sort(points.begin(), points.end(),
            [](const auto& a, const auto& b) { return hilbert_key(a.first) < hilbert_key(b.first); });
  std::vector<LatticePoint> p;
  std::vector<std::int32_t> z;
  for (const auto& [at, h] : points) {
    p.push_back({at.x - base.x, at.y - base.y});
    z.push_back(h - base_z);
  }
  Monolith out;
  out.vertices = p.size();
  out.duplicates = position.size() - p.size();
  for (LatticePoint& at : reference.position) at = {at.x - base.x, at.y - base.y};
  for (std::int32_t& h : reference.height) h -= base_z;
  const auto triangulation =
      triangulate(p, z, PointSetOptions{.order = k, .polygon = {.objectives = objectives, .max_error = limit}},
                  {reference.position, reference.height});
  out.triangles = triangulation.triangles.size();
  std::vector<std::uint32_t> corners;
  for (const auto& t : triangulation.triangles) corners.insert(corners.end(), t.begin(), t.end());
  const VertexGraph graph = make_vertex_graph(static_cast<std::uint32_t>(p.size()), corners);
  std::vector<std::uint8_t> outlet(p.size());
  if (hull_outlets)
    for (const auto& e : graph.boundary) outlet[e.origin] = outlet[e.target] = 1;
  else
    outlet[lowest_vertex(z, p)] = 1;
  out.pits_before = count_pits(graph, z, outlet);
  RemovalOptions removal;
  removal.limits.max_visits = kScalableVisits;
  removal.limits.max_lake = PitOptions{}.largest_lake;
  removal.limits.max_group = PitOptions{}.largest_group;
  const std::vector<std::int32_t> level = remove_pits({&graph, z, p, outlet, {}, {}, {}}, removal).height;
  Fingerprint fingerprint;
  for (const auto& t : triangulation.triangles)
    fingerprint.add({{{p[t[0]].x, p[t[0]].y, level[t[0]]},
                      {p[t[1]].x, p[t[1]].y, level[t[1]]},
                      {p[t[2]].x, p[t[2]].y, level[t[2]]}}});
  out.fingerprint = fingerprint.hex();
  out.figures = triangulation;
  out.figures.triangles.clear();
  return out;
}

/// Points of the wanted class that are not withheld; file integers, for files of one scale and offset.
inline Cloud read_cloud(const std::vector<std::string>& paths, std::uint8_t wanted) {
  Cloud out;
  for (const std::string& path : paths) {
    const LasFile file(path);
    PointBatch batch;
    for (std::size_t c = 0; c < file.num_chunks(); ++c) {
      file.decode(c, batch);
      for (std::size_t i = 0; i < batch.size(); ++i)
        if (batch.classification[i] == wanted && !(batch.flags[i] & PointFlag::withheld)) {
          out.position.push_back({batch.x[i], batch.y[i]});
          out.height.push_back(batch.z[i]);
        }
    }
  }
  return out;
}

}  // namespace hydrotin::testing
