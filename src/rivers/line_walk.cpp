#include "hydrotin/line_walk.h"

#include <numeric>
#include <optional>

#include "box_index.h"
#include "exact_ratio.h"
#include "hydrotin/predicates.h"

namespace hydrotin {
namespace {

std::vector<LatticeBox> triangle_boxes(const LatticeTerrain& terrain) {
  std::vector<LatticeBox> boxes(terrain.triangle.size() / 3);
  for (std::size_t c = 0; c < terrain.triangle.size(); ++c) boxes[c / 3].extend(terrain.position[terrain.triangle[c]]);
  return boxes;
}

std::vector<std::uint32_t> rim_of(const LatticeTerrain& terrain) {
  std::vector<std::uint32_t> rim;
  for (std::uint32_t h = 0; h < terrain.twin.size(); ++h)
    if (terrain.twin[h] == kNoHalfedge) rim.push_back(h);
  return rim;
}

std::vector<LatticeBox> rim_boxes(const LatticeTerrain& terrain, const std::vector<std::uint32_t>& rim) {
  std::vector<LatticeBox> boxes;
  for (const std::uint32_t h : rim)
    boxes.push_back(box_around(terrain.position[terrain.origin(h)], terrain.position[terrain.target(h)]));
  return boxes;
}

}  // namespace

struct TerrainLocator::State {
  explicit State(const LatticeTerrain& t)
      : terrain(t), triangles(triangle_boxes(t)), rim(rim_of(t)), rim_index(rim_boxes(t, rim)) {
    begin.assign(std::size_t{t.num_vertices()} + 1, 0);
    for (const std::uint32_t v : t.triangle) ++begin[v + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    spoke.resize(t.triangle.size());
    std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
    for (std::uint32_t h = 0; h < t.triangle.size(); ++h) spoke[next[t.triangle[h]]++] = h;
  }

  const LatticeTerrain& terrain;
  BoxIndex triangles;
  std::vector<std::uint32_t> rim;
  BoxIndex rim_index;
  std::vector<std::uint32_t> begin, spoke;
};

TerrainLocator::TerrainLocator(const LatticeTerrain& terrain) : state_(std::make_unique<State>(terrain)) {}
TerrainLocator::~TerrainLocator() = default;
TerrainLocator::TerrainLocator(TerrainLocator&&) noexcept = default;

const LatticeTerrain& TerrainLocator::terrain() const {
  return state_->terrain;
}

std::span<const std::uint32_t> TerrainLocator::spokes(std::uint32_t v) const {
  return {state_->spoke.data() + state_->begin[v], state_->spoke.data() + state_->begin[v + 1]};
}

std::vector<std::uint32_t> TerrainLocator::rim_near(LatticePoint p, LatticePoint q) const {
  std::vector<std::uint32_t> near;
  state_->rim_index.query(box_around(p, q), [&](std::uint32_t i) { near.push_back(state_->rim[i]); });
  return near;
}

Place TerrainLocator::locate(LatticePoint p) const {
  const LatticeTerrain& t = state_->terrain;
  Place found;
  state_->triangles.query(box_around(p, p), [&](std::uint32_t i) {
    if (found.kind != PlaceKind::outside) return;
    std::uint32_t on = kNoHalfedge;
    for (std::uint32_t h = 3 * i; h < 3 * i + 3; ++h) {
      if (t.position[t.origin(h)] == p) {
        found = {PlaceKind::vertex, t.origin(h)};
        return;
      }
      const int side = orientation(t.position[t.origin(h)], t.position[t.target(h)], p);
      if (side < 0) return;
      if (side == 0) on = h;
    }
    found = on == kNoHalfedge ? Place{PlaceKind::triangle, i} : Place{PlaceKind::edge, on};
  });
  return found;
}

namespace {

class Walker {
 public:
  Walker(const TerrainLocator& locator, std::span<const LatticePoint> line)
      : locator_(locator), t_(locator.terrain()), line_(line) {}

  LineWalk run() {
    place_ = locator_.locate(line_[0]);
    if (place_.kind != PlaceKind::outside) emit(0);
    for (segment_ = 0; segment_ + 1 < line_.size(); ++segment_) walk_segment();
    close_piece();
    return std::move(walk_);
  }

 private:
  [[nodiscard]] int side(LatticePoint p) const { return orientation(from_, to_, p); }
  [[nodiscard]] LatticePoint at(std::uint32_t v) const { return t_.position[v]; }

  void emit(std::uint32_t point) {
    WalkStop stop{place_, segment_, point};
    if (place_.kind == PlaceKind::edge && t_.twin[place_.id] != kNoHalfedge && t_.twin[place_.id] < place_.id)
      stop.place.id = t_.twin[place_.id];
    walk_.stop.push_back(stop);
  }

  void close_piece() {
    if (walk_.stop.size() - walk_.piece_begin.back() < 2)
      walk_.stop.resize(walk_.piece_begin.back());  // the line only touches the terrain here
    else
      walk_.piece_begin.push_back(walk_.stop.size());
  }

  void leave() {
    place_ = {};
    close_piece();
  }

  void walk_segment() {
    from_ = line_[segment_];
    to_ = line_[segment_ + 1];
    left_at_.reset();
    bool is_done = false;
    while (!is_done) {
      switch (place_.kind) {
        case PlaceKind::outside:
          is_done = enter();
          break;
        case PlaceKind::triangle:
          is_done = cross_triangle(place_.id);
          break;
        case PlaceKind::edge:
          is_done = leave_edge(place_.id);
          break;
        case PlaceKind::vertex:
          is_done = leave_vertex(place_.id);
          break;
      }
    }
  }

  // The segment goes through the inside of the triangle, or starts there.
  bool cross_triangle(std::uint32_t triangle) {
    int inside = 1;
    std::uint32_t on = kNoHalfedge;
    for (std::uint32_t h = 3 * triangle; h < 3 * triangle + 3; ++h) {
      const int s = orientation(at(t_.origin(h)), at(t_.target(h)), to_);
      if (s < 0) inside = -1;
      if (s == 0) on = h;
    }
    if (inside > 0) return stop_in(triangle, on);
    for (std::uint32_t h = 3 * triangle; h < 3 * triangle + 3; ++h) {
      const int s = side(at(t_.origin(h)));
      if (s < 0 && side(at(t_.target(h))) > 0) return pass({PlaceKind::edge, h});
      if (s == 0 && side(at(t_.apex(h))) < 0 && side(at(t_.target(h))) > 0)
        return pass({PlaceKind::vertex, t_.origin(h)});
    }
    return stop_outside();  // unreachable for a valid terrain
  }

  bool stop_in(std::uint32_t triangle, std::uint32_t on) {
    place_ = {PlaceKind::triangle, triangle};
    if (on != kNoHalfedge) place_ = {PlaceKind::edge, on};
    for (std::uint32_t h = 3 * triangle; h < 3 * triangle + 3; ++h)
      if (at(t_.origin(h)) == to_) place_ = {PlaceKind::vertex, t_.origin(h)};
    emit(segment_ + 1);
    return true;
  }

  bool stop_outside() {
    leave();
    return true;
  }

  // Goes on from an edge or a vertex in the course of the segment.
  bool pass(Place place) {
    place_ = place;
    emit(kNoPoint);
    return false;
  }

  bool leave_edge(std::uint32_t h) {
    const LatticePoint a = at(t_.origin(h)), b = at(t_.target(h));
    const int s = orientation(a, b, to_);
    if (s > 0) return cross_triangle(h / 3);
    if (s < 0) {
      if (t_.twin[h] != kNoHalfedge) return cross_triangle(t_.twin[h] / 3);
      left_at_ = share_of_edge(h);
      leave();
      return false;
    }
    return follow_edge(h, dot_from(from_, b, to_) - dot_from(from_, a, to_) > 0 ? t_.target(h) : t_.origin(h));
  }

  // Along an edge towards its end v.
  bool follow_edge(std::uint32_t h, std::uint32_t v) {
    if (at(v) == to_) {
      place_ = {PlaceKind::vertex, v};
      emit(segment_ + 1);
      return true;
    }
    if (dot_from(from_, at(v), to_) < dot_from(from_, to_, to_)) return pass({PlaceKind::vertex, v});
    place_ = {PlaceKind::edge, h};
    emit(segment_ + 1);
    return true;
  }

  bool leave_vertex(std::uint32_t v) {
    if (at(v) == to_) return true;  // only if the segment was entered at its end
    for (const std::uint32_t h : locator_.spokes(v)) {
      const std::uint32_t right = t_.target(h), left = t_.apex(h);
      if (side(at(right)) == 0 && dot_from(at(v), at(right), to_) > 0) return follow_edge(h, right);
      if (side(at(left)) == 0 && dot_from(at(v), at(left), to_) > 0) return follow_edge(previous_halfedge(h), left);
    }
    for (const std::uint32_t h : locator_.spokes(v))
      if (side(at(t_.target(h))) < 0 && side(at(t_.apex(h))) > 0) return cross_triangle(h / 3);
    left_at_ = share_of_vertex(v);
    leave();
    return false;
  }

  [[nodiscard]] Ratio share_of_vertex(std::uint32_t v) const {
    return {dot_from(from_, at(v), to_), dot_from(from_, to_, to_)};
  }
  [[nodiscard]] Ratio share_of_edge(std::uint32_t h) const {
    return crossing_share(at(t_.origin(h)), at(t_.target(h)), from_, to_);
  }

  // From outside to the first place of the rim ahead.
  bool enter() {
    std::optional<Ratio> nearest;
    Place found;
    const auto offer = [&](const Ratio& share, Place place) {
      if (share.numerator < 0 || share.numerator > share.denominator) return;
      if (left_at_ && compare(share, *left_at_) <= 0) return;
      if (nearest && compare(share, *nearest) >= 0) return;
      nearest = share;
      found = place;
    };
    for (const std::uint32_t h : locator_.rim_near(from_, to_)) {
      const std::uint32_t a = t_.origin(h), b = t_.target(h);
      const int sa = side(at(a)), sb = side(at(b));
      if (sa == 0) offer(share_of_vertex(a), {PlaceKind::vertex, a});
      if (sb == 0) offer(share_of_vertex(b), {PlaceKind::vertex, b});
      if (sa * sb < 0) offer(share_of_edge(h), {PlaceKind::edge, h});
    }
    if (!nearest) return true;  // the segment ends outside
    place_ = found;
    const bool is_end = nearest->numerator == nearest->denominator;
    emit(is_end ? segment_ + 1 : kNoPoint);
    return is_end;
  }

  const TerrainLocator& locator_;
  const LatticeTerrain& t_;
  std::span<const LatticePoint> line_;
  LineWalk walk_;
  Place place_;
  std::uint32_t segment_ = 0;
  LatticePoint from_, to_;
  std::optional<Ratio> left_at_;  ///< where the segment left the terrain
};

}  // namespace

LineWalk walk_line(const TerrainLocator& locator, std::span<const LatticePoint> line) {
  return Walker(locator, line).run();
}

}  // namespace hydrotin
