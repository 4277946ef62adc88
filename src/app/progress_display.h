#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>

#include "hydrotin/progress.h"

namespace hydrotin::app {

/// Shows progress: a bar with rate and time left on a terminal, plain lines at intervals otherwise; and appends every
/// event as a line of JSON to a file.
///
/// Events  {"time": UTC, "event": "phase_begins", "phase", "units", "work"}, {... "unit_done", "phase", "unit", "work",
///         "skipped"}, {... "phase_ends", "phase", "seconds"}, {... "note", "text"}; work is in points.
class ProgressDisplay : public Progress {
 public:
  /// @param out     where people look; nullptr = nowhere
  /// @param events  file to append to, made with its folder at the first event; empty = none
  ProgressDisplay(std::FILE* out, bool is_terminal, std::filesystem::path events, double interval_seconds = 5);
  ~ProgressDisplay() override;
  ProgressDisplay(const ProgressDisplay&) = delete;
  ProgressDisplay& operator=(const ProgressDisplay&) = delete;

  void phase_begins(Phase phase, std::uint64_t units, std::uint64_t work) override;
  void unit_done(Phase phase, std::uint64_t unit, std::uint64_t work, bool skipped) override;
  void phase_ends(Phase phase, double seconds) override;
  void note(std::string_view text) override;

 private:
  using Clock = std::chrono::steady_clock;

  void show(bool at_once);
  void clear_bar();
  void record(const std::string& fields);
  [[nodiscard]] double seconds() const;
  [[nodiscard]] std::string rate_and_rest() const;

  std::FILE* out_;
  bool is_terminal_;
  std::filesystem::path events_path_;
  std::FILE* events_ = nullptr;
  double interval_;
  Phase phase_ = Phase::plan;
  std::uint64_t units_ = 0, work_ = 0;  // of the phase
  std::uint64_t done_units_ = 0, skipped_units_ = 0;
  std::uint64_t done_work_ = 0, skipped_work_ = 0;
  Clock::time_point begun_, shown_;
  bool bar_visible_ = false;
};

/// "0:07", "12:40", "3:05:00".
[[nodiscard]] std::string as_duration(double seconds);

}  // namespace hydrotin::app
