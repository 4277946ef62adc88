#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

/// Triangle meshes as files: PLY written (binary, little-endian), PLY and OBJ read.
///
/// PLY   vertices are three doubles x, y, z in the units of the CRS; faces are lists of three 32-bit indices. The
///       comment line `comment offset X Y Z` says what to add to vertices to get coordinates of the CRS (ours: 0 0 0).
/// CRS   WKT in a sidecar `NAME.prj` beside the mesh, where there is one.
///
/// Threads  Functions for different files may run concurrently.

namespace hydrotin {

using MeshVertex = std::array<double, 3>;
using MeshTriangle = std::array<std::uint32_t, 3>;

/// A mesh in memory.
struct Mesh {
  std::vector<MeshVertex> vertex;      ///< [n] finite
  std::vector<MeshTriangle> triangle;  ///< [T] indices < n, three different ones each
  std::string crs_wkt;                 ///< of the sidecar; empty = unknown
};

/// Streaming writer of a binary PLY whose counts are known beforehand.
/// Errors  Error(storage). Memory  a fixed buffer.
class PlyWriter {
 public:
  /// @param crs_wkt  for the sidecar; empty = none is written.
  PlyWriter(const std::filesystem::path& path, std::size_t num_vertices, std::size_t num_triangles,
            const std::string& crs_wkt);
  ~PlyWriter();
  PlyWriter(const PlyWriter&) = delete;
  PlyWriter& operator=(const PlyWriter&) = delete;

  /// All vertices come before the first triangle; exactly as many of both as announced.
  void add_vertices(std::span<const MeshVertex> vertices);
  void add_triangles(std::span<const MeshTriangle> triangles);
  /// Gives the mesh its final name, after its sidecar. Without it nothing is left behind.
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Writes a whole mesh.
void write_ply(const std::filesystem::path& path, std::span<const MeshVertex> vertices,
               std::span<const MeshTriangle> triangles, const std::string& crs_wkt);

/// Reads a PLY (ascii, binary of either byte order, any numeric types, other elements and properties passed over) or an
/// OBJ (v and f, other elements passed over), told apart by content.
///
/// Complexity: O(file) time and memory; nothing is allocated that the file's size does not back.
/// Fails: Error(input) with file and line (ascii) or byte (binary): a face that is not a triangle, an index out of
/// range or repeated, a number that is none or not finite, a file that ends early.
[[nodiscard]] Mesh read_mesh(const std::filesystem::path& path);

}  // namespace hydrotin
