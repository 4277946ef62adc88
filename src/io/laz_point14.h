#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "las_bytes.h"
#include "laz_items.h"

// POINT14, the 30 bytes common to point formats 6 to 10, in nine layers. The record: x, y, z at 0, 4, 8; intensity 12;
// returns 14 (number low, count high); flags 15 (class flags low, scanner channel, direction, edge); class 16; user
// data 17; scan angle 18; point source 20; GPS time 22.

namespace hydrotin {

// One layer of a chunk: a stream of its own. Absent: nothing in it changes in this chunk, or nobody asked for it.
struct LazLayer {
  ArithmeticDecoder decoder;
  bool present = false;
};

enum Point14Layer : std::size_t {
  returns_xy_layer,
  z_layer,
  class_layer,
  flags_layer,
  intensity_layer,
  scan_angle_layer,
  user_data_layer,
  source_layer,
  time_layer,
  kNumPoint14Layers
};

// Contexts: which return of how many, folded to 6; rows are the number of returns.
inline constexpr char kReturnContext14[16][17] = {
    "0123453445555555", "1013333333333333", "2124444444433333", "3345444444444444",
    "4344544444444444", "5344454444444444", "3344445444444444", "4344444544444444",
    "4344444454444444", "5344444445444444", "5344444444544444", "5334444444455444",
    "5334444444455544", "5334444444445554", "5334444444444555", "5334444444444455"};

// What one scanner channel remembers.
struct Point14Context {
  std::array<std::uint8_t, 30> record{};
  bool time_changed = false;
  std::array<Median5, 12> x_step, y_step;
  std::array<std::int32_t, 8> last_z{};
  std::array<std::uint16_t, 8> last_intensity{};

  ModelSet<128> changed{8, 128};
  SymbolModel<3> channel;
  ModelSet<16> number_of_returns{16, 16}, return_number{16, 16};
  SymbolModel<13> return_step;
  IntegerDecoder<32> dx{2}, dy{22}, z{20};
  ModelSet<256> classification{64, 256}, user_data{64, 256};
  ModelSet<64> flags{64, 64};
  IntegerDecoder<16> intensity{4}, scan_angle{2}, source{1};
  GpsTimeDecoder<true> time;

  void reset(const std::uint8_t* first) {
    std::memcpy(record.data(), first, record.size());
    time_changed = false;
    for (auto& median : x_step) median.reset();
    for (auto& median : y_step) median.reset();
    last_z.fill(load<std::int32_t>(first + 8));
    last_intensity.fill(load<std::uint16_t>(first + 12));
    changed.reset();
    channel.reset(3);
    number_of_returns.reset();
    return_number.reset();
    return_step.reset(13);
    dx.reset();
    dy.reset();
    z.reset();
    classification.reset();
    user_data.reset();
    flags.reset();
    intensity.reset();
    scan_angle.reset();
    source.reset();
    time.reset(load<std::uint64_t>(first + 22));
  }
};

class Point14Decoder {
 public:
  // Begins a chunk with its first point.
  void start(const std::uint8_t* first) {
    used_.fill(false);
    channel_ = (first[15] >> 4U) & 3U;
    open(channel_, first);
  }
  [[nodiscard]] std::size_t channel() const { return channel_; }
  // Did the last point come from another scanner channel than the one before?
  [[nodiscard]] bool switched() const { return switched_; }

  // Decodes the next point; the record stays valid until the next call.
  HYDROTIN_HOT const std::uint8_t* decode(std::array<LazLayer, kNumPoint14Layers>& layers) {
    ArithmeticDecoder& decoder = layers[returns_xy_layer].decoder;
    Point14Context* c = context_[channel_].get();
    const std::uint32_t last_r = c->record[14] & 15U, last_n = c->record[14] >> 4U;
    const std::size_t last_return =
        (last_r == 1 ? 1U : 0U) + (last_r >= last_n ? 2U : 0U) + (c->time_changed ? 4U : 0U);
    const std::uint32_t changed = decoder.symbol(c->changed[last_return]);
    switched_ = (changed & 64U) != 0;
    if (switched_) c = switch_channel(decoder, *c);
    const bool time_changed = (changed & 16U) != 0;

    const std::uint32_t returns = decode_returns(decoder, *c, changed, time_changed);
    decode_xy(decoder, *c, returns, time_changed);
    if (layers[z_layer].present) decode_z(layers[z_layer].decoder, *c, returns);
    const std::uint32_t r = returns & 15U, n = returns >> 4U;
    const std::size_t place = (r == 1 ? 2U : 0U) + (r >= n ? 1U : 0U);  // intermediate, last, first, single
    if (layers[class_layer].present) {
      std::uint8_t& classification = c->record[16];
      auto& model = c->classification[((classification & 31U) << 1U) + (place == 3 ? 1U : 0U)];
      classification = static_cast<std::uint8_t>(layers[class_layer].decoder.symbol(model));
    }
    if (layers[flags_layer].present) {
      std::uint8_t& b = c->record[15];
      const std::uint32_t flags = layers[flags_layer].decoder.symbol(c->flags[((b >> 2U) & 0x30U) | (b & 15U)]);
      b = static_cast<std::uint8_t>((flags & 15U) | (b & 0x30U) | ((flags & 0x30U) << 2U));
    }
    if (all_) decode_rest(layers, *c, changed, place);
    c->time_changed = time_changed;
    return c->record.data();
  }

  // Are layers beyond those of position, class and flags decoded?
  void want_all(bool all) { all_ = all; }

 private:
  void open(std::size_t channel, const std::uint8_t* first) {
    if (context_[channel] == nullptr) context_[channel] = std::make_unique<Point14Context>();
    context_[channel]->reset(first);
    used_[channel] = true;
  }

  [[gnu::noinline]] Point14Context* switch_channel(ArithmeticDecoder& decoder, Point14Context& from) {
    channel_ = (channel_ + decoder.symbol(from.channel) + 1) & 3U;
    if (!used_[channel_]) open(channel_, from.record.data());
    Point14Context* to = context_[channel_].get();
    to->record[15] = static_cast<std::uint8_t>((to->record[15] & 0xCFU) | (channel_ << 4U));
    return to;
  }

  HYDROTIN_HOT std::uint32_t decode_returns(ArithmeticDecoder& decoder, Point14Context& c, std::uint32_t changed,
                                            bool time_changed) {
    std::uint32_t r = c.record[14] & 15U, n = c.record[14] >> 4U;
    if ((changed & 4U) != 0) n = decoder.symbol(c.number_of_returns[n]);
    switch (changed & 3U) {
      case 0:
        break;
      case 1:
        r = (r + 1) & 15U;
        break;
      case 2:
        r = (r + 15) & 15U;
        break;
      default:
        r = time_changed ? decoder.symbol(c.return_number[r]) : (r + decoder.symbol(c.return_step) + 2) & 15U;
    }
    const std::uint32_t returns = r | (n << 4U);
    c.record[14] = static_cast<std::uint8_t>(returns);
    return returns;
  }

  HYDROTIN_HOT static void decode_xy(ArithmeticDecoder& decoder, Point14Context& c, std::uint32_t returns,
                                     bool time_changed) {
    const std::uint32_t r = returns & 15U, n = returns >> 4U;
    const std::size_t single = n == 1 ? 1 : 0;
    const std::size_t m = (static_cast<std::size_t>(kReturnContext14[n][r] - '0') << 1U) | (time_changed ? 1U : 0U);
    std::uint8_t* const record = c.record.data();
    const std::int32_t dx = c.dx.decode(decoder, c.x_step[m].get(), single);
    store(record, load<std::uint32_t>(record) + static_cast<std::uint32_t>(dx));
    c.x_step[m].add(dx);
    const std::uint32_t kx = c.dx.k();
    const std::int32_t dy = c.dy.decode(decoder, c.y_step[m].get(), single + (kx < 20 ? kx & ~1U : 20));
    store(record + 4, load<std::uint32_t>(record + 4) + static_cast<std::uint32_t>(dy));
    c.y_step[m].add(dy);
  }

  HYDROTIN_HOT static void decode_z(ArithmeticDecoder& decoder, Point14Context& c, std::uint32_t returns) {
    const std::uint32_t r = returns & 15U, n = returns >> 4U;
    const std::size_t depth = std::min(n > r ? n - r : r - n, 7U);
    const std::uint32_t k = (c.dx.k() + c.dy.k()) / 2;
    c.last_z[depth] = c.z.decode(decoder, c.last_z[depth], (n == 1 ? 1U : 0U) + (k < 18 ? k & ~1U : 18U));
    store(c.record.data() + 8, c.last_z[depth]);
  }

  void decode_rest(std::array<LazLayer, kNumPoint14Layers>& layers, Point14Context& c, std::uint32_t changed,
                   std::size_t place) {
    std::uint8_t* const record = c.record.data();
    const std::size_t time_changed = (changed & 16U) != 0 ? 1 : 0;
    const auto decode16 = [](LazLayer& layer, IntegerDecoder<16>& integer, std::uint32_t predicted,
                             std::size_t context) {
      return static_cast<std::uint16_t>(integer.decode(layer.decoder, predicted, context));
    };
    if (layers[intensity_layer].present) {
      std::uint16_t& last = c.last_intensity[(place << 1U) | time_changed];
      last = decode16(layers[intensity_layer], c.intensity, last, place);
      store(record + 12, last);
    }
    if (layers[scan_angle_layer].present && (changed & 8U) != 0)
      store(record + 18,
            decode16(layers[scan_angle_layer], c.scan_angle, load<std::uint16_t>(record + 18), time_changed));
    if (layers[user_data_layer].present)
      record[17] = static_cast<std::uint8_t>(layers[user_data_layer].decoder.symbol(c.user_data[record[17] / 4U]));
    if (layers[source_layer].present && (changed & 32U) != 0)
      store(record + 20, decode16(layers[source_layer], c.source, load<std::uint16_t>(record + 20), 0));
    if (layers[time_layer].present && time_changed != 0) store(record + 22, c.time.decode(layers[time_layer].decoder));
  }

  std::array<std::unique_ptr<Point14Context>, 4> context_;
  std::array<bool, 4> used_{};
  std::size_t channel_ = 0;
  bool switched_ = false;
  bool all_ = true;
};

}  // namespace hydrotin
