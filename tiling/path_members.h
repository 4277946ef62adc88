#pragma once

#include <cstdint>
#include <vector>

#include "hydrotin/lake_bound.h"
#include "hydrotin/lake_breaches.h"
#include "hydrotin/wide.h"
#include "phases.h"
#include "store.h"
#include "surface.h"

/// The members that breaches add, by their points, with the figures of the lakes that were breached:
/// `member_point` u64 [M] ascending, `member_level` i32 [M]; attributes lake_pits, pits_unbreached,
/// pits_unfinished, dearest_breach, bound_high and bound_low (see LakeBound).

namespace hydrotin {

struct PathMembers {
  std::vector<std::pair<std::uint64_t, std::int32_t>> member;  ///< point, the lowest level of the breaches through it
  std::int64_t num_pits = 0, num_unbreached = 0, num_unfinished = 0, dearest = 0;

  Wide bound = 0;  ///< sum of the bounds of the lakes

  void add(const Surface& surface, const LakeBreaches& found, std::int64_t lake_bound);
  void write(store::Writer& out);
  /// After `write`: the tiles whose points are members, for `BreachIndex`: `member_tile` u32 [K] ascending,
  /// `member_tile_begin` u64 [K + 1] offsets into the members.
  void write_tiles(store::Writer& out) const;
};

[[nodiscard]] std::vector<std::pair<std::uint64_t, std::int32_t>> read_path_members(const store::Reader& in);
/// Entries first .. first + count only.
[[nodiscard]] std::vector<std::pair<std::uint64_t, std::int32_t>> read_path_members(const store::Reader& in,
                                                                                    std::uint64_t first,
                                                                                    std::uint64_t count);

[[nodiscard]] Wide read_bound(const store::Reader& in);

/// From `drain`.
[[nodiscard]] OutletHeights lowest_outlets_of(const RunContext& context);

}  // namespace hydrotin
