#include "store_filters.h"

#include <libdeflate.h>

#include <algorithm>
#include <cassert>
#include <new>

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

namespace {

// Element sizes are constants, so that the loops become vector instructions.
template <std::size_t kElement>
void shuffle(const std::byte* in, std::size_t count, std::byte* out) {
  for (std::size_t j = 0; j < count; ++j)
    for (std::size_t i = 0; i < kElement; ++i) out[i * count + j] = in[j * kElement + i];
}

template <std::size_t kElement>
void unshuffle(const std::byte* in, std::size_t count, std::byte* out) {
  for (std::size_t j = 0; j < count; ++j)
    for (std::size_t i = 0; i < kElement; ++i) out[j * kElement + i] = in[i * count + j];
}

}  // namespace

struct ChunkCodec::Impl {
  static constexpr int kFastest = 1;

  std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor{nullptr,
                                                                                           libdeflate_free_compressor};
  std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> decompressor{
      nullptr, libdeflate_free_decompressor};
  std::vector<std::byte> shuffled;
};

ChunkCodec::ChunkCodec() : impl_(std::make_unique<Impl>()) {}
ChunkCodec::~ChunkCodec() = default;

void ChunkCodec::encode(std::span<const std::byte> bytes, std::size_t element, std::vector<std::byte>& out) {
  assert(element == 1 || element == 4 || element == 8);
  auto& [compressor, unused, shuffled] = *impl_;
  if (!compressor) compressor.reset(libdeflate_alloc_compressor(Impl::kFastest));
  if (!compressor) throw std::bad_alloc();
  const std::byte* stream = bytes.data();
  if (element > 1) {
    shuffled.resize(bytes.size());
    (element == 4 ? shuffle<4> : shuffle<8>)(bytes.data(), bytes.size() / element, shuffled.data());
    stream = shuffled.data();
  }
  out.resize(libdeflate_zlib_compress_bound(compressor.get(), bytes.size()) + 4);
  const std::size_t size = libdeflate_zlib_compress(compressor.get(), stream, bytes.size(), out.data(), out.size() - 4);
  assert(size > 0 && "the bound holds");
  const std::uint32_t sum = fletcher32(std::span(out).first(size));
  for (std::size_t i = 0; i < 4; ++i) out[size + i] = static_cast<std::byte>(sum >> (8 * i));
  out.resize(size + 4);
}

bool ChunkCodec::decode(std::span<const std::byte> encoded, std::size_t element, std::span<std::byte> out) {
  assert(element == 1 || element == 4 || element == 8);
  if (encoded.size() < 4) return false;
  const auto stream = encoded.first(encoded.size() - 4);
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < 4; ++i) sum |= std::to_integer<std::uint32_t>(encoded[stream.size() + i]) << (8 * i);
  if (sum != fletcher32(stream)) return false;
  auto& [unused, decompressor, shuffled] = *impl_;
  if (!decompressor) decompressor.reset(libdeflate_alloc_decompressor());
  if (!decompressor) throw std::bad_alloc();
  std::byte* target = out.data();
  if (element > 1) {
    shuffled.resize(out.size());
    target = shuffled.data();
  }
  // Without a place for the actual size, any other than that of the chunk is a failure.
  if (libdeflate_zlib_decompress(decompressor.get(), stream.data(), stream.size(), target, out.size(), nullptr) !=
      LIBDEFLATE_SUCCESS)
    return false;
  if (element > 1) (element == 4 ? unshuffle<4> : unshuffle<8>)(shuffled.data(), out.size() / element, out.data());
  return true;
}

}  // namespace hydrotin::store
