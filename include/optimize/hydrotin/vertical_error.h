#pragma once

#include <cstdint>
#include <span>

#include "hydrotin/exact_sum.h"
#include "hydrotin/lattice.h"
#include "hydrotin/measure.h"

/// Vertical distance of reference points from a surface, and which triangle answers for which point.
///
/// A reference point belongs to exactly one triangle of any triangulation: to the one that holds it after it is moved
/// by an infinitesimal (e, e^2). A point on an edge of the hull or of a simple polygon (`on_rim`) belongs to the
/// triangle at that edge. A point at a vertex belongs to no triangle; its distance does not depend on the
/// triangulation.
///
/// Units    z lattice units.
/// Properties
///   (1) In a triangulation whose triangles cover a point, exactly one of them owns it.
///   (2) Distances are exact fractions; a limit is compared without rounding.
/// Threads  Pure functions.

namespace hydrotin {

/// A measured point that is not a vertex.
struct ReferencePoint {
  LatticePoint position;
  std::int32_t height = 0;
  std::uint32_t triangle = 0;  ///< a Delaunay triangle that owns it
  bool on_rim = false;         ///< on an edge of the hull, or of the simple polygon that is triangulated
};

/// Whether triangle abc (counter-clockwise) owns a reference point that is none of its corners.
[[nodiscard]] bool owns(LatticePoint a, LatticePoint b, LatticePoint c, LatticePoint p, bool on_rim);

/// Height of the point minus height of the plane at its place, as a fraction with positive denominator.
struct VerticalDistance {
  Wide numerator = 0, denominator = 1;

  /// Equal fractions have equal values, however they are written.
  [[nodiscard]] double value() const;
};

/// Precondition: a, b, c counter-clockwise. Exact: below 2^100 for all 32-bit coordinates.
[[nodiscard]] VerticalDistance vertical_distance(const SurfacePoint& a, const SurfacePoint& b, const SurfacePoint& c,
                                                 LatticePoint position, std::int32_t height);

/// A limit on distances, in millionths of a z lattice unit: 0.2 m on a lattice of 1 mm is 200 000 000.
struct ErrorLimit {
  std::int64_t millionths = 0;

  /// Exact. Precondition: the limit is not negative and below 2^31 z lattice units.
  [[nodiscard]] bool allows(const VerticalDistance& distance) const;
};

/// Distances of all reference points that a triangle, or several, own.
struct TriangleError {
  ExactSum squared, absolute;
  double largest = 0;
  bool within_limit = true;

  void add(const VerticalDistance& distance, const ErrorLimit* limit);
  void add(const TriangleError& other);
  friend bool operator==(const TriangleError&, const TriangleError&) = default;
};

}  // namespace hydrotin
