#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

/// Longitudinal profiles of rivers as pictures: heights before and after over the way from the source.
///
/// Errors  Error(storage). Threads  Different files may be written concurrently.

namespace hydrotin {

/// NN-name.svg, with what file names may not have left out.
[[nodiscard]] std::string profile_file_name(std::size_t number, const std::string& name);

/// @param along          [n] way from the source, ascending; n > 0
/// @param before, after  [n]
void write_profile_svg(const std::filesystem::path& path, const std::string& name, std::span<const double> along,
                       std::span<const double> before, std::span<const double> after);

}  // namespace hydrotin
