#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/lattice.h"

/// River lines on the lattice, and how they hang together.
///
/// A line is what a file holds: a chain of points. A reach is a part of a line between nodes: points where lines begin
/// or end. Where a tributary ends at a point inside another line, that line is split.
///
/// Symbols  L = lines, P = points.
/// Properties
///   (1) The reaches of a line in their order are the line, without repeated points.
///   (2) No reach has a node between its ends; a node inside the chord of a segment, not at a point, is none.
///   (3) The networks are the connected components of lines that share nodes, numbered by their smallest node in (x, y)
///       order.
/// Threads  Pure functions.

namespace hydrotin {

/// Chains of points as CSR. Line i: point[begin[i] .. begin[i + 1]).
struct RiverLines {
  std::vector<std::size_t> begin{0};
  std::vector<LatticePoint> point;
  std::vector<std::uint32_t> source;  ///< [L] the line of the input that it comes from

  [[nodiscard]] std::size_t size() const { return source.size(); }
  [[nodiscard]] std::span<const LatticePoint> line(std::size_t i) const {
    return {point.data() + begin[i], point.data() + begin[i + 1]};
  }
  void add(std::span<const LatticePoint> chain, std::uint32_t from);
};

/// Consecutive equal points become one; lines of one point go. O(P).
[[nodiscard]] RiverLines without_repeats(const RiverLines& lines);

/// O(P log P). Precondition: no consecutive equal points.
[[nodiscard]] RiverLines split_at_nodes(const RiverLines& lines);

struct LineNetworks {
  std::vector<std::uint32_t> network;  ///< [L]
  std::uint32_t num_networks = 0;
};

/// The networks of lines by the nodes that they share, ends or inner points at which other lines end. O(P log P).
[[nodiscard]] LineNetworks connect_lines(const RiverLines& lines);

/// Turns lines round: their points come in the opposite order. @param is_turned  [L]
[[nodiscard]] RiverLines turned(const RiverLines& lines, std::span<const std::uint8_t> is_turned);

}  // namespace hydrotin
