#include "hydrotin/las_writer.h"

#include <cpl_vsi.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <filesystem>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "hydrotin/crs.h"
#include "hydrotin/error.h"
#include "hydrotin/las.h"
#include "las_memory_file.h"

namespace hydrotin {
namespace {

using testing::Bytes;
using testing::peek;

constexpr std::string_view kPath = "/vsimem/hydrotin_written.las";

// A cloud of every value a point format can hold, extremes first.
struct Cloud {
  std::vector<std::int32_t> x, y, z;
  std::vector<std::uint8_t> classification, flags, return_number, number_of_returns;
  std::vector<std::uint16_t> intensity, source, red, green, blue, nir;
  std::vector<double> time;

  [[nodiscard]] LasPoints points(std::size_t from, std::size_t n) const {
    const auto part = [&](const auto& all) { return std::span(all).subspan(from, n); };
    LasPoints p;
    p.x = part(x), p.y = part(y), p.z = part(z);
    p.classification = part(classification), p.flags = part(flags);
    p.return_number = part(return_number), p.number_of_returns = part(number_of_returns);
    p.intensity = part(intensity), p.point_source = part(source), p.gps_time = part(time);
    p.red = part(red), p.green = part(green), p.blue = part(blue), p.near_infrared = part(nir);
    return p;
  }
};

Cloud random_cloud(std::size_t n, bool format_14, unsigned seed) {
  std::mt19937 random(seed);
  const auto below = [&](unsigned bound) { return random() % bound; };
  Cloud c;
  for (std::size_t i = 0; i < n; ++i) {
    const auto coordinate = [&] {
      if (i == 0) return std::numeric_limits<std::int32_t>::min();
      if (i == 1) return std::numeric_limits<std::int32_t>::max();
      return static_cast<std::int32_t>(random());
    };
    c.x.push_back(coordinate());
    c.y.push_back(coordinate());
    c.z.push_back(coordinate());
    c.classification.push_back(static_cast<std::uint8_t>(below(format_14 ? 256 : 32)));
    c.flags.push_back(static_cast<std::uint8_t>(below(format_14 ? 16 : 8)));
    c.return_number.push_back(static_cast<std::uint8_t>(below(format_14 ? 16 : 8)));
    c.number_of_returns.push_back(static_cast<std::uint8_t>(below(format_14 ? 16 : 8)));
    for (auto* values : {&c.intensity, &c.source, &c.red, &c.green, &c.blue, &c.nir})
      values->push_back(static_cast<std::uint16_t>(below(65536)));
    c.time.push_back(std::bit_cast<double>((std::uint64_t{random()} << 32U) | random()));
  }
  return c;
}

template <class T>
T at(const std::vector<std::byte>& records, std::size_t place) {
  T value;
  std::memcpy(&value, records.data() + place, sizeof value);
  return value;
}

class LasWriterFormats : public ::testing::TestWithParam<int> {};

TEST_P(LasWriterFormats, ReaderGetsWhatWasWritten) {
  const int format = GetParam();
  const bool is_14 = format >= 6;
  constexpr std::size_t kPoints = 20'000;
  const Cloud cloud = random_cloud(kPoints, is_14, 7U + static_cast<unsigned>(format));
  const std::string path(kPath);
  LasWriterOptions options;
  options.point_format = format;
  options.scale = {0.001, 0.01, 0.0005};
  options.offset = {500000, 6000000, -12.5};
  options.creation_year = 2024;
  LasWriter writer(path, options);
  for (std::size_t from = 0, n = 1; from < kPoints; from += n, n = std::min(kPoints - from, n * 3))
    writer.write(cloud.points(from, n));
  VSIStatBufL stat;
  EXPECT_NE(VSIStatL(path.c_str(), &stat), 0) << "nothing may appear before close";
  writer.close();

  const LasFile file(path);
  const LasHeader& header = file.header();
  EXPECT_EQ(header.point_format, format);
  EXPECT_EQ(header.version_minor, is_14 ? 4 : 2);
  EXPECT_EQ(header.point_count, kPoints);
  EXPECT_EQ(header.scale, options.scale);
  EXPECT_EQ(header.offset, options.offset);
  EXPECT_EQ(header.extra_bytes, 0);
  EXPECT_EQ(header.creation_year, 2024);
  EXPECT_EQ(header.generator, "hydrotin");
  EXPECT_TRUE(header.crs_wkt.empty() && header.warnings.empty());
  EXPECT_EQ(header.min[0], std::numeric_limits<std::int32_t>::min() * options.scale[0] + options.offset[0]);
  EXPECT_EQ(header.max[2], std::numeric_limits<std::int32_t>::max() * options.scale[2] + options.offset[2]);

  PointBatch batch;
  std::vector<std::byte> records;
  ASSERT_EQ(file.num_chunks(), 1U);
  file.decode(0, batch, {.classification = true, .flags = true, .returns = true});
  file.decode_records(0, records);
  EXPECT_EQ(batch.x, cloud.x);
  EXPECT_EQ(batch.y, cloud.y);
  EXPECT_EQ(batch.z, cloud.z);
  EXPECT_EQ(batch.classification, cloud.classification);
  EXPECT_EQ(batch.flags, cloud.flags);
  EXPECT_EQ(batch.return_number, cloud.return_number);
  EXPECT_EQ(batch.number_of_returns, cloud.number_of_returns);
  // Byte places by the tables of the LAS specification.
  const std::size_t length = header.record_length;
  const std::size_t source = is_14 ? 20 : 18, time = is_14 ? 22 : 20;
  const std::size_t rgb = format == 2 ? 20 : format == 3 ? 28 : 30;
  const bool has_time = format != 0 && format != 2, has_rgb = format == 2 || format == 3 || format >= 7;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const std::size_t begin = i * length;
    ASSERT_EQ(at<std::uint16_t>(records, begin + 12), cloud.intensity[i]);
    ASSERT_EQ(at<std::uint16_t>(records, begin + source), cloud.source[i]);
    if (has_time) {
      ASSERT_EQ(at<std::uint64_t>(records, begin + time), std::bit_cast<std::uint64_t>(cloud.time[i]));
    }
    if (has_rgb) {
      ASSERT_EQ(at<std::uint16_t>(records, begin + rgb), cloud.red[i]);
      ASSERT_EQ(at<std::uint16_t>(records, begin + rgb + 2), cloud.green[i]);
      ASSERT_EQ(at<std::uint16_t>(records, begin + rgb + 4), cloud.blue[i]);
    }
    if (format == 8) {
      ASSERT_EQ(at<std::uint16_t>(records, begin + rgb + 6), cloud.nir[i]);
    }
  }
  VSIUnlink(path.c_str());
}

INSTANTIATE_TEST_SUITE_P(All, LasWriterFormats, ::testing::Values(0, 1, 2, 3, 6, 7, 8));

TEST(LasWriter, AbsentFieldsAreZeroAndSingleReturns) {
  for (const int format : {1, 6}) {
    LasWriterOptions options;
    options.point_format = format;
    LasWriter writer(std::string(kPath), options);
    const std::vector<std::int32_t> x{1, 2, 3};
    LasPoints points;
    points.x = points.y = points.z = x;
    writer.write(points);
    writer.write(LasPoints{});
    writer.close();
    PointBatch batch;
    LasFile(std::string(kPath)).decode(0, batch, {.classification = true, .flags = true, .returns = true});
    EXPECT_EQ(batch.z, x);
    EXPECT_EQ(batch.classification, std::vector<std::uint8_t>(3, 0));
    EXPECT_EQ(batch.flags, std::vector<std::uint8_t>(3, 0));
    EXPECT_EQ(batch.return_number, std::vector<std::uint8_t>(3, 1));
    EXPECT_EQ(batch.number_of_returns, std::vector<std::uint8_t>(3, 1));
    VSIUnlink(std::string(kPath).c_str());
  }
}

TEST(LasWriter, KnowsItsCrs) {
  struct Case {
    int format;
    const char* given;
    const char* found;
  };
  for (const Case& c : {Case{1, "EPSG:2154", "EPSG:2154"}, Case{6, "EPSG:2154", "EPSG:2154"},
                        Case{3, "EPSG:4326", "EPSG:4326"}, Case{7, "EPSG:4979", "EPSG:4979"},
                        Case{0, "EPSG:26917+5703", "EPSG:26917"}, Case{6, "EPSG:26917+5703", "EPSG:26917"}}) {
    SCOPED_TRACE(std::string(c.given) + " in format " + std::to_string(c.format));
    LasWriterOptions options;
    options.point_format = c.format;
    options.crs = c.given;
    LasWriter writer(std::string(kPath), options);
    writer.close();
    const LasHeader header = read_las_header(std::string(kPath));
    EXPECT_EQ(header.crs, c.found);
    EXPECT_TRUE(same_crs(crs_from_wkt(header.crs_wkt, "a"), parse_crs(c.given, "crs")));
    EXPECT_FALSE(same_crs(crs_from_wkt(header.crs_wkt, "a"), parse_crs("EPSG:32633", "crs")));
    VSIUnlink(std::string(kPath).c_str());
  }
  // A system that EPSG does not list: WKT says it in LAS 1.4, nothing can in LAS 1.2.
  LasWriterOptions options;
  options.crs = "+proj=lcc +lat_1=10 +lat_2=20 +lat_0=15 +lon_0=3 +datum=WGS84 +units=m";
  LasWriter writer(std::string(kPath), options);
  writer.close();
  const LasHeader header = read_las_header(std::string(kPath));
  EXPECT_EQ(header.crs, header.crs_wkt);
  EXPECT_TRUE(same_crs(crs_from_wkt(header.crs_wkt, "a"), parse_crs(options.crs, "crs")));
  VSIUnlink(std::string(kPath).c_str());
  options.point_format = 1;
  EXPECT_THROW(LasWriter(std::string(kPath), options), Error);
  options.crs = "no such thing";
  EXPECT_THROW(LasWriter(std::string(kPath), options), Error);
}

TEST(LasWriter, SameCallsSameBytes) {
  const auto bytes = [] {
    const auto path = std::filesystem::temp_directory_path() / "hydrotin_las_writer_same.las";
    LasWriterOptions options;
    options.crs = "EPSG:3005";
    LasWriter writer(path.string(), options);
    writer.write(random_cloud(1000, true, 3).points(0, 1000));
    writer.close();
    Bytes all = testing::read_bytes(path.string());
    std::filesystem::remove(path);
    return all;
  };
  const Bytes first = bytes();
  EXPECT_GT(first.size(), 30'000U);
  EXPECT_EQ(first, bytes());
}

TEST(LasWriter, LeavesNothingBehindWhenItFails) {
  const auto folder = std::filesystem::temp_directory_path() / "hydrotin_las_writer";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  const std::string path = (folder / "cloud.las").string();
  const auto num_files = [&] {
    return std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator());
  };
  const std::vector<std::int32_t> one{1};
  LasPoints points;
  points.x = points.y = points.z = one;
  LasWriterOptions options;
  {
    LasWriter writer(path, options);
    writer.write(points);
    EXPECT_EQ(num_files(), 1) << "the file in the making";
  }
  EXPECT_EQ(num_files(), 0);

  {  // an older file stays until the new one is whole
    LasWriter older(path, options);
    older.write(points);
    older.close();
    LasWriter newer(path, options);
    newer.write(points);
    newer.write(points);
    EXPECT_EQ(LasFile(path).header().point_count, 1U);
    newer.close();
    EXPECT_EQ(LasFile(path).header().point_count, 2U);
    EXPECT_THROW(newer.write(points), Error);
    newer.close();
  }
  EXPECT_EQ(num_files(), 1);

  EXPECT_THROW(LasWriter((folder / "no" / "such" / "folder.las").string(), options), Error);
  std::filesystem::create_directories(folder / "taken" / "inside");
  LasWriter blocked((folder / "taken").string(), options);
  EXPECT_THROW(blocked.close(), Error);
  EXPECT_EQ(num_files(), 2);
  std::filesystem::remove_all(folder);
}

TEST(LasWriter, RefusesWhatTheFormatCannotHold) {
  const std::vector<std::int32_t> x{1, 2};
  const std::vector<std::uint8_t> small{1, 2}, big{1, 40}, one{1};
  const auto fails = [&](int format, auto change) {
    LasWriterOptions options;
    options.point_format = format;
    LasWriter writer(std::string(kPath), options);
    LasPoints points;
    points.x = points.y = points.z = x;
    change(points);
    try {
      writer.write(points);
    } catch (const Error& error) {
      return error.kind() == ErrorKind::config;
    }
    return false;
  };
  EXPECT_FALSE(fails(1, [&](LasPoints& p) { p.classification = small; }));
  EXPECT_TRUE(fails(1, [&](LasPoints& p) { p.classification = big; }));
  EXPECT_FALSE(fails(6, [&](LasPoints& p) { p.classification = big; }));
  EXPECT_TRUE(fails(6, [&](LasPoints& p) { p.flags = big; }));
  EXPECT_TRUE(fails(6, [&](LasPoints& p) { p.return_number = big; }));
  EXPECT_TRUE(fails(6, [&](LasPoints& p) { p.classification = one; }));
  EXPECT_TRUE(fails(6, [&](LasPoints& p) { p.z = p.z.first(1); }));
  for (const int format : {-1, 4, 5, 9, 10, 11}) {
    LasWriterOptions options;
    options.point_format = format;
    EXPECT_THROW(LasWriter(std::string(kPath), options), Error) << format;
  }
  LasWriterOptions options;
  options.scale[1] = 0;
  EXPECT_THROW(LasWriter(std::string(kPath), options), Error);
}

}  // namespace
}  // namespace hydrotin
