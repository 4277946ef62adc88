#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

/// A config as a tree in which every value knows where it stands.
///
/// YAML (1.2, one document) from a file, then single values replaced from the command line. Errors are Error(config)
/// "place: what", place = "file:line:column" or the option as the user wrote it ("--set a.b", "--memory").

namespace hydrotin::app {

struct ConfigValue {
  enum class Kind : unsigned char { absent, scalar, list, section };

  Kind kind = Kind::absent;
  std::string place{};
  std::string text{};                ///< of a scalar
  bool is_quoted = false;            ///< the scalar was written in quotes: text, never a number
  std::vector<ConfigValue> items{};  ///< of a list
  std::vector<std::pair<std::string, ConfigValue>> entries{};  ///< of a section, in file order
  std::vector<std::string> key_places{};                       ///< of a section, one per entry

  [[nodiscard]] const ConfigValue* find(const std::string& key) const;
};

/// A value given on the command line: `key` is a path ("run.memory"), `option` how the user said it.
struct ConfigOverride {
  std::string key, text, option;
};

/// Splits "key=value" of --set. Fails: Error(config).
[[nodiscard]] ConfigOverride parse_override(const std::string& assignment);

/// Reads a file. An empty one is an empty section.
[[nodiscard]] ConfigValue read_config_tree(const std::filesystem::path& path);

/// Replaces or adds the value at the override's path.
void apply_override(ConfigValue& root, const ConfigOverride& override);

}  // namespace hydrotin::app
