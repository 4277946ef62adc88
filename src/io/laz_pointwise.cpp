#include "laz_pointwise.h"

#include <optional>

#include "laz_coder.h"
#include "laz_items.h"
#include "laz_point10.h"

namespace hydrotin {
namespace {

// Extra bytes, each against the one before it.
class BytesDecoder {
 public:
  BytesDecoder(std::size_t num, bool version_1) : num_(num), version_1_(version_1) {
    if (version_1_) {
      integers_.emplace(num);
    } else {
      models_.emplace(num, 256);
    }
  }
  void reset() {
    if (version_1_) {
      integers_->reset();
    } else {
      models_->reset();
    }
  }
  void decode(ArithmeticDecoder& decoder, std::uint8_t* bytes) {
    for (std::size_t i = 0; i < num_; ++i) {
      const std::uint32_t last = bytes[i];
      bytes[i] = static_cast<std::uint8_t>(version_1_ ? integers_->decode(decoder, last, i)
                                                      : last + decoder.symbol((*models_)[i]));
    }
  }

 private:
  std::size_t num_;
  bool version_1_;
  std::optional<IntegerDecoder<8>> integers_;
  std::optional<ModelSet<256>> models_;
};

// Copies a record in pieces no larger than those it was just written in: wider reads would have to wait for the writes.
HYDROTIN_HOT void copy_record(const std::uint8_t* from, std::size_t length, std::uint8_t* to) {
  std::size_t i = 0;
  for (; i + 4 <= length; i += 4) store(to + i, load<std::uint32_t>(from + i));
  for (; i < length; ++i) to[i] = from[i];
}

}  // namespace

struct PointwiseDecoder::State {
  std::size_t record_length = 0;
  ArithmeticDecoder decoder;
  std::vector<std::uint8_t> record;  // the last point
  bool at_first = true;

  // Engaged: the item is there, in this version. `at_*` is its place in the record.
  std::optional<Point10V1Decoder> point_v1;
  std::optional<Point10V2Decoder> point_v2;
  std::optional<GpsTimeV1Decoder> time_v1;
  std::optional<GpsTimeDecoder<false>> time_v2;
  std::optional<RgbV1Decoder> rgb_v1;
  std::optional<RgbDecoder> rgb_v2;
  std::optional<WavepacketDecoder> wavepacket;
  std::optional<BytesDecoder> bytes;
  std::size_t at_time = 0, at_rgb = 0, at_wavepacket = 0, at_bytes = 0;

  void add(const LazItem& item) {
    const bool v1 = item.version == 1;
    switch (item.kind) {
      case LazItemKind::point10:
        if (v1) {
          point_v1.emplace();
        } else {
          point_v2.emplace();
        }
        break;
      case LazItemKind::gpstime11:
        at_time = item.begin;
        if (v1) {
          time_v1.emplace();
        } else {
          time_v2.emplace();
        }
        break;
      case LazItemKind::rgb12:
        at_rgb = item.begin;
        if (v1) {
          rgb_v1.emplace();
        } else {
          rgb_v2.emplace();
        }
        break;
      case LazItemKind::wavepacket13:
        at_wavepacket = item.begin;
        wavepacket.emplace();
        break;
      default:
        at_bytes = item.begin;
        bytes.emplace(item.size, v1);
    }
  }

  void reset() {
    const auto first_time = time_v1 || time_v2 ? load<std::uint64_t>(record.data() + at_time) : 0;
    if (point_v1) point_v1->reset();
    if (point_v2) {
      point_v2->reset();
      store<std::uint16_t>(record.data() + 12, 0);  // version 2 predicts the second intensity from 0
    }
    if (time_v1) time_v1->reset(first_time);
    if (time_v2) time_v2->reset(first_time);
    if (rgb_v1) rgb_v1->reset();
    if (rgb_v2) rgb_v2->reset();
    if (wavepacket) wavepacket->reset();
    if (bytes) bytes->reset();
  }

  HYDROTIN_HOT void decode(ArithmeticDecoder& d, std::uint8_t* p) {
    if (point_v2) {
      point_v2->decode(d, p);
    } else {
      point_v1->decode(d, p);
    }
    if (time_v2) {
      store(p + at_time, time_v2->decode(d));
    } else if (time_v1) {
      store(p + at_time, time_v1->decode(d));
    }
    if (rgb_v2) {
      rgb_v2->decode(d, p + at_rgb, p + at_rgb);
    } else if (rgb_v1) {
      rgb_v1->decode(d, p + at_rgb);
    }
    if (wavepacket) wavepacket->decode(d, p + at_wavepacket, p + at_wavepacket);
    if (bytes) bytes->decode(d, p + at_bytes);
  }
};

PointwiseDecoder::PointwiseDecoder(const LazLayout& layout) : state_(std::make_unique<State>()) {
  state_->record_length = layout.record_length;
  state_->record.resize(layout.record_length);
  for (const LazItem& item : layout.items) state_->add(item);
}

PointwiseDecoder::~PointwiseDecoder() = default;

bool PointwiseDecoder::start(const std::uint8_t* data, const std::uint8_t* end) {
  State& s = *state_;
  if (static_cast<std::size_t>(end - data) < s.record_length) return false;
  std::memcpy(s.record.data(), data, s.record_length);
  s.at_first = true;
  s.decoder.rebase(data + s.record_length, end);
  return true;
}

bool PointwiseDecoder::read(std::size_t count, std::uint8_t* records) {
  State& s = *state_;
  std::size_t done = 0;
  if (s.at_first && count > 0) {
    std::memcpy(records, s.record.data(), s.record_length);
    s.reset();
    s.decoder.start(s.decoder.next(), s.decoder.end());
    s.at_first = false;
    done = 1;
    records += s.record_length;
  }
  while (done < count) {
    const std::size_t stop = std::min(count, done + kPointsPerCheck);
    for (; done < stop; ++done, records += s.record_length) {
      s.decode(s.decoder, s.record.data());
      copy_record(s.record.data(), s.record_length, records);
    }
    if (s.decoder.overran()) return false;
  }
  return !s.decoder.overran();
}

const std::uint8_t* PointwiseDecoder::next() const {
  return state_->decoder.next();
}

void PointwiseDecoder::rebase(const std::uint8_t* next, const std::uint8_t* end) {
  state_->decoder.rebase(next, end);
}

}  // namespace hydrotin
