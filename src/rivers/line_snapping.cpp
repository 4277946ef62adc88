#include "hydrotin/line_snapping.h"

#include "exact_ratio.h"

namespace hydrotin {
namespace {

Int128 squared_distance(LatticePoint a, LatticePoint b) {
  return dot_from(a, b, b);
}

std::uint32_t nearest_corner(const LatticeTerrain& t, std::uint32_t triangle, LatticePoint p) {
  std::uint32_t best = t.triangle[3 * triangle];
  for (std::uint32_t i = 1; i < 3; ++i) {
    const std::uint32_t v = t.triangle[3 * triangle + i];
    const Int128 d = squared_distance(p, t.position[v]), least = squared_distance(p, t.position[best]);
    if (d < least || (d == least && t.position[v] < t.position[best])) best = v;
  }
  return best;
}

// The nearer end of an edge that the line through p and q crosses: distances along the edge are in the ratio of those
// from the line.
std::uint32_t nearer_end(const LatticeTerrain& t, std::uint32_t h, LatticePoint p, LatticePoint q) {
  const std::uint32_t a = t.origin(h), b = t.target(h);
  Int128 from_a = doubled_area(p, q, t.position[a]), from_b = doubled_area(p, q, t.position[b]);
  from_a = from_a < 0 ? -from_a : from_a;
  from_b = from_b < 0 ? -from_b : from_b;
  if (from_a != from_b) return from_a < from_b ? a : b;
  return t.position[a] < t.position[b] ? a : b;
}

std::uint32_t nearer_end(const LatticeTerrain& t, std::uint32_t h, LatticePoint on) {
  const std::uint32_t a = t.origin(h), b = t.target(h);
  const Int128 from_a = squared_distance(on, t.position[a]), from_b = squared_distance(on, t.position[b]);
  if (from_a != from_b) return from_a < from_b ? a : b;
  return t.position[a] < t.position[b] ? a : b;
}

}  // namespace

SnappedLines snap_lines(const TerrainLocator& locator, const RiverLines& reaches) {
  const LatticeTerrain& t = locator.terrain();
  SnappedLines snapped;
  for (std::size_t i = 0; i < reaches.size(); ++i) {
    const auto line = reaches.line(i);
    const LineWalk walk = walk_line(locator, line);
    if (walk.num_pieces() == 0) ++snapped.counts.outside;
    for (std::size_t piece = 0; piece < walk.num_pieces(); ++piece) {
      ++snapped.counts.pieces;
      const auto stops = walk.piece(piece);
      auto& path = snapped.paths.vertex;
      for (const WalkStop& stop : stops) {
        const bool is_end = stop.point == 0 || stop.point + 1 == line.size();
        std::uint32_t v = stop.place.id;
        if (stop.place.kind == PlaceKind::triangle) {
          if (!is_end) {
            ++snapped.counts.dropped_points;
            continue;
          }
          v = nearest_corner(t, stop.place.id, line[stop.point]);
        } else if (stop.place.kind == PlaceKind::edge) {
          ++snapped.counts.crossings;
          v = stop.point == kNoPoint ? nearer_end(t, stop.place.id, line[stop.segment], line[stop.segment + 1])
                                     : nearer_end(t, stop.place.id, line[stop.point]);
        }
        if (path.size() > snapped.paths.begin.back() && path.back() == v)
          ++snapped.counts.repeated;
        else
          path.push_back(v);
      }
      if (path.size() < snapped.paths.begin.back() + 2) {
        ++snapped.counts.vanished;
        path.resize(snapped.paths.begin.back());
        continue;
      }
      snapped.paths.begin.push_back(path.size());
      snapped.paths.line.push_back(reaches.source[i]);
    }
  }
  return snapped;
}

}  // namespace hydrotin
