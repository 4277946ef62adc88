#pragma once

#include <array>
#include <cstdint>
#include <cstdlib>

#include "las_bytes.h"
#include "laz_coder.h"

// The parts of a point that pointwise (version 2) and layered LAZ code alike. Each is the state of one context: what
// came last, and the models. Items are read from and written to the record in its LAS form.

namespace hydrotin {

// Running median of about five values: alternately the largest and the smallest make room for the next one.
class Median5 {
 public:
  void reset() {
    sorted_.fill(0);
    drop_largest_ = true;
  }
  [[nodiscard]] std::int32_t get() const { return sorted_[2]; }
  HYDROTIN_HOT void add(std::int32_t value) {
    const std::int32_t median = sorted_[2];
    const std::int32_t* const kept = sorted_.data() + (drop_largest_ ? 0 : 1);
    std::int32_t rest = value;
    std::array<std::int32_t, 5> next;
    for (std::size_t i = 0; i < 4; ++i) {
      next[i] = std::min(kept[i], rest);
      rest = std::max(kept[i], rest);
    }
    next[4] = rest;
    sorted_ = next;
    drop_largest_ = drop_largest_ ? value < median : value <= median;
  }

 private:
  std::array<std::int32_t, 5> sorted_;
  bool drop_largest_;
};

// Times as integers (the bits of the double), predicted by multiples of the last difference in one of four sequences.
// The pointwise form has a code for "unchanged" which the layered form keeps elsewhere: its codes are one lower.
template <bool Layered>
class GpsTimeDecoder {
 public:
  GpsTimeDecoder() : value_(9) {}

  void reset(std::uint64_t first) {
    multiple_.reset(kNumMultiples);
    start_.reset(kNumStarts);
    value_.reset();
    last_ = next_ = 0;
    time_ = {first, 0, 0, 0};
    difference_.fill(0);
    extremes_.fill(0);
  }

  HYDROTIN_HOT std::uint64_t decode(ArithmeticDecoder& decoder) {
    // An encoder switches sequence at most once per point.
    for (int attempt = 0; attempt < 4; ++attempt)
      if (step(decoder)) return time_[last_];
    decoder.mark_bad();
    return time_[last_];
  }
  [[nodiscard]] std::uint64_t last() const { return time_[last_]; }

 private:
  static constexpr std::uint32_t kTop = 500, kBottom = 10, kUnchanged = kTop + kBottom + 1;
  static constexpr std::uint32_t kNumMultiples = kTop + kBottom + (Layered ? 5 : 6), kNumStarts = Layered ? 5 : 6;

  // False after a switch to another sequence: the time is still to come.
  HYDROTIN_HOT bool step(ArithmeticDecoder& decoder) {
    if (difference_[last_] == 0) {
      const std::uint32_t code = decoder.symbol(start_) + (Layered ? 1 : 0);
      if (code == 1) {
        difference_[last_] = value_.decode(decoder, std::int32_t{0}, 0);
        advance(difference_[last_]);
        extremes_[last_] = 0;
      } else if (code == 2) {
        jump(decoder);
      } else if (code > 2) {
        last_ = (last_ + code - 2) & 3U;
        return false;
      }
      return true;
    }
    std::uint32_t code = decoder.symbol(multiple_);
    if (Layered && code >= kUnchanged) ++code;
    if (code == 1) {
      advance(value_.decode(decoder, difference_[last_], 1));
      extremes_[last_] = 0;
    } else if (code < kUnchanged) {
      advance(predicted(decoder, code));
    } else if (code == kUnchanged + 1) {
      jump(decoder);
    } else if (code > kUnchanged + 1) {
      last_ = (last_ + code - kUnchanged - 1) & 3U;
      return false;
    }
    return true;
  }

  std::int32_t predicted(ArithmeticDecoder& decoder, std::uint32_t code) {
    const auto times = [&](std::uint32_t factor) {
      return static_cast<std::int32_t>(factor * static_cast<std::uint32_t>(difference_[last_]));
    };
    if (code == 0) return extreme(value_.decode(decoder, std::int32_t{0}, 7));
    if (code < kTop) return value_.decode(decoder, times(code), code < 10 ? 2 : 3);
    if (code == kTop) return extreme(value_.decode(decoder, times(kTop), 4));
    const std::uint32_t minus = code - kTop;
    if (minus < kBottom) return value_.decode(decoder, times(0U - minus), 5);
    return extreme(value_.decode(decoder, times(0U - kBottom), 6));
  }
  // The fourth extreme difference in a row becomes the unit of the multiples.
  std::int32_t extreme(std::int32_t difference) {
    if (++extremes_[last_] > 3) {
      difference_[last_] = difference;
      extremes_[last_] = 0;
    }
    return difference;
  }
  void advance(std::int32_t difference) { time_[last_] += static_cast<std::uint64_t>(std::int64_t{difference}); }
  void jump(ArithmeticDecoder& decoder) {
    next_ = (next_ + 1) & 3U;
    const std::uint64_t high = value_.decode(decoder, static_cast<std::uint32_t>(time_[last_] >> 32U), 8);
    time_[next_] = (high << 32U) | decoder.bits(32);
    last_ = next_;
    difference_[last_] = 0;
    extremes_[last_] = 0;
  }

  SymbolModel<516> multiple_;
  SymbolModel<6> start_;
  IntegerDecoder<32> value_;
  std::uint32_t last_ = 0, next_ = 0;
  std::array<std::uint64_t, 4> time_{};
  std::array<std::int32_t, 4> difference_{};
  std::array<std::int32_t, 4> extremes_{};
};

[[nodiscard]] inline std::int32_t clamp_byte(std::int32_t value) {
  return std::min(std::max(value, 0), 255);
}

// Red, green, blue: each byte against the one before it, green and blue also against the step of red (and green).
class RgbDecoder {
 public:
  void reset() {
    used_.reset(128);
    for (auto& model : difference_) model.reset(256);
  }

  // Decodes `to` from `last`; both are 6 bytes and may be the same.
  void decode(ArithmeticDecoder& decoder, const std::uint8_t* last, std::uint8_t* to) {
    const std::uint32_t used = decoder.symbol(used_);
    std::array<std::uint8_t, 6> now;
    std::memcpy(now.data(), last, 6);
    const auto changed = [&](std::size_t byte, std::int32_t predicted) {
      if ((used & (1U << byte)) != 0)
        now[byte] =
            static_cast<std::uint8_t>(decoder.symbol(difference_[byte]) + static_cast<std::uint32_t>(predicted));
    };
    changed(0, last[0]);
    changed(1, last[1]);
    if ((used & 64U) == 0) {
      now[2] = now[4] = now[0];
      now[3] = now[5] = now[1];
    } else {
      for (const std::size_t half : {std::size_t{0}, std::size_t{1}}) {
        const std::int32_t red_step = now[half] - last[half];
        changed(half + 2, clamp_byte(red_step + last[half + 2]));
        const std::int32_t step = (red_step + now[half + 2] - last[half + 2]) / 2;
        changed(half + 4, clamp_byte(step + last[half + 4]));
      }
    }
    std::memcpy(to, now.data(), 6);
  }

 private:
  SymbolModel<128> used_;
  std::array<SymbolModel<256>, 6> difference_;
};

// Near infrared (layered only): each byte against the one before it.
class NirDecoder {
 public:
  void reset() {
    used_.reset(4);
    for (auto& model : difference_) model.reset(256);
  }
  void decode(ArithmeticDecoder& decoder, const std::uint8_t* last, std::uint8_t* to) {
    const std::uint32_t used = decoder.symbol(used_);
    std::array<std::uint8_t, 2> now{last[0], last[1]};
    for (const std::size_t byte : {std::size_t{0}, std::size_t{1}})
      if ((used & (1U << byte)) != 0)
        now[byte] = static_cast<std::uint8_t>(decoder.symbol(difference_[byte]) + last[byte]);
    std::memcpy(to, now.data(), 2);
  }

 private:
  SymbolModel<4> used_;
  std::array<SymbolModel<256>, 2> difference_;
};

// Wave packets: descriptor index, byte offset (8), size (4), return location (4), dx, dy, dz (4 each): 29 bytes.
class WavepacketDecoder {
 public:
  WavepacketDecoder() : offset_step_(1), size_(1), location_(1), direction_(3) {}

  void reset() {
    index_.reset(256);
    for (auto& model : offset_kind_) model.reset(4);
    offset_step_.reset();
    size_.reset();
    location_.reset();
    direction_.reset();
    last_step_ = 0;
    last_kind_ = 0;
  }

  // Decodes `to` from `last`; both are 29 bytes and may be the same.
  void decode(ArithmeticDecoder& decoder, const std::uint8_t* last, std::uint8_t* to) {
    const auto index = static_cast<std::uint8_t>(decoder.symbol(index_));
    auto offset = load<std::uint64_t>(last + 1);
    const auto size = load<std::uint32_t>(last + 9);
    last_kind_ = decoder.symbol(offset_kind_[last_kind_]);
    if (last_kind_ == 1) {
      offset += size;
    } else if (last_kind_ == 2) {
      last_step_ = offset_step_.decode(decoder, last_step_, 0);
      offset += static_cast<std::uint64_t>(std::int64_t{last_step_});
    } else if (last_kind_ == 3) {
      offset = decoder.bits64();
    }
    const std::uint32_t new_size = size_.decode(decoder, size, 0);
    const std::uint32_t location = location_.decode(decoder, load<std::uint32_t>(last + 13), 0);
    to[0] = index;
    store(to + 1, offset);
    store(to + 9, new_size);
    store(to + 13, location);
    for (std::size_t axis = 0; axis < 3; ++axis)
      store(to + 17 + 4 * axis, direction_.decode(decoder, load<std::uint32_t>(last + 17 + 4 * axis), axis));
  }

 private:
  SymbolModel<256> index_;
  std::array<SymbolModel<4>, 4> offset_kind_;
  IntegerDecoder<32> offset_step_, size_, location_, direction_;
  std::int32_t last_step_ = 0;
  std::uint32_t last_kind_ = 0;
};

}  // namespace hydrotin
