#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/lattice.h"

/// Boxes that follow a curve, eight under one at each level, for finding those that meet a region.

namespace hydrotin {

class BoxTree {
 public:
  explicit BoxTree(std::vector<LatticeBox> boxes) {
    level_.push_back(std::move(boxes));
    while (level_.back().size() > kFan) {
      std::vector<LatticeBox> above((level_.back().size() + kFan - 1) / kFan);
      for (std::size_t i = 0; i < level_.back().size(); ++i) above[i / kFan].extend(level_.back()[i]);
      level_.push_back(std::move(above));
    }
  }

  /// Calls visit(i) for the boxes that `meets` accepts, ascending, until one call returns false. Empty boxes are passed
  /// over. `meets` must accept every box around one that it accepts.
  template <class Meets, class Visit>
  bool for_each(Meets meets, Visit visit) const {
    return descend(level_.size() - 1, 0, level_.back().size(), meets, visit);
  }

 private:
  static constexpr std::size_t kFan = 8;

  template <class Meets, class Visit>
  bool descend(std::size_t level, std::size_t first, std::size_t last, Meets& meets, Visit& visit) const {
    for (std::size_t i = first; i < last; ++i) {
      const LatticeBox& box = level_[level][i];
      if (box.is_empty() || !meets(box)) continue;
      const bool go_on =
          level == 0 ? visit(static_cast<std::uint32_t>(i))
                     : descend(level - 1, kFan * i, std::min(kFan * (i + 1), level_[level - 1].size()), meets, visit);
      if (!go_on) return false;
    }
    return true;
  }

  std::vector<std::vector<LatticeBox>> level_;
};

}  // namespace hydrotin
