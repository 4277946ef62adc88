#include "fluvial_relief.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

#include "seeded_noise.h"

namespace hydrotin {
namespace {

constexpr double kSpacing = 8;            // metres between nodes, if the domain is not too large
constexpr std::uint32_t kMaxNodes = 768;  // along a side
constexpr std::uint32_t kMinNodes = 24;
constexpr int kRounds = 24;
constexpr double kConcavity = 0.45;      // slope ~ area^-0.45
constexpr double kHillslopeArea = 1500;  // m2: below it slopes do not grow further
constexpr double kReliefPerMetre = 0.2;
constexpr double kMaxRelief = 2500;
constexpr double kRiverArea = 40'000;  // m2: catchment at which a river begins, in a domain of a kilometre or more
constexpr double kBankSlope = 0.25, kBankCurvature = 0.08;  // valley sides, steeper away from the bed
constexpr double kUnseen = 1e300;
constexpr double kJitter = 0.4;  // of the spacing: rivers do not run along the grid

}  // namespace

FluvialRelief::FluvialRelief(double side, std::uint64_t seed)
    : side_(side), relief_(std::min(kMaxRelief, kReliefPerMetre * side)), seed_(scramble(seed ^ 0xF1)) {
  num_ = std::clamp(static_cast<std::uint32_t>(side / kSpacing) + 1, kMinNodes, kMaxNodes);
  spacing_ = side / (num_ - 1);
  river_area_ = std::max(kRiverArea * std::min(1.0, side_ / 1000), 30 * spacing_ * spacing_);
  height_.resize(std::size_t{num_} * num_);
  place_nodes();
  hardness_.resize(height_.size());
  for (std::uint32_t node = 0; node < height_.size(); ++node)
    hardness_[node] = 1 + 0.28 * fractal_noise(seed_ + 57, position_[node].x, position_[node].y, 200, 3);
  for (std::uint32_t row = 0; row < num_; ++row)
    for (std::uint32_t column = 0; column < num_; ++column)
      height_[row * num_ + column] =
          0.6 * row * spacing_ / side_ +
          fractal_noise(seed_, column * spacing_, row * spacing_, std::max(side_ / 3, 8.0), 8);
  for (int round = 0; round < kRounds; ++round) {
    drain();
    accumulate();
    const double highest = rebuild();
    creep();
    if (round + 1 < kRounds) continue;
    creep();
    for (double& z : height_) z *= relief_ / highest;
  }
  find_rivers();
  index_rivers();
}

/// Nodes stand off the grid, so that rivers do not run along it; the outlets stay on the edge.
void FluvialRelief::place_nodes() {
  position_.resize(height_.size());
  const double jitter = kJitter * spacing_;
  for (std::uint32_t row = 0; row < num_; ++row)
    for (std::uint32_t column = 0; column < num_; ++column) {
      const std::uint64_t bits = random_bits(seed_ + 101, column, row);
      const double x = column * spacing_ + jitter * (2 * fraction16(bits, 0) - 1);
      const double y = row == 0 ? 0 : row * spacing_ + jitter * (2 * fraction16(bits, 1) - 1);
      position_[row * num_ + column] = {std::clamp(x, 0.0, side_), std::clamp(y, 0.0, side_)};
    }
}

double FluvialRelief::distance(std::uint32_t a, std::uint32_t b) const {
  const Position p = position_[a], q = position_[b];
  return std::max(0.3 * spacing_, std::sqrt((p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y)));
}

/// Priority flood from the southern edge: every node drains to the steepest neighbour flooded before it.
void FluvialRelief::drain() {
  std::vector<double> level(height_.size(), kUnseen);
  std::vector<std::uint8_t> done(height_.size(), 0);
  receiver_.resize(height_.size());
  order_.clear();
  order_.reserve(height_.size());
  using Entry = std::pair<double, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  for (std::uint32_t column = 0; column < num_; ++column) open.emplace(level[column] = height_[column], column);
  while (!open.empty()) {
    const std::uint32_t node = open.top().second;
    open.pop();
    order_.push_back(node);
    receiver_[node] = node;
    double steepest = -1;
    each_neighbour(node, [&](std::uint32_t neighbour) {
      if (done[neighbour] != 0 && node >= num_) {
        const double slope = (level[node] - level[neighbour]) / distance(node, neighbour);
        if (slope > steepest) receiver_[node] = neighbour;
        steepest = std::max(steepest, slope);
      }
      if (level[neighbour] != kUnseen) return;
      level[neighbour] = std::max(level[node], height_[neighbour]);
      open.emplace(level[neighbour], neighbour);
    });
    done[node] = 1;
  }
}

/// Soil creep: levels hillslopes a little, leaves the rivers.
void FluvialRelief::creep() {
  const std::vector<double> before = height_;
  for (std::uint32_t node = num_; node < height_.size(); ++node) {
    if (area_[node] > river_area_ / 4) continue;
    double sum = 0, count = 0;
    each_neighbour(node, [&](std::uint32_t neighbour) {
      sum += before[neighbour];
      ++count;
    });
    height_[node] = 0.4 * before[node] + 0.6 * sum / count;
  }
}

void FluvialRelief::accumulate() {
  area_.assign(height_.size(), spacing_ * spacing_);
  for (auto node = order_.rbegin(); node != order_.rend(); ++node)
    if (receiver_[*node] != *node) area_[receiver_[*node]] += area_[*node];
}

/// New heights from the outlets up; returns the highest.
double FluvialRelief::rebuild() {
  double highest = 0;
  for (const std::uint32_t node : order_) {
    const std::uint32_t below = receiver_[node];
    if (below == node) {
      height_[node] = 0;
      continue;
    }
    const double slope = hardness_[node] * std::pow(area_[node] / kHillslopeArea + 1, -kConcavity);
    height_[node] = height_[below] + slope * distance(node, below);
    highest = std::max(highest, height_[node]);
  }
  return highest;
}

/// The river bed lies below the node by a depth that grows downstream, so it descends as the nodes do.
double FluvialRelief::bed(std::uint32_t node) const {
  return height_[node] - std::min(8.0, 0.25 * spacing_ + 0.5 * std::log2(std::max(1.0, area_[node] / river_area_)));
}

void FluvialRelief::find_rivers() {
  is_river_.assign(height_.size(), 0);
  for (std::uint32_t node = 0; node < height_.size(); ++node) is_river_[node] = area_[node] >= river_area_ ? 1 : 0;
}

/// Files every reach (node to receiver) under the coarse cells within reach of its banks.
void FluvialRelief::index_rivers() {
  const std::uint32_t cells = num_ - 1;
  const auto each_cell = [&](std::uint32_t node, auto&& visit) {
    const std::uint32_t below = receiver_[node];
    if (is_river_[node] == 0 || below == node) return;
    const auto [c0, c1] = std::minmax({node % num_, below % num_});
    const auto [r0, r1] = std::minmax({node / num_, below / num_});
    for (std::uint32_t r = r0 < 2 ? 0 : r0 - 2; r <= std::min(r1 + 1, cells - 1); ++r)
      for (std::uint32_t c = c0 < 2 ? 0 : c0 - 2; c <= std::min(c1 + 1, cells - 1); ++c) visit(r * cells + c);
  };
  reach_begin_.assign(std::size_t{cells} * cells + 1, 0);
  for (std::uint32_t node = 0; node < height_.size(); ++node)
    each_cell(node, [&](std::uint32_t cell) { ++reach_begin_[cell + 1]; });
  for (std::size_t cell = 0; cell + 1 < reach_begin_.size(); ++cell) reach_begin_[cell + 1] += reach_begin_[cell];
  reach_.resize(reach_begin_.back());
  auto fill = reach_begin_;
  for (std::uint32_t node = 0; node < height_.size(); ++node)
    each_cell(node, [&](std::uint32_t cell) { reach_[fill[cell]++] = node; });
}

/// Quadratic B-spline of the nodes: smooth, and never outside the heights around.
double FluvialRelief::grid_height(double x, double y) const {
  const double u = std::clamp(x / spacing_, 0.0, num_ - 1.0), v = std::clamp(y / spacing_, 0.0, num_ - 1.0);
  const auto column = static_cast<std::int64_t>(u + 0.5), row = static_cast<std::int64_t>(v + 0.5);
  const double s = u - static_cast<double>(column), t = v - static_cast<double>(row);  // -0.5 .. 0.5
  const double across[3] = {0.5 * (0.5 - s) * (0.5 - s), 0.75 - s * s, 0.5 * (0.5 + s) * (0.5 + s)};
  const double up[3] = {0.5 * (0.5 - t) * (0.5 - t), 0.75 - t * t, 0.5 * (0.5 + t) * (0.5 + t)};
  const auto last = static_cast<std::int64_t>(num_) - 1;
  double z = 0;
  for (int j = -1; j <= 1; ++j) {
    const double* line = &height_[static_cast<std::size_t>(std::clamp<std::int64_t>(row + j, 0, last)) * num_];
    double sum = 0;
    for (int i = -1; i <= 1; ++i) sum += across[i + 1] * line[std::clamp<std::int64_t>(column + i, 0, last)];
    z += up[j + 1] * sum;
  }
  return z;
}

double FluvialRelief::height(double x, double y) const {
  double z = grid_height(x, y) + 0.5 * value_noise(seed_ + 201, x / 23, y / 23) +
             0.2 * value_noise(seed_ + 202, x / 9, y / 9) + 0.06 * value_noise(seed_ + 203, x / 3.5, y / 3.5);
  const std::uint32_t cells = num_ - 1;
  const auto column = std::min(static_cast<std::uint32_t>(std::max(0.0, x / spacing_)), cells - 1);
  const auto row = std::min(static_cast<std::uint32_t>(std::max(0.0, y / spacing_)), cells - 1);
  const std::size_t cell = std::size_t{row} * cells + column;
  for (std::uint32_t i = reach_begin_[cell]; i < reach_begin_[cell + 1]; ++i) {
    const std::uint32_t node = reach_[i], below = receiver_[node];
    const Position a = position_[node], b = position_[below];
    const double dx = b.x - a.x, dy = b.y - a.y;
    const double along = std::clamp(((x - a.x) * dx + (y - a.y) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
    const double off_x = x - a.x - along * dx, off_y = y - a.y - along * dy;
    const double away = std::sqrt(off_x * off_x + off_y * off_y);
    z = std::min(z, bed(node) + along * (bed(below) - bed(node)) + away * (kBankSlope + kBankCurvature * away));
  }
  return z;
}

std::vector<SyntheticRiver> FluvialRelief::rivers() const {
  std::vector<int> strahler(height_.size(), 0), best_above(height_.size(), 0), num_above(height_.size(), 0);
  for (auto node = order_.rbegin(); node != order_.rend(); ++node) {
    if (is_river_[*node] == 0) continue;
    if (strahler[*node] == 0) strahler[*node] = 1;  // a head
    const std::uint32_t below = receiver_[*node];
    if (below == *node) continue;
    ++num_above[below];
    if (strahler[*node] == best_above[below]) {
      strahler[below] = best_above[below] + 1;
    } else if (strahler[*node] > best_above[below]) {
      best_above[below] = strahler[*node];
      strahler[below] = std::max(strahler[below], best_above[below]);
    }
  }
  std::vector<SyntheticRiver> rivers;
  for (std::uint32_t start = 0; start < height_.size(); ++start) {
    if (is_river_[start] == 0 || num_above[start] == 1 || receiver_[start] == start) continue;
    SyntheticRiver river;
    river.strahler = strahler[start];
    std::uint32_t node = start;
    for (;;) {
      river.line.push_back({position_[node].x, position_[node].y, bed(node)});
      if (node != start && num_above[node] != 1) break;
      if (receiver_[node] == node) break;
      river.catchment_m2 = area_[node];
      node = receiver_[node];
    }
    rivers.push_back(std::move(river));
  }
  return rivers;
}

}  // namespace hydrotin
