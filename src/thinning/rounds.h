#pragma once

#include <cstdint>
#include <vector>

#include "doubt_map.h"
#include "hydrotin/thinning.h"
#include "thin_mesh.h"

/// What the two kinds of rounds share: the mesh, what is in doubt, and what became of the points.

namespace hydrotin::thinning {

struct RoundState {
  ThinMesh& mesh;
  DoubtMap* doubt = nullptr;                ///< nothing: all points are known
  std::int32_t near = 0;                    ///< no local triangle at a point reaches farther
  std::int64_t origin_x = 0, origin_y = 0;  ///< of the grid
  std::vector<PointFate> fate;
  std::vector<std::uint8_t> round, doubtful;
  std::uint32_t rounds = 0, pruning_rounds = 0;

  void mark(std::uint32_t p) {
    doubtful[p] = 1;
    doubt->mark(mesh.at(p));
  }
  /// Whether what lies near a place is in doubt.
  [[nodiscard]] bool is_unclear_around(LatticePoint p) const {
    const auto clamp = [](std::int64_t v) {
      return static_cast<std::int32_t>(std::clamp<std::int64_t>(v, -2147483647, 2147483647));
    };
    return doubt->any({{clamp(std::int64_t{p.x} - near), clamp(std::int64_t{p.y} - near)},
                       {clamp(std::int64_t{p.x} + near), clamp(std::int64_t{p.y} + near)}});
  }
  [[nodiscard]] bool is_unclear(std::uint32_t t) const { return doubt->any(mesh[t].reach); }
};

struct InsertingStages {
  std::uint32_t polite = 0, eager = 0, last = 0;
  PointFate fate = PointFate::inserted;  ///< of points inserted
};

/// Inserts points until all are within the limit, or the rounds are over.
void insert_in_rounds(RoundState& state, const InsertingStages& stages);

/// Removes vertices that are not needed.
void prune_in_rounds(RoundState& state);

}  // namespace hydrotin::thinning
