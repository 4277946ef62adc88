#include <algorithm>
#include <array>

#include "rounds.h"

namespace hydrotin::thinning {
namespace {

constexpr std::size_t kMostNeighbors = 64;

// Spreads places evenly, so that ties on flat ground do not make long queues.
std::uint64_t scattered(std::int64_t x, std::int64_t y) {
  std::uint64_t h = static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15ULL + static_cast<std::uint64_t>(y);
  h = (h ^ (h >> 33)) * 0xff51afd7ed558ccdULL;
  h = (h ^ (h >> 33)) * 0xc4ceb9fe1a85ec53ULL;
  return h ^ (h >> 33);
}

class Pruning {
 public:
  explicit Pruning(RoundState& state)
      : state_(state), mesh_(state.mesh), may_go_(state.fate.size(), kUnknown), error_(state.fate.size(), 0) {
    for (std::uint32_t v = 0; v < state.fate.size(); ++v)
      if (is_kept(state.fate[v])) vertices_.push_back(v);
  }

  void run() {
    for (std::uint32_t round = 1; round <= kPruningRounds; ++round) {
      for (const std::uint32_t v : vertices_)
        if (may_go_[v] == kUnknown) judge(v);
      const std::vector<std::uint32_t> chosen = choose();
      const bool has_spread = state_.doubt != nullptr && state_.doubt->settle();
      if (chosen.empty() && !has_spread) return;
      if (!chosen.empty()) state_.pruning_rounds = round;
      for (const std::uint32_t v : chosen) remove(v);
      std::erase_if(vertices_, [&](std::uint32_t v) { return !is_kept(state_.fate[v]); });
    }
  }

 private:
  static constexpr std::uint8_t kUnknown = 0, kNo = 1, kYes = 2;

  [[nodiscard]] bool is_local_star() const {
    return std::all_of(triangles_.begin(), triangles_.end(), [&](std::uint32_t t) { return mesh_[t].is_local; });
  }

  void judge(std::uint32_t v) {
    may_go_[v] = kNo;
    if (!mesh_.star(v, triangles_, link_) || link_.size() > kMostNeighbors || !is_local_star()) return;
    if (!mesh_.fill_hole(link_, fill_)) return;
    error_[v] = mesh_.error_without(v, triangles_, link_, fill_);
    if (error_[v] >= 0) may_go_[v] = kYes;
  }

  [[nodiscard]] std::uint64_t number_of(LatticePoint p) const {
    return scattered(p.x - state_.origin_x, p.y - state_.origin_y);
  }

  [[nodiscard]] bool goes_first(std::uint32_t v, std::uint32_t w) const {
    if (error_[v] != error_[w]) return error_[v] < error_[w];
    const std::uint64_t a = number_of(mesh_.at(v)), b = number_of(mesh_.at(w));
    return a != b ? a < b : mesh_.at(v) < mesh_.at(w);
  }

  // Vertices that go: no neighbour that may go comes before them.
  std::vector<std::uint32_t> choose() {
    if (state_.doubt != nullptr) find_unclear();
    std::vector<std::uint32_t> out;
    for (const std::uint32_t v : vertices_) {
      if (may_go_[v] != kYes) continue;
      (void)mesh_.star(v, triangles_, link_);
      bool waits = false, waits_for_certain = false, is_in_doubt = false;
      for (const std::uint32_t w : link_) {
        const bool is_after = may_go_[w] == kYes && goes_first(w, v);
        const bool is_certain = state_.doubt == nullptr || unclear_[w] == 0;
        waits = waits || is_after;
        waits_for_certain = waits_for_certain || (is_after && is_certain);
        is_in_doubt = is_in_doubt || !is_certain;
      }
      if (is_in_doubt && !waits_for_certain) state_.mark(v);
      if (!waits) out.push_back(v);
    }
    return out;
  }

  // A vertex is judged as with all points known if its star is; other vertices are in doubt from now on.
  void find_unclear() {
    unclear_.resize(state_.fate.size());
    for (const std::uint32_t v : vertices_) {
      const bool is_whole = mesh_.star(v, triangles_, link_);
      bool is_unclear = false;
      if (is_whole && is_local_star())
        is_unclear =
            std::any_of(triangles_.begin(), triangles_.end(), [&](std::uint32_t t) { return state_.is_unclear(t); });
      else
        is_unclear = state_.is_unclear_around(mesh_.at(v));
      unclear_[v] = is_unclear;
      if (is_unclear) state_.mark(v);
    }
  }

  void remove(std::uint32_t v) {
    fresh_.clear();
    (void)mesh_.star(v, triangles_, link_);
    (void)mesh_.fill_hole(link_, fill_);
    mesh_.remove(v, triangles_, link_, fill_, fresh_);
    state_.fate[v] = PointFate::pruned;
    for (const std::uint32_t w : link_) may_go_[w] = kUnknown;
  }

  RoundState& state_;
  ThinMesh& mesh_;
  std::vector<std::uint32_t> vertices_;
  std::vector<std::uint8_t> may_go_, unclear_;  // [n]
  std::vector<double> error_;                   // [n] of the worst point if the vertex went
  std::vector<std::uint32_t> triangles_, link_, fresh_;
  std::vector<std::array<std::uint32_t, 3>> fill_;
};

}  // namespace

void prune_in_rounds(RoundState& state) {
  Pruning(state).run();
}

}  // namespace hydrotin::thinning
