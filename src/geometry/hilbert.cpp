#include "hydrotin/hilbert.h"

#include <array>

namespace hydrotin {
namespace {

// The curve visits the four quadrants of a cell in an order that depends on its orientation: 0 as drawn, 1 mirrored at
// the main diagonal, 2 mirrored at the other one, 3 turned by 180 degrees. Four levels (8 bits of the key) per step.
struct Step {
  std::uint8_t digits, orientation;
};

constexpr Step one_level(unsigned orientation, unsigned x, unsigned y) {
  if (orientation & 1U) std::swap(x, y);
  if (orientation & 2U) {
    x ^= 1U;
    y ^= 1U;
  }
  const unsigned digit = (x << 1U | (x ^ y)) & 3U;
  const unsigned turn = digit == 0 ? 1U : digit == 3 ? 3U : 0U;
  return {static_cast<std::uint8_t>(digit), static_cast<std::uint8_t>(orientation ^ turn)};
}

constexpr auto make_table() {
  std::array<Step, 4 * 256> table{};
  for (unsigned orientation = 0; orientation < 4; ++orientation)
    for (unsigned x = 0; x < 16; ++x)
      for (unsigned y = 0; y < 16; ++y) {
        unsigned digits = 0, o = orientation;
        for (int level = 3; level >= 0; --level) {
          const Step s = one_level(o, x >> level & 1U, y >> level & 1U);
          digits = digits << 2U | s.digits;
          o = s.orientation;
        }
        table[orientation * 256 + x * 16 + y] = {static_cast<std::uint8_t>(digits), static_cast<std::uint8_t>(o)};
      }
  return table;
}

constexpr auto kTable = make_table();

}  // namespace

std::uint64_t hilbert_key(LatticePoint p) {
  const std::uint32_t x = static_cast<std::uint32_t>(p.x) ^ 0x80000000U;
  const std::uint32_t y = static_cast<std::uint32_t>(p.y) ^ 0x80000000U;
  std::uint64_t key = 0;
  unsigned orientation = 0;
  for (int shift = 28; shift >= 0; shift -= 4) {
    const Step s = kTable[orientation * 256 + (x >> shift & 15U) * 16 + (y >> shift & 15U)];
    key = key << 8U | s.digits;
    orientation = s.orientation;
  }
  return key;
}

}  // namespace hydrotin
