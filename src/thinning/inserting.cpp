#include <algorithm>

#include "rounds.h"

namespace hydrotin::thinning {
namespace {

enum class Stage : std::uint8_t { polite, eager, last };

constexpr std::uint8_t kListed = 1, kUnclear = 2;  // marks of triangles

class Inserting {
 public:
  Inserting(RoundState& state, const InsertingStages& stages) : state_(state), stages_(stages), mesh_(state.mesh) {
    for (std::uint32_t t = 0; t < mesh_.num_slots(); ++t)
      if (mesh_[t].is_live) list(t);
  }

  void run() {
    const std::uint32_t polite = stages_.polite, eager = polite + stages_.eager;
    for (std::uint32_t round = 1; round <= eager + stages_.last; ++round) {
      const Stage stage = round <= polite ? Stage::polite : round <= eager ? Stage::eager : Stage::last;
      if (state_.doubt != nullptr) find_unclear();
      accept(stage);
      const bool has_spread = state_.doubt != nullptr && state_.doubt->settle();
      if (accepted_.empty() && !has_spread) return;
      insert(round);
    }
  }

 private:
  // Triangles that may have something to accept.
  void list(std::uint32_t t) {
    if ((mesh_[t].mark & kListed) != 0 || !is_active(t)) return;
    mesh_[t].mark |= kListed;
    active_.push_back(t);
  }

  [[nodiscard]] bool is_active(std::uint32_t t) const {
    const Triangle& at = mesh_[t];
    return at.is_live && at.head != kNone && (!at.is_local || at.worst != kNone);
  }

  // Doubt spreads: what a triangle holds is as certain as the points kept inside its circle.
  void find_unclear() {
    for (std::uint32_t t = 0; t < mesh_.num_slots(); ++t) {
      Triangle& at = mesh_[t];
      if (!at.is_live || (at.mark & kUnclear) != 0) continue;
      if (!at.is_local) {
        for (std::uint32_t p = at.head; p != kNone; p = mesh_.next_point(p))
          if (state_.is_unclear_around(mesh_.at(p))) state_.mark(p);
        continue;
      }
      if (!state_.is_unclear(t)) continue;
      at.mark |= kUnclear;
      for (std::uint32_t p = at.head; p != kNone; p = mesh_.next_point(p)) state_.mark(p);
    }
  }

  void accept(Stage stage) {
    accepted_.clear();
    // A number may be listed twice: for a triangle that went and for the one that took it over.
    std::sort(active_.begin(), active_.end());
    active_.erase(std::unique(active_.begin(), active_.end()), active_.end());
    std::size_t kept = 0;
    for (const std::uint32_t t : active_) {
      if (!is_active(t)) {
        mesh_[t].mark &= static_cast<std::uint8_t>(~kListed);
        continue;
      }
      active_[kept++] = t;
      accept_from(t, stage);
    }
    active_.resize(kept);
  }

  void accept_from(std::uint32_t t, Stage stage) {
    const Triangle& at = mesh_[t];
    if (!at.is_local) {
      for (std::uint32_t p = at.head; p != kNone; p = mesh_.next_point(p)) accepted_.push_back(p);
    } else if (stage == Stage::last) {
      for (std::uint32_t p = at.head; p != kNone; p = mesh_.next_point(p))
        if (mesh_.is_beyond(mesh_.distance(at.corner[0], at.corner[1], at.corner[2], p))) accepted_.push_back(p);
    } else if (stage == Stage::eager || is_worst_around(t)) {
      accepted_.push_back(at.worst);
    }
  }

  [[nodiscard]] bool beats(const Triangle& a, const Triangle& b) const {
    return a.error != b.error ? a.error > b.error : mesh_.at(a.worst) < mesh_.at(b.worst);
  }

  bool is_worst_around(std::uint32_t t) {
    const Triangle& at = mesh_[t];
    bool is_beaten = false, is_beaten_for_certain = false, is_in_doubt = false;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t n = at.across[i];
      const bool proposes = n != kNone && mesh_[n].is_local && mesh_[n].worst != kNone;
      const bool loses = proposes && beats(mesh_[n], at);
      is_beaten = is_beaten || loses;
      if (state_.doubt == nullptr) continue;
      const bool is_certain = n != kNone && mesh_[n].is_local
                                  ? (mesh_[n].mark & kUnclear) == 0
                                  : !state_.is_unclear_around(mesh_.at(at.corner[i])) &&
                                        !state_.is_unclear_around(mesh_.at(at.corner[(i + 1) % 3]));
      is_beaten_for_certain = is_beaten_for_certain || (loses && is_certain);
      is_in_doubt = is_in_doubt || !is_certain;
    }
    if (is_in_doubt && !is_beaten_for_certain) state_.mark(at.worst);
    return !is_beaten;
  }

  void insert(std::uint32_t round) {
    if (accepted_.empty()) return;
    state_.rounds = round;
    std::sort(accepted_.begin(), accepted_.end());  // along the curve
    fresh_.clear();
    for (const std::uint32_t p : accepted_) {
      mesh_.insert(p, fresh_);
      state_.fate[p] = stages_.fate;
      state_.round[p] = static_cast<std::uint8_t>(round);
    }
    for (const std::uint32_t t : fresh_)
      if (mesh_[t].is_live) list(t);
  }

  RoundState& state_;
  const InsertingStages& stages_;
  ThinMesh& mesh_;
  std::vector<std::uint32_t> active_, accepted_, fresh_;
};

}  // namespace

void insert_in_rounds(RoundState& state, const InsertingStages& stages) {
  Inserting(state, stages).run();
}

}  // namespace hydrotin::thinning
