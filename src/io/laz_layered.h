#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "laz_layout.h"

// Layered LAZ: after the first point, stored as it is, come the number of points, the bytes of each layer, and the
// layers. A layer is a stream of its own, so those of fields nobody asked for are skipped.

namespace hydrotin {

class LayeredDecoder {
 public:
  static constexpr std::size_t kPointsPerCheck = 64;
  // Readable bytes wanted behind the end of a chunk: no layer takes more between two looks at its end.
  static constexpr std::size_t kPadding = kPointsPerCheck * 256;

  // Bytes of a chunk before its layers, and how many layers it has.
  [[nodiscard]] static std::size_t num_layers(const LazLayout& layout);
  [[nodiscard]] static std::size_t head_bytes(const LazLayout& layout);
  // Bytes of a chunk, from its head on, that hold all layers of x, y, z, class and flags: they come first.
  [[nodiscard]] static std::uint64_t front_bytes(const LazLayout& layout, const std::uint8_t* head);

  explicit LayeredDecoder(const LazLayout& layout);
  ~LayeredDecoder();
  LayeredDecoder(const LayeredDecoder&) = delete;
  LayeredDecoder& operator=(const LayeredDecoder&) = delete;

  // Begins a chunk of `count` points; `fields` besides x, y, z and returns, or all of the record. Without the whole
  // records only the front of the chunk is looked at. False: it is damaged.
  [[nodiscard]] bool start(const std::uint8_t* data, const std::uint8_t* end, std::uint64_t count, PointFields fields,
                           bool whole_records);
  // Decodes the next `count` records; what was not asked for keeps some older value. False: the data are damaged.
  [[nodiscard]] bool read(std::size_t count, std::uint8_t* records);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace hydrotin
