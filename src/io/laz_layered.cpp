#include "laz_layered.h"

#include <optional>

#include "laz_point14.h"

namespace hydrotin {
namespace {

// Which scanner channel's context an item uses besides the point. In version 4 that is the point's. In version 3, as
// its writers do it, channel 0 is meant by every point that did not just change channel, and after a change to a
// context already in use the old context's last item goes on being the one predicted from (and written to) for this one
// point.
class ItemContext {
 public:
  explicit ItemContext(bool version_4) : version_4_(version_4) {}

  void start(std::size_t channel) {
    used_.fill(false);
    used_[channel] = true;
    current_ = last_ = channel;
  }
  // Returns the context to copy from, if the one now in use is new.
  std::optional<std::size_t> follow(std::size_t channel, bool switched) {
    const std::size_t to = version_4_ || switched ? channel : 0;
    last_ = current_;
    if (to == current_) return std::nullopt;
    const std::size_t from = current_;
    current_ = to;
    if (used_[to]) {
      if (version_4_) last_ = to;
      return std::nullopt;
    }
    used_[to] = true;
    last_ = to;
    return from;
  }
  [[nodiscard]] std::size_t models() const { return current_; }
  [[nodiscard]] std::size_t last() const { return last_; }

 private:
  bool version_4_;
  std::array<bool, 4> used_{};
  std::size_t current_ = 0, last_ = 0;
};

// The items behind POINT14: `Models` per context, `Size` bytes of last item.
struct ItemLayers {
  LazItem item;
  ItemContext context;
  std::array<std::vector<std::uint8_t>, 4> last;
  std::vector<LazLayer> layers;

  ItemLayers(const LazItem& which, std::size_t num_layers)
      : item(which), context(which.version == 4), layers(num_layers) {
    for (auto& bytes : last) bytes.resize(which.size);
  }
  virtual ~ItemLayers() = default;
  ItemLayers(const ItemLayers&) = delete;
  ItemLayers& operator=(const ItemLayers&) = delete;

  virtual void reset(std::size_t channel) = 0;
  virtual void decode(std::size_t models, std::uint8_t* last_item) = 0;

  void start(std::size_t channel, const std::uint8_t* record) {
    context.start(channel);
    std::memcpy(last[channel].data(), record + item.begin, item.size);
    reset(channel);
  }
  void read(std::size_t channel, bool switched, std::uint8_t* record) {
    if (const auto from = context.follow(channel, switched)) {
      last[context.models()] = last[*from];
      reset(context.models());
    }
    std::uint8_t* const last_item = last[context.last()].data();
    decode(context.models(), last_item);
    std::memcpy(record + item.begin, last_item, item.size);
  }
};

struct RgbLayers final : ItemLayers {
  struct Models {
    RgbDecoder rgb;
    NirDecoder nir;
  };
  std::array<std::unique_ptr<Models>, 4> models;

  explicit RgbLayers(const LazItem& which) : ItemLayers(which, which.kind == LazItemKind::rgbnir14 ? 2 : 1) {}
  void reset(std::size_t channel) override {
    if (models[channel] == nullptr) models[channel] = std::make_unique_for_overwrite<Models>();
    models[channel]->rgb.reset();
    models[channel]->nir.reset();
  }
  void decode(std::size_t channel, std::uint8_t* rgb) override {
    if (layers[0].present) models[channel]->rgb.decode(layers[0].decoder, rgb, rgb);
    if (layers.size() > 1 && layers[1].present) models[channel]->nir.decode(layers[1].decoder, rgb + 6, rgb + 6);
  }
};

struct WavepacketLayers final : ItemLayers {
  std::array<std::unique_ptr<WavepacketDecoder>, 4> models;

  explicit WavepacketLayers(const LazItem& which) : ItemLayers(which, 1) {}
  void reset(std::size_t channel) override {
    if (models[channel] == nullptr) models[channel] = std::make_unique<WavepacketDecoder>();
    models[channel]->reset();
  }
  void decode(std::size_t channel, std::uint8_t* packet) override {
    if (layers[0].present) models[channel]->decode(layers[0].decoder, packet, packet);
  }
};

struct ByteLayers final : ItemLayers {
  std::array<std::optional<ModelSet<256>>, 4> models;

  explicit ByteLayers(const LazItem& which) : ItemLayers(which, which.size) {}
  void reset(std::size_t channel) override {
    if (!models[channel]) models[channel].emplace(item.size, 256);
    models[channel]->reset();
  }
  void decode(std::size_t channel, std::uint8_t* bytes) override {
    for (std::size_t i = 0; i < layers.size(); ++i)
      if (layers[i].present)
        bytes[i] = static_cast<std::uint8_t>(bytes[i] + layers[i].decoder.symbol((*models[channel])[i]));
  }
};

std::size_t layers_of(const LazItem& item) {
  switch (item.kind) {
    case LazItemKind::point14:
      return kNumPoint14Layers;
    case LazItemKind::rgbnir14:
      return 2;
    case LazItemKind::byte14:
      return item.size;
    default:
      return 1;
  }
}

// Copies POINT14 in the pieces it was just written in: wider reads would have to wait for the writes.
HYDROTIN_HOT void copy_point14(const std::uint8_t* from, std::uint8_t* to) {
  for (std::size_t i = 0; i < 12; i += 4) store(to + i, load<std::uint32_t>(from + i));
  store(to + 12, load<std::uint16_t>(from + 12));
  for (std::size_t i = 14; i < 18; ++i) to[i] = from[i];
  store(to + 18, load<std::uint16_t>(from + 18));
  store(to + 20, load<std::uint16_t>(from + 20));
  store(to + 22, load<std::uint64_t>(from + 22));
}

}  // namespace

struct LayeredDecoder::State {
  std::size_t record_length = 0, head_bytes = 0;
  Point14Decoder point;
  std::array<LazLayer, kNumPoint14Layers> layers;
  std::vector<std::unique_ptr<ItemLayers>> items;
  std::vector<std::uint8_t> first;  // the chunk's first record, the rest of which skipped items keep
  bool at_first = true;
  bool whole = true;

  // Every layer with whether it is wanted, in the order of the chunk.
  template <class Visit>
  void for_each_layer(PointFields fields, Visit visit) {
    for (std::size_t i = 0; i < layers.size(); ++i) {
      const bool wanted =
          whole || i <= z_layer || (i == class_layer && fields.classification) || (i == flags_layer && fields.flags);
      visit(layers[i], wanted);
    }
    for (const auto& item : items)
      for (LazLayer& layer : item->layers) visit(layer, whole);
  }

  [[nodiscard]] bool overran() const {
    bool bad = false;
    for (const LazLayer& layer : layers) bad |= layer.present && layer.decoder.overran();
    if (whole)
      for (const auto& item : items)
        for (const LazLayer& layer : item->layers) bad |= layer.present && layer.decoder.overran();
    return bad;
  }
};

std::size_t LayeredDecoder::num_layers(const LazLayout& layout) {
  std::size_t num = 0;
  for (const LazItem& item : layout.items) num += layers_of(item);
  return num;
}

std::size_t LayeredDecoder::head_bytes(const LazLayout& layout) {
  return layout.record_length + 4 + 4 * num_layers(layout);
}

LayeredDecoder::LayeredDecoder(const LazLayout& layout) : state_(std::make_unique<State>()) {
  state_->record_length = layout.record_length;
  state_->head_bytes = head_bytes(layout);
  state_->first.resize(layout.record_length);
  for (const LazItem& item : layout.items) {
    if (item.kind == LazItemKind::rgb14 || item.kind == LazItemKind::rgbnir14)
      state_->items.push_back(std::make_unique<RgbLayers>(item));
    if (item.kind == LazItemKind::wavepacket14) state_->items.push_back(std::make_unique<WavepacketLayers>(item));
    if (item.kind == LazItemKind::byte14) state_->items.push_back(std::make_unique<ByteLayers>(item));
  }
}

LayeredDecoder::~LayeredDecoder() = default;

bool LayeredDecoder::start(const std::uint8_t* data, const std::uint8_t* end, std::uint64_t count, PointFields fields,
                           bool whole_records) {
  State& s = *state_;
  s.whole = whole_records;
  s.at_first = true;
  if (static_cast<std::size_t>(end - data) < s.head_bytes) return false;
  std::memcpy(s.first.data(), data, s.record_length);
  const std::uint8_t* size = data + s.record_length;
  if (load<std::uint32_t>(size) != count) return false;
  size += 4;
  const std::uint8_t* at = data + s.head_bytes;
  bool fits = true;
  s.for_each_layer(fields, [&](LazLayer& layer, bool wanted) {
    const std::size_t bytes = load<std::uint32_t>(size);
    size += 4;
    layer.present = false;
    if (!fits || bytes > static_cast<std::size_t>(end - at)) {
      fits = false;
      return;
    }
    if (bytes > 0 && wanted) {
      layer.decoder.start(at, at + bytes);
      layer.present = true;
    }
    at += bytes;
  });
  if (!fits || (count > 1 && !s.layers[returns_xy_layer].present)) return false;
  s.point.want_all(whole_records);
  s.point.start(s.first.data());
  for (const auto& item : s.items) item->start(s.point.channel(), s.first.data());
  return true;
}

bool LayeredDecoder::read(std::size_t count, std::uint8_t* records) {
  State& s = *state_;
  std::size_t done = 0;
  if (s.at_first && count > 0) {
    std::memcpy(records, s.first.data(), s.record_length);
    s.at_first = false;
    done = 1;
    records += s.record_length;
  }
  while (done < count) {
    const std::size_t stop = std::min(count, done + kPointsPerCheck);
    for (; done < stop; ++done, records += s.record_length) {
      copy_point14(s.point.decode(s.layers), records);
      if (s.whole)
        for (const auto& item : s.items) item->read(s.point.channel(), s.point.switched(), records);
    }
    if (s.overran()) return false;
  }
  return true;
}

}  // namespace hydrotin
