#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "hydrotin/las.h"

namespace hydrotin::testing {

/// All there is to know of a point without its record.
inline constexpr PointFields kAllFields{.classification = true, .flags = true, .returns = true};

inline std::vector<std::byte> all_records(const LasFile& file) {
  std::vector<std::byte> all, chunk;
  for (std::size_t i = 0; i < file.num_chunks(); ++i) {
    file.decode_records(i, chunk);
    EXPECT_EQ(chunk.size(), file.chunk_point_count(i) * file.header().record_length);
    all.insert(all.end(), chunk.begin(), chunk.end());
  }
  return all;
}

}  // namespace hydrotin::testing
