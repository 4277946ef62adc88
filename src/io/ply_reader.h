#pragma once

#include <filesystem>
#include <string_view>

#include "hydrotin/mesh.h"

namespace hydrotin {

/// Reads the content of a PLY file; `path` is for messages. Fails: Error(input) with line or byte.
[[nodiscard]] Mesh read_ply(const std::filesystem::path& path, std::string_view content);

}  // namespace hydrotin
