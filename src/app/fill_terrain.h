#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hydrotin/lattice.h"
#include "hydrotin/mesh.h"
#include "hydrotin/vertex_graph.h"

namespace hydrotin::app {

/// A mesh as the terrain room wants it: integers in place of coordinates.
struct FillTerrain {
  VertexGraph graph;
  std::vector<std::int32_t> height;     ///< [n] heights = origin + height * quantum
  std::vector<LatticePoint> position;   ///< [n] on `lattice`; without it ranks of x and of y: all that ties ask for
  std::vector<std::uint32_t> triangle;  ///< [3T] counter-clockwise
  std::vector<std::uint8_t> on_rim;     ///< [n] nonzero on an edge of one triangle
  std::vector<std::int64_t> weight;     ///< [n] areas of the stars in units of `area_unit`, at least 1
  Lattice lattice;                      ///< of positions and heights
  bool has_lattice = false;             ///< all vertices have places of their own on it, and no triangle turns over
  double area_unit = 1;                 ///< [squared mesh units]
  std::int64_t denominator = 1;         ///< heights are (base + integer) / denominator
  std::int64_t base = 0;
  bool is_exact = true;     ///< all heights of the mesh are of that form; else these are their roundings
  bool is_rounded = false;  ///< by more than the rounding errors of doubles

  [[nodiscard]] double z(std::int32_t h) const {
    return static_cast<double>(base + h) / static_cast<double>(denominator);
  }
  [[nodiscard]] double quantum() const { return 1 / static_cast<double>(denominator); }
};

/// Coordinates become integers of a lattice of decimals if they are decimals, else of the finest one that fits.
/// Fails: Error(input) for what is no terrain: two vertices at one place, an edge of three triangles, heights out of
/// reach (above 10^15 or a relief above 10^9).
[[nodiscard]] FillTerrain make_fill_terrain(const std::string& path, const Mesh& mesh);

/// Heights as ranks: exact whatever doubles they are, fit for everything that only compares.
struct RankedHeights {
  std::vector<double> level;         ///< values that occur, ascending
  std::vector<std::int32_t> height;  ///< [n] index into `level`
};
[[nodiscard]] RankedHeights rank_heights(const Mesh& mesh);

/// Lengths, areas and maps need places on a lattice.
/// @param what  that needs it, for the message.
/// Fails: Error(input) where there is none, or two triangles lie on the same side of an edge.
void require_lattice(const std::string& path, const FillTerrain& terrain, const std::string& what);

/// Where water may leave.
struct OutletChoice {
  std::string policy = "hull";  ///< "hull", "lowest", a CSV file (.csv) of vertices or edges whose ends are outlets (a
                                ///< header line, then one or two 0-based vertex indices a line), or a vector file
  std::string crs_wkt;          ///< of the terrain, for the vector file
  std::optional<double> void_edge;  ///< [units of the mesh] also at triangles with a longer edge
};

/// Vertices of no triangle are outlets in any case: nothing is to happen to them.
/// Fails: Error(input) for a bad file, Error(config) for the name of none; Error(input) where a piece of the terrain
/// has no outlet.
[[nodiscard]] std::vector<std::uint8_t> find_outlets(const std::string& path, const OutletChoice& choice,
                                                     const FillTerrain& terrain);

/// With a list of vertices, only their pits are to be removed: the plateaus of all other pits become outlets.
/// Fails: Error(config) for a vertex that does not exist or lies in no pit.
[[nodiscard]] std::vector<std::uint8_t> keep_other_pits(const std::vector<std::uint32_t>& wanted,
                                                        const FillTerrain& terrain,
                                                        std::vector<std::uint8_t> is_outlet);

}  // namespace hydrotin::app
