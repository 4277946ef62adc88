#include "ingest_index.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "store.h"

namespace hydrotin {
namespace {

struct Meeting {
  std::uint32_t file, tile;
};

// The tiles of one file's runs, each once.
std::vector<std::uint32_t> tiles_in(const store::Reader& in, std::uint32_t num_tiles) {
  auto tiles = in.read<std::uint32_t>("run_tile");
  if (!std::is_sorted(tiles.begin(), tiles.end()) || (!tiles.empty() && tiles.back() >= num_tiles))
    throw Error(ErrorKind::storage, in.path() + ": its runs do not fit the plan; delete the file and run again");
  tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
  return tiles;
}

}  // namespace

void IngestIndex::build(const Layout& layout, std::size_t num_files, std::uint32_t num_tiles) {
  std::vector<Meeting> meetings;
  for (std::uint32_t f = 0; f < num_files; ++f)
    for (const std::uint32_t tile : tiles_in(store::Reader(layout.unit(Phase::ingest, f)), num_tiles))
      meetings.push_back({f, tile});
  begin_.assign(std::size_t{num_tiles} + 1, 0);
  for (const Meeting& m : meetings) ++begin_[m.tile + 1];
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  file_.resize(meetings.size());
  std::vector<std::uint64_t> next(begin_.begin(), begin_.end() - 1);
  for (const Meeting& m : meetings) file_[next[m.tile]++] = m.file;
}

std::span<const std::uint32_t> IngestIndex::files_of(std::uint32_t tile, const Layout& layout, std::size_t num_files,
                                                     std::uint32_t num_tiles) {
  std::call_once(once_, [&] { build(layout, num_files, num_tiles); });
  return std::span(file_).subspan(begin_[tile], begin_[tile + 1] - begin_[tile]);
}

}  // namespace hydrotin
