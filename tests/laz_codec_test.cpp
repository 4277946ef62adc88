#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "hydrotin/error.h"
#include "hydrotin/las.h"
#include "las_decoding.h"
#include "las_header_bytes.h"
#include "las_memory_file.h"
#include "laz_encoder.h"

// Items that no real file at hand has: wave packets, colours and extra bytes of version 1, chunks of various sizes.
// They are encoded here, on points that otherwise never change.

namespace hydrotin {
namespace {

using testing::Bytes;
using testing::las_header_bytes;
using testing::MemoryFile;
using testing::peek;
using testing::poke;
using testing::SlowEncoder;
using testing::SlowInteger;
using testing::SlowModel;

constexpr std::size_t kWavepacket = 29;

struct Item {
  std::uint16_t type, size, version;
};

Bytes laz_head(int format, std::uint64_t points, std::uint16_t compressor, std::uint32_t chunk_size,
               const std::vector<Item>& items) {
  std::uint16_t record_length = 0;
  for (const Item& item : items) record_length = static_cast<std::uint16_t>(record_length + item.size);
  Bytes vlr(54 + 34 + 6 * items.size(), 0);
  const std::string user = "laszip encoded";
  std::copy(user.begin(), user.end(), vlr.begin() + 2);
  poke<std::uint16_t>(vlr, 18, 22204);
  poke(vlr, 20, static_cast<std::uint16_t>(vlr.size() - 54));
  poke(vlr, 54, compressor);
  poke(vlr, 54 + 12, chunk_size);
  poke(vlr, 54 + 32, static_cast<std::uint16_t>(items.size()));
  for (std::size_t i = 0; i < items.size(); ++i) {
    poke(vlr, 88 + 6 * i, items[i].type);
    poke(vlr, 90 + 6 * i, items[i].size);
    poke(vlr, 92 + 6 * i, items[i].version);
  }
  Bytes file = las_header_bytes(format >= 6 ? 4 : 2, format, record_length, points);
  poke(file, 96, static_cast<std::uint32_t>(file.size() + vlr.size()));
  poke(file, 100, std::uint32_t{1});
  file[104] |= 0x80;
  file.insert(file.end(), vlr.begin(), vlr.end());
  return file;
}

void append(Bytes& to, const Bytes& more) {
  to.insert(to.end(), more.begin(), more.end());
}

// Puts chunks and their table behind the head.
Bytes with_chunks(Bytes file, const std::vector<Bytes>& chunks, const std::vector<std::uint32_t>& counts) {
  const std::size_t place = file.size();
  file.resize(place + 8);
  for (const Bytes& chunk : chunks) append(file, chunk);
  poke(file, place, std::uint64_t{file.size()});
  const std::size_t table = file.size();
  file.resize(table + 8, 0);
  poke(file, table + 4, static_cast<std::uint32_t>(chunks.size()));
  SlowEncoder encoder;
  SlowInteger integers(32, 2);
  std::uint32_t last_count = 0, last_bytes = 0;
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    if (!counts.empty()) {
      integers.encode(encoder, last_count, counts[i], 0);
      last_count = counts[i];
    }
    const auto bytes = static_cast<std::uint32_t>(chunks[i].size());
    integers.encode(encoder, last_bytes, bytes, 1);
    last_bytes = bytes;
  }
  append(file, encoder.done());
  return file;
}

Bytes records_of(const Bytes& bytes) {
  const MemoryFile memory("hydrotin_codec.laz", bytes);
  const auto all = testing::all_records(LasFile(memory.path()));
  const auto* const begin = reinterpret_cast<const std::uint8_t*>(all.data());
  return {begin, begin + all.size()};
}

// Wave packets with every way in which the offset may go on.
Bytes random_packets(std::size_t n, unsigned seed) {
  std::mt19937 random(seed);
  Bytes all(n * kWavepacket, 0);
  std::uint64_t offset = 60;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t at = i * kWavepacket;
    const std::uint32_t last_size = i > 0 ? peek<std::uint32_t>(all, at - kWavepacket + 9) : 0;
    switch (random() % 5) {
      case 0:
        break;
      case 1:
        offset += last_size;
        break;
      case 2:
        offset += 100 + random() % 50;
        break;
      case 3:
        offset -= random() % 2'000'000'000U;
        break;
      default:
        offset = (std::uint64_t{random()} << 32U) | static_cast<std::uint32_t>(random());
    }
    all[at] = static_cast<std::uint8_t>(random());
    poke(all, at + 1, offset);
    poke(all, at + 9, static_cast<std::uint32_t>(random() % 3 == 0 ? random() : 128));
    for (std::size_t f = 0; f < 4; ++f) poke(all, at + 13 + 4 * f, static_cast<float>(random() % 1000) * 0.25F);
  }
  return all;
}

struct PacketEncoder {
  SlowModel index{256};
  std::vector<SlowModel> kind = std::vector<SlowModel>(4, SlowModel(4));
  SlowInteger step{32}, size{32}, location{32}, direction{32, 3};
  std::uint32_t last_kind = 0, last_step = 0;

  void encode(SlowEncoder& to, const Bytes& packets, std::size_t i) {
    const std::size_t now = i * kWavepacket, last = now - kWavepacket;
    to.symbol(index, packets[now]);
    const auto difference = peek<std::uint64_t>(packets, now + 1) - peek<std::uint64_t>(packets, last + 1);
    const auto small = static_cast<std::int32_t>(static_cast<std::uint32_t>(difference));
    const std::uint32_t way = difference == 0                                                 ? 0
                              : difference == peek<std::uint32_t>(packets, last + 9)          ? 1
                              : difference == static_cast<std::uint64_t>(std::int64_t{small}) ? 2
                                                                                              : 3;
    to.symbol(kind[last_kind], way);
    last_kind = way;
    if (way == 2) {
      step.encode(to, last_step, static_cast<std::uint32_t>(small));
      last_step = static_cast<std::uint32_t>(small);
    }
    if (way == 3) {
      to.bits(32, peek<std::uint32_t>(packets, now + 1));
      to.bits(32, peek<std::uint32_t>(packets, now + 5));
    }
    const auto word = [&](SlowInteger& integer, std::size_t at, std::size_t context) {
      integer.encode(to, peek<std::uint32_t>(packets, last + at), peek<std::uint32_t>(packets, now + at), context);
    };
    word(size, 9, 0);
    word(location, 13, 0);
    for (std::size_t axis = 0; axis < 3; ++axis) word(direction, 17 + 4 * axis, axis);
  }
};

// POINT10 and GPSTIME11 that stay as they are; in version 1 position comes first, in version 2 what has changed.
struct ConstantPoint10 {
  bool v1;
  SlowModel changed{64}, time{v1 ? 3U : 6U};
  SlowInteger dx{32, v1 ? 1U : 2U}, dy{32, v1 ? 20U : 22U}, z{32, 20};
  std::uint32_t last_z = 0;  // version 2 begins with height 0

  void encode(SlowEncoder& to, std::uint32_t height, bool has_time) {
    if (!v1) to.symbol(changed, 0);
    dx.encode(to, 0, 0);
    dy.encode(to, 0, 0);
    // The magnitude classes of dx and dy are 0, and there is not one return: context 0.
    z.encode(to, v1 ? height : last_z, height);
    last_z = height;
    if (v1) to.symbol(changed, 0);
    if (has_time) to.symbol(time, 0);
  }
};

void put(Bytes& record, std::size_t at, const Bytes& from, std::size_t begin, std::size_t n) {
  std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(begin), n, record.begin() + static_cast<std::ptrdiff_t>(at));
}

TEST(LazCodec, WavepacketsPointwise) {
  constexpr std::size_t kPoints = 3000, kLength = 57;
  for (const std::uint16_t version : {std::uint16_t{1}, std::uint16_t{2}}) {
    const Bytes packets = random_packets(kPoints, version);
    Bytes first(kLength, 0);
    poke(first, 8, std::int32_t{1234});
    Bytes expected;
    SlowEncoder encoder;
    ConstantPoint10 point{.v1 = version == 1};
    PacketEncoder packet;
    for (std::size_t i = 0; i < kPoints; ++i) {
      Bytes record = first;
      put(record, 28, packets, i * kWavepacket, kWavepacket);
      append(expected, record);
      if (i == 0) continue;
      point.encode(encoder, 1234, true);
      packet.encode(encoder, packets, i);
    }
    Bytes stream(expected.begin(), expected.begin() + kLength);
    append(stream, encoder.done());
    const std::vector<Item> items{{6, 20, version}, {7, 8, version}, {9, 29, 1}};
    Bytes whole = laz_head(4, kPoints, 1, 0, items);
    append(whole, stream);
    EXPECT_EQ(records_of(whole), expected) << "in one stream, version " << version;
    EXPECT_EQ(records_of(with_chunks(laz_head(4, kPoints, 2, 50000, items), {stream}, {})), expected);
  }
}

TEST(LazCodec, ColoursAndExtraBytesOfVersion1) {
  constexpr std::size_t kPoints = 4000, kExtra = 3, kLength = 26 + kExtra;
  std::mt19937 random(5);
  Bytes last(kLength, 0), expected;
  poke(last, 8, std::int32_t{-77});
  SlowEncoder encoder;
  ConstantPoint10 point{.v1 = true};
  SlowModel used(64);
  SlowInteger colour(8, 6), extra(8, kExtra);
  for (std::size_t i = 0; i < kPoints; ++i) {
    Bytes record = last;
    for (std::size_t b = 20; b < kLength; ++b)
      if (random() % 3 == 0) record[b] = static_cast<std::uint8_t>(random() % 2 == 0 ? random() : record[b] + 1U);
    append(expected, record);
    if (i > 0) {
      point.encode(encoder, static_cast<std::uint32_t>(-77), false);
      std::uint32_t mask = 0;
      for (std::uint32_t b = 0; b < 6; ++b) mask |= (record[20 + b] != last[20 + b] ? 1U : 0U) << b;
      encoder.symbol(used, mask);
      for (std::size_t b = 0; b < 6; ++b)
        if ((mask >> b & 1U) != 0) colour.encode(encoder, last[20 + b], record[20 + b], b);
      for (std::size_t b = 0; b < kExtra; ++b) extra.encode(encoder, last[26 + b], record[26 + b], b);
    }
    last = record;
  }
  Bytes stream(expected.begin(), expected.begin() + kLength);
  append(stream, encoder.done());
  const std::vector<Item> items{{6, 20, 1}, {8, 6, 1}, {0, kExtra, 1}};
  Bytes whole = laz_head(2, kPoints, 1, 0, items);
  append(whole, stream);
  EXPECT_EQ(records_of(whole), expected);
  EXPECT_EQ(records_of(with_chunks(laz_head(2, kPoints, 2, 50000, items), {stream}, {})), expected);
}

// One layered chunk of points that do not move, with wave packets. Version 4 differs only when channels change.
Bytes layered_chunk(const Bytes& first, const Bytes& packets, std::size_t from, std::size_t n) {
  SlowEncoder xy, wave;
  // r = 1 of n = 1 is a single return (first and last); the time does not change.
  SlowModel changed(128);
  SlowInteger dx(32, 2), dy(32, 22);
  PacketEncoder packet;
  for (std::size_t i = from + 1; i < from + n; ++i) {
    xy.symbol(changed, 0);
    dx.encode(xy, 0, 0, 1);
    dy.encode(xy, 0, 0, 1);
    packet.encode(wave, packets, i);
  }
  const Bytes xy_bytes = xy.done(), wave_bytes = wave.done();
  Bytes chunk = first;
  put(chunk, 30, packets, from * kWavepacket, kWavepacket);
  const std::size_t head = chunk.size();
  chunk.resize(head + 4 + 4 * 10, 0);
  poke(chunk, head, static_cast<std::uint32_t>(n));
  poke(chunk, head + 4, static_cast<std::uint32_t>(xy_bytes.size()));
  poke(chunk, head + 4 + 4 * 9, static_cast<std::uint32_t>(wave_bytes.size()));
  append(chunk, xy_bytes);
  append(chunk, wave_bytes);
  return chunk;
}

TEST(LazCodec, WavepacketsLayeredInChunksOfVariousSizes) {
  constexpr std::size_t kLength = 59;
  const std::vector<std::uint32_t> counts{1, 700, 2, 1297, 1000};
  constexpr std::size_t kPoints = 3000;
  const Bytes packets = random_packets(kPoints, 17);
  Bytes first(kLength, 0);
  poke(first, 0, std::int32_t{-5});
  first[14] = 0x11;
  first[16] = 200;
  Bytes expected;
  for (std::size_t i = 0; i < kPoints; ++i) {
    append(expected, first);
    put(expected, i * kLength + 30, packets, i * kWavepacket, kWavepacket);
  }
  std::vector<Bytes> chunks;
  std::size_t from = 0;
  for (const std::uint32_t n : counts) {
    chunks.push_back(layered_chunk(first, packets, from, n));
    from += n;
  }
  for (const std::uint16_t version : {std::uint16_t{3}, std::uint16_t{4}}) {
    const Bytes file =
        with_chunks(laz_head(9, kPoints, 3, 0xFFFFFFFFU, {{10, 30, version}, {13, 29, version}}), chunks, counts);
    EXPECT_EQ(records_of(file), expected);
    const MemoryFile memory("hydrotin_various.laz", file);
    const LasFile las(memory.path());
    ASSERT_EQ(las.num_chunks(), counts.size());
    for (std::size_t i = 0; i < counts.size(); ++i) EXPECT_EQ(las.chunk_point_count(i), counts[i]);
  }
  // Counts that do not add up are refused.
  std::vector<std::uint32_t> wrong = counts;
  ++wrong[1];
  EXPECT_THROW(records_of(with_chunks(laz_head(9, kPoints, 3, 0xFFFFFFFFU, {{10, 30, 3}, {13, 29, 3}}), chunks, wrong)),
               Error);
  --wrong[3];
  EXPECT_THROW(records_of(with_chunks(laz_head(9, kPoints, 3, 0xFFFFFFFFU, {{10, 30, 3}, {13, 29, 3}}), chunks, wrong)),
               Error);
}

TEST(LazCodec, NoPointsAtAll) {
  EXPECT_TRUE(records_of(laz_head(1, 0, 2, 50000, {{6, 20, 2}, {7, 8, 2}})).empty());
  EXPECT_TRUE(records_of(with_chunks(laz_head(6, 0, 3, 50000, {{10, 30, 3}}), {}, {})).empty());
  EXPECT_TRUE(records_of(laz_head(1, 0, 1, 0, {{6, 20, 1}, {7, 8, 1}})).empty());
}

// A stream that goes on costs almost nothing: many points from few bytes, and only as much memory as there are points.
TEST(LazCodec, ManyPointsFromFewBytes) {
  constexpr std::uint32_t kPoints = 300'000;
  Bytes first(20, 0);
  SlowEncoder encoder;
  ConstantPoint10 point{.v1 = false};
  for (std::uint32_t i = 1; i < kPoints; ++i) point.encode(encoder, 0, false);
  Bytes stream = first;
  append(stream, encoder.done());
  EXPECT_LT(stream.size(), 4000U);
  const Bytes file = with_chunks(laz_head(0, kPoints, 2, 0x7FFFFFFFU, {{6, 20, 2}}), {stream}, {});
  EXPECT_EQ(records_of(file), Bytes(std::size_t{kPoints} * 20, 0));
}

// The same for records as long as they can be: 50,000 of them are claimed, 3 GB, but their stream ends soon.
TEST(LazCodec, LongRecordsTakeMemoryAsTheyAreDecoded) {
  constexpr std::uint16_t kLength = 65535;
  Bytes stream(kLength, 0);
  append(stream, Bytes(100, 7));
  const Bytes file = with_chunks(laz_head(0, 50'000, 2, 50'000, {{6, 20, 2}, {0, kLength - 20, 2}}), {stream}, {});
  const MemoryFile memory("hydrotin_long.laz", file);
  const LasFile las(memory.path());
  std::vector<std::byte> records;
  EXPECT_THROW(las.decode_records(0, records), Error);
  EXPECT_LT(records.capacity(), std::size_t{64} << 20U);
  PointBatch batch;
  EXPECT_THROW(las.decode(0, batch), Error);
}

}  // namespace
}  // namespace hydrotin
