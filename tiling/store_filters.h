#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

/// The HDF5 filter pipeline shuffle, deflate, Fletcher-32, outside the library.
///
/// Threads  One object by one thread at a time.
/// Errors   std::bad_alloc.

namespace hydrotin::store {

/// Runs the pipeline over chunks; keeps its working memory from one to the next.
class ChunkCodec {
 public:
  ChunkCodec();
  ~ChunkCodec();

  /// The bytes of one chunk as the pipeline would write them. @param bytes whole elements of 1, 4 or 8 bytes
  void encode(std::span<const std::byte> bytes, std::size_t element, std::vector<std::byte>& out);

  /// Undoes `encode`; false if the checksum or the stream is wrong. `out` has the size of a chunk.
  [[nodiscard]] bool decode(std::span<const std::byte> encoded, std::size_t element, std::span<std::byte> out);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The checksum of the HDF5 file format.
[[nodiscard]] std::uint32_t fletcher32(std::span<const std::byte> bytes);

}  // namespace hydrotin::store
