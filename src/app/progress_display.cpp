#include "progress_display.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "hydrotin/error.h"

namespace hydrotin::app {
namespace {

constexpr int kBarWidth = 20;
constexpr double kBarInterval = 0.1;

std::string quoted(std::string_view text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace

std::string as_duration(double seconds) {
  if (!(seconds >= 0) || seconds > 1e7) return "?";
  const auto whole = static_cast<long>(std::ceil(seconds));
  if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
  return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

ProgressDisplay::ProgressDisplay(std::FILE* out, bool is_terminal, std::filesystem::path events,
                                 double interval_seconds)
    : out_(out),
      is_terminal_(is_terminal),
      events_path_(std::move(events)),
      interval_(is_terminal ? kBarInterval : interval_seconds),
      begun_(Clock::now()),
      shown_(begun_) {}

ProgressDisplay::~ProgressDisplay() {
  clear_bar();
  if (events_ != nullptr) std::fclose(events_);
}

double ProgressDisplay::seconds() const {
  return std::chrono::duration<double>(Clock::now() - begun_).count();
}

void ProgressDisplay::record(const std::string& fields) {
  if (events_path_.empty()) return;
  if (events_ == nullptr) {
    std::error_code ignored;  // the next line says what is wrong
    std::filesystem::create_directories(events_path_.parent_path(), ignored);
    events_ = std::fopen(events_path_.c_str(), "ae");
    if (events_ == nullptr)
      throw Error(ErrorKind::storage, events_path_.string() + ": cannot be written: " + std::strerror(errno) +
                                          " (choose another output.dir or run.scratch)");
  }
  const auto now = std::chrono::floor<std::chrono::milliseconds>(std::chrono::system_clock::now());
  const auto milliseconds = now.time_since_epoch().count() % 1000;
  const std::string line = fmt::format("{{\"time\":\"{:%Y-%m-%dT%H:%M:%S}.{:03}Z\",{}}}\n",
                                       fmt::gmtime(std::chrono::system_clock::to_time_t(now)), milliseconds, fields);
  // One write per line: the tasks of a job array may share the file.
  if (std::fwrite(line.data(), 1, line.size(), events_) != line.size() || std::fflush(events_) != 0)
    throw Error(ErrorKind::storage, events_path_.string() + ": cannot be written: " + std::strerror(errno));
}

void ProgressDisplay::phase_begins(Phase phase, std::uint64_t units, std::uint64_t work) {
  phase_ = phase;
  units_ = units;
  work_ = work;
  done_units_ = skipped_units_ = done_work_ = skipped_work_ = 0;
  begun_ = shown_ = Clock::now();
  record(fmt::format("\"event\":\"phase_begins\",\"phase\":\"{}\",\"units\":{},\"work\":{}", name(phase), units, work));
  if (is_terminal_) show(true);
}

void ProgressDisplay::unit_done(Phase phase, std::uint64_t unit, std::uint64_t work, bool skipped) {
  ++done_units_;
  done_work_ += work;
  if (skipped) {
    ++skipped_units_;
    skipped_work_ += work;
  }
  record(fmt::format("\"event\":\"unit_done\",\"phase\":\"{}\",\"unit\":{},\"work\":{},\"skipped\":{}", name(phase),
                     unit, work, skipped));
  show(false);
}

void ProgressDisplay::phase_ends(Phase phase, double seconds) {
  record(fmt::format("\"event\":\"phase_ends\",\"phase\":\"{}\",\"seconds\":{:.3f}", name(phase), seconds));
  clear_bar();
  if (out_ == nullptr) return;
  const std::string skipped = skipped_units_ > 0 ? fmt::format(", {} of them from before", skipped_units_) : "";
  const double fresh = static_cast<double>(done_work_ - skipped_work_);
  const std::string rate = fresh > 0 && seconds > 0 ? fmt::format(", {:.2f} M points/s", fresh / seconds * 1e-6) : "";
  fmt::print(out_, "{:<12} {} unit{}{} in {:.1f} s{}\n", name(phase), done_units_, done_units_ == 1 ? "" : "s", skipped,
             seconds, rate);
  std::fflush(out_);
}

void ProgressDisplay::note(std::string_view text) {
  record(fmt::format("\"event\":\"note\",\"text\":{}", quoted(text)));
  clear_bar();
  if (out_ == nullptr) return;
  fmt::print(out_, "note: {}\n", text);
  std::fflush(out_);
}

std::string ProgressDisplay::rate_and_rest() const {
  const double elapsed = seconds();
  const double fresh = static_cast<double>(done_work_ - skipped_work_);
  if (fresh <= 0 || elapsed < 0.5) return "";
  const double left = static_cast<double>(work_ > done_work_ ? work_ - done_work_ : 0);
  return fmt::format("  {:.2f} M points/s  ETA {}", fresh / elapsed * 1e-6, as_duration(left * elapsed / fresh));
}

void ProgressDisplay::show(bool at_once) {
  if (out_ == nullptr) return;
  const auto now = Clock::now();
  if (!at_once && std::chrono::duration<double>(now - shown_).count() < interval_) return;
  shown_ = now;
  const std::string units = fmt::format("{}/{} units{}", done_units_, units_, rate_and_rest());
  if (!is_terminal_) {
    fmt::print(out_, "{:<12} {}\n", name(phase_), units);
  } else {
    const double share = work_ > 0    ? static_cast<double>(done_work_) / static_cast<double>(work_)
                         : units_ > 0 ? static_cast<double>(done_units_) / static_cast<double>(units_)
                                      : 0;
    const int filled = std::clamp(static_cast<int>(share * kBarWidth), 0, kBarWidth);
    fmt::print(out_, "\r\033[K{:<12} [{:#<{}}{:.<{}}] {}", name(phase_), "", filled, "", kBarWidth - filled, units);
    bar_visible_ = true;
  }
  std::fflush(out_);
}

void ProgressDisplay::clear_bar() {
  if (!bar_visible_ || out_ == nullptr) return;
  fmt::print(out_, "\r\033[K");
  std::fflush(out_);
  bar_visible_ = false;
}

}  // namespace hydrotin::app
