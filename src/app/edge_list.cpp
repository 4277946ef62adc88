#include "edge_list.h"

#include <fmt/format.h>

#include <charconv>
#include <fstream>
#include <string_view>

#include "hydrotin/error.h"

namespace hydrotin::app {
namespace {

std::string_view skip_separators(std::string_view text) {
  const std::size_t at = text.find_first_not_of(" \t,;\r");
  return at == std::string_view::npos ? std::string_view{} : text.substr(at);
}

}  // namespace

std::vector<std::array<std::uint32_t, 2>> read_edges(const std::string& path, std::uint64_t num_vertices) {
  std::ifstream stream(path);
  if (!stream) throw Error(ErrorKind::input, path + ": cannot be opened (check the name and the permissions)");
  std::vector<std::array<std::uint32_t, 2>> edges;
  std::string line;
  std::getline(stream, line);
  for (std::size_t number = 2; std::getline(stream, line); ++number) {
    std::string_view rest = skip_separators(line);
    if (rest.empty()) continue;
    std::array<std::uint32_t, 2> edge{};
    for (std::uint32_t& end : edge) {
      const auto [stop, error] = std::from_chars(rest.data(), rest.data() + rest.size(), end);
      if (error != std::errc{} || end >= num_vertices)
        throw Error(ErrorKind::input, fmt::format("{}:{}: '{}' is not an edge (write two indices below {})", path,
                                                  number, line, num_vertices));
      rest = skip_separators(rest.substr(static_cast<std::size_t>(stop - rest.data())));
    }
    if (!rest.empty())
      throw Error(ErrorKind::input, fmt::format("{}:{}: more than two indices (write one edge a line)", path, number));
    edges.push_back(edge);
  }
  return edges;
}

}  // namespace hydrotin::app
