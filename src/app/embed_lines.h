#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "embed_options.h"
#include "hydrotin/mesh.h"
#include "hydrotin/river_matching.h"
#include "hydrotin/river_mouths.h"
#include "hydrotin/river_network.h"
#include "hydrotin/vector_reader.h"

namespace hydrotin::app {

/// River lines matched to a TIN, and what became of them on the way.
struct LineMatch {
  VectorParts parts;                     ///< the lines as read, in the CRS of the TIN
  std::vector<std::uint8_t> is_turned;   ///< [parts] runs against the order of its points
  std::vector<double> drop;              ///< [parts] downstream, by the terrain
  std::vector<std::uint32_t> disagrees;  ///< parts that rise downstream, by the terrain
  std::vector<std::string> name;         ///< [parts] of the river; empty: none
  std::vector<RiverEdge> rivers;
  std::vector<std::uint32_t> line_of_edge;         ///< [R] part that a river edge comes from
  std::vector<std::vector<std::uint32_t>> cycles;  ///< parts that made circles; the first of each was left out
  StepCounts counts;                               ///< every step, in its order
};

/// Reads the lines, gives them directions, matches them to the mesh (which gets new vertices with --match insert) and
/// cleans the network.
/// Fails: Error(input) for a file that cannot be read, lines that do not meet the TIN, a TIN whose triangles are
/// thinner than the lattice resolves; Error(config) for a CRS that is none.
[[nodiscard]] LineMatch match_lines(const EmbedArguments& arguments, Mesh& mesh);

/// Puts Steiner points where wingtips are on rivers, outlet chains or in lakes. The mesh gets new vertices and
/// triangles; returns how many points, and how many triangles are too small.
/// @param lake  [n] number of the lake of each vertex, 0 = none.
[[nodiscard]] std::pair<std::uint64_t, std::uint64_t> clear_mesh_wingtips(const std::string& path, Mesh& mesh,
                                                                          const std::vector<RiverEdge>& rivers,
                                                                          const std::vector<RiverEdge>& chain,
                                                                          const std::vector<std::uint32_t>& lake);

}  // namespace hydrotin::app
