#include <cpl_vsi.h>
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "hydrotin/error.h"
#include "hydrotin/las.h"
#include "hydrotin/las_summary.h"
#include "las_decoding.h"
#include "las_header_bytes.h"
#include "las_memory_file.h"
#include "shared_data.h"

// Files that are damaged, cut off, extreme or unusual: each has one right answer.

namespace hydrotin {
namespace {

using testing::all_records;
using testing::Bytes;
using testing::las_header_bytes;
using testing::MemoryFile;
using testing::peek;
using testing::poke;
using testing::read_bytes;
using testing::shared_path;

std::string problem_of(const std::string& path) {
  try {
    const LasSummary summary = summarize_las(path);
    EXPECT_EQ(summary.complete, summary.problem.empty());
    return summary.problem;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    return error.what();
  }
}

void expect_problem(const std::string& path, const std::string& word) {
  const std::string problem = problem_of(path);
  EXPECT_NE(problem.find(word), std::string::npos) << "\"" << problem << "\" lacks \"" << word << "\"";
  EXPECT_EQ(problem.find(path), 0U) << "names the file first: " << problem;
}

TEST(LasBroken, EachIsRefusedByItsFault) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  expect_problem(shared_path("broken/broken_coder.laz"), "coder 15");
  expect_problem(shared_path("broken/broken_compressor.laz"), "compressor 16");
  expect_problem(shared_path("broken/broken_size.laz"), "POINT10 in version 6");
  expect_problem(shared_path("broken/broken_version.laz"), "POINT10 in version 6");
  expect_problem(shared_path("broken/broken_type.laz"), "is of type 22 and 8 bytes, but its points need GPSTIME11");
  expect_problem(shared_path("broken/garbage_nVariableLength.las"), "declares 719 points, but only 718");
}

TEST(LasBroken, SoundPointsAreRead) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  struct Case {
    const char* name;
    std::uint64_t points;
    std::size_t warnings;
    const char* crs;
  };
  for (const Case& c : {Case{"bad_vlr_count.las", 10, 1, "EPSG:32617"}, Case{"malformed_extrabytes.las", 10, 0, ""},
                        Case{"gps-time-nan.las", 1, 0, ""}, Case{"no-points.las", 0, 0, "EPSG:4269"},
                        Case{"1.2-empty-geotiff-vlrs.las", 43, 0, ""}, Case{"nocrs.las", 30, 0, ""}}) {
    SCOPED_TRACE(c.name);
    const LasSummary summary = summarize_las(shared_path(std::string("broken/") + c.name));
    EXPECT_TRUE(summary.complete) << summary.problem;
    EXPECT_EQ(summary.tally.points(), c.points);
    EXPECT_EQ(summary.header.warnings.size(), c.warnings);
    EXPECT_EQ(summary.header.crs, c.crs);
  }
}

TEST(LasBroken, OtherThingsThanLasFiles) {
  expect_problem("/vsimem/there_is_no_such_file.las", "cannot be opened");
  expect_problem(MemoryFile("empty.las", {}).path(), "is empty");
  expect_problem(MemoryFile("text.las", Bytes(1000, 'x')).path(), "not a LAS");
  Bytes head{'L', 'A', 'S', 'F'};
  expect_problem(MemoryFile("head.las", head).path(), "ends inside its header after 4 bytes");
  expect_problem("/", "is a folder");
}

TEST(LasHeader, SenselessValuesAreNamed) {
  const auto problem = [](auto change, const char* word) {
    Bytes h = las_header_bytes(2, 1, 28, 0);
    change(h);
    const MemoryFile file("senseless.las", h);
    expect_problem(file.path(), word);
  };
  problem([](Bytes& h) { h[24] = 2; }, "version 2.2");
  problem([](Bytes& h) { h[25] = 9; }, "version 1.9");
  problem([](Bytes& h) { h[25] = 4; }, "a header of 227 bytes");
  problem([](Bytes& h) { poke<std::uint16_t>(h, 94, 100); }, "a header of 100 bytes");
  problem([](Bytes& h) { poke<std::uint32_t>(h, 96, 1000); }, "points at byte 1000");
  problem([](Bytes& h) { poke<std::uint32_t>(h, 96, 10); }, "points at byte 10");
  problem([](Bytes& h) { h[104] = 11; }, "point format 11");
  problem([](Bytes& h) { poke<std::uint16_t>(h, 105, 27); }, "records of 27 bytes");
  problem([](Bytes& h) { poke(h, 131, 0.0); }, "scale");
  problem([](Bytes& h) { poke(h, 139, -1.0); }, "scale");
  problem([](Bytes& h) { poke(h, 147, std::numeric_limits<double>::quiet_NaN()); }, "scale");
  problem([](Bytes& h) { poke(h, 155, std::numeric_limits<double>::infinity()); }, "offset");
  problem(
      [](Bytes& h) {
        h[104] = 0x81;
        h.push_back(0);
      },
      "no laszip record");
  const MemoryFile sound("sound.las", las_header_bytes(2, 1, 28, 0));
  EXPECT_EQ(problem_of(sound.path()), "");
}

// More points than 32 bits count, in a file that says it has them all (its size is a sparse file's).
TEST(LasHeader, MoreThan32BitsOfPoints) {
  constexpr std::uint64_t kPoints = 5'000'000'123ULL;
  Bytes h = las_header_bytes(4, 6, 30, kPoints);
  const MemoryFile missing("missing.las", h);
  expect_problem(missing.path(), "declares 5000000123 points, but only 0 are there");
  EXPECT_EQ(read_las_header(missing.path()).point_count, kPoints);

  const auto folder = std::filesystem::temp_directory_path() / "hydrotin_las_sparse";
  std::filesystem::create_directories(folder);
  const std::string path = (folder / "sparse.las").string();
  {
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(h.data()), static_cast<std::streamsize>(h.size()));
  }
  std::error_code cannot;
  std::filesystem::resize_file(path, h.size() + kPoints * 30, cannot);
  if (cannot) GTEST_SKIP() << "skipped: no sparse files here";
  {
    const LasFile file(path);
    EXPECT_EQ(file.header().point_count, kPoints);
    EXPECT_EQ(file.num_chunks(), (kPoints + 65535) / 65536);
    const std::size_t last = file.num_chunks() - 1;
    EXPECT_EQ(file.chunk_first_point(last), last * std::uint64_t{65536});
    EXPECT_EQ(file.chunk_first_point(last) + file.chunk_point_count(last), kPoints);
    PointBatch batch;
    file.decode(last, batch);
    EXPECT_EQ(batch.size(), kPoints % 65536);
  }
  std::filesystem::remove_all(folder);

  // No multiplication overflows: 2^60 records of 30 bytes are 0 bytes modulo 2^64.
  for (const std::uint64_t points : {std::uint64_t{1} << 60U, std::uint64_t{1} << 63U, ~std::uint64_t{0}}) {
    const MemoryFile absurd("absurd.las", las_header_bytes(4, 6, 32, points));
    expect_problem(absurd.path(), "declares " + std::to_string(points));
  }
}

TEST(LasHeader, LegacyCountServesWhereTheLongOneIsZero) {
  Bytes h = las_header_bytes(4, 1, 28, 0);
  poke<std::uint32_t>(h, 107, 2);
  h.resize(h.size() + 56);
  const MemoryFile file("legacy.las", h);
  EXPECT_EQ(LasFile(file.path()).header().point_count, 2U);
}

TEST(LasHeader, MorePointsThanDeclaredAreWorthAWarning) {
  Bytes h = las_header_bytes(2, 1, 28, 1);
  h.resize(h.size() + 28 * 5);
  const MemoryFile file("more.las", h);
  const LasFile las(file.path());
  EXPECT_EQ(las.header().point_count, 1U);
  ASSERT_EQ(las.header().warnings.size(), 1U);
  EXPECT_NE(las.header().warnings[0].find("declares 1 points, but has room for 5"), std::string::npos);
}

// --- chunk tables ------------------------------------------------------------------------------------------------

TEST(LazChunkTable, WhereStreamedWritersPutIt) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  for (const char* name : {"pairs/Topography.laz", "pairs/pdrf6-1.4.laz", "formats/1.2-with-color.copc.laz"}) {
    SCOPED_TRACE(name);
    Bytes bytes = read_bytes(shared_path(name));
    const auto expected = all_records(LasFile(shared_path(name)));
    const std::size_t at = peek<std::uint32_t>(bytes, 96);
    const auto table = peek<std::uint64_t>(bytes, at);
    poke(bytes, at, ~std::uint64_t{0});
    bytes.resize(bytes.size() + 8);
    poke(bytes, bytes.size() - 8, table);
    const MemoryFile file("streamed.laz", bytes);
    EXPECT_EQ(all_records(LasFile(file.path())), expected);
  }
}

TEST(LazChunkTable, InterruptedWritersHaveNone) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  for (const char* name : {"quickstart/lake.laz", "pairs/autzen_trim.laz", "pairs/pdrf6-1.4.laz",
                           "lidar_river_ign/test_semis_2023_0292_6833_LA93_IGN69.laz"}) {
    SCOPED_TRACE(name);
    Bytes bytes = read_bytes(shared_path(name));
    const LasFile sound(shared_path(name));
    const auto expected = all_records(sound);
    const std::size_t at = peek<std::uint32_t>(bytes, 96);
    bytes.resize(static_cast<std::size_t>(peek<std::uint64_t>(bytes, at)));  // drops the table and what follows
    poke(bytes, at, std::uint64_t{at});
    const bool layered = sound.header().point_format >= 6;
    {
      const MemoryFile file("interrupted.laz", bytes);
      const LasFile found(file.path());
      EXPECT_EQ(found.header().sequential, !layered);
      ASSERT_EQ(found.num_chunks(), sound.num_chunks());
      EXPECT_EQ(all_records(found), expected);
      std::vector<std::byte> a, b;  // backwards too
      for (std::size_t i = found.num_chunks(); i-- > 0;) {
        found.decode_records(i, a);
        sound.decode_records(i, b);
        EXPECT_EQ(a, b) << "chunk " << i;
      }
    }
    bytes.resize(bytes.size() - bytes.size() / 3);
    const MemoryFile cut("interrupted_and_cut.laz", bytes);
    EXPECT_NE(problem_of(cut.path()), "");
  }
}

TEST(LazChunkTable, SenselessTablesAreRefused) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  const Bytes sound = read_bytes(shared_path("quickstart/lake.laz"));
  const std::size_t at = peek<std::uint32_t>(sound, 96);
  const auto table = static_cast<std::size_t>(peek<std::uint64_t>(sound, at));
  const auto problem = [&](auto change, const char* word) {
    Bytes bytes = sound;
    change(bytes);
    const MemoryFile file("senseless.laz", bytes);
    expect_problem(file.path(), word);
  };
  problem([&](Bytes& b) { poke<std::uint32_t>(b, table, 1); }, "unknown version 1");
  problem([&](Bytes& b) { poke<std::uint32_t>(b, table + 4, 0xFFFFFFFF); }, "claims 4294967295 chunks");
  problem([&](Bytes& b) { poke<std::uint32_t>(b, table + 4, 2); }, "its LAZ chunk table counts 100000");
  problem([&](Bytes& b) { poke<std::uint64_t>(b, at, b.size()); }, "should be at byte");
  problem([&](Bytes& b) { poke<std::uint64_t>(b, at, 3); }, "should be at byte 3");
  problem([&](Bytes& b) { b.resize(b.size() / 2); }, "declares 102622 points, but its LAZ chunk table");
  problem([&](Bytes& b) { poke<std::uint32_t>(b, 107, 102623); }, "damaged");
}

TEST(LasFile, ReadsThroughVirtualFileSystems) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  const Bytes bytes = read_bytes(shared_path("pairs/Megaplot.laz"));
  const std::string zip = "/vsizip//vsimem/hydrotin_las.zip/inside/cloud.laz";
  VSILFILE* to = VSIFOpenL(zip.c_str(), "wb");
  ASSERT_NE(to, nullptr);
  ASSERT_EQ(VSIFWriteL(bytes.data(), 1, bytes.size(), to), bytes.size());
  VSIFCloseL(to);
  EXPECT_EQ(all_records(LasFile(zip)), all_records(LasFile(shared_path("pairs/Megaplot.las"))));
  VSIUnlink("/vsimem/hydrotin_las.zip");
}

}  // namespace
}  // namespace hydrotin
