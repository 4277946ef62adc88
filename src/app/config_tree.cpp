#include "config_tree.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "hydrotin/error.h"

namespace hydrotin::app {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{16} << 20;
constexpr std::size_t kMaxValues = 1'000'000;  // aliases of aliases can grow without end
constexpr int kMaxDepth = 32;

[[noreturn]] void fail(const std::string& place, const std::string& what) {
  throw Error(ErrorKind::config, place + ": " + what);
}

/// Where a YAML node stands: in a file, or in an option of the command line.
class Places {
 public:
  explicit Places(std::filesystem::path file) : file_(std::move(file)) {}
  explicit Places(std::string option) : option_(std::move(option)) {}

  [[nodiscard]] std::string of(const YAML::Mark& mark) const {
    if (!option_.empty()) return option_;
    if (mark.is_null()) return file_.string();
    return file_.string() + ":" + std::to_string(mark.line + 1) + ":" + std::to_string(mark.column + 1);
  }

 private:
  std::filesystem::path file_;
  std::string option_;
};

/// Copies YAML's nodes, expanding aliases within bounds and refusing repeated keys.
class Converter {
 public:
  explicit Converter(const Places& places) : places_(places) {}

  ConfigValue convert(const YAML::Node& node, int depth) {
    ConfigValue value;
    value.place = places_.of(node.Mark());
    if (++num_values_ > kMaxValues || depth > kMaxDepth)
      fail(value.place, "too much nested or repeated content for a config");
    switch (node.Type()) {
      case YAML::NodeType::Undefined:
      case YAML::NodeType::Null:
        break;
      case YAML::NodeType::Scalar:
        value.kind = ConfigValue::Kind::scalar;
        value.text = node.Scalar();
        value.is_quoted = node.Tag() == "!";
        break;
      case YAML::NodeType::Sequence:
        value.kind = ConfigValue::Kind::list;
        for (const auto& item : node) value.items.push_back(convert(item, depth + 1));
        break;
      case YAML::NodeType::Map:
        convert_entries(node, depth, value);
        break;
    }
    return value;
  }

 private:
  void convert_entries(const YAML::Node& node, int depth, ConfigValue& value) {
    value.kind = ConfigValue::Kind::section;
    for (const auto& entry : node) {
      const std::string place = places_.of(entry.first.Mark());
      if (!entry.first.IsScalar()) fail(place, "a key must be plain text");
      const std::string key = entry.first.Scalar();
      if (value.find(key) != nullptr) fail(place, "the key '" + key + "' stands here twice");
      value.entries.emplace_back(key, convert(entry.second, depth + 1));
      if (value.entries.back().second.kind == ConfigValue::Kind::absent) value.entries.back().second.place = place;
      value.key_places.push_back(place);
    }
  }

  const Places& places_;
  std::size_t num_values_ = 0;
};

ConfigValue parse(const std::string& text, const Places& places) {
  try {
    const auto documents = YAML::LoadAll(text);
    if (documents.size() > 1) fail(places.of(documents[1].Mark()), "a second YAML document (a config is one)");
    return documents.empty() ? ConfigValue{} : Converter(places).convert(documents[0], 0);
  } catch (const YAML::Exception& problem) {
    fail(places.of(problem.mark), "is not YAML: " + problem.msg);
  }
}

}  // namespace

const ConfigValue* ConfigValue::find(const std::string& key) const {
  const auto found =
      std::find_if(entries.begin(), entries.end(), [&](const auto& entry) { return entry.first == key; });
  return found == entries.end() ? nullptr : &found->second;
}

ConfigOverride parse_override(const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0)
    fail("--set " + assignment, "must be key=value, for example --set tiles.target_points=1000000");
  const std::string key = assignment.substr(0, equals);
  return {key, assignment.substr(equals + 1), "--set " + key};
}

ConfigValue read_config_tree(const std::filesystem::path& path) {
  std::error_code problem;
  if (!std::filesystem::exists(path, problem)) fail(path.string(), "no such config file");
  if (!std::filesystem::is_regular_file(path, problem)) fail(path.string(), "is not a config file");
  if (std::filesystem::file_size(path, problem) > kMaxBytes) fail(path.string(), "is too large for a config");
  std::ifstream in(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  if (in.bad() || !in.is_open()) fail(path.string(), "cannot be read (check its permissions)");
  ConfigValue root = parse(text, Places(path));
  if (root.kind == ConfigValue::Kind::absent) root = {.kind = ConfigValue::Kind::section, .place = path.string()};
  if (root.kind != ConfigValue::Kind::section) fail(root.place, "a config is sections of 'key: value' lines");
  return root;
}

void apply_override(ConfigValue& root, const ConfigOverride& override) {
  ConfigValue* value = &root;
  std::size_t begin = 0;
  while (begin <= override.key.size()) {
    const std::size_t end = std::min(override.key.find('.', begin), override.key.size());
    const std::string key = override.key.substr(begin, end - begin);
    if (key.empty()) fail(override.option, "the key must be names joined by points, for example run.memory");
    if (value->kind != ConfigValue::Kind::section) {
      // A section replaces what stood there: `dem: false` in the file, `--set output.dem.cell_m=2` on the command line.
      *value = {.kind = ConfigValue::Kind::section, .place = override.option};
    }
    auto found = std::find_if(value->entries.begin(), value->entries.end(),
                              [&](const auto& entry) { return entry.first == key; });
    if (found == value->entries.end()) {
      value->entries.emplace_back(key, ConfigValue{.place = override.option});
      value->key_places.push_back(override.option);
      found = value->entries.end() - 1;
    }
    value = &found->second;
    begin = end + 1;
  }
  *value = parse(override.text, Places(override.option));
  value->place = override.option;
}

}  // namespace hydrotin::app
