#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "hydrotin/options.h"
#include "hydrotin/river_lines.h"
#include "hydrotin/river_matching.h"
#include "hydrotin/vector_reader.h"
#include "plan.h"

/// The files of rivers and lakes, in the CRS of the data set.
///
/// Memory   all coordinates at once. Errors  Error(input) naming the file.
/// Threads  Const functions are safe to call concurrently.

namespace hydrotin {

struct RiverInput {
  std::string lines_path, lakes_path, preserved_path;
  VectorParts lines, lakes;
  VectorParts preserved;                 ///< lines along edges whose type must not change
  std::vector<std::uint8_t> is_against;  ///< [lines] drawn upstream, by the attribute of the options
  std::vector<std::string> name;         ///< [lines] of rivers; empty: none
  std::vector<std::uint8_t> has_level;   ///< [lakes]
  std::vector<double> level;             ///< [lakes] in the unit of heights
  std::string hash;                      ///< of all that matters, for recipes

  [[nodiscard]] PlanePolygons polygons() const { return {lakes.ring_begin, lakes.point_begin, lakes.point}; }
};

/// Reads the files that the options name; null without rivers.
[[nodiscard]] std::shared_ptr<const RiverInput> load_river_input(const RiverOptions& options, const Plan& plan);

/// The lines on the lattice: what lies within `reach`, in pieces where a line leaves it.
[[nodiscard]] RiverLines lines_on_lattice(const RiverInput& input, const Lattice& lattice, const LatticeBox& reach);

/// A piece of a line along an edge that is to be preserved.
struct PreservedSegment {
  LatticePoint a, b;
  std::size_t line = 0;  ///< of `preserved`
};

/// On the lattice. Fails: Error(input) for points outside `box`, which no vertex can be at.
[[nodiscard]] std::vector<PreservedSegment> preserved_segments(const RiverInput& input, const Lattice& lattice,
                                                               const LatticeBox& box);

/// Heights at the points of lines within `reach`, ascending by place; of several the least.
[[nodiscard]] std::vector<std::pair<LatticePoint, double>> heights_of_lines(const RiverInput& input,
                                                                            const Lattice& lattice,
                                                                            const LatticeBox& reach);

}  // namespace hydrotin
