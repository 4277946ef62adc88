#include "river_measures.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <string_view>

#include "hydrotin/error.h"

namespace hydrotin::app {
namespace {

struct Measure {
  double value = 0;
  std::string_view unit;
};

Measure parse_measure(const std::string& option, const std::string& text, const std::string& wanted) {
  Measure measure;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), measure.value);
  if (error != std::errc{} || !std::isfinite(measure.value) || measure.value < 0) refuse(option, text, wanted);
  measure.unit = std::string_view(stop, static_cast<std::size_t>(text.data() + text.size() - stop));
  return measure;
}

}  // namespace

void refuse(const std::string& option, const std::string& text, const std::string& wanted) {
  throw Error(ErrorKind::config, fmt::format("{}: '{}' is not possible ({})", option, text, wanted));
}

void set_decline(const std::string& option, const std::string& text, RiverConstraints& constraints) {
  const std::string wanted = "write 10%, 1deg or rise over run, not negative";
  const auto [value, unit] = parse_measure(option, text, wanted);
  constraints.decline_measure = DeclineMeasure::slope;
  if (unit == "%") {
    constraints.decline_measure = DeclineMeasure::fraction;
    constraints.decline = value / 100;
  } else if (unit == "deg") {
    if (value >= 90) refuse(option, text, "less than 90deg");
    constraints.decline = std::tan(value * std::acos(-1.0) / 180);
  } else if (unit.empty()) {
    constraints.decline = value;
  } else {
    refuse(option, text, wanted);
  }
}

double parse_slope_limit(const std::string& option, const std::string& text) {
  const std::string wanted = "write 50% of the old slope, or 0.5";
  const auto [value, unit] = parse_measure(option, text, wanted);
  if (unit == "%") return value / 100;
  if (!unit.empty()) refuse(option, text, wanted);
  return value;
}

void set_contiguity(const std::string& option, const std::string& text, RiverConstraints& constraints) {
  if (text.empty()) return;
  constraints.contiguity = Contiguity::exact;
  if (text == "exact") return;
  constraints.contiguity = Contiguity::imaginary_points;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), constraints.imaginary_points);
  if (error != std::errc{} || stop != text.data() + text.size() || constraints.imaginary_points > 1000)
    refuse(option, text, "write a number of imaginary points from 0 to 1000, or exact");
}

void set_variant(const std::string& option, const std::string& text, RiverConstraints& constraints) {
  if (text != "VF" && text != "VFR" && text != "VFRS") refuse(option, text, "allowed: VF, VFR, VFRS");
  if (text == "VF") constraints.decline_measure = DeclineMeasure::none;
  constraints.limit_edge_slope = text == "VFRS";
}

// Slopes in opposite directions are the same: half a turn is divided.
void set_directions(const std::string& option, std::uint32_t number, RiverConstraints& constraints) {
  if (number > 180) refuse(option, std::to_string(number), "at most 180");
  const double half_turn = std::acos(-1.0);
  for (std::uint32_t i = 0; i < number; ++i) constraints.directions.push_back(half_turn * i / number);
}

}  // namespace hydrotin::app
