#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <tuple>
#include <vector>

#include "oracle/definitions.h"

/// The measures of thesis, Sections 3.1 and 3.2, of one whole triangulation, each from its textbook formula.

namespace hydrotin::oracle {

struct Reference {
  LatticePoint position;
  std::int32_t height;
};

struct Terrain {
  Points p;
  std::vector<std::int32_t> z;
  std::vector<Reference> reference;
  std::map<Triangle, int> order;  ///< of every empty triangle
};

namespace detail {

struct Corner {
  long double x, y, z;
};

inline Corner corner(const Terrain& terrain, int i) {
  const auto n = static_cast<std::size_t>(i);
  return {static_cast<long double>(terrain.p[n].x), static_cast<long double>(terrain.p[n].y),
          static_cast<long double>(terrain.z[n])};
}
inline long double distance(Corner a, Corner b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}
inline long double area(Corner a, Corner b, Corner c) {
  return std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2;
}
// Law of cosines.
inline long double angle(Corner at, Corner b, Corner c) {
  const long double u = distance(at, b), v = distance(at, c), w = distance(b, c);
  return std::acos(std::clamp((u * u + v * v - w * w) / (2 * u * v), -1.0L, 1.0L)) * 180 /
         std::numbers::pi_v<long double>;
}
inline long double circumradius(Corner a, Corner b, Corner c) {
  return distance(a, b) * distance(b, c) * distance(c, a) / (4 * area(a, b, c));
}
inline long double enclosing_radius(Corner a, Corner b, Corner c) {
  const long double widest = std::max({angle(a, b, c), angle(b, c, a), angle(c, a, b)});
  if (widest >= 90) return std::max({distance(a, b), distance(b, c), distance(c, a)}) / 2;
  return circumradius(a, b, c);
}
inline long double inradius(Corner a, Corner b, Corner c) {
  return 2 * area(a, b, c) / (distance(a, b) + distance(b, c) + distance(c, a));
}
// Height of the plane through three corners.
inline long double plane_at(Corner a, Corner b, Corner c, long double x, long double y) {
  const long double d = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  const long double s = ((x - a.x) * (c.y - a.y) - (y - a.y) * (c.x - a.x)) / d;
  const long double t = ((b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x)) / d;
  return a.z + s * (b.z - a.z) + t * (c.z - a.z);
}

}  // namespace detail

/// Every value by name, as `evaluate` and the solver report them.
inline std::map<std::string, double> measures(const Terrain& terrain, const Triangles& triangles, double z_per_xy) {
  using namespace detail;
  std::map<std::string, double> out;
  long double weight = 0, longest = 0, least_angle = 180, most_angle = 0, radius = 0, enclosing = 0, largest = 0,
              smallest = 1e300L, inscribed = 0;
  int order = 0;
  std::map<int, int> degree;
  std::map<int, bool> has_lower;
  std::map<Edge, std::vector<int>> apexes;
  for (const auto& [a, b] : edges_of(triangles)) {
    const long double length = distance(corner(terrain, a), corner(terrain, b));
    weight += length;
    longest = std::max(longest, length);
    ++degree[a];
    ++degree[b];
    const auto key = [&](int i) {
      const auto n = static_cast<std::size_t>(i);
      return std::tuple(terrain.z[n], terrain.p[n].x, terrain.p[n].y);
    };
    has_lower[key(a) < key(b) ? b : a] = true;
  }
  for (const Triangle& t : triangles) {
    const Corner a = corner(terrain, t[0]), b = corner(terrain, t[1]), c = corner(terrain, t[2]);
    for (const long double angle_at : {angle(a, b, c), angle(b, c, a), angle(c, a, b)}) {
      least_angle = std::min(least_angle, angle_at);
      most_angle = std::max(most_angle, angle_at);
    }
    radius = std::max(radius, circumradius(a, b, c));
    enclosing = std::max(enclosing, enclosing_radius(a, b, c));
    largest = std::max(largest, area(a, b, c));
    smallest = std::min(smallest, area(a, b, c));
    inscribed += detail::inradius(a, b, c);
    order = std::max(order, terrain.order.at(t));
    apexes[edge(t[0], t[1])].push_back(t[2]);
    apexes[edge(t[1], t[2])].push_back(t[0]);
    apexes[edge(t[0], t[2])].push_back(t[1]);
  }
  long double ratio = 0, bend = 0;
  int convex = 0;
  for (const auto& [e, apex] : apexes) {
    if (apex.size() != 2) continue;
    const Corner a = corner(terrain, e.first), b = corner(terrain, e.second), c = corner(terrain, apex[0]),
                 d = corner(terrain, apex[1]);
    const long double s = area(a, b, c), t = area(a, b, d);
    ratio = std::max(ratio, std::max(s / t, t / s));
    const long double below = plane_at(a, b, c, d.x, d.y) - d.z;
    convex += below > 1e-9L * (1 + std::abs(d.z));
    const auto gradient = [&](Corner q) {
      const long double zx = plane_at(a, b, q, a.x + 1, a.y) - a.z, zy = plane_at(a, b, q, a.x, a.y + 1) - a.z;
      return std::pair{zx * z_per_xy, zy * z_per_xy};
    };
    const auto [px, py] = gradient(c);
    const auto [qx, qy] = gradient(d);
    const long double cosine = (px * qx + py * qy + 1) / std::sqrt((px * px + py * py + 1) * (qx * qx + qy * qy + 1));
    bend = std::max(bend, std::acos(std::clamp(cosine, -1.0L, 1.0L)) * 180 / std::numbers::pi_v<long double>);
  }
  int minima = 0, most = 0;
  for (const auto& [v, d] : degree) {
    minima += !has_lower.contains(v);
    most = std::max(most, d);
  }
  long double squared = 0, absolute = 0, worst = 0;
  for (const Reference& r : terrain.reference) {
    // The surface is continuous: any triangle that holds the point will do.
    for (const Triangle& t : triangles) {
      const auto at = [&](int i) { return terrain.p[static_cast<std::size_t>(i)]; };
      const int turn = side(at(t[0]), at(t[1]), at(t[2]));
      bool inside = true;
      for (std::size_t i = 0; i < 3; ++i) inside = inside && turn * side(at(t[i]), at(t[(i + 1) % 3]), r.position) >= 0;
      if (!inside) continue;
      const long double d =
          std::abs(static_cast<long double>(r.height) -
                   plane_at(corner(terrain, t[0]), corner(terrain, t[1]), corner(terrain, t[2]),
                            static_cast<long double>(r.position.x), static_cast<long double>(r.position.y)));
      squared += d * d;
      absolute += d;
      worst = std::max(worst, d);
      break;
    }
  }
  const auto set = [&](const char* name, long double value) { out[name] = static_cast<double>(value); };
  set("delaunay", 0);
  set("min-weight", weight);
  set("local-minima", minima);
  set("min-max-edge", longest);
  set("max-min-angle", least_angle);
  set("min-max-angle", most_angle);
  set("min-max-circumradius", radius);
  set("min-max-enclosing-circle", enclosing);
  set("min-max-area", largest);
  set("max-min-area", smallest);
  set("max-sum-inradius", inscribed);
  set("min-sum-inradius", inscribed);
  set("min-squared-error", squared);
  set("min-absolute-error", absolute);
  set("min-max-error", worst);
  set("min-max-degree", most);
  set("min-max-area-ratio", ratio);
  set("min-max-normal-angle", bend);
  set("max-convex-edges", convex);
  set("min-max-order", order);
  return out;
}

}  // namespace hydrotin::oracle
