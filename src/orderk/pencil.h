#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "hydrotin/useful_edges.h"

/// Pencils of circles, in doubles relative to their first point.
///
/// With u as origin, the circle through u, s and p is x.(x - s) = ratio * (x cross s). Right of us (positive cross
/// product) a smaller ratio is hit earlier by circles that slide to the right, left of us later. Numerator and
/// denominator of a ratio of small vectors are exact in double, so that two ratios can be in doubt only if they are
/// next to equal.

namespace hydrotin {

/// Products of coordinates below this bound, and sums of two of them, are exact in double.
inline constexpr double kExactExtent = 1 << 25;
/// Two ratios of small vectors that differ by more than this, relatively, are ordered as computed.
inline constexpr double kRatioError = 2e-15;

struct Vector {
  double x, y;

  [[nodiscard]] double extent() const { return std::max(std::fabs(x), std::fabs(y)); }
};

/// The cross product of vectors of any size; exact for small vectors, else the sign is.
inline double wide_cross(Vector p, Vector q) {
  const double left = p.x * q.y, right = p.y * q.x;
  const double d = left - right;
  // Below 2^52 the products are exact, or the right one is so large that it decides.
  if (std::fabs(left) < 0x1p52 || std::fabs(d) > 1e-15 * (std::fabs(left) + std::fabs(right))) return d;
  __extension__ using Wide = __int128;
  const auto wide = [](double v) { return static_cast<Wide>(v); };
  return static_cast<double>(wide(p.x) * wide(q.y) - wide(p.y) * wide(q.x));
}

inline double ratio(Vector p, Vector s, double p_cross_s) {
  return (p.x * (p.x - s.x) + p.y * (p.y - s.y)) / p_cross_s;
}

/// A point in a pencil.
struct Hit {
  VertexId p;
  double ratio;
};

/// Whether the order of two ratios of small vectors is certain as computed.
inline bool is_certain(const Hit& p, const Hit& q) {
  return std::fabs(p.ratio - q.ratio) > kRatioError * (std::fabs(p.ratio) + std::fabs(q.ratio));
}

/// At most kMaxOrder + 1 hits of one side of an edge.
class HitList {
 public:
  double extent = 0;  ///< of all vectors that the ratios are made of; kept by the owner

  void clear() { size_ = 0; }
  [[nodiscard]] std::uint32_t size() const { return size_; }
  [[nodiscard]] const Hit& operator[](std::uint32_t i) const { return hit_[i]; }
  [[nodiscard]] bool has(VertexId p) const {
    for (std::uint32_t i = 0; i < size_; ++i)
      if (hit_[i].p == p) return true;
    return false;
  }
  void append(const Hit& hit) { hit_[size_++] = hit; }
  /// Keeps a sorted list sorted.
  template <class Before>
  void insert(const Hit& hit, Before before) {
    sink(hit, size_++, before);
  }
  template <class Before>
  void sort(Before before) {
    for (std::uint32_t i = 1; i < size_; ++i) sink(Hit{hit_[i]}, i, before);
  }

 private:
  // Puts a hit into the sorted first `i` ones; the lists are short.
  template <class Before>
  void sink(const Hit& hit, std::uint32_t i, Before before) {
    for (; i > 0 && before(hit, hit_[i - 1]); --i) hit_[i] = hit_[i - 1];
    hit_[i] = hit;
  }

  std::array<Hit, kMaxOrder + 1> hit_;
  std::uint32_t size_ = 0;
};

/// Points next to those inside, in no order; may hold a point twice.
class Frontier {
 public:
  void clear() { size_ = 0; }
  void make_room(std::size_t more) {
    if (p_.size() >= size_ + more) return;
    p_.resize(2 * (size_ + more));
    ratio_.resize(2 * (size_ + more));
  }
  /// Adds a point if `wanted`, without a branch. Precondition: there is room, also for what is not wanted.
  void offer(const Hit& hit, bool wanted) {
    p_[size_] = hit.p;
    ratio_[size_] = hit.ratio;
    size_ += wanted;
  }
  [[nodiscard]] std::uint32_t size() const { return size_; }
  [[nodiscard]] Hit operator[](std::uint32_t i) const { return {p_[i], ratio_[i]}; }

  /// One of the points with the smallest ratio. Precondition: not empty.
  [[nodiscard]] Hit least() const {
    std::uint32_t best = 0;
    double least = ratio_[0];
    for (std::uint32_t i = 1; i < size_; ++i) {
      const bool less = ratio_[i] < least;
      best = less ? i : best;
      least = less ? ratio_[i] : least;
    }
    return {p_[best], least};
  }
  /// Entries of other points whose ratio is at most the given one.
  [[nodiscard]] std::uint32_t count_others(VertexId p, double most) const {
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < size_; ++i) count += (p_[i] != p) & (ratio_[i] <= most);
    return count;
  }
  /// Removes a point as often as it is there.
  void remove(VertexId p) {
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < size_; ++i) {
      const bool keep = p_[i] != p;
      p_[kept] = p_[i];
      ratio_[kept] = ratio_[i];
      kept += keep;
    }
    size_ = kept;
  }

 private:
  std::vector<VertexId> p_;
  std::vector<double> ratio_;
  std::uint32_t size_ = 0;
};

}  // namespace hydrotin
