#pragma once

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "shared_data.h"

/// The real clouds that are sound: whatever lies in the folders, so that a new file is tested without being listed.
namespace hydrotin::testing {

/// Paths below the shared data, sorted; empty where there is no shared data.
inline std::vector<std::string> good_las_files() {
  // What the manifest calls damaged although it does not lie in broken/: nothing so far.
  const std::vector<std::string> unsound{};
  std::vector<std::string> files;
  if (!has_shared_data()) return files;
  const std::filesystem::path root = shared_path("");
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
    std::string extension = entry.path().extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const std::string name = std::filesystem::relative(entry.path(), root).string();
    if ((extension == ".las" || extension == ".laz") && !name.starts_with("broken/") &&
        std::find(unsound.begin(), unsound.end(), name) == unsound.end())
      files.push_back(name);
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// The compressor that the file names: 0 none, 1 one stream, 2 chunks, 3 layered chunks. Looks at the head only.
inline int laz_compressor(const std::string& name) {
  std::string head(65536, '\0');
  std::ifstream file(shared_path(name), std::ios::binary);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  const std::size_t tag = head.find("laszip encoded");
  if ((static_cast<unsigned char>(head[104]) & 0x80U) == 0 || tag == std::string::npos) return 0;
  return head.at(tag - 2 + 54);
}

/// A name that tests may have.
inline std::string test_name_of(std::string path) {
  std::replace_if(
      path.begin(), path.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return path;
}

}  // namespace hydrotin::testing
