#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "hydrotin/polygon.h"
#include "phases.h"
#include "pieces.h"

/// Polygons that are put together from pieces.

namespace hydrotin {

class SeamPolygon {
 public:
  void clear();
  void add(const Piece& piece);
  /// Vertices among `wanting` (ascending) that other polygons were to save may be saved by this one. Returns whether
  /// there is any.
  bool adopt(std::span<const std::uint64_t> wanting);
  /// To be called once, after all pieces were added; valid until `clear`.
  [[nodiscard]] PolygonProblem problem();

  [[nodiscard]] const std::vector<PieceVertex>& vertices() const { return vertex_; }
  [[nodiscard]] const std::vector<std::uint8_t>& wants_lower() const { return wants_; }
  [[nodiscard]] const std::vector<std::array<PointId, 2>>& hull() const { return hull_; }

 private:
  [[nodiscard]] std::uint32_t num_components() const;

  std::unordered_map<std::uint64_t, std::uint32_t> number_;
  std::vector<PieceVertex> vertex_;
  std::vector<LatticePoint> position_;
  std::vector<std::int32_t> height_;
  std::vector<std::uint8_t> wants_, fixed_, others_order_;
  std::vector<std::pair<std::array<std::uint32_t, 3>, std::uint8_t>> met_;  // others, as the pieces list them
  std::vector<std::array<std::uint32_t, 3>> delaunay_, others_;
  std::vector<ReferencePoint> reference_;
  std::vector<std::array<PointId, 2>> hull_;
};

/// The polygons that one tile was given by `join`.
class SeamList {
 public:
  SeamList(const RunContext& context, std::uint32_t tile);

  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(begin_.size() - 1); }
  /// Puts a polygon together. Files of tiles stay open until the list goes.
  void read(std::uint32_t number, SeamPolygon& polygon);

 private:
  const PieceReader& pieces_of(std::uint32_t tile);

  const RunContext& context_;
  std::vector<std::uint64_t> begin_;
  std::vector<std::uint32_t> tile_, piece_;
  std::map<std::uint32_t, PieceReader> pieces_;
};

}  // namespace hydrotin
