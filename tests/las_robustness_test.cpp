#include <cpl_error.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "hydrotin/error.h"
#include "hydrotin/las.h"
#include "hydrotin/las_summary.h"
#include "las_memory_file.h"
#include "shared_data.h"

// Damaged files end in an Error or in a result; in a build with sanitizers every wrong step on the way is found.

namespace hydrotin {
namespace {

using testing::Bytes;
using testing::MemoryFile;
using testing::peek;
using testing::poke;
using testing::read_bytes;

// Small files, which together need every codec, and where to cut the chunk table off.
const std::vector<std::string> kFiles{
    "pairs/point10.laz",      "pairs/point-time.laz", "pairs/point-color.laz",           "pairs/point-time-color.laz",
    "pairs/extra-bytes.laz",  "pairs/pdrf6-1.4.laz",  "pairs/pdrf7-v4-1.4.laz",          "pairs/pdrf8-1.4.laz",
    "pairs/example.laz",      "pairs/example.las",    "formats/1.2-with-color.copc.laz", "formats/wontcompress3.las",
    "formats/interesting.las"};

// Everything a reader does with a file. Returns whether it was complete.
bool use(const Bytes& bytes) {
  const MemoryFile memory("hydrotin_damaged.laz", bytes);
  try {
    const LasFile file(memory.path());
    PointBatch batch;
    std::vector<std::byte> records;
    for (std::size_t i = 0; i < file.num_chunks(); ++i) {
      file.decode(i, batch, {.classification = true, .flags = true, .returns = true});
      EXPECT_EQ(batch.size(), file.chunk_point_count(i));
      file.decode_records(i, records);
      EXPECT_EQ(records.size(), file.chunk_point_count(i) * file.header().record_length);
    }
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_EQ(std::string(error.what()).find(memory.path()), 0U) << error.what();
    return false;
  }
  return true;
}

class LasRobustness : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override { CPLPushErrorHandler(CPLQuietErrorHandler); }
  void TearDown() override { CPLPopErrorHandler(); }
};

TEST_P(LasRobustness, CutAnywhere) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  const Bytes sound = read_bytes(testing::shared_path(GetParam()));
  ASSERT_TRUE(use(sound));
  constexpr std::size_t kCuts = 200;
  for (std::size_t i = 0; i < kCuts; ++i) {
    const std::size_t length = sound.size() * i / kCuts;
    SCOPED_TRACE("cut at " + std::to_string(length));
    // COPC keeps its index behind the points; all else ends with them or with the chunk table.
    if (use(Bytes(sound.begin(), sound.begin() + static_cast<std::ptrdiff_t>(length)))) {
      EXPECT_NE(GetParam().find("copc"), std::string::npos) << "points are missing, but nobody says so";
    }
  }
}

TEST_P(LasRobustness, BytesFlippedAnywhere) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  const Bytes sound = read_bytes(testing::shared_path(GetParam()));
  std::mt19937 random(20240607);
  for (int i = 0; i < 1000; ++i) {
    SCOPED_TRACE("damage " + std::to_string(i));
    Bytes bytes = sound;
    // Every other time where it hurts most: header, VLRs, the first chunk's head.
    const std::size_t range = i % 2 == 0 ? bytes.size() : std::min<std::size_t>(bytes.size(), 700);
    for (std::size_t n = 1 + random() % 3; n > 0; --n)
      bytes[random() % range] ^= static_cast<std::uint8_t>(1 + random() % 255);
    use(bytes);
  }
}

// The stream in which chunks are found by decoding them.
TEST_P(LasRobustness, DamagedWithoutChunkTable) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  Bytes sound = read_bytes(testing::shared_path(GetParam()));
  const std::size_t at = peek<std::uint32_t>(sound, 96);
  if ((sound[104] & 0x80U) == 0) return;
  sound.resize(static_cast<std::size_t>(peek<std::uint64_t>(sound, at)));
  poke(sound, at, std::uint64_t{at});
  use(sound);
  std::mt19937 random(4711);
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE("damage " + std::to_string(i));
    Bytes bytes = sound;
    bytes[at + 8 + random() % (bytes.size() - at - 8)] ^= static_cast<std::uint8_t>(1 + random() % 255);
    if (i % 4 == 0) bytes.resize(at + random() % (bytes.size() - at));
    use(bytes);
  }
}

INSTANTIATE_TEST_SUITE_P(All, LasRobustness, ::testing::ValuesIn(kFiles), [](const auto& name) {
  std::string text = name.param;
  std::replace_if(
      text.begin(), text.end(), [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
  return text;
});

// A header may claim anything: memory follows what is really there.
TEST(LasRobustnessClaims, HugeCountsTakeNoMemory) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  for (const char* name : {"pairs/point-time.laz", "pairs/pdrf6-1.4.laz"}) {
    Bytes bytes = read_bytes(testing::shared_path(name));
    const bool is_14 = bytes[25] >= 4;
    // One chunk that claims four thousand million points.
    if (is_14) {
      poke(bytes, 247, std::uint64_t{4'000'000'000U});
    } else {
      poke(bytes, 107, std::uint32_t{4'000'000'000U});
    }
    const std::string tag = "laszip encoded";
    const auto vlr = std::search(bytes.begin(), bytes.end(), tag.begin(), tag.end()) - bytes.begin();
    poke(bytes, static_cast<std::size_t>(vlr) - 2 + 54 + 12, std::uint32_t{4'000'000'000U});
    poke(bytes, static_cast<std::size_t>(peek<std::uint64_t>(bytes, peek<std::uint32_t>(bytes, 96))) + 4,
         std::uint32_t{1});
    EXPECT_FALSE(use(bytes)) << name;
  }
}

TEST(LasRobustnessClaims, PointwiseStreamWithoutChunks) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  Bytes sound = read_bytes(testing::shared_path("formats/TO_core_last_zoom.laz"));
  sound.resize(40'000);
  poke(sound, 107, std::uint32_t{12'000});
  ASSERT_TRUE(use(sound)) << "12,000 points are in the first 40,000 bytes";
  std::mt19937 random(99);
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE("damage " + std::to_string(i));
    Bytes bytes = sound;
    bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1 + random() % 255);
    if (i % 4 == 0) bytes.resize(random() % bytes.size());
    use(bytes);
  }
}

}  // namespace
}  // namespace hydrotin
