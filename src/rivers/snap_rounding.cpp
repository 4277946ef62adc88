#include "hydrotin/snap_rounding.h"

#include <algorithm>

#include "box_index.h"
#include "exact_ratio.h"
#include "hydrotin/predicates.h"

namespace hydrotin {
namespace {

struct Segment {
  LatticePoint from, to;
};

// Shares of a segment where it is in half-open strips; empty intervals are recognised exactly.
class Interval {
 public:
  // Keeps shares with from + share * step >= low and < high (all doubled coordinates).
  void cut(std::int64_t from, std::int64_t step, std::int64_t low, std::int64_t high) {
    if (step == 0) {
      if (from < low || from >= high) is_empty_ = true;
      return;
    }
    const Ratio at_low = step > 0 ? Ratio{low - from, step} : Ratio{from - low, -step};
    const Ratio at_high = step > 0 ? Ratio{high - from, step} : Ratio{from - high, -step};
    if (step > 0) {
      raise(at_low, true);
      lower(at_high, false);
    } else {
      raise(at_high, false);
      lower(at_low, true);
    }
  }
  [[nodiscard]] bool is_empty() const {
    if (is_empty_) return true;
    const int order = compare(first_, last_);
    return order > 0 || (order == 0 && !(has_first_ && has_last_));
  }

 private:
  void raise(const Ratio& share, bool is_closed) {
    const int order = compare(share, first_);
    if (order > 0) has_first_ = is_closed;
    if (order == 0) has_first_ = has_first_ && is_closed;
    if (order > 0) first_ = share;
  }
  void lower(const Ratio& share, bool is_closed) {
    const int order = compare(share, last_);
    if (order < 0) has_last_ = is_closed;
    if (order == 0) has_last_ = has_last_ && is_closed;
    if (order < 0) last_ = share;
  }

  Ratio first_{0, 1}, last_{1, 1};
  bool has_first_ = true, has_last_ = true, is_empty_ = false;
};

bool meets_square(const Segment& s, LatticePoint middle) {
  Interval shares;
  const auto twice = [](std::int32_t a) { return 2 * std::int64_t{a}; };
  shares.cut(twice(s.from.x), twice(s.to.x) - twice(s.from.x), twice(middle.x) - 1, twice(middle.x) + 1);
  shares.cut(twice(s.from.y), twice(s.to.y) - twice(s.from.y), twice(middle.y) - 1, twice(middle.y) + 1);
  return !shares.is_empty();
}

LatticeBox widened(const Segment& s) {
  LatticeBox box = box_around(s.from, s.to);
  box.min = {box.min.x - 1, box.min.y - 1};
  box.max = {box.max.x + 1, box.max.y + 1};
  return box;
}

std::vector<Segment> segments_of(const RiverLines& lines) {
  std::vector<Segment> segments;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto line = lines.line(i);
    for (std::size_t k = 1; k < line.size(); ++k) segments.push_back({line[k - 1], line[k]});
  }
  return segments;
}

void add_crossings(const std::vector<Segment>& segments, std::vector<LatticePoint>& hot, RoundedLines& result) {
  std::vector<LatticeBox> boxes;
  for (const Segment& s : segments) boxes.push_back(box_around(s.from, s.to));
  const BoxIndex index(boxes);
  for (std::uint32_t i = 0; i < segments.size(); ++i)
    index.query(boxes[i], [&](std::uint32_t j) {
      if (j <= i) return;
      Segment a = segments[i], b = segments[j];
      if (!properly_cross(a.from, a.to, b.from, b.to)) return;
      ++result.num_crossings;
      // The same point whichever way the segments run, and whichever comes first.
      if (a.to < a.from) std::swap(a.from, a.to);
      if (b.to < b.from) std::swap(b.from, b.to);
      if (std::pair(b.from, b.to) < std::pair(a.from, a.to)) std::swap(a, b);
      hot.push_back(point_at(a.from, a.to, crossing_share(b.from, b.to, a.from, a.to)));
    });
}

}  // namespace

RoundedLines snap_round(const RiverLines& lines, std::span<const LatticePoint> extra) {
  RoundedLines result;
  const std::vector<Segment> segments = segments_of(lines);
  std::vector<LatticePoint> hot(extra.begin(), extra.end());
  for (const Segment& s : segments) {
    hot.push_back(s.from);
    hot.push_back(s.to);
  }
  add_crossings(segments, hot, result);
  std::sort(hot.begin(), hot.end());
  hot.erase(std::unique(hot.begin(), hot.end()), hot.end());
  std::vector<LatticeBox> boxes;
  for (const LatticePoint p : hot) boxes.push_back(box_around(p, p));
  const BoxIndex index(std::move(boxes));
  std::vector<LatticePoint> chain, inner;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto line = lines.line(i);
    chain.assign(1, line[0]);
    for (std::size_t k = 1; k < line.size(); ++k) {
      const Segment s{line[k - 1], line[k]};
      inner.clear();
      index.query(widened(s), [&](std::uint32_t h) {
        if (hot[h] != s.from && hot[h] != s.to && meets_square(s, hot[h])) inner.push_back(hot[h]);
      });
      // A segment runs steadily in x and in y, so the squares do so too.
      const int east = s.to.x >= s.from.x ? 1 : -1, north = s.to.y >= s.from.y ? 1 : -1;
      std::sort(inner.begin(), inner.end(), [&](LatticePoint a, LatticePoint b) {
        const std::int64_t ax = std::int64_t{a.x} * east, bx = std::int64_t{b.x} * east;
        return ax != bx ? ax < bx : std::int64_t{a.y} * north < std::int64_t{b.y} * north;
      });
      result.num_bent += inner.size();
      chain.insert(chain.end(), inner.begin(), inner.end());
      chain.push_back(s.to);
    }
    chain.erase(std::unique(chain.begin(), chain.end()), chain.end());
    if (chain.size() > 1) result.lines.add(chain, lines.source[i]);
  }
  return result;
}

}  // namespace hydrotin
