#include "hydrotin/csv_points.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <string_view>

#include "hydrotin/error.h"
#include "text_scan.h"

namespace hydrotin {
namespace {

constexpr int kMaxExponent = 400;  // beyond every finite double

struct Place {
  const std::filesystem::path& path;
  std::size_t line = 0, column = 0;
};

[[noreturn]] void fail(const Place& place, const std::string& what) {
  throw Error(ErrorKind::input, place.path.string() + ":" + std::to_string(place.line) + ":" +
                                    std::to_string(place.column) + ": " + what);
}

/// One field cut off a line, with the column (from 1) where it begins.
struct Field {
  std::string_view text;
  std::size_t column = 0;
};

/// Cuts the next comma-separated field off `line`; false when there is none left.
bool next_field(std::string_view line, std::size_t& at, Field& field) {
  if (at > line.size()) return false;
  const std::size_t comma = std::min(line.find(',', at), line.size());
  std::string_view text = line.substr(at, comma - at);
  const std::size_t blanks = std::min(text.find_first_not_of(" \t"), text.size());
  field = {trimmed(text), at + blanks + 1};
  if (field.text.size() >= 2 && field.text.front() == '"' && field.text.back() == '"') {
    field.text = trimmed(field.text.substr(1, field.text.size() - 2));
    ++field.column;
  }
  at = comma + 1;
  return true;
}

/// Number of decimals that a number's text uses: those after the point without trailing zeros, less the exponent.
int decimals_of(std::string_view text) {
  const std::size_t e = text.find_first_of("eE");
  const std::string_view mantissa = text.substr(0, e);
  const auto point = static_cast<long long>(std::min(mantissa.find('.'), mantissa.size()));
  long long exponent = 0;
  if (e != std::string_view::npos) {
    std::string_view digits = text.substr(e + 1);
    if (!digits.empty() && digits.front() == '+') digits.remove_prefix(1);
    exponent = std::clamp<long long>(parse_integer(digits).value_or(0), -kMaxExponent, kMaxExponent);
  }
  const std::size_t last_digit = mantissa.find_last_not_of("0.");
  if (last_digit == std::string_view::npos) return 0;  // zero
  const auto last = static_cast<long long>(last_digit);
  const long long after = last < point ? last - (point - 1) : last - point;
  return static_cast<int>(std::max(0LL, after - exponent));
}

/// Column of x, y and z in the header.
std::array<std::size_t, 3> read_header(const Place& place, std::string_view line) {
  constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::array<std::size_t, 3> where{kNone, kNone, kNone};
  Field field;
  for (std::size_t at = 0, i = 0; next_field(line, at, field); ++i) {
    if (field.text.size() != 1) continue;
    const auto axis = static_cast<std::size_t>(std::tolower(static_cast<unsigned char>(field.text[0])) - 'x');
    if (axis > 2) continue;
    if (where[axis] != kNone)
      fail({place.path, place.line, field.column}, "the header names " + in_quotes(field.text) + " twice");
    where[axis] = i;
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (where[axis] == kNone)
      fail(place, std::string("the header names no column ") + "xyz"[axis] + " (the first line must be x,y,z)");
  return where;
}

}  // namespace

CsvPoints read_csv_points(const std::filesystem::path& path) {
  const std::string text = read_whole_file(path);
  std::string_view content = text;
  if (content.starts_with("\xEF\xBB\xBF")) content.remove_prefix(3);  // byte order mark
  LineScanner lines(content);
  const auto header = lines.next();
  if (!header) fail({path, 1, 1}, "is empty (the first line must be x,y,z)");
  const auto where = read_header({path, 1, 1}, *header);

  CsvPoints points;
  std::array<std::vector<double>*, 3> axes{&points.x, &points.y, &points.z};
  while (const auto line = lines.next()) {
    if (trimmed(*line).empty()) continue;
    std::array<bool, 3> seen{};
    Field field;
    for (std::size_t at = 0, i = 0; next_field(*line, at, field); ++i)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (where[axis] != i) continue;
        const auto value = parse_real(field.text);
        if (!value) fail({path, lines.line_number(), field.column}, in_quotes(field.text) + " is not a finite number");
        axes[axis]->push_back(*value);
        int& decimals = axis == 2 ? points.decimals_z : points.decimals_xy;
        decimals = std::max(decimals, decimals_of(field.text));
        seen[axis] = true;
      }
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (!seen[axis])
        fail({path, lines.line_number(), line->size() + 1}, std::string("the line ends before its ") + "xyz"[axis]);
  }
  return points;
}

}  // namespace hydrotin
