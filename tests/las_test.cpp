#include "hydrotin/las.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "hydrotin/error.h"
#include "shared_data.h"

namespace hydrotin {
namespace {

using testing::shared_path;

std::vector<std::byte> all_records(const LasFile& file) {
  std::vector<std::byte> all, chunk;
  for (std::size_t i = 0; i < file.num_chunks(); ++i) {
    file.decode_records(i, chunk);
    EXPECT_EQ(chunk.size(), file.chunk_point_count(i) * file.header().record_length);
    all.insert(all.end(), chunk.begin(), chunk.end());
  }
  return all;
}

// --- pairs: a LAZ file holds the records of its LAS file -----------------------------------------------------------

class LasPair : public ::testing::TestWithParam<const char*> {};

TEST_P(LasPair, RecordsOfLazAreThoseOfLas) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  const std::string stem = shared_path(std::string("pairs/") + GetParam());
  const LasFile las(stem + ".las"), laz(stem + ".laz");
  EXPECT_FALSE(las.header().compressed);
  EXPECT_TRUE(laz.header().compressed);
  EXPECT_EQ(las.header().scale, laz.header().scale);
  EXPECT_EQ(las.header().point_count, laz.header().point_count);
  ASSERT_EQ(las.header().record_length, laz.header().record_length);
  const auto expected = all_records(las), actual = all_records(laz);
  ASSERT_EQ(expected.size(), actual.size());
  const auto differs = std::mismatch(expected.begin(), expected.end(), actual.begin()).first - expected.begin();
  EXPECT_EQ(static_cast<std::size_t>(differs), expected.size())
      << "record " << differs / las.header().record_length << " byte " << differs % las.header().record_length;
}

INSTANTIATE_TEST_SUITE_P(All, LasPair,
                         ::testing::Values("Topography", "Megaplot", "autzen_trim", "point10", "point-time",
                                           "point-color", "point-time-color", "extra-bytes", "pdrf6-1.4", "pdrf8-1.4",
                                           "pdrf7-v4-1.4", "example"));

}  // namespace
}  // namespace hydrotin
