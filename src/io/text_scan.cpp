#include "text_scan.h"

#include <cpl_vsi.h>

#include <charconv>
#include <cmath>
#include <memory>

#include "gdal_calls.h"

namespace hydrotin {

std::string read_whole_file(const std::filesystem::path& path, std::size_t max_bytes) {
  const gdal::MessageTrap trap;
  VSIStatBufL status;
  if (VSIStatL(path.c_str(), &status) != 0) trap.fail(ErrorKind::input, path, "no such file");
  if (VSI_ISDIR(status.st_mode)) trap.fail(ErrorKind::input, path, "is a folder, not a file");
  const std::unique_ptr<VSILFILE, decltype(&VSIFCloseL)> file(VSIFOpenL(path.c_str(), "rb"), VSIFCloseL);
  if (!file) trap.fail(ErrorKind::input, path, "cannot be opened", "check its permissions");
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size > max_bytes)
    trap.fail(ErrorKind::input, path, "has " + std::to_string(size) + " bytes, too many to be read as a whole");
  std::string text(size, '\0');
  if (size > 0 && VSIFReadL(text.data(), 1, size, file.get()) != size)
    trap.fail(ErrorKind::input, path, "cannot be read to its end");
  return text;
}

std::optional<std::string_view> LineScanner::next() {
  if (rest_.empty()) return std::nullopt;
  const std::size_t end = rest_.find_first_of("\r\n");
  const std::string_view line = rest_.substr(0, end);
  if (end == std::string_view::npos) {
    rest_ = {};
  } else {
    rest_.remove_prefix(end + (rest_.compare(end, 2, "\r\n") == 0 ? 2 : 1));
  }
  ++number_;
  return line;
}

std::string_view next_word(std::string_view& line) {
  const std::size_t begin = line.find_first_not_of(" \t");
  if (begin == std::string_view::npos) {
    line = {};
    return {};
  }
  line.remove_prefix(begin);
  const std::string_view word = line.substr(0, line.find_first_of(" \t"));
  line.remove_prefix(word.size());
  return word;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

std::optional<double> parse_real(std::string_view text) {
  if (!text.empty() && text.front() == '+') {
    text.remove_prefix(1);
    if (!text.empty() && text.front() == '-') return std::nullopt;
  }
  double value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<long long> parse_integer(std::string_view text) {
  long long value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string in_quotes(std::string_view text) {
  std::string result = "'";
  for (const char c : text.substr(0, 40)) result += c >= ' ' && c != '\x7f' ? c : '?';
  return result + (text.size() > 40 ? "...'" : "'");
}

}  // namespace hydrotin
