#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "laz_layout.h"

// Pointwise LAZ: the items of a point follow each other in one stream; the first point of a chunk is stored as it is.

namespace hydrotin {

// A decoder and its models: large, so made once and used for many chunks.
class PointwiseDecoder {
 public:
  // Bytes a point can take at most, however damaged the data.
  [[nodiscard]] static std::size_t max_point_bytes(std::size_t record_length) { return 512 + 3 * record_length; }
  // Points between two looks at the end of the data.
  static constexpr std::size_t kPointsPerCheck = 64;
  // Readable bytes wanted behind the end of a chunk.
  [[nodiscard]] static std::size_t padding(std::size_t record_length) {
    return kPointsPerCheck * max_point_bytes(record_length);
  }

  explicit PointwiseDecoder(const LazLayout& layout);
  ~PointwiseDecoder();
  PointwiseDecoder(const PointwiseDecoder&) = delete;
  PointwiseDecoder& operator=(const PointwiseDecoder&) = delete;

  // Begins a chunk at `data`. False: it is too short.
  [[nodiscard]] bool start(const std::uint8_t* data, const std::uint8_t* end);
  // Decodes the next `count` records. False: the data are damaged, the records worthless.
  [[nodiscard]] bool read(std::size_t count, std::uint8_t* records);
  // Where the stream goes on; after a chunk's last point, its end.
  [[nodiscard]] const std::uint8_t* next() const;
  void rebase(const std::uint8_t* next, const std::uint8_t* end);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace hydrotin
