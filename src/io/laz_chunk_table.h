#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "las_source.h"
#include "laz_layout.h"

// Where the chunks of a LAZ file lie.

namespace hydrotin {

struct LazChunk {
  std::uint64_t begin = 0;        // byte in the file
  std::uint64_t first_point = 0;  // index of its first point
};

// Chunks in file order and one more entry for the end of the last. Nothing: the writer was interrupted before it wrote
// the table, or never writes one; the chunks can then only be found by decoding.
[[nodiscard]] std::optional<std::vector<LazChunk>> read_chunk_table(const LasSource& source, const LasHeader& header,
                                                                    const LazLayout& layout);

}  // namespace hydrotin
