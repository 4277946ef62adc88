#include "editable_terrain.h"

#include <algorithm>
#include <deque>

#include "exact_ratio.h"
#include "hydrotin/predicates.h"

namespace hydrotin {

EditableTerrain::EditableTerrain(LatticeTerrain terrain)
    : t_(std::move(terrain)), constrained_(t_.triangle.size(), 0), spoke_(t_.position.size(), kNoHalfedge) {
  std::vector<std::uint32_t> rims(t_.position.size(), 0);
  for (std::uint32_t h = 0; h < t_.triangle.size(); ++h) {
    spoke_[t_.origin(h)] = h;
    if (t_.twin[h] == kNoHalfedge) ++rims[t_.origin(h)];
  }
  for (std::uint32_t h = 0; h < t_.triangle.size(); ++h)
    if (t_.twin[h] == kNoHalfedge && rims[t_.origin(h)] > 1) fans_[t_.origin(h)].push_back(h);
}

void EditableTerrain::set_halfedge(std::uint32_t h, std::uint32_t origin, std::uint32_t twin, bool is_constrained) {
  t_.triangle[h] = origin;
  t_.twin[h] = twin;
  constrained_[h] = is_constrained ? 1 : 0;
  spoke_[origin] = h;
  if (twin != kNoHalfedge) {
    t_.twin[twin] = h;
  } else if (const auto found = fans_.find(origin); found != fans_.end()) {
    found->second.push_back(h);
  }
}

std::uint32_t EditableTerrain::add_triangle() {
  const auto first = static_cast<std::uint32_t>(t_.triangle.size());
  t_.triangle.resize(first + 3);
  t_.twin.resize(first + 3, kNoHalfedge);
  constrained_.resize(first + 3, 0);
  return first;
}

// All half-edges with this origin in the fan of `start`: on counter-clockwise, then clockwise from the start.
void EditableTerrain::add_fan(std::uint32_t v, std::uint32_t start, std::vector<std::uint32_t>& spokes) const {
  std::uint32_t h = start;
  do {
    spokes.push_back(h);
    h = t_.twin[previous_halfedge(h)];
  } while (h != kNoHalfedge && h != start);
  if (h == start) return;
  for (h = t_.twin[start]; h != kNoHalfedge; h = t_.twin[h]) {
    h = next_halfedge(h);
    if (t_.origin(h) != v) break;  // unreachable
    spokes.push_back(h);
  }
}

std::vector<std::uint32_t> EditableTerrain::spokes(std::uint32_t v) const {
  std::vector<std::uint32_t> found;
  const auto fans = fans_.find(v);
  if (fans == fans_.end()) {
    if (spoke_[v] != kNoHalfedge) add_fan(v, spoke_[v], found);
    return found;
  }
  for (const std::uint32_t h : fans->second)
    if (t_.origin(h) == v && t_.twin[h] == kNoHalfedge && std::find(found.begin(), found.end(), h) == found.end())
      add_fan(v, h, found);
  return found;
}

std::uint32_t EditableTerrain::find_edge(std::uint32_t a, std::uint32_t b) const {
  for (const std::uint32_t h : spokes(a)) {
    if (t_.target(h) == b) return h;
    if (t_.apex(h) == b && t_.twin[previous_halfedge(h)] == kNoHalfedge) return previous_halfedge(h);
  }
  return kNoHalfedge;
}

void EditableTerrain::constrain(std::uint32_t h) {
  constrained_[h] = 1;
  if (t_.twin[h] != kNoHalfedge) constrained_[t_.twin[h]] = 1;
}

// The edge h from a to b with apexes c (left) and d (right) becomes the edge from d to c.
void EditableTerrain::flip(std::uint32_t h) {
  const std::uint32_t g = t_.twin[h];
  const std::uint32_t hn = next_halfedge(h), hp = previous_halfedge(h), gn = next_halfedge(g),
                      gp = previous_halfedge(g);
  const std::uint32_t a = t_.origin(h), b = t_.origin(g), c = t_.origin(hp), d = t_.origin(gp);
  const std::uint32_t bc = t_.twin[hn], ca = t_.twin[hp], ad = t_.twin[gn], db = t_.twin[gp];
  const bool f_bc = constrained_[hn] != 0, f_ca = constrained_[hp] != 0, f_ad = constrained_[gn] != 0,
             f_db = constrained_[gp] != 0;
  // Left triangle becomes c, a, d; right one d, b, c.
  set_halfedge(hn, c, ca, f_ca);
  set_halfedge(hp, a, ad, f_ad);
  set_halfedge(gn, d, db, f_db);
  set_halfedge(gp, b, bc, f_bc);
  set_halfedge(h, d, g, false);
  set_halfedge(g, c, h, false);
}

bool EditableTerrain::is_flippable(std::uint32_t h) const {
  const std::uint32_t g = t_.twin[h];
  if (g == kNoHalfedge || constrained_[h] != 0) return false;
  const auto at = [&](std::uint32_t v) { return t_.position[v]; };
  const LatticePoint a = at(t_.origin(h)), b = at(t_.target(h)), c = at(t_.apex(h)), d = at(t_.apex(g));
  return orientation(d, b, c) > 0 && orientation(c, a, d) > 0;
}

void EditableTerrain::legalize(std::vector<std::uint32_t> open) {
  while (!open.empty()) {
    const std::uint32_t h = open.back();
    open.pop_back();
    if (!is_flippable(h)) continue;
    const std::uint32_t g = t_.twin[h];
    const auto at = [&](std::uint32_t v) { return t_.position[v]; };
    if (!in_circle(at(t_.origin(h)), at(t_.target(h)), at(t_.apex(h)), at(t_.apex(g)))) continue;
    flip(h);
    for (const std::uint32_t side : {next_halfedge(h), previous_halfedge(h), next_halfedge(g), previous_halfedge(g)})
      open.push_back(side);
  }
}

Place EditableTerrain::locate(LatticePoint p, std::uint32_t hint) const {
  const auto test = [&](std::uint32_t triangle, std::uint32_t& exit) -> Place {
    std::uint32_t on = kNoHalfedge;
    exit = kNoHalfedge;
    for (std::uint32_t h = 3 * triangle; h < 3 * triangle + 3; ++h) {
      if (t_.position[t_.origin(h)] == p) return {PlaceKind::vertex, t_.origin(h)};
      const int side = orientation(t_.position[t_.origin(h)], t_.position[t_.target(h)], p);
      if (side < 0 && (exit == kNoHalfedge || t_.twin[exit] == kNoHalfedge)) exit = h;
      if (side == 0) on = h;
    }
    if (exit != kNoHalfedge) return {};
    return on == kNoHalfedge ? Place{PlaceKind::triangle, triangle} : Place{PlaceKind::edge, on};
  };
  std::uint32_t exit = kNoHalfedge;
  std::uint32_t triangle = spoke_[hint] == kNoHalfedge ? kNoHalfedge : spoke_[hint] / 3;
  for (int step = 0; triangle != kNoHalfedge && step < 10000; ++step) {
    const Place place = test(triangle, exit);
    if (place.kind != PlaceKind::outside) return place;
    if (exit == kNoHalfedge || t_.twin[exit] == kNoHalfedge) break;
    triangle = t_.twin[exit] / 3;
  }
  // The way was barred by the rim (or went round in a circle): look everywhere.
  for (std::uint32_t i = 0; i < t_.triangle.size() / 3; ++i)
    if (const Place place = test(i, exit); place.kind != PlaceKind::outside) return place;
  return {};
}

std::optional<std::uint32_t> EditableTerrain::insert_vertex(LatticePoint p, double height, std::uint32_t hint) {
  const Place place = locate(p, hint);
  if (place.kind == PlaceKind::outside) return std::nullopt;
  if (place.kind == PlaceKind::vertex) return place.id;
  const std::uint32_t v =
      place.kind == PlaceKind::edge ? split_edge(place.id, p, height) : split_triangle(place.id, p, height);
  std::vector<std::uint32_t> link;
  for (const std::uint32_t h : spokes(v)) link.push_back(next_halfedge(h));
  legalize(std::move(link));
  return v;
}

bool EditableTerrain::can_split_edge(std::uint32_t h, LatticePoint p) const {
  const auto halves = [&](std::uint32_t g) {
    const LatticePoint a = t_.position[t_.origin(g)], b = t_.position[t_.target(g)], c = t_.position[t_.apex(g)];
    return orientation(a, p, c) > 0 && orientation(p, b, c) > 0;
  };
  const std::uint32_t g = t_.twin[h];
  return halves(h) && (g == kNoHalfedge || halves(g));
}

std::uint32_t EditableTerrain::split_edge(std::uint32_t h, LatticePoint p, double height) {
  const auto v = static_cast<std::uint32_t>(t_.position.size());
  t_.position.push_back(p);
  t_.height.push_back(height);
  spoke_.push_back(kNoHalfedge);
  const std::uint32_t g = t_.twin[h], b = t_.target(h), c = t_.apex(h), a = t_.origin(h);
  const bool is_fixed = constrained_[h] != 0;
  // Left of the edge: a, v, c and v, b, c.
  const std::uint32_t hn = next_halfedge(h), bc = t_.twin[hn];
  const bool f_bc = constrained_[hn] != 0;
  const std::uint32_t n = add_triangle();  // v, b, c
  set_halfedge(n, v, kNoHalfedge, is_fixed);
  set_halfedge(n + 1, b, bc, f_bc);
  set_halfedge(n + 2, c, hn, false);
  set_halfedge(hn, v, n + 2, false);
  spoke_[c] = n + 2;
  if (g == kNoHalfedge) {
    set_halfedge(h, a, kNoHalfedge, is_fixed);
    return v;
  }
  const std::uint32_t gn = next_halfedge(g), ad = t_.twin[gn], d = t_.apex(g);
  const bool f_ad = constrained_[gn] != 0;
  const std::uint32_t m = add_triangle();  // v, a, d
  set_halfedge(m, v, h, is_fixed);
  set_halfedge(h, a, m, is_fixed);
  set_halfedge(m + 1, a, ad, f_ad);
  set_halfedge(m + 2, d, gn, false);
  set_halfedge(gn, v, m + 2, false);
  set_halfedge(g, b, n, is_fixed);
  set_halfedge(n, v, g, is_fixed);
  return v;
}

std::uint32_t EditableTerrain::split_triangle(std::uint32_t triangle, LatticePoint p, double height) {
  const auto v = static_cast<std::uint32_t>(t_.position.size());
  t_.position.push_back(p);
  t_.height.push_back(height);
  spoke_.push_back(kNoHalfedge);
  const std::uint32_t h = 3 * triangle;
  const std::uint32_t a = t_.triangle[h], b = t_.triangle[h + 1], c = t_.triangle[h + 2];
  const std::uint32_t bc = t_.twin[h + 1], ca = t_.twin[h + 2];
  const bool f_bc = constrained_[h + 1] != 0, f_ca = constrained_[h + 2] != 0;
  const std::uint32_t m = add_triangle(), n = add_triangle();  // b, c, v and c, a, v; the old one becomes a, b, v
  set_halfedge(m, b, bc, f_bc);
  set_halfedge(n, c, ca, f_ca);
  set_halfedge(h + 1, b, m + 2, false);
  set_halfedge(m + 2, v, h + 1, false);
  set_halfedge(m + 1, c, n + 2, false);
  set_halfedge(n + 2, v, m + 1, false);
  set_halfedge(n + 1, a, h + 2, false);
  set_halfedge(h + 2, v, n + 1, false);
  return v;
}

// From a towards b: the next vertex on the segment, and the edges crossed before it. False at the rim.
bool EditableTerrain::cross_to(std::uint32_t a, std::uint32_t b, std::uint32_t& reached,
                               std::vector<std::array<std::uint32_t, 2>>& crossed) const {
  const LatticePoint from = t_.position[a], to = t_.position[b];
  const auto side = [&](std::uint32_t v) { return orientation(from, to, t_.position[v]); };
  const auto around = spokes(a);
  for (const std::uint32_t h : around)
    for (const std::uint32_t v : {t_.target(h), t_.apex(h)})
      if (side(v) == 0 && dot_from(from, t_.position[v], to) > 0) {
        reached = v;
        return true;
      }
  for (std::uint32_t h : around) {
    if (!(side(t_.target(h)) < 0 && side(t_.apex(h)) > 0)) continue;
    h = next_halfedge(h);
    while (true) {
      if (t_.twin[h] == kNoHalfedge || constrained_[h] != 0) return false;
      crossed.push_back({t_.origin(h), t_.target(h)});
      h = t_.twin[h];
      const std::uint32_t apex = t_.apex(h);
      const int s = side(apex);
      if (s == 0) {
        reached = apex;
        return true;
      }
      // h runs from the left of the segment to its right.
      h = s > 0 ? next_halfedge(h) : previous_halfedge(h);
    }
  }
  return false;
}

// Flips the crossed edges until none crosses the segment ab (Sloan 1993), then makes the new ones Delaunay.
void EditableTerrain::clear_way(std::uint32_t a, std::uint32_t b, std::vector<std::array<std::uint32_t, 2>> crossed) {
  std::deque<std::array<std::uint32_t, 2>> open(crossed.begin(), crossed.end());
  std::vector<std::array<std::uint32_t, 2>> made;
  const LatticePoint from = t_.position[a], to = t_.position[b];
  const auto side = [&](std::uint32_t v) { return orientation(from, to, t_.position[v]); };
  while (!open.empty()) {
    const auto edge = open.front();
    open.pop_front();
    const std::uint32_t h = find_edge(edge[0], edge[1]);
    if (!is_flippable(h)) {
      open.push_back(edge);
      continue;
    }
    flip(h);
    const std::array<std::uint32_t, 2> diagonal{t_.origin(h), t_.target(h)};
    const bool is_on = diagonal[0] == a || diagonal[0] == b || diagonal[1] == a || diagonal[1] == b;
    if (!is_on && side(diagonal[0]) * side(diagonal[1]) < 0)
      open.push_back(diagonal);
    else
      made.push_back(diagonal);
  }
  constrain(find_edge(a, b));
  std::vector<std::uint32_t> edges;
  for (const auto& edge : made) edges.push_back(find_edge(edge[0], edge[1]));
  legalize(std::move(edges));
}

bool EditableTerrain::insert_segment(std::uint32_t a, std::uint32_t b, std::vector<std::uint32_t>& way) {
  while (a != b) {
    std::uint32_t reached = a;
    std::vector<std::array<std::uint32_t, 2>> crossed;
    if (!cross_to(a, b, reached, crossed)) return false;
    // A vertex beyond b on the line of the segment cannot come first: b is a vertex.
    if (crossed.empty())
      constrain(find_edge(a, reached));
    else
      clear_way(a, reached, std::move(crossed));
    way.push_back(reached);
    a = reached;
  }
  return true;
}

}  // namespace hydrotin
