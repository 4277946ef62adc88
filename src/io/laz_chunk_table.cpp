#include "laz_chunk_table.h"

#include <algorithm>
#include <array>

#include "hydrotin/error.h"
#include "las_bytes.h"
#include "laz_coder.h"
#include "laz_layered.h"

namespace hydrotin {
namespace {

[[noreturn]] void fail(const LasSource& source, const std::string& what) {
  throw Error(ErrorKind::input, source.path() + ": " + what + " (the file is damaged or cut off: get it again)");
}

std::uint64_t read_u64(const LasSource& source, std::uint64_t at) {
  std::array<std::uint8_t, 8> bytes;
  source.read(at, bytes.data(), bytes.size());
  return load<std::uint64_t>(bytes.data());
}

// Layered chunks tell their length: a missing table can be made again by walking from head to head.
std::vector<LazChunk> walk_layered(const LasSource& source, const LasHeader& header, const LazLayout& layout,
                                   std::uint64_t at) {
  std::vector<LazChunk> chunks;
  std::vector<std::uint8_t> head(LayeredDecoder::head_bytes(layout));
  std::uint64_t point = 0;
  while (point < header.point_count) {
    chunks.push_back({at, point});
    std::uint64_t count = 0, bytes = head.size();
    if (at <= source.size() && source.size() - at >= head.size()) {
      source.read(at, head.data(), head.size());
      count = load<std::uint32_t>(head.data() + layout.record_length);
      for (std::size_t i = layout.record_length + 4; i < head.size(); i += 4)
        bytes += load<std::uint32_t>(head.data() + i);
    }
    if (count == 0 || count > header.point_count - point || bytes > source.size() - at)
      fail(source, "declares " + std::to_string(header.point_count) + " points, but its LAZ chunks end after " +
                       std::to_string(point) + ", and it has no chunk table");
    point += count;
    at += bytes;
  }
  chunks.push_back({at, point});
  return chunks;
}

struct Counted {
  std::uint32_t points, bytes;
};

std::vector<Counted> decode_table(const LasSource& source, std::uint64_t at, std::uint32_t num, bool variable) {
  constexpr std::size_t kPadding = 64, kEntryBytes = 24, kBlock = 1 << 16;
  std::vector<std::uint8_t> bytes(
      static_cast<std::size_t>(std::min<std::uint64_t>(source.size() - at, std::uint64_t{num} * kEntryBytes + 8)));
  source.read(at, bytes.data(), bytes.size());
  const std::size_t present = bytes.size();
  bytes.resize(present + kPadding);
  ArithmeticDecoder decoder;
  decoder.start(bytes.data(), bytes.data() + present);
  IntegerDecoder<32> integers(2);
  std::vector<Counted> table;
  table.reserve(std::min<std::size_t>(num, kBlock));
  Counted last{0, 0};
  for (std::uint32_t i = 0; i < num; ++i) {
    if (variable) last.points = integers.decode(decoder, last.points, 0);
    last.bytes = integers.decode(decoder, last.bytes, 1);
    if (decoder.overran()) fail(source, "its LAZ chunk table breaks off at entry " + std::to_string(i + 1));
    table.push_back(last);
  }
  return table;
}

}  // namespace

std::optional<std::vector<LazChunk>> read_chunk_table(const LasSource& source, const LasHeader& header,
                                                      const LazLayout& layout) {
  if (header.point_count == 0) return std::vector<LazChunk>{{header.offset_to_points, 0}};
  if (layout.compressor == LazCompressor::pointwise) return std::nullopt;
  const std::uint64_t begin = header.offset_to_points + 8;
  if (begin > source.size())
    fail(source, "declares " + std::to_string(header.point_count) + " points, but ends before the first of them");
  std::uint64_t table_at = read_u64(source, header.offset_to_points);
  if (table_at == ~std::uint64_t{0}) {  // a writer that could not go back put the place at the end
    if (source.size() < begin + 8) fail(source, "ends before its LAZ chunk table");
    table_at = read_u64(source, source.size() - 8);
  }
  const bool variable = layout.chunk_size == kVariableChunks;
  if (table_at == header.offset_to_points) {
    if (layout.compressor == LazCompressor::layered_chunked) return walk_layered(source, header, layout, begin);
    if (variable) fail(source, "has LAZ chunks of various sizes, but its writer was interrupted before it said which");
    return std::nullopt;
  }
  if (table_at < begin || table_at > source.size() || source.size() - table_at < 8)
    fail(source, "declares " + std::to_string(header.point_count) +
                     " points, but its LAZ chunk table should be at byte " + std::to_string(table_at) +
                     " and it has only " + std::to_string(source.size()) + " bytes");

  std::array<std::uint8_t, 8> head;
  source.read(table_at, head.data(), head.size());
  const auto version = load<std::uint32_t>(head.data()), num = load<std::uint32_t>(head.data() + 4);
  if (version != 0) fail(source, "its LAZ chunk table has the unknown version " + std::to_string(version));
  if (num > (table_at - begin) / layout.record_length)
    fail(source, "its LAZ chunk table claims " + std::to_string(num) + " chunks, more than fit into the " +
                     std::to_string(table_at - begin) + " bytes before it");

  std::vector<LazChunk> chunks;
  std::uint64_t at = begin, point = 0;
  std::uint32_t index = 0;
  for (const Counted& entry : decode_table(source, table_at + 8, num, variable)) {
    ++index;
    const std::uint64_t left = header.point_count - point;
    const std::uint64_t points = variable ? entry.points : std::min<std::uint64_t>(layout.chunk_size, left);
    if (points > left || entry.bytes > table_at - at || (points > 0 && entry.bytes < layout.record_length))
      fail(source, "entry " + std::to_string(index) + " of its LAZ chunk table (" + std::to_string(points) +
                       " points in " + std::to_string(entry.bytes) + " bytes) does not fit the file");
    if (points > 0) chunks.push_back({at, point});
    at += entry.bytes;
    point += points;
  }
  if (point != header.point_count)
    fail(source, "declares " + std::to_string(header.point_count) + " points, but its LAZ chunk table counts " +
                     std::to_string(point));
  chunks.push_back({at, point});
  return chunks;
}

}  // namespace hydrotin
