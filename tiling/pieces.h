#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/id.h"
#include "hydrotin/lattice.h"
#include "hydrotin/vertical_error.h"
#include "store.h"

/// Pieces: what one tile knows of polygons that cross its border.
///
/// A piece is a set of owned Delaunay triangles joined across edges that are not fixed, with all order-k triangles that
/// enter the polygon through one of them. Two pieces belong to one polygon if a non-fixed edge lies between them; both
/// tiles list that edge by the ids of its ends.

namespace hydrotin {

struct PieceVertex {
  PointId point;
  LatticePoint position;
  std::int32_t height = 0;
};

struct Piece {
  std::vector<PieceVertex> vertex;
  std::vector<std::uint8_t> wants_lower;               ///< [vertices]
  std::vector<std::array<std::uint32_t, 3>> delaunay;  ///< [T]
  std::vector<std::uint8_t> fixed;                     ///< [T] bit i: side i is fixed
  std::vector<std::array<std::uint32_t, 3>> others;    ///< [C]
  std::vector<std::uint8_t> others_order;              ///< [C]
  std::vector<ReferencePoint> reference;               ///< owned by its Delaunay triangles
  std::vector<std::array<PointId, 2>> hull;            ///< its directed edges on the convex hull
};

/// An edge between a piece of this tile and one of another.
struct BorderEdge {
  PointId a, b;  ///< a < b
  std::uint32_t piece = 0;
  friend auto operator<=>(const BorderEdge&, const BorderEdge&) = default;
};

/// A directed edge of the convex hull at a piece.
struct HullEdge {
  std::uint32_t piece = 0;
  PointId origin, target;
  friend auto operator<=>(const HullEdge&, const HullEdge&) = default;
};

/// Collects pieces and writes them as flat arrays.
class PieceWriter {
 public:
  /// Returns the piece's number.
  std::uint32_t add(const Piece& piece);
  void add_border(PointId a, PointId b, std::uint32_t piece);
  void add_hull(PointId origin, PointId target, std::uint32_t piece);
  void write(store::Writer& out) const;

 private:
  std::vector<std::uint32_t> vertex_begin_{0}, delaunay_begin_{0}, others_begin_{0};
  std::vector<std::uint64_t> point_;
  std::vector<std::int32_t> xyz_;
  std::vector<std::uint8_t> wants_, fixed_, others_order_;
  std::vector<std::uint32_t> delaunay_, others_;
  std::vector<std::uint64_t> border_a_, border_b_;
  std::vector<std::uint32_t> border_piece_;
  std::vector<HullEdge> hull_;
  std::vector<std::uint32_t> reference_begin_{0}, reference_triangle_;
  std::vector<std::int32_t> reference_xyz_;
  std::vector<std::uint8_t> reference_on_rim_;
};

/// All pieces of one tile, as they lie in its file.
class PieceReader {
 public:
  explicit PieceReader(const store::Reader& in);
  [[nodiscard]] std::uint32_t num_pieces() const { return static_cast<std::uint32_t>(delaunay_begin_.size() - 1); }
  [[nodiscard]] Piece piece(std::uint32_t number) const;

 private:
  [[nodiscard]] std::vector<std::array<std::uint32_t, 3>> triangles(const std::vector<std::uint32_t>& flat,
                                                                    std::uint32_t begin, std::uint32_t end,
                                                                    std::size_t num_vertices) const;

  std::string path_;
  std::vector<std::uint32_t> vertex_begin_, delaunay_begin_, others_begin_;
  std::vector<std::uint64_t> point_;
  std::vector<std::int32_t> xyz_;
  std::vector<std::uint8_t> wants_, fixed_, others_order_;
  std::vector<std::uint32_t> delaunay_, others_;
  std::vector<HullEdge> hull_;  // by piece
  std::vector<std::uint32_t> reference_begin_, reference_triangle_;
  std::vector<std::int32_t> reference_xyz_;
  std::vector<std::uint8_t> reference_on_rim_;
};

/// What `join` needs of a tile: triangles per piece, and the border edges.
struct PieceSummary {
  std::vector<std::uint32_t> num_triangles;
  std::vector<BorderEdge> border;
};

[[nodiscard]] PieceSummary read_piece_summary(const store::Reader& in);

}  // namespace hydrotin
