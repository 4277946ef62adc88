#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "box_tree.h"
#include "hydrotin/convex_hull.h"
#include "hydrotin/id.h"
#include "hydrotin/lattice.h"

/// What all tiles know of each other: boxes, counts, and the convex hull of everything. The vertices of the hull are
/// loaded by every tile: so each knows where the data truly ends.

namespace hydrotin {

struct HullVertex {
  PointId point;
  LatticePoint position;
  std::int32_t height = 0;
};

struct Outline {
  std::vector<std::uint64_t> count;            ///< [tiles] vertices
  std::vector<LatticeBox> box;                 ///< [tiles] tight box of the vertices; empty where there are none
  std::vector<HullVertex> hull;                ///< strictly convex, counter-clockwise, from the smallest by (x, y)
  HullVertex lowest;                           ///< by (z, x, y)
  std::vector<std::uint64_t> reference_count;  ///< [tiles] reference points
  std::vector<LatticeBox> reference_box;       ///< [tiles] tight box of these
  std::uint64_t points = 0;                    ///< kept by the filters
  std::uint64_t vertices = 0;
  std::uint64_t removed = 0;  ///< by thinning
  std::uint64_t duplicates = 0;
  BoxTree tree{{}};            ///< of `box`
  BoxTree reference_tree{{}};  ///< of `reference_box`

  [[nodiscard]] LatticeBox bounds() const {
    LatticeBox all;
    for (const LatticeBox& b : box) all.extend(b);
    return all;
  }
};

[[nodiscard]] Outline load_outline(const std::string& path);

}  // namespace hydrotin
