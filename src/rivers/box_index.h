#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "hydrotin/hilbert.h"
#include "hydrotin/lattice.h"

namespace hydrotin {

/// A packed tree of boxes: items in the order of a space-filling curve, sixteen to a parent. Whatever the boxes are, it
/// holds each once; queries cost O(log n + found) where boxes are not all on top of each other.
class BoxIndex {
 public:
  explicit BoxIndex(std::vector<LatticeBox> boxes) {
    item_.resize(boxes.size());
    std::iota(item_.begin(), item_.end(), 0u);
    std::vector<std::uint64_t> key(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i)
      key[i] =
          hilbert_key({std::midpoint(boxes[i].min.x, boxes[i].max.x), std::midpoint(boxes[i].min.y, boxes[i].max.y)});
    std::sort(item_.begin(), item_.end(),
              [&](std::uint32_t a, std::uint32_t b) { return std::pair(key[a], a) < std::pair(key[b], b); });
    level_.emplace_back();
    for (const std::uint32_t i : item_) level_.back().push_back(boxes[i]);
    while (level_.back().size() > 1) {
      const std::vector<LatticeBox>& below = level_.back();
      std::vector<LatticeBox> parents((below.size() + kFanout - 1) / kFanout);
      for (std::size_t i = 0; i < below.size(); ++i) parents[i / kFanout].extend(below[i]);
      level_.push_back(std::move(parents));
    }
  }

  /// Calls visit(item) for every item whose box meets `box`.
  template <class Visit>
  void query(const LatticeBox& box, Visit&& visit) const {
    if (!item_.empty()) descend(level_.size() - 1, 0, box, visit);
  }

 private:
  static constexpr std::size_t kFanout = 16;

  template <class Visit>
  void descend(std::size_t level, std::size_t at, const LatticeBox& box, Visit&& visit) const {
    if (!level_[level][at].intersects(box)) return;
    if (level == 0) {
      visit(item_[at]);
      return;
    }
    const std::size_t end = std::min((at + 1) * kFanout, level_[level - 1].size());
    for (std::size_t i = at * kFanout; i < end; ++i) descend(level - 1, i, box, visit);
  }

  std::vector<std::uint32_t> item_;
  std::vector<std::vector<LatticeBox>> level_;
};

[[nodiscard]] inline LatticeBox box_around(LatticePoint a, LatticePoint b) {
  LatticeBox box;
  box.extend(a);
  box.extend(b);
  return box;
}

}  // namespace hydrotin
