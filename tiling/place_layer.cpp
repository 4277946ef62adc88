#include "hydrotin/place_layer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "box_tree.h"
#include "hydrotin/error.h"
#include "hydrotin/predicates.h"
#include "hydrotin/vector_reader.h"
#include "recipe.h"

namespace hydrotin {
namespace {

LatticeBox box_of(LatticePoint a, LatticePoint b) {
  LatticeBox box;
  box.extend(a);
  box.extend(b);
  return box;
}

// The nearest lattice point, if there is one; the lattice may be continued by its own width on each side.
std::optional<LatticePoint> to_lattice(const Lattice& l, double x, double y) {
  const double i = std::round((x - l.offset_x) / l.scale_xy - static_cast<double>(l.base_x));
  const double j = std::round((y - l.offset_y) / l.scale_xy - static_cast<double>(l.base_y));
  constexpr double kMost = std::numeric_limits<std::int32_t>::max();
  if (!(std::abs(i) <= kMost && std::abs(j) <= kMost)) return std::nullopt;
  return LatticePoint{static_cast<std::int32_t>(i), static_cast<std::int32_t>(j)};
}

bool on_segment(LatticePoint p, LatticePoint a, LatticePoint b) {
  return orientation(a, b, p) == 0 && box_of(a, b).contains(p);
}

bool segments_meet(LatticePoint a, LatticePoint b, LatticePoint c, LatticePoint d) {
  return properly_cross(a, b, c, d) || on_segment(a, c, d) || on_segment(b, c, d) || on_segment(c, a, b) ||
         on_segment(d, a, b);
}

struct Segment {
  LatticePoint a, b;  // equal: a point
  std::uint32_t polygon = 0;
};

BoxTree tree_of(const std::vector<Segment>& segments) {
  std::vector<LatticeBox> boxes;
  boxes.reserve(segments.size());
  for (const Segment& s : segments) boxes.push_back(box_of(s.a, s.b));
  return BoxTree(std::move(boxes));
}

}  // namespace

struct PlaceLayer::State {
  std::vector<Segment> segment, ring;  // of points and lines; of polygons
  BoxTree segment_tree{{}}, ring_tree{{}};
  std::uint64_t num_polygons = 0;

  void add(const VectorParts& parts, const Lattice& lattice, bool is_polygon) {
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (is_polygon) ++num_polygons;
      for (std::size_t r = parts.ring_begin[i]; r < parts.ring_begin[i + 1]; ++r) {
        std::vector<LatticePoint> chain;
        bool fits = true;
        for (const auto& p : parts.ring(r)) {
          const auto at = to_lattice(lattice, p[0], p[1]);
          fits = fits && at.has_value();
          if (at && (chain.empty() || chain.back() != *at)) chain.push_back(*at);
        }
        if (fits && !chain.empty()) add_chain(chain, is_polygon);
      }
    }
  }

  void add_chain(const std::vector<LatticePoint>& chain, bool is_polygon) {
    const auto polygon = static_cast<std::uint32_t>(num_polygons);
    if (is_polygon) {
      for (std::size_t p = 0; p < chain.size(); ++p) ring.push_back({chain[p], chain[(p + 1) % chain.size()], polygon});
    } else if (chain.size() == 1) {
      segment.push_back({chain[0], chain[0], 0});
    } else {
      for (std::size_t p = 1; p < chain.size(); ++p) segment.push_back({chain[p - 1], chain[p], 0});
    }
  }
};

PlaceLayer::PlaceLayer() : state_(std::make_unique<State>()) {}
PlaceLayer::PlaceLayer(PlaceLayer&&) noexcept = default;
PlaceLayer& PlaceLayer::operator=(PlaceLayer&&) noexcept = default;
PlaceLayer::~PlaceLayer() = default;

PlaceLayer::PlaceLayer(const std::string& path, const Lattice& lattice, const std::string& crs_wkt, bool only_polygons)
    : PlaceLayer() {
  VectorReadOptions options;
  options.target_wkt = crs_wkt;
  for (const VectorGeometry kind : {VectorGeometry::point, VectorGeometry::line, VectorGeometry::polygon}) {
    const bool is_polygon = kind == VectorGeometry::polygon;
    if (only_polygons && !is_polygon) continue;
    options.geometry = kind;
    state_->add(read_vector(path, options), lattice, is_polygon);
  }
  if (state_->segment.empty() && state_->ring.empty())
    throw Error(ErrorKind::input, path + ": it has no " + (only_polygons ? "polygon" : "point, line or polygon") +
                                      " near the data; check its CRS");
  state_->segment_tree = tree_of(state_->segment);
  state_->ring_tree = tree_of(state_->ring);
}

bool PlaceLayer::covers(LatticePoint p) const {
  if (state_->ring.empty()) return false;
  // Edges that a ray to the right meets, each with its upper end only.
  const LatticeBox ray{p, {std::numeric_limits<std::int32_t>::max(), p.y}};
  std::map<std::uint32_t, bool> is_inside;
  bool is_on_border = false;
  state_->ring_tree.for_each([&](const LatticeBox& box) { return box.intersects(ray); },
                             [&](std::uint32_t i) {
                               const Segment& s = state_->ring[i];
                               is_on_border = on_segment(p, s.a, s.b);
                               if (is_on_border) return false;
                               if ((s.a.y <= p.y) == (s.b.y <= p.y)) return true;
                               const bool up = s.a.y <= p.y;
                               if (orientation(s.a, s.b, p) == (up ? 1 : -1))
                                 is_inside[s.polygon] = !is_inside[s.polygon];
                               return true;
                             });
  return is_on_border ||
         std::any_of(is_inside.begin(), is_inside.end(), [](const auto& polygon) { return polygon.second; });
}

bool PlaceLayer::meets(std::span<const LatticePoint, 3> corner) const {
  if (state_->segment.empty()) return false;
  LatticeBox box;
  for (const LatticePoint p : corner) box.extend(p);
  const auto contains = [&](LatticePoint p) {
    for (std::size_t i = 0; i < 3; ++i)
      if (orientation(corner[i], corner[(i + 1) % 3], p) < 0) return false;
    return true;
  };
  bool found = false;
  state_->segment_tree.for_each([&](const LatticeBox& other) { return other.intersects(box); },
                                [&](std::uint32_t i) {
                                  const Segment& s = state_->segment[i];
                                  found = contains(s.a) || contains(s.b);
                                  for (std::size_t e = 0; e < 3 && !found && s.a != s.b; ++e)
                                    found = segments_meet(s.a, s.b, corner[e], corner[(e + 1) % 3]);
                                  return !found;
                                });
  return found;
}

std::string PlaceLayer::hash() const {
  RecipeHash hash;
  for (const auto* list : {&state_->segment, &state_->ring}) {
    hash.add(static_cast<std::int64_t>(list->size()));
    for (const Segment& s : *list)
      hash.add(std::int64_t{s.a.x})
          .add(std::int64_t{s.a.y})
          .add(std::int64_t{s.b.x})
          .add(std::int64_t{s.b.y})
          .add(std::int64_t{s.polygon});
  }
  return hash.hex();
}

void PlaceLayer::mark(std::span<const LatticePoint> position, std::span<const std::int32_t> height,
                      std::span<const std::uint32_t> triangle_vertex, std::span<std::uint8_t> is_marked) const {
  for (std::size_t v = 0; v < position.size(); ++v) is_marked[v] |= static_cast<std::uint8_t>(covers(position[v]));
  if (state_->segment.empty()) return;
  for (std::size_t t = 0; t < triangle_vertex.size(); t += 3) {
    const std::uint32_t* v = &triangle_vertex[t];
    const std::array corner{position[v[0]], position[v[1]], position[v[2]]};
    if (!meets(corner)) continue;
    const auto before = [&](std::uint32_t a, std::uint32_t b) {
      return std::tie(height[a], position[a]) < std::tie(height[b], position[b]);
    };
    is_marked[*std::min_element(v, v + 3, before)] = 1;
  }
}

std::uint64_t PlaceLayer::num_polygons() const {
  return state_->num_polygons;
}

}  // namespace hydrotin
