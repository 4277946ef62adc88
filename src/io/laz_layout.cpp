#include "laz_layout.h"

#include "hydrotin/error.h"
#include "las_bytes.h"
#include "las_header.h"

namespace hydrotin {
namespace {

struct Wanted {
  LazItemKind kind;
  std::uint16_t size;
};

// The items that make up a record of the format, in order.
std::vector<Wanted> items_of(const LasHeader& header) {
  using enum LazItemKind;
  const int format = header.point_format;
  std::vector<Wanted> items;
  if (format <= 5) {
    items.push_back({point10, 20});
    if (format != 0 && format != 2) items.push_back({gpstime11, 8});
    if (format == 2 || format == 3 || format == 5) items.push_back({rgb12, 6});
    if (format >= 4) items.push_back({wavepacket13, 29});
  } else {
    items.push_back({point14, 30});
    if (format == 7) items.push_back({rgb14, 6});
    if (format == 8 || format == 10) items.push_back({rgbnir14, 8});
    if (format >= 9) items.push_back({wavepacket14, 29});
  }
  if (header.extra_bytes > 0) items.push_back({format <= 5 ? byte : byte14, header.extra_bytes});
  return items;
}

std::string name_of(std::uint16_t kind) {
  switch (static_cast<LazItemKind>(kind)) {
    case LazItemKind::byte:
      return "BYTE";
    case LazItemKind::point10:
      return "POINT10";
    case LazItemKind::gpstime11:
      return "GPSTIME11";
    case LazItemKind::rgb12:
      return "RGB12";
    case LazItemKind::wavepacket13:
      return "WAVEPACKET13";
    case LazItemKind::point14:
      return "POINT14";
    case LazItemKind::rgb14:
      return "RGB14";
    case LazItemKind::rgbnir14:
      return "RGBNIR14";
    case LazItemKind::wavepacket14:
      return "WAVEPACKET14";
    case LazItemKind::byte14:
      return "BYTE14";
  }
  return "type " + std::to_string(kind);
}

// Version 2 of the layered items is what an early prototype called version 3.
bool known_version(LazItemKind kind, std::uint16_t version) {
  switch (kind) {
    case LazItemKind::wavepacket13:
      return version == 1;
    case LazItemKind::byte:
    case LazItemKind::point10:
    case LazItemKind::gpstime11:
    case LazItemKind::rgb12:
      return version == 1 || version == 2;
    case LazItemKind::wavepacket14:
      return version == 3 || version == 4;
    default:
      return version >= 2 && version <= 4;
  }
}

}  // namespace

std::string compressor_name(std::uint16_t compressor) {
  switch (compressor) {
    case 0:
      return "none";
    case 1:
      return "pointwise";
    case 2:
      return "pointwise chunked";
    case 3:
      return "layered chunked";
    default:
      return "unknown (" + std::to_string(compressor) + ")";
  }
}

LazLayout parse_laszip(std::span<const std::uint8_t> payload, const LasHeader& header, const std::string& path) {
  const auto fail = [&](const std::string& what) {
    throw Error(ErrorKind::input, path + ": " + what + " (damaged, or written by a newer LASzip: convert it to LAS)");
  };
  constexpr std::size_t kHead = 34, kItem = 6;
  if (payload.empty()) fail("says it is compressed, but has no laszip record");
  if (payload.size() < kHead) fail("its laszip record is too short");
  const std::uint8_t* const b = payload.data();
  const auto compressor = load<std::uint16_t>(b);
  const auto coder = load<std::uint16_t>(b + 2);
  const std::size_t num_items = load<std::uint16_t>(b + 32);
  if (compressor < 1 || compressor > 3) fail("LAZ compressor " + std::to_string(compressor) + " is unknown");
  if (coder != 0) fail("LAZ coder " + std::to_string(coder) + " is unknown");
  if (payload.size() < kHead + num_items * kItem) fail("its laszip record is shorter than its list of items");

  LazLayout layout;
  layout.compressor = static_cast<LazCompressor>(compressor);
  layout.record_length = header.record_length;
  layout.chunk_size = load<std::uint32_t>(b + 12);
  if (layout.chunk_size == 0) layout.chunk_size = kVariableChunks;
  if (layout.compressor == LazCompressor::pointwise) layout.chunk_size = kVariableChunks;
  if ((layout.compressor == LazCompressor::layered_chunked) != (header.point_format >= 6))
    fail("point format " + std::to_string(header.point_format) + " cannot be compressed " +
         compressor_name(compressor));

  const std::vector<Wanted> wanted = items_of(header);
  if (num_items != wanted.size())
    fail("its laszip record lists " + std::to_string(num_items) + " items, but its points have " +
         std::to_string(wanted.size()));
  std::uint16_t begin = 0;
  for (std::size_t i = 0; i < num_items; ++i) {
    const std::uint8_t* const at = b + kHead + i * kItem;
    const auto kind = load<std::uint16_t>(at), size = load<std::uint16_t>(at + 2),
               version = load<std::uint16_t>(at + 4);
    if (kind != static_cast<std::uint16_t>(wanted[i].kind) || size != wanted[i].size)
      fail("LAZ item " + std::to_string(i + 1) + " is of " + name_of(kind) + " and " + std::to_string(size) +
           " bytes, but its points need " + name_of(static_cast<std::uint16_t>(wanted[i].kind)) + " of " +
           std::to_string(wanted[i].size) + " bytes");
    if (!known_version(wanted[i].kind, version))
      fail("LAZ item " + name_of(kind) + " in version " + std::to_string(version) + " cannot be read");
    layout.items.push_back({wanted[i].kind, size, version, begin});
    begin = static_cast<std::uint16_t>(begin + size);
  }
  return layout;
}

}  // namespace hydrotin
