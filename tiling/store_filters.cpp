#include "store_filters.h"

#include <zlib.h>

#include <algorithm>
#include <array>

namespace hydrotin::store {

std::uint32_t fletcher32(std::span<const std::byte> bytes) {
  std::uint32_t sum1 = 0, sum2 = 0;
  const auto fold = [](std::uint32_t s) { return (s & 0xffffU) + (s >> 16U); };
  const std::size_t words = bytes.size() / 2;
  constexpr std::size_t kNoOverflow = 360;  // words that can be added before sum2 overflows
  for (std::size_t i = 0; i < words;) {
    for (const std::size_t end = std::min(words, i + kNoOverflow); i < end; ++i) {
      sum1 += std::to_integer<std::uint32_t>(bytes[2 * i]) << 8U | std::to_integer<std::uint32_t>(bytes[2 * i + 1]);
      sum2 += sum1;
    }
    sum1 = fold(sum1);
    sum2 = fold(sum2);
  }
  if (bytes.size() % 2 != 0) {
    sum1 += std::to_integer<std::uint32_t>(bytes.back()) << 8U;
    sum2 += sum1;
    sum1 = fold(sum1);
    sum2 = fold(sum2);
  }
  return fold(sum2) << 16U | fold(sum1);
}

void encode_chunk(std::span<const std::byte> bytes, std::size_t element, std::vector<std::byte>& out) {
  const std::size_t count = bytes.size() / element;
  std::vector<std::byte> shuffled(bytes.size());
  for (std::size_t i = 0; i < element; ++i)
    for (std::size_t j = 0; j < count; ++j) shuffled[i * count + j] = bytes[j * element + i];
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  out.resize(size + 4);
  compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(shuffled.data()),
            static_cast<uLong>(shuffled.size()), Z_BEST_SPEED);
  const std::uint32_t sum = fletcher32(std::span(out).first(size));
  for (std::size_t i = 0; i < 4; ++i) out[size + i] = static_cast<std::byte>(sum >> (8 * i));
  out.resize(size + 4);
}

bool decode_chunk(std::span<const std::byte> encoded, std::size_t element, std::span<std::byte> out) {
  if (encoded.size() < 4) return false;
  const auto stream = encoded.first(encoded.size() - 4);
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < 4; ++i) sum |= std::to_integer<std::uint32_t>(encoded[stream.size() + i]) << (8 * i);
  if (sum != fletcher32(stream)) return false;
  std::vector<std::byte> shuffled(out.size());
  uLongf size = static_cast<uLongf>(shuffled.size());
  if (uncompress(reinterpret_cast<Bytef*>(shuffled.data()), &size, reinterpret_cast<const Bytef*>(stream.data()),
                 static_cast<uLong>(stream.size())) != Z_OK ||
      size != shuffled.size())
    return false;
  const std::size_t count = out.size() / element;
  for (std::size_t i = 0; i < element; ++i)
    for (std::size_t j = 0; j < count; ++j) out[j * element + i] = shuffled[i * count + j];
  return true;
}

}  // namespace hydrotin::store
