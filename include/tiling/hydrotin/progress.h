#pragma once

#include <cstdint>
#include <string_view>

#include "hydrotin/phase.h"

/// How the pipeline talks while it works. Calls come from one thread at a time, in any order of units.

namespace hydrotin {

class Progress {
 public:
  virtual ~Progress() = default;
  /// `units` of `phase` are about to be looked at; `work` is their total weight in points.
  virtual void phase_begins(Phase phase, std::uint64_t units, std::uint64_t work) = 0;
  /// A unit is complete; `skipped` when its output of an earlier run was still valid. `work` is its weight in points.
  virtual void unit_done(Phase phase, std::uint64_t unit, std::uint64_t work, bool skipped) = 0;
  virtual void phase_ends(Phase phase, double seconds) = 0;
  /// Something the user should know that stops nothing.
  virtual void note(std::string_view text) = 0;
};

}  // namespace hydrotin
