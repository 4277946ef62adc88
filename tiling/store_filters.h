#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

/// The HDF5 filter pipeline shuffle, deflate, Fletcher-32, outside the library.

namespace hydrotin::store {

/// The bytes of one chunk as the pipeline would write them. @param bytes whole elements of `element` bytes
void encode_chunk(std::span<const std::byte> bytes, std::size_t element, std::vector<std::byte>& out);

/// Undoes `encode_chunk`; false if the checksum or the stream is wrong. `out` has the size of a chunk.
[[nodiscard]] bool decode_chunk(std::span<const std::byte> encoded, std::size_t element, std::span<std::byte> out);

/// The checksum of the HDF5 file format.
[[nodiscard]] std::uint32_t fletcher32(std::span<const std::byte> bytes);

}  // namespace hydrotin::store
