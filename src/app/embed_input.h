#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "embed_lines.h"
#include "embed_options.h"
#include "hydrotin/mesh.h"
#include "hydrotin/river_network.h"

namespace hydrotin::app {

/// A TIN with its river edges, checked.
struct EmbedInput {
  Mesh mesh;
  std::string rivers_path;
  std::vector<std::array<double, 2>> position;  ///< [n]
  std::vector<double> height;                   ///< [n]
  std::vector<std::uint32_t> triangle;          ///< [3T]
  std::vector<RiverEdge> rivers;
  std::optional<LineMatch> lines;       ///< where the rivers came as lines
  OutletChains mouths;                  ///< where chains are wanted
  std::vector<std::uint8_t> is_outlet;  ///< [n] where chains are wanted: outlets, lakes and closed mouths
  std::uint32_t num_given = 0;          ///< vertices of the file; those after them are new

  /// Takes positions, heights and triangles from the mesh.
  void refresh();
  [[nodiscard]] RiverTerrain terrain() const { return {position, height, triangle}; }
  [[nodiscard]] double length(const RiverEdge& edge) const;
  [[nodiscard]] std::uint64_t num_river_vertices() const;
  [[nodiscard]] std::uint64_t num_wingtips() const;             ///< of all river edges together
  [[nodiscard]] std::string name_of(std::uint32_t edge) const;  ///< "the river edge 3 -> 7"
};

/// Reads the files and matches lines; lakes, preserved edges and outlet chains become constraints.
/// Fails: Error(input) for a TIN that is no terrain, edges that it does not have, rivers that flow in circles.
[[nodiscard]] EmbedInput read_embed_input(const EmbedArguments& arguments, RiverConstraints& constraints);

}  // namespace hydrotin::app
