#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "hydrotin/useful_edges.h"
#include "hydrotin/wide.h"

#ifdef __SSE2__
#include <emmintrin.h>
#endif

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

/// Two numbers at once, in the way of g++ and clang: the ratios of two points cost little more than that of one.
using Pair = double __attribute__((vector_size(16)));

/// Two small vectors.
struct VectorPair {
  Pair x, y;
};

/// The vectors from `origin` to two points. Precondition: they are small.
inline VectorPair vectors_between(LatticePoint origin, LatticePoint p, LatticePoint q) {
#ifdef __SSE2__
  const auto load = [](LatticePoint at) { return _mm_cvtsi64_si128(std::bit_cast<long long>(at)); };
  const __m128i from = load(origin);
  const __m128i both = _mm_sub_epi32(_mm_unpacklo_epi32(load(p), load(q)), _mm_unpacklo_epi32(from, from));
  return {_mm_cvtepi32_pd(both), _mm_cvtepi32_pd(_mm_unpackhi_epi64(both, both))};
#else
  return {Pair{static_cast<double>(p.x - origin.x), static_cast<double>(q.x - origin.x)},
          Pair{static_cast<double>(p.y - origin.y), static_cast<double>(q.y - origin.y)}};
#endif
}

/// The ratios of two points in the pencil of `s`, not yet divided: numerators, and cross products with `s`.
struct FractionPair {
  Pair numerator, cross;

  [[nodiscard]] Pair ratio() const { return numerator / cross; }
};

inline FractionPair fractions(const VectorPair& p, Vector s) {
  return {p.x * (p.x - s.x) + p.y * (p.y - s.y), p.x * s.y - p.y * s.x};
}

/// Bit i: the i-th number is above 0.
inline unsigned positive(Pair d) {
#ifdef __SSE2__
  return static_cast<unsigned>(_mm_movemask_pd(_mm_cmpgt_pd(d, _mm_setzero_pd())));
#else
  return (d[0] > 0 ? 1U : 0U) | (d[1] > 0 ? 2U : 0U);
#endif
}

/// Bit i: the i-th point is on the left, and its ratio is at least `least`; ratios next to it may be missed or taken.
inline unsigned left_and_least(const FractionPair& f, double least) {
#ifdef __SSE2__
  const __m128d bound = _mm_mul_pd(f.cross, _mm_set1_pd(least));
  return static_cast<unsigned>(
      _mm_movemask_pd(_mm_and_pd(_mm_cmplt_pd(f.cross, _mm_setzero_pd()), _mm_cmple_pd(f.numerator, bound))));
#else
  return (f.cross[0] < 0 && f.numerator[0] <= f.cross[0] * least ? 1U : 0U) |
         (f.cross[1] < 0 && f.numerator[1] <= f.cross[1] * least ? 2U : 0U);
#endif
}

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

/// A set of vertices that is emptied in constant time.
class Marks {
 public:
  explicit Marks(std::uint32_t num_vertices) : stamp_(num_vertices) {}

  void clear() {
    if (++now_ != 0) return;
    std::fill(stamp_.begin(), stamp_.end(), 0U);
    now_ = 1;
  }
  void add(VertexId p) { stamp_[p.value] = now_; }
  [[nodiscard]] bool has(VertexId p) const { return stamp_[p.value] == now_; }

 private:
  std::vector<std::uint32_t> stamp_;  // [n] equal to `now_`: is in the set
  std::uint32_t now_ = 1;
};

/// Points next to those inside a pencil's circle, in no order, each once.
class Frontier {
 public:
  explicit Frontier(std::uint32_t num_vertices) : stamp_(num_vertices) {}

  /// Forgets all points.
  void clear() {
    size_ = 0;
    if (++now_ != 0) return;
    std::fill(stamp_.begin(), stamp_.end(), 0U);
    now_ = 1;
  }
  /// Keeps a point from being added.
  void bar(VertexId p) { stamp_[p.value] = now_; }
  void make_room(std::size_t more) {
    if (p_.size() < size_ + more) grow(size_ + more);
  }
  /// Adds points for as long as it lives; keeps where it stands in a register.
  class Filler {
   public:
    explicit Filler(Frontier& to)
        : to_(to),
          p_(to.p_.data()),
          ratio_(to.ratio_.data()),
          stamp_(to.stamp_.data()),
          size_(to.size_),
          now_(to.now_) {}
    ~Filler() { to_.size_ = size_; }
    Filler(const Filler&) = delete;
    Filler& operator=(const Filler&) = delete;
    /// Adds a point if `wanted` is 1, not if it is 0 or if it was offered before, without a branch. Precondition: there
    /// is room, also for what is not wanted.
    void offer(VertexId p, double ratio, std::uint32_t wanted) {
      p_[size_] = p;
      ratio_[size_] = ratio;
      size_ += wanted & static_cast<std::uint32_t>(stamp_[p.value] != now_);
      stamp_[p.value] = now_;
    }

   private:
    Frontier& to_;
    VertexId* p_;
    double* ratio_;
    std::uint32_t* stamp_;
    std::uint32_t size_, now_;
  };
  [[nodiscard]] std::uint32_t size() const { return size_; }
  [[nodiscard]] Hit operator[](std::uint32_t i) const { return {p_[i], ratio_[i]}; }

  struct Least {
    std::uint32_t index;
    double ratio, following;  ///< the smallest ratio and the next one
  };
  /// The point with the smallest ratio. Precondition: not empty.
  [[nodiscard]] Least least() const {
    const double* ratio = ratio_.data();
    const std::uint32_t size = size_;
    Least out{0, ratio[0], std::numeric_limits<double>::infinity()};
    for (std::uint32_t i = 1; i < size; ++i) {
      const double r = ratio[i];
      out.index = r < out.ratio ? i : out.index;
      const double more = r > out.ratio ? r : out.ratio;
      out.following = more < out.following ? more : out.following;
      out.ratio = r < out.ratio ? r : out.ratio;
    }
    return out;
  }
  void remove(std::uint32_t i) {
    --size_;
    p_[i] = p_[size_];
    ratio_[i] = ratio_[size_];
  }

 private:
  void grow(std::size_t least) {
    p_.resize(2 * least);
    ratio_.resize(2 * least);
  }

  std::vector<VertexId> p_;
  std::vector<double> ratio_;
  std::vector<std::uint32_t> stamp_;  // [n] equal to `now_`: was offered or barred
  std::uint32_t size_ = 0, now_ = 0;
};

}  // namespace hydrotin
