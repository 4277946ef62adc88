#include "profile_svg.h"

#include <fmt/format.h>

#include <filesystem>

#include "hydrotin/error.h"
#include "hydrotin/profile_svg.h"

namespace hydrotin::app {

std::vector<std::string> write_profiles(const std::string& folder, const EmbedInput& input,
                                        const std::vector<double>& after, const NamedRivers& rivers, std::size_t most) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw Error(ErrorKind::storage, fmt::format("{}: cannot be made: {}", folder, error.message()));
  const MainStems stems =
      main_stems(input.terrain(), input.rivers, rivers.river, static_cast<std::uint32_t>(rivers.name.size()));
  std::vector<std::string> paths;
  for (std::size_t g = 0; g < rivers.name.size() && g < most; ++g) {
    const std::span<const std::uint32_t> stem(stems.vertex.data() + stems.begin[g],
                                              stems.begin[g + 1] - stems.begin[g]);
    const std::filesystem::path path = std::filesystem::path(folder) / profile_file_name(g, rivers.name[g]);
    std::vector<double> along, before, now;
    for (std::size_t i = 0; i < stem.size(); ++i) {
      along.push_back(i == 0 ? 0 : along.back() + input.length({stem[i - 1], stem[i]}));
      before.push_back(input.height[stem[i]]);
      now.push_back(after[stem[i]]);
    }
    write_profile_svg(path, rivers.name[g], along, before, now);
    paths.push_back(path.string());
  }
  return paths;
}

}  // namespace hydrotin::app
