#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <memory>

// The adaptive arithmetic decoder of LAZ (Said, "Introduction to Arithmetic Coding", HPL-2004-76) and its models.
//
// A decoder holds value < length, both 32-bit, and takes a byte whenever length falls below 2^24. All integer
// operations are fixed by the format: the encoder made the same ones.
//
// Reading never checks for the end of the data. The caller keeps readable bytes behind it, as many as can be taken
// between two calls of `overran()`; damaged data then costs some wasted decoding, no more. A symbol takes at most 3
// bytes and looks at 4.

#define HYDROTIN_HOT [[gnu::always_inline]] inline

namespace hydrotin {

inline constexpr std::uint32_t kMinInterval = 1U << 24U;
inline constexpr std::uint32_t kSymbolShift = 15, kBitShift = 13;
inline constexpr std::uint32_t kLikely = (1U << kSymbolShift) / 2;  // share from which a symbol is worth a guess

// A bit with adaptive probability.
struct BitModel {
  std::uint32_t zero_count, total, zero_probability, cycle, left;

  void reset() {
    zero_count = 1;
    total = 2;
    zero_probability = 1U << (kBitShift - 1);
    cycle = left = 4;
  }
  void adapt() {
    total += cycle;
    if (total > (1U << kBitShift)) {
      total = (total + 1) >> 1U;
      zero_count = (zero_count + 1) >> 1U;
      if (zero_count == total) ++total;
    }
    zero_probability = (zero_count * (0x80000000U / total)) >> (31 - kBitShift);
    cycle = std::min<std::uint32_t>((5 * cycle) >> 2U, 64);
    left = cycle;
  }
};

// An alphabet of `num` <= Capacity symbols with adaptive probabilities, found through a table over the top bits.
template <std::uint32_t Capacity>
struct SymbolModel {
  using Symbol = std::conditional_t<(Capacity <= 256), std::uint8_t, std::uint16_t>;
  static constexpr std::uint32_t kTableBits = std::min<std::uint32_t>(std::bit_width(Capacity - 1) + 1, 9);

  std::uint32_t num, total, cycle, left, table_shift;
  std::uint32_t likely, likely_begin, likely_size;  // a symbol that mostly comes, and its share; size 0: there is none
  std::array<std::uint16_t, Capacity + 1> cumulative;  // in 1 / 2^15; entry num is 2^15
  std::array<std::uint16_t, Capacity> count;
  std::array<Symbol, std::size_t{1} << kTableBits> first;  // of each table slot: the symbol at its beginning

  void reset(std::uint32_t symbols) {
    num = symbols;
    table_shift =
        kSymbolShift - std::min<std::uint32_t>(kTableBits, static_cast<std::uint32_t>(std::bit_width(num - 1)) + 1);
    std::fill_n(count.begin(), num, std::uint16_t{1});
    total = 0;
    cycle = num;
    adapt();
    cycle = left = (num + 6) >> 1U;
  }

  [[gnu::noinline]] void adapt() {
    total += cycle;
    if (total > (1U << kSymbolShift)) {
      total = 0;
      for (std::uint32_t i = 0; i < num; ++i) {
        count[i] = static_cast<std::uint16_t>((count[i] + 1U) >> 1U);
        total += count[i];
      }
    }
    const std::uint32_t scale = 0x80000000U / total;
    std::uint32_t sum = 0, slot = 0, most = 0;
    for (std::uint32_t i = 0; i < num; ++i) {
      if (count[i] > most) {
        most = count[i];
        likely = i;
      }
      const std::uint32_t begin = (scale * sum) >> (31 - kSymbolShift);
      cumulative[i] = static_cast<std::uint16_t>(begin);
      sum += count[i];
      for (; (slot << table_shift) < begin; ++slot) first[slot] = static_cast<Symbol>(i - 1);
    }
    cumulative[num] = 1U << kSymbolShift;
    for (; (slot << table_shift) < (1U << kSymbolShift); ++slot) first[slot] = static_cast<Symbol>(num - 1);
    likely_begin = cumulative[likely];
    likely_size = cumulative[likely + 1] - likely_begin;
    if (likely_size < kLikely) likely_size = 0;
    cycle = std::min((5 * cycle) >> 2U, (num + 6) << 3U);
    left = cycle;
  }
};

class ArithmeticDecoder {
 public:
  // Begins at the four bytes at `data`; see above for what must be readable behind `end`.
  void start(const std::uint8_t* data, const std::uint8_t* end) {
    length_ = 0xFFFFFFFFU;
    value_ = load_big_endian(data);
    next_ = data + 4;
    end_ = end;
    bad_ = value_ == length_;  // no encoder writes this, and value < length is what everything below rests on
    if (bad_) value_ = 0;
  }

  [[nodiscard]] const std::uint8_t* next() const { return next_; }
  [[nodiscard]] const std::uint8_t* end() const { return end_; }
  // Moves the data elsewhere: the same bytes, perhaps more of them.
  void rebase(const std::uint8_t* next, const std::uint8_t* end) {
    next_ = next;
    end_ = end;
  }
  // Did the decoder meet what no encoder writes, or the end of its data?
  [[nodiscard]] bool overran() const { return bad_ || next_ > end_; }
  void mark_bad() { bad_ = true; }

  template <std::uint32_t Capacity>
  HYDROTIN_HOT std::uint32_t symbol(SymbolModel<Capacity>& model) {
    const std::uint32_t step = length_ >> kSymbolShift;
    // Foreseen symbols need not wait for the division: the processor goes on while it is still being checked.
    const std::uint32_t likely_low = model.likely_begin * step, likely_length = model.likely_size * step;
    if (value_ - likely_low < likely_length) {
      const std::uint32_t found = model.likely;
      value_ -= likely_low;
      length_ = found + 1 == model.num ? length_ - likely_low : likely_length;
      renormalise();
      ++model.count[found];
      if (--model.left == 0) model.adapt();
      return found;
    }
    const std::uint32_t at = std::min(value_ / step, (1U << kSymbolShift) - 1);
    std::uint32_t found = model.first[at >> model.table_shift];
    while (model.cumulative[found + 1] <= at) ++found;
    const std::uint32_t low = model.cumulative[found] * step;
    const std::uint32_t high = found + 1 == model.num ? length_ : model.cumulative[found + 1] * step;
    value_ -= low;
    length_ = high - low;
    renormalise();
    ++model.count[found];
    if (--model.left == 0) model.adapt();
    return found;
  }

  HYDROTIN_HOT std::uint32_t bit(BitModel& model) {
    const std::uint32_t split = model.zero_probability * (length_ >> kBitShift);
    const std::uint32_t one = value_ >= split ? 1 : 0;
    if (one != 0) {
      value_ -= split;
      length_ -= split;
    } else {
      length_ = split;
      ++model.zero_count;
    }
    renormalise();
    if (--model.left == 0) model.adapt();
    return one;
  }

  // `count` equiprobable bits, 1 to 32; more than 19 are coded as the low 16, then the rest.
  HYDROTIN_HOT std::uint32_t bits(std::uint32_t count) {
    if (count <= 19) return few_bits(count);
    const std::uint32_t low = few_bits(16);
    return (few_bits(count - 16) << 16U) | low;
  }
  std::uint64_t bits64() {
    const std::uint64_t low = bits(32);
    return (std::uint64_t{bits(32)} << 32U) | low;
  }

 private:
  static std::uint32_t load_big_endian(const std::uint8_t* from) {
    std::uint32_t word;
    std::memcpy(&word, from, 4);
    return __builtin_bswap32(word);
  }
  HYDROTIN_HOT std::uint32_t few_bits(std::uint32_t count) {
    length_ >>= count;
    const std::uint32_t found = value_ / length_;
    value_ -= found * length_;
    if (found >> count != 0) bad_ = true;
    renormalise();
    return found & ((1U << count) - 1);
  }
  HYDROTIN_HOT void renormalise() {
    // Without a branch: whether a byte is due cannot be foreseen.
    const std::uint32_t shift = static_cast<std::uint32_t>(std::countl_zero(length_)) & ~7U;
    const std::uint64_t wide = (std::uint64_t{value_} << 32U) | load_big_endian(next_);
    value_ = static_cast<std::uint32_t>((wide << shift) >> 32U);
    length_ <<= shift;
    next_ += shift >> 3U;
  }

  std::uint32_t value_ = 0, length_ = kMinInterval;
  const std::uint8_t* next_ = nullptr;
  const std::uint8_t* end_ = nullptr;
  bool bad_ = false;
};

// `Num` models of one alphabet, made ready when first used: most contexts never are.
template <std::uint32_t Capacity>
class ModelSet {
 public:
  ModelSet(std::size_t num, std::uint32_t symbols)
      : models_(std::make_unique_for_overwrite<SymbolModel<Capacity>[]>(num)),
        ready_(std::make_unique<std::uint8_t[]>(num)),
        num_(num),
        symbols_(symbols) {}
  void reset() { std::memset(ready_.get(), 0, num_); }
  HYDROTIN_HOT SymbolModel<Capacity>& operator[](std::size_t context) {
    SymbolModel<Capacity>& model = models_[context];
    if (ready_[context] == 0) {
      ready_[context] = 1;
      model.reset(symbols_);
    }
    return model;
  }

 private:
  std::unique_ptr<SymbolModel<Capacity>[]> models_;
  std::unique_ptr<std::uint8_t[]> ready_;
  std::size_t num_;
  std::uint32_t symbols_;
};

// Integers as a prediction plus a corrector. The corrector's magnitude class k (it lies in [-(2^k - 1), 2^k]) is coded
// per context, its place in the class with up to eight modelled bits, the rest plain.
template <std::uint32_t Bits>
class IntegerDecoder {
 public:
  explicit IntegerDecoder(std::size_t contexts)
      : class_(contexts, Bits + 1), place_(std::make_unique_for_overwrite<SymbolModel<256>[]>(Bits + 1)) {
    reset();
  }
  void reset() {
    class_.reset();
    unit_.reset();
    place_ready_.fill(0);
    k_ = 0;
  }
  // Magnitude class of the last corrector.
  [[nodiscard]] std::uint32_t k() const { return k_; }

  // The integer modulo 2^Bits; with fewer than 32 bits only the low ones mean anything.
  HYDROTIN_HOT std::uint32_t decode(ArithmeticDecoder& decoder, std::uint32_t predicted, std::size_t context) {
    return predicted + corrector(decoder, context);
  }
  HYDROTIN_HOT std::int32_t decode(ArithmeticDecoder& decoder, std::int32_t predicted, std::size_t context) {
    return static_cast<std::int32_t>(decode(decoder, static_cast<std::uint32_t>(predicted), context));
  }

 private:
  HYDROTIN_HOT std::uint32_t corrector(ArithmeticDecoder& decoder, std::size_t context) {
    const std::uint32_t k = decoder.symbol(class_[context]);
    k_ = k;
    if (k == 0) return decoder.bit(unit_);
    if (k == 32) return 0x80000000U;
    if (place_ready_[k] == 0) {
      place_ready_[k] = 1;
      place_[k].reset(1U << std::min<std::uint32_t>(k, 8));
    }
    std::uint32_t place = decoder.symbol(place_[k]);
    if (k > 8) place = (place << (k - 8)) | decoder.bits(k - 8);
    return place >= (1U << (k - 1)) ? place + 1 : place - ((1U << k) - 1);
  }

  ModelSet<Bits + 1> class_;
  BitModel unit_;
  std::unique_ptr<SymbolModel<256>[]> place_;
  std::array<std::uint8_t, 33> place_ready_;
  std::uint32_t k_ = 0;
};

}  // namespace hydrotin
