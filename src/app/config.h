#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "config_tree.h"
#include "hydrotin/options.h"

/// From a YAML file and the command line to checked options.
///
/// Every key has a default except `input.points`. Unknown keys, wrong types and impossible values are Error(config)
/// "file:line:column: what is wrong (what is allowed)" or "--set a.b: ..."; nothing else has been done by then.
/// Relative paths count from the config's folder.

namespace hydrotin::app {

/// Reads, overrides, checks. Later overrides win.
[[nodiscard]] PipelineOptions read_config(const std::filesystem::path& path,
                                          std::span<const ConfigOverride> overrides = {});

/// The section `pits` alone, given key by key ("method", "keep.deeper_than_m"), for commands without a config.
/// @param folder  relative paths count from it.
[[nodiscard]] PitOptions read_pit_options(std::span<const ConfigOverride> given, const std::filesystem::path& folder);

/// "4GiB", "500MB", "1.5 GB", "1048576": a number of bytes; units of 1000 (kB, MB, GB, TB) and 1024 (KiB, MiB, GiB,
/// TiB).
[[nodiscard]] std::optional<std::uint64_t> parse_byte_count(std::string_view text);

}  // namespace hydrotin::app
