#pragma once

#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "layout.h"

/// Which input files have points for a tile.
///
/// An output of `ingest` lists its runs of points by tile. Read once for all files and turned round, the lists tell
/// each tile its files: `arrange` opens these and no others, so that its work grows with the points and not with files
/// times tiles. It is derived from the outputs alone: each process of a job array makes its own.
///
/// Memory   4 bytes for each pair of a file and a tile that meet, and for each tile.
/// Threads  May be called concurrently; the first caller reads the lists, others wait for it.

namespace hydrotin {

class IngestIndex {
 public:
  /// The files with points of `tile`, ascending. Valid as long as this object.
  /// @param tile  < num_tiles; the other arguments are those of the first call
  /// Fails: Error(storage) if an output of `ingest` is missing or damaged; the next call tries again.
  [[nodiscard]] std::span<const std::uint32_t> files_of(std::uint32_t tile, const Layout& layout, std::size_t num_files,
                                                        std::uint32_t num_tiles);

 private:
  void build(const Layout& layout, std::size_t num_files, std::uint32_t num_tiles);

  std::once_flag once_;
  std::vector<std::uint64_t> begin_;  // [tiles + 1]
  std::vector<std::uint32_t> file_;   // of tile t: file_[begin_[t] .. begin_[t + 1])
};

}  // namespace hydrotin
