#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "hydrotin/river_network.h"

/// What a terrain with rivers must satisfy: the criteria of Table 7.1 that linear rows can express.
///
/// Each is a row lower <= sum a_i d_i <= upper over the displacements d = h - h0, its sides computed from differences
/// of the old heights only, so that neither large coordinates nor large heights cost digits.
///
///   flow          h_from - h_to >= decline * length of the edge
///   valley        h_w - ((1 - t) h_from + t h_to) >= side slope * distance of w from the line, for both wingtips w; t
///                 is the foot of w on the line of the edge, and the row is divided by max(1, |t|, |1 - t|). It says
///                 the same as the 4 x 4 determinant of Section 7.1.1.
///   slope limit   |d_a - d_b| <= p |h0_a - h0_b| for edges that are not flat and have no river vertex
///   triangle      the same for the slope of a triangle in given directions; triangles with a river vertex are exempt
///   contiguous    no way down from a river vertex is steeper than its river edge; not posed where the river parts
///   lake          all vertices at one height
///   chain         h_v >= h_next along outlet chains (river_mouths.h); their vertices are exempt from limits of slopes
///   edge type     ridge, valley, transfluent; convex, reflex: the sides on which weak inequalities hold stay the same
///
/// Source   thesis, Sections 7.1.1 and 7.1.2.
/// Units    metres; slopes as rise over run.

namespace hydrotin {

enum class DeclineMeasure : std::uint8_t {
  none,      ///< weak flow: h_from >= h_to
  fraction,  ///< of the average slope of the connected network; 0 where that is not positive
  slope,     ///< rise over run
};

/// A set of vertices that must be level.
struct Lake {
  std::vector<std::uint32_t> vertex;
  bool has_level = false;
  double level = 0;  ///< where `has_level`
};

/// An edge of the terrain whose type must not change.
struct PreservedEdge {
  std::uint32_t a = 0, b = 0;
  bool drainage = true;    ///< ridge, valley, transfluent
  bool curvature = false;  ///< convex, reflex
};

enum class Contiguity : std::uint8_t {
  none,
  imaginary_points,  ///< T's slightly stronger rows
  exact,             ///< cutting planes, one per triangle and round
};

struct RiverConstraints {
  bool flow = true;
  bool valley = true;
  DeclineMeasure decline_measure = DeclineMeasure::fraction;
  double decline = 0.1;            ///< in the measure above, >= 0
  double side_slope = 0;           ///< >= 0; 0 = weak valleys
  bool limit_edge_slope = true;    ///< the S of VFRS
  double edge_slope_change = 0.5;  ///< fraction of the old slope
  std::vector<double> directions;  ///< angles [rad] in which the slope of triangles is limited; empty = not
  double triangle_slope_change = 0.5;
  Contiguity contiguity = Contiguity::none;
  std::uint32_t imaginary_points = 0;  ///< per triangle, on the side opposite to the river vertex
  bool river_only = false;             ///< only river vertices may move
  double max_change = 0;               ///< of each vertex; 0 = no limit
  std::vector<Lake> lakes;             ///< no vertex in two of them
  std::vector<PreservedEdge> preserve;
  std::vector<RiverEdge> chain;  ///< of outlet chains, edges of the terrain; no cycle with the river edges
};

}  // namespace hydrotin
