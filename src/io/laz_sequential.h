#pragma once

#include <cstdint>
#include <mutex>
#include <vector>

#include "las_source.h"
#include "laz_layout.h"
#include "laz_pointwise.h"

// Pointwise LAZ whose chunks can only be found by decoding: streams without chunks, and files whose writer was
// interrupted before the chunk table. Points come one after another; going back starts again at the beginning of the
// last chunk found. Memory is one window of the file.

namespace hydrotin {

class LazSequential {
 public:
  // `begin`: byte of the first chunk; `chunk_size`: points of every chunk but the last.
  LazSequential(const LasSource& source, const LazLayout& layout, std::uint64_t begin, std::uint64_t chunk_size);

  // Held while its owner reads.
  using Turn = std::unique_lock<std::mutex>;

  // Waits for its turn, then goes to a point. Fails with Error when the points before it are damaged.
  [[nodiscard]] Turn seek(std::uint64_t point);
  // Decodes the next `count` records. False: the data are damaged.
  [[nodiscard]] bool read(std::size_t count, std::uint8_t* records);

 private:
  [[nodiscard]] bool read_some(std::size_t count, std::uint8_t* records);
  void fill();

  const LasSource& source_;
  std::size_t record_length_;
  std::uint64_t chunk_size_;
  std::vector<std::uint64_t> chunk_begin_;  // of the chunks found so far
  std::mutex mutex_;
  PointwiseDecoder decoder_;
  std::vector<std::uint8_t> window_;  // the file from window_begin_ to window_end_, and padding
  std::uint64_t window_begin_ = 0, window_end_ = 0;
  std::uint64_t point_ = ~std::uint64_t{0};  // next to decode
};

}  // namespace hydrotin
