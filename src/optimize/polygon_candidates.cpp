#include "polygon_candidates.h"

#include <algorithm>
#include <numeric>

#include "hydrotin/hilbert.h"
#include "hydrotin/predicates.h"
#include "hydrotin/triangulation.h"

namespace hydrotin {
namespace {

constexpr std::uint32_t kNone = static_cast<std::uint32_t>(-1);

// Edges that must be there, to ask whether a segment crosses one: buckets of equal width in x.
class RimIndex {
 public:
  explicit RimIndex(const SoundPolygon& polygon) : position_(polygon.given.position), rim_(polygon.rim) {
    LatticeBox box;
    for (const LatticePoint p : position_) box.extend(p);
    min_x_ = box.min.x;
    const std::size_t buckets = std::clamp<std::size_t>(rim_.size(), 1, 1024);
    width_ = (std::int64_t{box.max.x} - box.min.x) / static_cast<std::int64_t>(buckets) + 1;
    begin_.assign(buckets + 1, 0);
    for (const auto& e : rim_)
      for (std::size_t b = first(e); b <= last(e); ++b) ++begin_[b + 1];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    edge_.resize(begin_.back());
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    for (std::uint32_t i = 0; i < rim_.size(); ++i)
      for (std::size_t b = first(rim_[i]); b <= last(rim_[i]); ++b) edge_[next[b]++] = i;
  }

  [[nodiscard]] bool crosses(std::uint32_t u, std::uint32_t v) const {
    const std::array<std::uint32_t, 2> segment{u, v};
    for (std::size_t b = first(segment); b <= last(segment); ++b)
      for (std::uint32_t i = begin_[b]; i < begin_[b + 1]; ++i) {
        const auto& [a, c] = rim_[edge_[i]];
        if (properly_cross(position_[u], position_[v], position_[a], position_[c])) return true;
      }
    return false;
  }

 private:
  [[nodiscard]] std::size_t bucket(std::int32_t x) const {
    return static_cast<std::size_t>((std::int64_t{x} - min_x_) / width_);
  }
  [[nodiscard]] std::size_t first(const std::array<std::uint32_t, 2>& e) const {
    return bucket(std::min(position_[e[0]].x, position_[e[1]].x));
  }
  [[nodiscard]] std::size_t last(const std::array<std::uint32_t, 2>& e) const {
    return bucket(std::max(position_[e[0]].x, position_[e[1]].x));
  }

  std::span<const LatticePoint> position_;
  std::span<const std::array<std::uint32_t, 2>> rim_;
  std::int32_t min_x_ = 0;
  std::int64_t width_ = 1;
  std::vector<std::uint32_t> begin_, edge_;
};

class CandidateSearch {
 public:
  CandidateSearch(const SoundPolygon& polygon, std::uint32_t k)
      : polygon_(polygon), position_(polygon.given.position), k_(k), rim_(polygon) {
    sort_points();
    number_ring();
  }

  CandidateTriangles run() {
    for (std::uint32_t v = 0; v < position_.size(); ++v) find_at(v);
    std::vector<std::uint32_t> order(found_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t i, std::uint32_t j) { return found_order_[i] < found_order_[j]; });
    CandidateTriangles out;
    for (const std::uint32_t i : order) {
      out.triangle.push_back(found_[i]);
      out.order.push_back(found_order_[i]);
    }
    return out;
  }

 private:
  void sort_points() {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> keyed;
    for (std::uint32_t v = 0; v < position_.size(); ++v) keyed.emplace_back(hilbert_key(position_[v]), v);
    std::sort(keyed.begin(), keyed.end());
    std::vector<LatticePoint> sorted;
    number_.resize(keyed.size());
    for (const auto& [key, v] : keyed) {
      number_[v] = static_cast<std::uint32_t>(sorted.size());
      given_.push_back(v);
      sorted.push_back(position_[v]);
    }
    delaunay_ = delaunay(sorted);
    links_ = vertex_links(delaunay_.view());
    seen_.assign(position_.size(), kNone);
  }

  void number_ring() {
    ring_at_.assign(position_.size(), kNone);
    for (std::uint32_t i = 0; i < polygon_.ring.size(); ++i) ring_at_[polygon_.ring[i]] = i;
  }

  // All points within k + 2 Delaunay edges: circles of order at most k through v hold no other.
  void gather(std::uint32_t v) {
    near_.assign(1, v);
    seen_[v] = v;
    std::size_t begin = 0;
    for (std::uint32_t hop = 0; hop < k_ + 2 && begin < near_.size(); ++hop) {
      const std::size_t end = near_.size();
      for (; begin < end; ++begin)
        for (const VertexId w : links_.of(VertexId{number_[near_[begin]]}))
          if (const std::uint32_t given = given_[w.value]; seen_[given] != v) {
            seen_[given] = v;
            near_.push_back(given);
          }
    }
  }

  // Triangles whose smallest corner is v.
  void find_at(std::uint32_t v) {
    gather(v);
    ends_.clear();
    for (const std::uint32_t w : near_)
      if (position_[v] < position_[w] && !rim_.crosses(v, w)) ends_.push_back(w);
    for (std::size_t i = 0; i < ends_.size(); ++i)
      for (std::size_t j = i + 1; j < ends_.size(); ++j) {
        const int turn = orientation(position_[v], position_[ends_[i]], position_[ends_[j]]);
        if (turn == 0) continue;
        const std::array<std::uint32_t, 3> t =
            turn > 0 ? std::array{v, ends_[i], ends_[j]} : std::array{v, ends_[j], ends_[i]};
        const std::uint32_t order = order_of(t);
        if (order > k_ || rim_.crosses(t[1], t[2]) || !is_inside(t)) continue;
        found_.push_back(t);
        found_order_.push_back(order);
      }
  }

  // Points in the circumcircle; more than k if the triangle is not empty.
  [[nodiscard]] std::uint32_t order_of(const std::array<std::uint32_t, 3>& t) const {
    const LatticePoint a = position_[t[0]], b = position_[t[1]], c = position_[t[2]];
    std::uint32_t order = 0;
    for (const std::uint32_t w : near_) {
      if (w == t[0] || w == t[1] || w == t[2]) continue;
      const LatticePoint p = position_[w];
      if (!in_circle(a, b, c, p)) continue;
      if (++order > k_) return order;
      if (orientation(a, b, p) >= 0 && orientation(b, c, p) >= 0 && orientation(c, a, p) >= 0) return k_ + 1;
    }
    return order;
  }

  // No side cuts the triangle, so that one corner tells on which side of the boundary it lies.
  [[nodiscard]] bool is_inside(const std::array<std::uint32_t, 3>& t) const {
    for (std::size_t i = 0; i < 3; ++i)
      if (ring_at_[t[i]] == kNone) return true;
    const auto m = static_cast<std::uint32_t>(polygon_.ring.size());
    const std::uint32_t i = ring_at_[t[0]], next = polygon_.ring[(i + 1) % m],
                        previous = polygon_.ring[(i + m - 1) % m];
    if (t[1] == next) return true;
    const LatticePoint a = position_[t[0]], first = position_[next], last = position_[previous], b = position_[t[1]];
    if (orientation(last, a, first) > 0) return orientation(a, first, b) > 0 && orientation(a, b, last) > 0;
    return !(orientation(a, last, b) >= 0 && orientation(a, b, first) >= 0);
  }

  const SoundPolygon& polygon_;
  std::span<const LatticePoint> position_;
  std::uint32_t k_;
  RimIndex rim_;
  Triangulation delaunay_;
  VertexLinks links_;
  std::vector<std::uint32_t> number_, given_, ring_at_, seen_;
  std::vector<std::uint32_t> near_, ends_;
  std::vector<std::array<std::uint32_t, 3>> found_;
  std::vector<std::uint32_t> found_order_;
};

}  // namespace

CandidateTriangles candidate_triangles(const SoundPolygon& polygon, std::uint32_t k) {
  return CandidateSearch(polygon, k).run();
}

}  // namespace hydrotin
