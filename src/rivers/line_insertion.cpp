#include "hydrotin/line_insertion.h"

#include <algorithm>
#include <map>
#include <unordered_map>

#include "editable_terrain.h"
#include "exact_ratio.h"
#include "hydrotin/flow_direction.h"
#include "hydrotin/predicates.h"
#include "hydrotin/snap_rounding.h"

namespace hydrotin {
namespace {

using Wide = boost::multiprecision::cpp_int;

// Squared distance of a lattice point from a + share (b - a), times the squared denominator.
Wide distance_from(LatticePoint p, LatticePoint a, LatticePoint b, const Ratio& share) {
  const auto along = [&](std::int32_t from, std::int32_t to, std::int32_t at) {
    return Wide(std::int64_t{at} - from) * Wide(share.denominator) -
           Wide(std::int64_t{to} - from) * Wide(share.numerator);
  };
  const Wide x = along(a.x, b.x, p.x), y = along(a.y, b.y, p.y);
  return x * x + y * y;
}

class Inserter {
 public:
  Inserter(const TerrainLocator& locator, const RiverLines& reaches)
      : locator_(locator), old_(locator.terrain()), reaches_(reaches), mesh_(old_) {}

  InsertedLines run() {
    clip();
    split_rim();
    const RoundedLines rounded = snap_round(pieces_, old_.position);
    result_.counts.crossings = rounded.num_crossings;
    result_.counts.bent = rounded.num_bent;
    insert_points(rounded.lines);
    insert_segments(rounded.lines);
    result_.counts.new_vertices = mesh_.terrain().num_vertices() - old_.num_vertices();
    result_.terrain = mesh_.take();
    return std::move(result_);
  }

 private:
  /// A point of a piece, and the half-edge of the rim along which the piece goes on.
  struct ClippedPoint {
    LatticePoint at;
    std::uint32_t rim = kNoHalfedge;
  };

  // Cuts the reaches into their parts inside; where one meets the rim its place is noted.
  void clip() {
    std::vector<std::vector<ClippedPoint>> pieces;
    std::vector<std::uint32_t> source;
    for (std::size_t i = 0; i < reaches_.size(); ++i) {
      const auto line = reaches_.line(i);
      const LineWalk walk = walk_line(locator_, line);
      if (walk.num_pieces() == 0) ++result_.counts.outside;
      for (std::size_t k = 0; k < walk.num_pieces(); ++k) {
        ++result_.counts.pieces;
        pieces.push_back(clip_piece(line, walk.piece(k)));
        source.push_back(reaches_.source[i]);
      }
    }
    sort_rim_points();
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      std::vector<LatticePoint> chain;
      for (std::size_t k = 0; k < pieces[i].size(); ++k) {
        chain.push_back(pieces[i][k].at);
        if (pieces[i][k].rim != kNoHalfedge) follow_rim(pieces[i][k], pieces[i][k + 1].at, chain);
      }
      chain.erase(std::unique(chain.begin(), chain.end()), chain.end());
      if (chain.size() > 1) pieces_.add(chain, source[i]);
    }
  }

  std::vector<ClippedPoint> clip_piece(std::span<const LatticePoint> line, std::span<const WalkStop> stops) {
    std::vector<ClippedPoint> chain;
    for (std::size_t s = 0; s < stops.size(); ++s) {
      const WalkStop& stop = stops[s];
      const bool is_edge = stop.place.kind == PlaceKind::edge;
      const bool is_rim = is_edge && old_.twin[stop.place.id] == kNoHalfedge;
      if (stop.point != kNoPoint) {
        chain.push_back({line[stop.point]});
        if (is_rim) rim_points_[stop.place.id].push_back(line[stop.point]);
      } else if (stop.place.kind == PlaceKind::vertex) {
        chain.push_back({old_.position[stop.place.id]});
      } else if (is_rim) {
        chain.push_back({rim_point(stop.place.id, line[stop.segment], line[stop.segment + 1])});
      } else {
        continue;
      }
      if (s + 1 < stops.size()) chain.back().rim = rim_between(stop.place, stops[s + 1].place);
    }
    return chain;
  }

  // The half-edge of the rim on which both places lie.
  [[nodiscard]] std::uint32_t rim_between(const Place& a, const Place& b) const {
    std::uint32_t h = kNoHalfedge;
    if (a.kind == PlaceKind::edge)
      h = a.id;
    else if (b.kind == PlaceKind::edge)
      h = b.id;
    else if (a.kind == PlaceKind::vertex && b.kind == PlaceKind::vertex)
      h = mesh_.find_edge(a.id, b.id);
    if (h == kNoHalfedge || old_.twin[h] != kNoHalfedge) return kNoHalfedge;
    const auto is_on = [&](const Place& place) {
      if (place.kind == PlaceKind::vertex) return place.id == old_.origin(h) || place.id == old_.target(h);
      return place.kind == PlaceKind::edge && place.id == h;
    };
    return is_on(a) && is_on(b) ? h : kNoHalfedge;
  }

  // From the target back to the origin, as seen from the apex.
  void sort_rim_points() {
    for (auto& [h, points] : rim_points_) {
      const LatticePoint c = old_.position[old_.apex(h)];
      std::sort(points.begin(), points.end());
      points.erase(std::unique(points.begin(), points.end()), points.end());
      std::stable_sort(points.begin(), points.end(),
                       [&](LatticePoint p, LatticePoint q) { return orientation(c, p, q) < 0; });
    }
  }

  // The points between two places on one edge of the rim, which may lie a little inside.
  void follow_rim(const ClippedPoint& from, LatticePoint to, std::vector<LatticePoint>& chain) {
    const auto found = rim_points_.find(from.rim);
    if (found == rim_points_.end()) return;
    const LatticePoint c = old_.position[old_.apex(from.rim)];
    const int way = orientation(c, from.at, to);
    std::vector<LatticePoint> between;
    for (const LatticePoint p : found->second)
      if (orientation(c, from.at, p) == way && orientation(c, p, to) == way) between.push_back(p);
    if (way > 0) std::reverse(between.begin(), between.end());
    chain.insert(chain.end(), between.begin(), between.end());
  }

  // The lattice point that stands for the crossing of a line with the rim.
  LatticePoint rim_point(std::uint32_t h, LatticePoint p, LatticePoint q) {
    const LatticePoint a = old_.position[old_.origin(h)], b = old_.position[old_.target(h)];
    const LatticePoint c = old_.position[old_.apex(h)];
    const Ratio share = crossing_share(p, q, a, b);
    const LatticePoint middle = point_at(a, b, share);
    bool is_found = false;
    LatticePoint best{};
    Wide least;
    for (std::int32_t dx = -1; dx <= 1; ++dx)
      for (std::int32_t dy = -1; dy <= 1; ++dy) {
        const LatticePoint at{middle.x + dx, middle.y + dy};
        if (doubled_area(a, b, at) < 0 || doubled_area(b, c, at) <= 0 || doubled_area(c, a, at) <= 0) continue;
        const Wide distance = distance_from(at, a, b, share);
        if (is_found && !(distance < least) && !(distance == least && at < best)) continue;
        is_found = true;
        best = at;
        least = distance;
      }
    if (!is_found) return 2 * share.numerator <= share.denominator ? a : b;
    rim_points_[h].push_back(best);
    return best;
  }

  // New rim vertices go in before anything is flipped: each between its neighbours as seen from the apex.
  void split_rim() {
    std::vector<std::pair<std::pair<LatticePoint, LatticePoint>, std::uint32_t>> order;
    for (const auto& [h, points] : rim_points_)
      order.push_back({{old_.position[old_.origin(h)], old_.position[old_.target(h)]}, h});
    std::sort(order.begin(), order.end());
    std::vector<std::uint32_t> touched;
    for (const auto& [place, h] : order) {
      const auto& points = rim_points_[h];  // from the target back: what is left at the origin keeps the half-edge
      // A split at another rim edge of the triangle has moved this one.
      const std::uint32_t edge = mesh_.find_edge(old_.origin(h), old_.target(h));
      for (const LatticePoint p : points) {
        if (!mesh_.can_split_edge(edge, p)) continue;  // another one lies on the same ray from the apex
        touched.push_back(mesh_.split_edge(edge, p, interpolate(old_, h / 3, p)));
        ++result_.counts.rim_vertices;
      }
    }
    std::vector<std::uint32_t> edges;
    for (const std::uint32_t v : touched)
      for (const std::uint32_t h : mesh_.spokes(v))
        edges.insert(edges.end(), {h, next_halfedge(h), previous_halfedge(h)});
    mesh_.legalize(std::move(edges));
  }

  void insert_points(const RiverLines& lines) {
    std::vector<LatticePoint> points = lines.point;
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    for (const LatticePoint p : points) {
      const Place place = locator_.locate(p);
      if (place.kind == PlaceKind::outside) continue;
      std::uint32_t near = place.id;
      if (place.kind == PlaceKind::triangle) near = old_.triangle[3 * place.id];
      if (place.kind == PlaceKind::edge) near = old_.origin(place.id);
      const auto v = mesh_.insert_vertex(p, height_at(old_, place, p), near);
      if (v) vertex_[key(p)] = *v;
    }
  }

  // In (x, y) order, so that not even the numbers of triangles depend on the order of the lines.
  void insert_sorted(const RiverLines& lines) {
    std::vector<std::pair<LatticePoint, LatticePoint>> segments;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const auto line = lines.line(i);
      for (std::size_t k = 1; k < line.size(); ++k) segments.push_back(std::minmax(line[k - 1], line[k]));
    }
    std::sort(segments.begin(), segments.end());
    segments.erase(std::unique(segments.begin(), segments.end()), segments.end());
    std::vector<std::uint32_t> way;
    for (const auto& [from, to] : segments) {
      const auto a = vertex_.find(key(from)), b = vertex_.find(key(to));
      if (a == vertex_.end() || b == vertex_.end()) continue;
      way.clear();
      static_cast<void>(
          mesh_.insert_segment(a->second, b->second, way));  // what fails fails again below, and is counted
    }
  }

  // The chains of vertices; their edges are there.
  void insert_segments(const RiverLines& lines) {
    insert_sorted(lines);
    RiverPaths& paths = result_.paths;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const auto line = lines.line(i);
      std::vector<std::uint32_t> way;
      const auto close = [&] {
        if (way.size() > 1) {
          paths.vertex.insert(paths.vertex.end(), way.begin(), way.end());
          paths.begin.push_back(paths.vertex.size());
          paths.line.push_back(lines.source[i]);
        }
        way.clear();
      };
      for (std::size_t k = 1; k < line.size(); ++k) {
        const auto a = vertex_.find(key(line[k - 1])), b = vertex_.find(key(line[k]));
        if (a == vertex_.end() || b == vertex_.end()) {
          ++result_.counts.lost_segments;
          close();
          continue;
        }
        if (way.empty()) way.push_back(a->second);
        if (mesh_.insert_segment(a->second, b->second, way)) continue;
        ++result_.counts.lost_segments;
        close();
      }
      close();
    }
  }

  static std::uint64_t key(LatticePoint p) {
    return (std::uint64_t{static_cast<std::uint32_t>(p.x)} << 32) | static_cast<std::uint32_t>(p.y);
  }

  const TerrainLocator& locator_;
  const LatticeTerrain& old_;
  const RiverLines& reaches_;
  EditableTerrain mesh_;
  RiverLines pieces_;
  std::map<std::uint32_t, std::vector<LatticePoint>> rim_points_;
  std::unordered_map<std::uint64_t, std::uint32_t> vertex_;
  InsertedLines result_;
};

}  // namespace

InsertedLines insert_lines(const TerrainLocator& locator, const RiverLines& reaches) {
  return Inserter(locator, reaches).run();
}

}  // namespace hydrotin
