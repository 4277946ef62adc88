#include "hydrotin/las.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "hydrotin/error.h"
#include "hydrotin/las_summary.h"
#include "las_corpus.h"
#include "las_decoding.h"
#include "shared_data.h"

namespace hydrotin {
namespace {

using testing::all_records;
using testing::LasExpectation;
using testing::shared_path;

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

// --- corpus: counts, bounds and classes ------------------------------------------------------------------------

class LasCorpus : public ::testing::TestWithParam<LasExpectation> {};

TEST_P(LasCorpus, DecodesCompletely) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  const LasExpectation& expected = GetParam();
  const LasSummary summary = summarize_las(shared_path(expected.path));
  const LasHeader& header = summary.header;
  EXPECT_TRUE(summary.complete) << summary.problem;
  EXPECT_EQ(std::to_string(header.version_major) + "." + std::to_string(header.version_minor), expected.version);
  EXPECT_EQ(header.point_format, expected.point_format);
  EXPECT_EQ(header.point_count, expected.points);
  EXPECT_EQ(summary.tally.points(), expected.points);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(summary.min[axis], expected.min[axis], 0.005001) << axis;
    EXPECT_NEAR(summary.max[axis], expected.max[axis], 0.005001) << axis;
  }
  EXPECT_EQ(summary.tally.withheld(), expected.withheld);
  for (const auto& [code, count] : expected.classes)
    EXPECT_EQ(summary.tally.classes()[static_cast<std::size_t>(code)], count) << "class " << code;
  const std::string crs = expected.crs;
  if (crs == "WKT") {
    EXPECT_EQ(header.crs, header.crs_wkt);
    EXPECT_FALSE(header.crs_wkt.empty());
  } else {
    EXPECT_EQ(header.crs, crs);
    EXPECT_EQ(header.crs_wkt.empty(), crs.empty());
  }
}

INSTANTIATE_TEST_SUITE_P(All, LasCorpus, ::testing::ValuesIn(testing::kLasCorpus), [](const auto& name) {
  std::string text = name.param.path;
  std::replace_if(
      text.begin(), text.end(), [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
  return text;
});

// --- decoding in other ways gives the same ------------------------------------------------------------------------

struct Flat {
  std::vector<std::int32_t> xyz;
  std::vector<std::uint8_t> classes, flags, returns;
  friend bool operator==(const Flat&, const Flat&) = default;
};

void append(Flat& flat, const PointBatch& batch) {
  for (const auto* axis : {&batch.x, &batch.y, &batch.z}) flat.xyz.insert(flat.xyz.end(), axis->begin(), axis->end());
  flat.classes.insert(flat.classes.end(), batch.classification.begin(), batch.classification.end());
  flat.flags.insert(flat.flags.end(), batch.flags.begin(), batch.flags.end());
  flat.returns.insert(flat.returns.end(), batch.return_number.begin(), batch.return_number.end());
  flat.returns.insert(flat.returns.end(), batch.number_of_returns.begin(), batch.number_of_returns.end());
}

// Straight from the records, by the tables of the LAS specification.
Flat flat_of_records(const std::vector<std::byte>& records, const LasHeader& header) {
  const auto byte = [&](std::size_t at) { return std::to_integer<unsigned>(records[at]); };
  Flat flat;
  const std::size_t count = records.size() / header.record_length;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t at = i * header.record_length + 4 * axis;
      flat.xyz.push_back(
          static_cast<std::int32_t>(byte(at) | (byte(at + 1) << 8U) | (byte(at + 2) << 16U) | (byte(at + 3) << 24U)));
    }
  const bool is_14 = header.point_format >= 6;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = i * header.record_length;
    flat.classes.push_back(static_cast<std::uint8_t>(is_14 ? byte(at + 16) : byte(at + 15) % 32));
    flat.flags.push_back(static_cast<std::uint8_t>(is_14 ? byte(at + 15) % 16 : byte(at + 15) / 32));
  }
  for (const unsigned divisor : {1U, is_14 ? 16U : 8U})
    for (std::size_t i = 0; i < count; ++i)
      flat.returns.push_back(
          static_cast<std::uint8_t>(byte(i * header.record_length + 14) / divisor % (is_14 ? 16 : 8)));
  return flat;
}

const std::array<const char*, 8> kEveryCodec{"pairs/point10.laz",
                                             "pairs/extra-bytes.laz",
                                             "pairs/pdrf6-1.4.laz",
                                             "pairs/pdrf7-v4-1.4.laz",
                                             "pairs/pdrf8-1.4.laz",
                                             "pairs/autzen_trim.las",
                                             "formats/1.2-with-color.copc.laz",
                                             "formats/TO_core_last_zoom.laz"};

TEST(LasFile, BatchesAreTheRecords) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  for (const char* name : kEveryCodec) {
    SCOPED_TRACE(name);
    const LasFile file(shared_path(name));
    std::vector<std::byte> records;
    PointBatch batch;
    for (std::size_t i = 0; i < file.num_chunks(); ++i) {
      file.decode_records(i, records);
      file.decode(i, batch, {.classification = true, .flags = true, .returns = true});
      Flat flat;
      append(flat, batch);
      EXPECT_EQ(flat, flat_of_records(records, file.header()));
    }
  }
}

TEST(LasFile, SkippingFieldsChangesNoOther) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  for (const char* name : kEveryCodec) {
    SCOPED_TRACE(name);
    const LasFile file(shared_path(name));
    PointBatch all, some;
    for (std::size_t i = 0; i < file.num_chunks(); ++i) {
      file.decode(i, all, {.classification = true, .flags = true, .returns = true});
      file.decode(i, some, {.classification = false, .flags = true, .returns = false});
      EXPECT_EQ(some.x, all.x);
      EXPECT_EQ(some.y, all.y);
      EXPECT_EQ(some.z, all.z);
      EXPECT_EQ(some.flags, all.flags);
      EXPECT_TRUE(some.classification.empty() && some.return_number.empty() && some.number_of_returns.empty());
      file.decode(i, some, {.classification = true, .flags = false, .returns = true});
      EXPECT_EQ(some.classification, all.classification);
      EXPECT_EQ(some.return_number, all.return_number);
      EXPECT_EQ(some.number_of_returns, all.number_of_returns);
    }
  }
}

TEST(LasFile, ChunksDecodeInAnyOrderOnManyThreads) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  for (const char* name : {"tiles_bcts/bcts_1.laz", "formats/lone-star.copc.laz", "formats/autzen_trim_7.las",
                           "pairs/pdrf8-1.4.laz", "formats/TO_core_last_zoom.laz"}) {
    SCOPED_TRACE(name);
    const LasFile file(shared_path(name));
    std::vector<PointBatch> serial(file.num_chunks()), parallel(file.num_chunks());
    for (std::size_t i = 0; i < serial.size(); ++i) file.decode(i, serial[i]);
    std::vector<std::thread> threads;
    constexpr std::size_t kThreads = 4;
    for (std::size_t t = 0; t < kThreads; ++t)
      threads.emplace_back([&, t] {
        for (std::size_t i = serial.size(); i-- > 0;)
          if (i % kThreads == t) file.decode(i, parallel[i]);
      });
    for (auto& thread : threads) thread.join();
    for (std::size_t i = 0; i < serial.size(); ++i) {
      EXPECT_EQ(serial[i].x, parallel[i].x);
      EXPECT_EQ(serial[i].z, parallel[i].z);
      EXPECT_EQ(serial[i].classification, parallel[i].classification);
    }
  }
}

TEST(LasFile, ChunksAddUpInFileOrder) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  for (const auto& expected : testing::kLasCorpus) {
    SCOPED_TRACE(expected.path);
    const LasFile file(shared_path(expected.path));
    std::uint64_t next = 0;
    for (std::size_t i = 0; i < file.num_chunks(); ++i) {
      EXPECT_EQ(file.chunk_first_point(i), next);
      EXPECT_GT(file.chunk_point_count(i), 0U);
      next += file.chunk_point_count(i);
    }
    EXPECT_EQ(next, expected.points);
    EXPECT_EQ(file.chunk_first_point(file.num_chunks()), expected.points);
  }
}

// --- the summary's checksum ---------------------------------------------------------------------------------------

TEST(LasSummary, ChecksumIsThatOfThePoints) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  std::map<std::string, std::string> of_las;
  for (const char* name : {"Topography", "autzen_trim", "pdrf8-1.4", "pdrf7-v4-1.4", "extra-bytes"}) {
    const std::string stem = shared_path(std::string("pairs/") + name);
    const std::string las = summarize_las(stem + ".las", true).checksum;
    EXPECT_EQ(las.size(), 16U);
    EXPECT_EQ(las, summarize_las(stem + ".laz", true).checksum);
    of_las[las] = name;
  }
  EXPECT_EQ(of_las.size(), 5U) << "different clouds, different checksums";
  // Format 7 instead of 3, but the same points.
  EXPECT_EQ(summarize_las(shared_path("formats/autzen_trim_7.las"), true).checksum,
            summarize_las(shared_path("pairs/autzen_trim.las"), true).checksum);
  EXPECT_TRUE(summarize_las(shared_path("pairs/point10.las")).checksum.empty());
}

TEST(LasSummary, TallyDoesNotDependOnTheCuts) {
  PointBatch all;
  std::uint32_t state = 12345;
  const auto random = [&] { return state = state * 1664525U + 1013904223U; };
  for (int i = 0; i < 1000; ++i) {
    all.x.push_back(static_cast<std::int32_t>(random()));
    all.y.push_back(static_cast<std::int32_t>(random()));
    all.z.push_back(i % 3);
    all.classification.push_back(static_cast<std::uint8_t>(random() >> 24U));
    all.flags.push_back(static_cast<std::uint8_t>(random() >> 28U));
    all.return_number.push_back(static_cast<std::uint8_t>(random() >> 28U));
    all.number_of_returns.push_back(static_cast<std::uint8_t>(random() >> 28U));
  }
  const auto part = [&](std::size_t from, std::size_t to) {
    PointBatch batch;
    const auto cut = [&](const auto& source, auto& target) {
      target.assign(source.begin() + static_cast<std::ptrdiff_t>(from),
                    source.begin() + static_cast<std::ptrdiff_t>(to));
    };
    cut(all.x, batch.x);
    cut(all.y, batch.y);
    cut(all.z, batch.z);
    cut(all.classification, batch.classification);
    cut(all.flags, batch.flags);
    cut(all.return_number, batch.return_number);
    cut(all.number_of_returns, batch.number_of_returns);
    LasTally tally(true);
    tally.add(batch);
    return tally;
  };
  const LasTally whole = part(0, 1000);
  for (const std::size_t cut : {0, 1, 77, 500, 999, 1000}) {
    LasTally joined = part(0, cut);
    joined.append(part(cut, 1000));
    EXPECT_EQ(joined.checksum(), whole.checksum());
    EXPECT_EQ(joined.points(), whole.points());
    EXPECT_EQ(joined.withheld(), whole.withheld());
    EXPECT_EQ(joined.classes(), whole.classes());
    EXPECT_EQ(joined.min(), whole.min());
    EXPECT_EQ(joined.max(), whole.max());
  }
  LasTally swapped = part(500, 1000);
  swapped.append(part(0, 500));
  EXPECT_NE(swapped.checksum(), whole.checksum());
}

}  // namespace
}  // namespace hydrotin
