#pragma once

#include <array>
#include <cstdint>

#include "las_bytes.h"
#include "laz_items.h"

// POINT10, the 20 bytes common to point formats 0 to 5, in its two versions. `record` holds the point before and
// becomes the point decoded: x, y, z at 0, 4, 8; intensity 12; return byte 14; classification 15; scan angle 16; user
// data 17; point source 18.

namespace hydrotin {

// Contexts of version 2: which return of how many, folded to 16; rows are the number of returns.
inline constexpr char kReturnContext10[8][9] = {"ponmlkji", "oabdgkkj", "nbcehllk", "mdefimml",
                                                "lghijnnm", "kklmnoon", "jklmnopo", "ijklmnop"};

class Point10V2Decoder {
 public:
  Point10V2Decoder()
      : return_byte_(256, 256),
        classification_(256, 256),
        user_data_(256, 256),
        intensity_(4),
        source_(1),
        dx_(2),
        dy_(22),
        z_(20) {}

  void reset() {
    for (auto& median : x_step_) median.reset();
    for (auto& median : y_step_) median.reset();
    last_intensity_.fill(0);
    last_z_.fill(0);
    changed_.reset(64);
    for (auto& model : scan_angle_) model.reset(256);
    for (auto* set : {&return_byte_, &classification_, &user_data_}) set->reset();
    intensity_.reset();
    source_.reset();
    dx_.reset();
    dy_.reset();
    z_.reset();
  }

  HYDROTIN_HOT void decode(ArithmeticDecoder& decoder, std::uint8_t* record) {
    const std::uint32_t changed = decoder.symbol(changed_);
    if ((changed & 32U) != 0) record[14] = static_cast<std::uint8_t>(decoder.symbol(return_byte_[record[14]]));
    const std::uint32_t r = record[14] & 7U, n = (record[14] >> 3U) & 7U;
    const auto context = static_cast<std::size_t>(kReturnContext10[n][r] - 'a');
    const std::size_t depth = n > r ? n - r : r - n;
    if ((changed & 16U) != 0)
      last_intensity_[context] = static_cast<std::uint16_t>(
          intensity_.decode(decoder, std::uint32_t{last_intensity_[context]}, std::min<std::size_t>(context, 3)));
    if (changed != 0) store(record + 12, last_intensity_[context]);
    if ((changed & 15U) != 0) decode_rest(decoder, changed, record);
    decode_position(decoder, record, context, depth, n == 1 ? 1 : 0);
  }

 private:
  void decode_rest(ArithmeticDecoder& decoder, std::uint32_t changed, std::uint8_t* record) {
    if ((changed & 8U) != 0) record[15] = static_cast<std::uint8_t>(decoder.symbol(classification_[record[15]]));
    if ((changed & 4U) != 0)
      record[16] = static_cast<std::uint8_t>(record[16] + decoder.symbol(scan_angle_[(record[14] >> 6U) & 1U]));
    if ((changed & 2U) != 0) record[17] = static_cast<std::uint8_t>(decoder.symbol(user_data_[record[17]]));
    if ((changed & 1U) != 0)
      store(record + 18,
            static_cast<std::uint16_t>(source_.decode(decoder, std::uint32_t{load<std::uint16_t>(record + 18)}, 0)));
  }

  HYDROTIN_HOT void decode_position(ArithmeticDecoder& decoder, std::uint8_t* record, std::size_t context,
                                    std::size_t depth, std::size_t single) {
    const std::int32_t dx = dx_.decode(decoder, x_step_[context].get(), single);
    store(record, load<std::uint32_t>(record) + static_cast<std::uint32_t>(dx));
    x_step_[context].add(dx);

    const std::uint32_t kx = dx_.k();
    const std::int32_t dy = dy_.decode(decoder, y_step_[context].get(), single + (kx < 20 ? kx & ~1U : 20));
    store(record + 4, load<std::uint32_t>(record + 4) + static_cast<std::uint32_t>(dy));
    y_step_[context].add(dy);

    const std::uint32_t k = (kx + dy_.k()) / 2;
    last_z_[depth] = z_.decode(decoder, last_z_[depth], single + (k < 18 ? k & ~1U : 18));
    store(record + 8, last_z_[depth]);
  }

  std::array<Median5, 16> x_step_, y_step_;
  std::array<std::uint16_t, 16> last_intensity_{};
  std::array<std::int32_t, 8> last_z_{};
  SymbolModel<64> changed_;
  std::array<SymbolModel<256>, 2> scan_angle_;
  ModelSet<256> return_byte_, classification_, user_data_;
  IntegerDecoder<16> intensity_, source_;
  IntegerDecoder<32> dx_, dy_, z_;
};

class Point10V1Decoder {
 public:
  Point10V1Decoder()
      : return_byte_(256, 256),
        classification_(256, 256),
        user_data_(256, 256),
        intensity_(1),
        source_(1),
        scan_angle_(2),
        dx_(1),
        dy_(20),
        z_(20) {}

  void reset() {
    x_step_.fill(0);
    y_step_.fill(0);
    oldest_ = 0;
    changed_.reset(64);
    for (auto* set : {&return_byte_, &classification_, &user_data_}) set->reset();
    intensity_.reset();
    source_.reset();
    scan_angle_.reset();
    dx_.reset();
    dy_.reset();
    z_.reset();
  }

  void decode(ArithmeticDecoder& decoder, std::uint8_t* record) {
    const std::int32_t dx = dx_.decode(decoder, median(x_step_), 0);
    store(record, load<std::uint32_t>(record) + static_cast<std::uint32_t>(dx));
    const std::uint32_t kx = dx_.k();
    const std::int32_t dy = dy_.decode(decoder, median(y_step_), std::min(kx, 19U));
    store(record + 4, load<std::uint32_t>(record + 4) + static_cast<std::uint32_t>(dy));
    const std::uint32_t k = (kx + dy_.k()) / 2;
    store(record + 8, z_.decode(decoder, load<std::int32_t>(record + 8), std::min(k, 19U)));
    x_step_[oldest_] = dx;
    y_step_[oldest_] = dy;
    oldest_ = (oldest_ + 1) % 3;

    const std::uint32_t changed = decoder.symbol(changed_);
    if (changed != 0) decode_rest(decoder, changed, k, record);
  }

 private:
  static std::int32_t median(const std::array<std::int32_t, 3>& v) {
    return std::max(std::min(v[0], v[1]), std::min(std::max(v[0], v[1]), v[2]));
  }

  void decode_rest(ArithmeticDecoder& decoder, std::uint32_t changed, std::uint32_t k, std::uint8_t* record) {
    const auto decode16 = [&](IntegerDecoder<16>& integer, std::uint8_t* at) {
      store(at, static_cast<std::uint16_t>(integer.decode(decoder, std::uint32_t{load<std::uint16_t>(at)}, 0)));
    };
    if ((changed & 32U) != 0) decode16(intensity_, record + 12);
    if ((changed & 16U) != 0) record[14] = static_cast<std::uint8_t>(decoder.symbol(return_byte_[record[14]]));
    if ((changed & 8U) != 0) record[15] = static_cast<std::uint8_t>(decoder.symbol(classification_[record[15]]));
    if ((changed & 4U) != 0)
      record[16] = static_cast<std::uint8_t>(scan_angle_.decode(decoder, std::uint32_t{record[16]}, k < 3 ? 1 : 0));
    if ((changed & 2U) != 0) record[17] = static_cast<std::uint8_t>(decoder.symbol(user_data_[record[17]]));
    if ((changed & 1U) != 0) decode16(source_, record + 18);
  }

  std::array<std::int32_t, 3> x_step_{}, y_step_{};
  std::size_t oldest_ = 0;
  SymbolModel<64> changed_;
  ModelSet<256> return_byte_, classification_, user_data_;
  IntegerDecoder<16> intensity_, source_;
  IntegerDecoder<8> scan_angle_;
  IntegerDecoder<32> dx_, dy_, z_;
};

// GPSTIME11 in version 1: multiples of one last difference.
class GpsTimeV1Decoder {
 public:
  GpsTimeV1Decoder() : value_(6) {}

  void reset(std::uint64_t first) {
    multiple_.reset(kNumMultiples);
    start_.reset(3);
    value_.reset();
    time_ = first;
    difference_ = 0;
    extremes_ = 0;
  }

  std::uint64_t decode(ArithmeticDecoder& decoder) {
    if (difference_ == 0) {
      const std::uint32_t code = decoder.symbol(start_);
      if (code == 1) {
        difference_ = value_.decode(decoder, std::int32_t{0}, 0);
        time_ += static_cast<std::uint64_t>(std::int64_t{difference_});
      } else if (code == 2) {
        time_ = decoder.bits64();
      }
      return time_;
    }
    const std::uint32_t code = decoder.symbol(multiple_);
    if (code < kNumMultiples - 2) {
      time_ += static_cast<std::uint64_t>(std::int64_t{step(decoder, code)});
    } else if (code == kNumMultiples - 2) {
      time_ = decoder.bits64();
    }
    return time_;
  }

 private:
  static constexpr std::uint32_t kNumMultiples = 512;

  std::int32_t step(ArithmeticDecoder& decoder, std::uint32_t code) {
    if (code == 1) {
      difference_ = value_.decode(decoder, difference_, 1);
      extremes_ = 0;
      return difference_;
    }
    const auto predicted =
        code == 0 ? difference_ / 4 : static_cast<std::int32_t>(code * static_cast<std::uint32_t>(difference_));
    const std::size_t context = code == 0 ? 2 : code < 10 ? 3 : code < 50 ? 4 : 5;
    const std::int32_t difference = value_.decode(decoder, predicted, context);
    if ((code == 0 || code == kNumMultiples - 3) && ++extremes_ > 3) {
      difference_ = difference;
      extremes_ = 0;
    }
    return difference;
  }

  SymbolModel<512> multiple_;
  SymbolModel<3> start_;
  IntegerDecoder<32> value_;
  std::uint64_t time_ = 0;
  std::int32_t difference_ = 0;
  int extremes_ = 0;
};

// RGB12 in version 1: each byte against the one before it.
class RgbV1Decoder {
 public:
  RgbV1Decoder() : byte_(6) {}
  void reset() {
    used_.reset(64);
    byte_.reset();
  }
  void decode(ArithmeticDecoder& decoder, std::uint8_t* rgb) {
    const std::uint32_t used = decoder.symbol(used_);
    for (std::size_t i = 0; i < 6; ++i)
      if ((used & (1U << i)) != 0) rgb[i] = static_cast<std::uint8_t>(byte_.decode(decoder, std::uint32_t{rgb[i]}, i));
  }

 private:
  SymbolModel<64> used_;
  IntegerDecoder<8> byte_;
};

}  // namespace hydrotin
