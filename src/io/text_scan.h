#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

/// Reading small text files: the file as a whole, then lines, words and numbers with their places.

namespace hydrotin {

/// Reads a file through GDAL's virtual file systems. Fails: Error(input), also above `max_bytes`.
[[nodiscard]] std::string read_whole_file(const std::filesystem::path& path,
                                          std::size_t max_bytes = std::size_t{1} << 33);

/// Goes through a text line by line; ends of line are \n, \r\n or \r.
class LineScanner {
 public:
  explicit LineScanner(std::string_view text) : rest_(text) {}
  /// The next line without its end; nothing at the end of the text.
  [[nodiscard]] std::optional<std::string_view> next();
  [[nodiscard]] std::size_t line_number() const { return number_; }  ///< of the last line given, from 1
  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
};

/// Cuts the next blank-separated word off `line`; empty at its end.
[[nodiscard]] std::string_view next_word(std::string_view& line);

[[nodiscard]] std::string_view trimmed(std::string_view text);

/// The whole text as a finite number (a leading + is allowed), rounded to nearest.
[[nodiscard]] std::optional<double> parse_real(std::string_view text);

/// The whole text as an integer.
[[nodiscard]] std::optional<long long> parse_integer(std::string_view text);

/// At most 40 characters of a text for a message, with what cannot be printed replaced.
[[nodiscard]] std::string in_quotes(std::string_view text);

}  // namespace hydrotin
