#include "hydrotin/synthetic.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

#include "fluvial_relief.h"
#include "seeded_noise.h"

namespace hydrotin {
namespace {

constexpr std::int32_t kOriginX = 50'000'000;   // 500 km east, on the central meridian of a UTM zone [cm]
constexpr std::int32_t kOriginY = 460'000'000;  // 4600 km north [cm]
constexpr std::size_t kBatch = 1 << 14;

constexpr double kSwathWidth = 250, kSwathStep = 230;  // metres: neighbouring swaths overlap by 20
constexpr double kAlongLine = 0.6;                     // metres between points of a scan line
constexpr double kBetweenLines = 1 / kAlongLine * kSwathWidth / kSwathStep;  // gives one point per square metre in all
constexpr double kSlant = 0.05;  // parallel lines lean because the aircraft moves

constexpr double kBlock = 90, kStreet = 12, kMaxLakePitch = 1000;

enum Stream : std::uint64_t { kPlace = 11, kNoise = 23, kGround = 37, kLake = 53, kBuilding = 71 };

std::int32_t to_cm(double metres) {
  return static_cast<std::int32_t>(std::lround(metres * 100));
}

}  // namespace

struct SyntheticTerrain::State {
  SyntheticOptions options;
  std::int32_t side_cm;
  double side;
  std::optional<FluvialRelief> relief;

  std::uint64_t seed(Stream stream) const { return scramble(options.seed * 0x9E3779B97F4A7C15ULL + stream); }
  double ground(double x, double y) const;
  bool in_lake(double x, double y) const;
  bool under_roof(double x, double y) const;
};

namespace {

using Sink = std::function<void(std::span<const SyntheticPoint>)>;

/// Collects the points of one box into batches.
class Collector {
 public:
  Collector(const LatticeBox& box, const Sink& sink) : box_(box), sink_(sink) { batch_.reserve(kBatch); }
  ~Collector() = default;
  Collector(const Collector&) = delete;
  Collector& operator=(const Collector&) = delete;

  [[nodiscard]] bool wants(LatticePoint p) const { return box_.contains(p); }
  void add(SyntheticPoint point) {
    batch_.push_back(point);
    if (batch_.size() == kBatch) flush();
  }
  void flush() {
    if (!batch_.empty()) sink_(batch_);
    batch_.clear();
  }

 private:
  const LatticeBox& box_;
  const Sink& sink_;
  std::vector<SyntheticPoint> batch_;
};

/// Streets every `kBlock` metres in a frame turned by a seeded angle; place within the block and number of the block.
struct BlockPlace {
  std::int64_t i, j;
  double u, v;
};

BlockPlace block_of(std::uint64_t seed, double x, double y) {
  const double angle = 0.2 + 0.3 * fraction(scramble(seed));
  const double s = (x * std::cos(angle) + y * std::sin(angle)) / kBlock,
               t = (y * std::cos(angle) - x * std::sin(angle)) / kBlock;
  return {static_cast<std::int64_t>(std::floor(s)), static_cast<std::int64_t>(std::floor(t)),
          kBlock * (s - std::floor(s)), kBlock * (t - std::floor(t))};
}

}  // namespace

double SyntheticTerrain::State::ground(double x, double y) const {
  const std::uint64_t ground_seed = seed(kGround);
  switch (options.kind) {
    case SyntheticKind::fluvial:
      return relief->height(x, y);
    case SyntheticKind::urban: {
      const BlockPlace place = block_of(seed(kBuilding), x, y);
      const bool on_street = place.u < kStreet || place.v < kStreet;
      return 40 + 0.004 * y + 3 * fractal_noise(ground_seed, x, y, 400, 3) + (on_street ? 0 : 0.15);
    }
    case SyntheticKind::lattice:
    case SyntheticKind::scanline:
      break;
  }
  return 300 + 25 * fractal_noise(ground_seed, x, y, 350, 5) + 0.15 * value_noise(ground_seed + 77, x / 4, y / 4);
}

bool SyntheticTerrain::State::in_lake(double x, double y) const {
  const double pitch = std::min(kMaxLakePitch, side / 2);
  const auto i = static_cast<std::int64_t>(std::floor(x / pitch)), j = static_cast<std::int64_t>(std::floor(y / pitch));
  const std::uint64_t bits = random_bits(seed(kLake), i, j);
  const double radius = pitch * (0.08 + 0.12 * fraction16(bits, 0));
  const double room = pitch - 2 * radius;
  const double dx = x - (static_cast<double>(i) * pitch + radius + room * fraction16(bits, 1));
  const double dy = y - (static_cast<double>(j) * pitch + radius + room * fraction16(bits, 2));
  return dx * dx + dy * dy < radius * radius;
}

bool SyntheticTerrain::State::under_roof(double x, double y) const {
  const BlockPlace place = block_of(seed(kBuilding), x, y);
  if (place.u < kStreet || place.v < kStreet) return false;
  // Four lots in a block, most of them built on.
  const double half = (kBlock - kStreet) / 2;
  const double u = place.u - kStreet, v = place.v - kStreet;
  const auto lot_i = static_cast<std::int64_t>(u / half), lot_j = static_cast<std::int64_t>(v / half);
  const std::uint64_t bits = random_bits(seed(kBuilding), 2 * place.i + lot_i, 2 * place.j + lot_j);
  if (fraction16(bits, 0) < 0.15) return false;
  const double width = half * (0.4 + 0.45 * fraction16(bits, 1)), depth = half * (0.4 + 0.45 * fraction16(bits, 2));
  const double from_u = u - static_cast<double>(lot_i) * half - 3, from_v = v - static_cast<double>(lot_j) * half - 3;
  return from_u >= 0 && from_u < width && from_v >= 0 && from_v < depth;
}

namespace {

/// Makes the point at a place in centimetres from the corner, if it is wanted there.
template <class State>
void make_point(const State& state, std::int32_t x, std::int32_t y, std::uint64_t bits, Collector& collector) {
  if (x < 0 || y < 0 || x >= state.side_cm || y >= state.side_cm) return;
  if (!collector.wants({kOriginX + x, kOriginY + y})) return;
  const double metres_x = x * 0.01, metres_y = y * 0.01;
  if (state.options.kind == SyntheticKind::urban && state.under_roof(metres_x, metres_y)) return;
  if (state.options.voids && state.in_lake(metres_x, metres_y)) return;
  double z = state.ground(metres_x, metres_y);
  if (state.options.noise > 0) z += state.options.noise * nearly_normal(scramble(bits + kNoise));
  collector.add({kOriginX + x, kOriginY + y, to_cm(z)});
}

/// One point in every square metre: at random, or in its corner.
template <class State>
void make_cells(const State& state, const LatticeBox& box, bool in_corner, Collector& collector) {
  const std::uint64_t seed = state.seed(kPlace);
  const std::int32_t i_end = (box.max.x - kOriginX) / 100, j_end = (box.max.y - kOriginY) / 100;
  for (std::int32_t j = (box.min.y - kOriginY) / 100; j <= j_end; ++j)
    for (std::int32_t i = (box.min.x - kOriginX) / 100; i <= i_end; ++i) {
      const std::uint64_t bits = random_bits(seed, i, j);
      const auto dx = in_corner ? 0 : static_cast<std::int32_t>(100 * fraction16(bits, 0));
      const auto dy = in_corner ? 0 : static_cast<std::int32_t>(100 * fraction16(bits, 1));
      make_point(state, 100 * i + dx, 100 * j + dy, bits, collector);
    }
}

/// Swaths run north; their lines go across, parallel in even swaths and in zig-zag in odd ones.
template <class State>
void make_scan_lines(const State& state, const LatticeBox& box, Collector& collector) {
  const std::uint64_t seed = state.seed(kPlace);
  const double x_min = (box.min.x - kOriginX) * 0.01, x_max = (box.max.x - kOriginX) * 0.01;
  const double y_min = (box.min.y - kOriginY) * 0.01, y_max = (box.max.y - kOriginY) * 0.01;
  const auto num_along = static_cast<std::int64_t>(kSwathWidth / kAlongLine);
  const auto first_swath = static_cast<std::int64_t>(std::floor((x_min - kSwathWidth) / kSwathStep));
  const auto last_swath = static_cast<std::int64_t>(std::floor(x_max / kSwathStep)) + 2;
  const double lean = std::max(kSlant * kSwathWidth, kBetweenLines) + 1;
  const auto first_line = static_cast<std::int64_t>(std::floor((y_min - lean) / kBetweenLines));
  const auto last_line = static_cast<std::int64_t>(std::ceil((y_max + lean) / kBetweenLines));
  for (std::int64_t line = first_line; line <= last_line; ++line)
    for (std::int64_t swath = first_swath; swath <= last_swath; ++swath) {
      const double start = static_cast<double>(swath) * kSwathStep - (kSwathWidth - kSwathStep);
      const std::uint64_t line_seed = random_bits(seed, swath, line);
      const double phase = 0.5 * kAlongLine * fraction(line_seed);
      const auto from = std::max<std::int64_t>(0, static_cast<std::int64_t>((x_min - start) / kAlongLine) - 2);
      const auto to = std::min<std::int64_t>(num_along, static_cast<std::int64_t>((x_max - start) / kAlongLine) + 2);
      for (std::int64_t p = from; p < to; ++p) {
        const std::uint64_t bits = scramble(line_seed + static_cast<std::uint64_t>(p));
        const double across = static_cast<double>(p) * kAlongLine + phase + 0.04 * (fraction16(bits, 0) - 0.5);
        const double turn = across / kSwathWidth;
        const double shift = swath % 2 == 0 ? kSlant * across : kBetweenLines * (line % 2 == 0 ? turn : 1 - turn);
        const double y = static_cast<double>(line) * kBetweenLines + shift + 0.04 * (fraction16(bits, 1) - 0.5);
        make_point(state, to_cm(start + across), to_cm(y), bits, collector);
      }
    }
}

}  // namespace

SyntheticTerrain::SyntheticTerrain(const SyntheticOptions& options) {
  assert(options.num_points >= 16 && options.num_points <= kMaxSyntheticPoints);
  auto state = std::make_unique<State>();
  state->options = options;
  const auto metres = static_cast<std::int32_t>(std::lround(std::sqrt(static_cast<double>(options.num_points))));
  state->side_cm = 100 * metres;
  state->side = metres;
  if (options.kind == SyntheticKind::fluvial) state->relief.emplace(state->side, options.seed);
  state_ = std::move(state);
}

SyntheticTerrain::~SyntheticTerrain() = default;

LatticeBox SyntheticTerrain::box() const {
  return {{kOriginX, kOriginY}, {kOriginX + state_->side_cm - 1, kOriginY + state_->side_cm - 1}};
}

LatticeBox SyntheticTerrain::tile(std::uint32_t a, std::uint32_t num_a, std::uint32_t b, std::uint32_t num_b) const {
  assert(a < num_a && b < num_b);
  const auto cut = [&](std::uint32_t i, std::uint32_t num) {
    return static_cast<std::int32_t>(std::int64_t{state_->side_cm} * i / num);
  };
  return {{kOriginX + cut(a, num_a), kOriginY + cut(b, num_b)},
          {kOriginX + cut(a + 1, num_a) - 1, kOriginY + cut(b + 1, num_b) - 1}};
}

double SyntheticTerrain::height(double x, double y) const {
  return state_->ground(x - kOriginX * kSyntheticScale, y - kOriginY * kSyntheticScale);
}

bool SyntheticTerrain::is_void(double x, double y) const {
  const double from_x = x - kOriginX * kSyntheticScale, from_y = y - kOriginY * kSyntheticScale;
  return (state_->options.voids && state_->in_lake(from_x, from_y)) ||
         (state_->options.kind == SyntheticKind::urban && state_->under_roof(from_x, from_y));
}

void SyntheticTerrain::points_in(const LatticeBox& box, const Sink& sink) const {
  LatticeBox part = this->box();
  part.min = {std::max(part.min.x, box.min.x), std::max(part.min.y, box.min.y)};
  part.max = {std::min(part.max.x, box.max.x), std::min(part.max.y, box.max.y)};
  if (part.is_empty()) return;
  Collector collector(part, sink);
  if (state_->options.kind == SyntheticKind::scanline) {
    make_scan_lines(*state_, part, collector);
  } else {
    make_cells(*state_, part, state_->options.kind == SyntheticKind::lattice, collector);
  }
  collector.flush();
}

std::vector<SyntheticRiver> SyntheticTerrain::rivers() const {
  if (!state_->relief) return {};
  auto rivers = state_->relief->rivers();
  for (auto& river : rivers)
    for (auto& point : river.line) {
      point[0] += kOriginX * kSyntheticScale;
      point[1] += kOriginY * kSyntheticScale;
    }
  return rivers;
}

}  // namespace hydrotin
