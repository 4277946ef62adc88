#include "hydrotin/river_burning.h"

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <numeric>
#include <optional>

#include "declines.h"
#include "terrain_links.h"

namespace hydrotin {
namespace {

using Number = boost::multiprecision::cpp_rational;
constexpr auto kNone = static_cast<std::uint32_t>(-1);
constexpr double kStorageSlack = 1e-8;  // what turning rationals into doubles may cost

struct Line {
  Number slope, offset;
  [[nodiscard]] Number at(const Number& h) const { return slope * h + offset; }
};

struct Interval {
  std::optional<Number> low, high;  // absent = unbounded
  [[nodiscard]] bool has_inside(const Number& h) const { return (!low || *low < h) && (!high || h < *high); }
  void cut_low(const Number& h) {
    if (!low || *low < h) low = h;
  }
  void cut_high(const Number& h) {
    if (!high || h < *high) high = h;
  }
};

// What an edge allows its upper end when its lower end is at h: max(floors) <= x <= min(ceilings).
struct EdgeRegion {
  std::vector<Line> floors, ceilings;
  Interval domain;  // of h
};

// Value and one-sided slope of a maximum (sign = 1) or minimum (sign = -1) of lines; side = +1 right, -1 left.
Line tangent(const std::vector<Line>& lines, const Number& h, int sign, int side) {
  Line best;
  Number value;
  bool is_first = true;
  for (const Line& line : lines) {
    const Number here = line.at(h);
    const bool is_better = is_first || (sign > 0 ? here > value : here < value) ||
                           (here == value && (line.slope - best.slope) * sign * side > 0);
    if (!is_better) continue;
    best = line;
    value = here;
    is_first = false;
  }
  return best;
}

class Burner {
 public:
  Burner(const RiverTerrain& terrain, std::span<const RiverEdge> rivers, const BurningRows& rows)
      : terrain_(terrain),
        rivers_(rivers),
        rows_(rows),
        num_valleys_(static_cast<std::uint32_t>(rivers.size() - rows.num_chains)),
        links_(link_terrain(terrain)) {}

  Burning run() {
    if (!check_shape()) return std::move(result_);
    best_.resize(down_.size());
    domain_.resize(down_.size());
    for (const std::uint32_t v : order_)
      if (!settle(v)) return std::move(result_);
    assign_heights();
    return std::move(result_);
  }

 private:
  bool fail(BurningFault fault, std::uint32_t edge) {
    result_.fault = fault;
    result_.edge = edge;
    return false;
  }

  bool check_shape() {
    const std::uint32_t n = terrain_.num_vertices();
    down_.assign(n, kNone);
    begin_.assign(std::size_t{n} + 1, 0);
    std::vector<std::uint8_t> is_river(n, 0);
    for (std::uint32_t e = 0; e < rivers_.size(); ++e) {
      if (down_[rivers_[e].from] != kNone) return fail(BurningFault::not_a_forest, e);
      down_[rivers_[e].from] = e;
      is_river[rivers_[e].from] = is_river[rivers_[e].to] = 1;
      ++begin_[rivers_[e].to + 1];
    }
    for (std::uint32_t e = 0; e < num_valleys_; ++e) {
      const Wingtips tips = wingtips(terrain_, links_, rivers_[e].from, rivers_[e].to);
      for (int i = 0; i < tips.count; ++i)
        if (is_river[tips.vertex[i]] != 0) return fail(BurningFault::river_at_wingtip, e);
    }
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    above_.resize(rivers_.size());
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1), open(n, 0);
    for (std::uint32_t e = 0; e < rivers_.size(); ++e) {
      above_[next[rivers_[e].to]++] = e;
      ++open[rivers_[e].to];
    }
    for (std::uint32_t v = 0; v < n; ++v)
      if (is_river[v] != 0 && open[v] == 0) order_.push_back(v);
    for (std::size_t i = 0; i < order_.size(); ++i)
      if (const std::uint32_t e = down_[order_[i]]; e != kNone && --open[rivers_[e].to] == 0)
        order_.push_back(rivers_[e].to);
    region_.resize(rivers_.size());
    for (std::uint32_t e = 0; e < rivers_.size(); ++e) region_[e] = region_of(e);
    return true;
  }

  [[nodiscard]] EdgeRegion region_of(std::uint32_t e) const {
    const auto [from, to] = rivers_[e];
    const auto at = [&](std::uint32_t v, std::size_t axis) { return Number(terrain_.position[v][axis]); };
    const Number x = at(to, 0) - at(from, 0), y = at(to, 1) - at(from, 1);
    EdgeRegion region;
    const bool has_quantum = rows_.quantum > 0;
    const double slack = has_quantum ? kStorageSlack : 0;
    region.floors.push_back({1, Number(rows_.decline[e]) + Number(rows_.quantum) + Number(slack)});
    if (e >= num_valleys_) return region;
    const Wingtips tips = wingtips(terrain_, links_, from, to);
    for (int i = 0; i < tips.count; ++i) {
      const std::uint32_t w = tips.vertex[i];
      const Number t = ((at(w, 0) - at(from, 0)) * x + (at(w, 1) - at(from, 1)) * y) / (x * x + y * y);
      Number roof = Number(terrain_.height[w]);
      if (rows_.side_slope != 0) roof -= Number(rows_.side_slope * distance(e, w));
      if (has_quantum) {
        // As the row of the linear program, whose wingtip may move, too.
        const Number weights = 1 + abs(t) + abs(1 - t),
                     scale = std::max({Number(1), Number(abs(t)), Number(abs(1 - t))});
        roof -= weights * Number(rows_.quantum) / 2 + scale * Number(slack);
      }
      // (1 - t) x + t h <= roof
      const Number share = 1 - t;
      if (share == 0) {
        region.domain.cut_high(roof);  // t = 1
        continue;
      }
      (share > 0 ? region.ceilings : region.floors).push_back({-t / share, roof / share});
    }
    return region;
  }

  [[nodiscard]] double distance(std::uint32_t e, std::uint32_t w) const {
    const auto &a = terrain_.position[rivers_[e].from], &b = terrain_.position[rivers_[e].to],
               &c = terrain_.position[w];
    return std::abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) /
           std::hypot(b[0] - a[0], b[1] - a[1]);
  }

  // The region with the domain of C_u as constant lines: one clamp for all.
  void close_region(std::uint32_t e) {
    EdgeRegion& region = region_[e];
    const Interval& domain = domain_[rivers_[e].from];
    if (domain.low) region.floors.push_back({0, *domain.low});
    if (domain.high) region.ceilings.push_back({0, *domain.high});
    for (const Line& floor : region.floors)
      for (const Line& ceiling : region.ceilings) {
        const Number slope = floor.slope - ceiling.slope, room = ceiling.offset - floor.offset;  // slope * h <= room
        if (slope > 0) region.domain.cut_high(room / slope);
        if (slope < 0) region.domain.cut_low(room / slope);
        if (slope == 0 && room < 0) {  // never: an interval without points
          region.domain.cut_low(1);
          region.domain.cut_high(0);
        }
      }
  }

  // H(h) of an edge and its one-sided slope.
  [[nodiscard]] Line piece(std::uint32_t e, const Number& h, int side) const {
    const EdgeRegion& region = region_[e];
    const Number& best = best_[rivers_[e].from];
    Line line{0, best};
    const Line floor = tangent(region.floors, h, 1, side);
    Number value = floor.at(h);
    if (value > best || (value == best && floor.slope * side > 0)) return floor;
    if (region.ceilings.empty()) return line;
    const Line ceiling = tangent(region.ceilings, h, -1, side);
    value = ceiling.at(h);
    if (value < best || (value == best && ceiling.slope * side < 0)) return ceiling;
    return line;
  }

  // The slope of C_v at h on one side.
  Number slope(std::uint32_t v, const Number& h, int side) {
    struct Open {
      std::uint32_t vertex;
      Number h, factor;
      int side;
    };
    ++result_.evaluations;
    Number sum = 0;
    std::vector<Open> stack{{v, h, 1, side}};
    while (!stack.empty()) {
      const Open now = std::move(stack.back());
      stack.pop_back();
      const Number old(terrain_.height[now.vertex]);
      const int sign = now.h > old ? 1 : now.h < old ? -1 : now.side;
      sum += now.factor * sign;
      for (std::uint32_t i = begin_[now.vertex]; i < begin_[now.vertex + 1]; ++i) {
        const std::uint32_t e = above_[i];
        const Line line = piece(e, now.h, now.side);
        if (line.slope == 0) continue;
        stack.push_back(
            {rivers_[e].from, line.at(now.h), now.factor * line.slope, line.slope > 0 ? now.side : -now.side});
      }
    }
    return sum;
  }

  // A place on the river above v whose height is a linear function of v's over the whole interval.
  struct Place {
    std::uint32_t vertex;
    Line of;
  };

  // Finds the minimum of C_v, once those above are known.
  bool settle(std::uint32_t v) {
    Interval& domain = domain_[v];
    for (std::uint32_t i = begin_[v]; i < begin_[v + 1]; ++i) {
      close_region(above_[i]);
      const Interval& allowed = region_[above_[i]].domain;
      if (allowed.low) domain.cut_low(*allowed.low);
      if (allowed.high) domain.cut_high(*allowed.high);
      if (domain.low && domain.high && *domain.high < *domain.low) return fail(BurningFault::infeasible, above_[i]);
    }
    Interval interval = domain;
    if (is_minimum_at_end(v, interval)) return true;
    std::vector<Place> level{{v, {1, 0}}}, next;
    while (!level.empty()) {
      std::vector<Number> breaks;
      for (const Place& place : level) list_breaks(place, interval, breaks);
      if (shrink(v, interval, breaks)) return true;
      const Number inside = middle(interval);
      next.clear();
      for (const Place& place : level)
        for (std::uint32_t i = begin_[place.vertex]; i < begin_[place.vertex + 1]; ++i) {
          const Line line = piece(above_[i], place.of.at(inside), 1);
          if (line.slope != 0)
            next.push_back(
                {rivers_[above_[i]].from, {line.slope * place.of.slope, line.slope * place.of.offset + line.offset}});
        }
      level.swap(next);
    }
    // C_v is linear inside and falls into it from both ends: it is level there.
    best_[v] = interval.low ? *interval.low : *interval.high;
    return true;
  }

  bool is_minimum_at_end(std::uint32_t v, const Interval& interval) {
    if (interval.low && interval.high && *interval.low == *interval.high) {
      best_[v] = *interval.low;
      return true;
    }
    if (interval.low && slope(v, *interval.low, 1) >= 0) {
      best_[v] = *interval.low;
      return true;
    }
    if (interval.high && slope(v, *interval.high, -1) <= 0) {
      best_[v] = *interval.high;
      return true;
    }
    return false;
  }

  [[nodiscard]] static Number middle(const Interval& interval) {
    if (interval.low && interval.high) return (*interval.low + *interval.high) / 2;
    if (interval.low) return *interval.low + 1;
    return interval.high ? *interval.high - 1 : Number(0);
  }

  // Where C_v may bend because of one place: its old height, and the bends of H of the edges that end there.
  void list_breaks(const Place& place, const Interval& interval, std::vector<Number>& breaks) const {
    const auto add = [&](const Number& h) {
      const Number at = (h - place.of.offset) / place.of.slope;
      if (interval.has_inside(at)) breaks.push_back(at);
    };
    add(Number(terrain_.height[place.vertex]));
    for (std::uint32_t i = begin_[place.vertex]; i < begin_[place.vertex + 1]; ++i) {
      const EdgeRegion& region = region_[above_[i]];
      std::vector<Line> lines = region.floors;
      lines.insert(lines.end(), region.ceilings.begin(), region.ceilings.end());
      lines.push_back({0, best_[rivers_[above_[i]].from]});
      for (std::size_t a = 0; a < lines.size(); ++a)
        for (std::size_t b = a + 1; b < lines.size(); ++b)
          if (lines[a].slope != lines[b].slope)
            add((lines[b].offset - lines[a].offset) / (lines[a].slope - lines[b].slope));
    }
  }

  // Leaves no break inside the interval; true if the minimum was met on the way.
  bool shrink(std::uint32_t v, Interval& interval, std::vector<Number>& breaks) {
    std::sort(breaks.begin(), breaks.end());
    std::size_t low = 0, high = breaks.size();
    while (low < high) {
      const std::size_t half = (low + high) / 2;
      const Number& h = breaks[half];
      if (slope(v, h, 1) < 0) {
        interval.cut_low(h);
        low = half + 1;
      } else if (slope(v, h, -1) > 0) {
        interval.cut_high(h);
        high = half;
      } else {
        best_[v] = h;
        return true;
      }
    }
    return false;
  }

  // From the mouths upstream: what each vertex does when its lower neighbour is where it is.
  void assign_heights() {
    std::vector<Number> height(down_.size());
    Number total = 0;
    result_.height.assign(terrain_.height.begin(), terrain_.height.end());
    for (std::size_t i = order_.size(); i-- > 0;) {
      const std::uint32_t v = order_[i], e = down_[v];
      height[v] = e == kNone ? best_[v] : piece(e, height[rivers_[e].to], 1).at(height[rivers_[e].to]);
      total += abs(height[v] - Number(terrain_.height[v]));
      result_.height[v] = height[v].convert_to<double>();
    }
    result_.objective = total.convert_to<double>();
  }

  RiverTerrain terrain_;
  std::span<const RiverEdge> rivers_;
  BurningRows rows_;
  std::uint32_t num_valleys_;
  TerrainLinks links_;
  std::vector<std::uint32_t> down_, begin_, above_, order_;  // edge down; edges that end at a vertex (CSR); downstream
  std::vector<EdgeRegion> region_;                           // [R]
  std::vector<Number> best_;                                 // [n] h* of the thesis
  std::vector<Interval> domain_;                             // [n] of C_v
  Burning result_;
};

}  // namespace

Burning burn_rivers(const RiverTerrain& terrain, std::span<const RiverEdge> rivers, const BurningRows& rows) {
  return Burner(terrain, rivers, rows).run();
}

namespace {

std::vector<std::uint32_t> ends_of(const std::vector<RiverEdge>& edges) {
  std::vector<std::uint32_t> ends;
  for (const auto& [from, to] : edges) ends.insert(ends.end(), {from, to});
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  return ends;
}

}  // namespace

BurnedEmbedding embed_by_burning(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                                 const EmbeddingOptions& options) {
  const RiverConstraints& constraints = options.constraints;
  std::vector<RiverEdge> edges(rivers.begin(), rivers.end());
  edges.insert(edges.end(), constraints.chain.begin(), constraints.chain.end());
  BurnedEmbedding out;
  Embedding& embedding = out.embedding;
  embedding.touched = ends_of(edges);
  for (const std::uint32_t v : embedding.touched)
    if (!options.is_complete.empty() && options.is_complete[v] == 0) embedding.incomplete.push_back(v);
  if (!embedding.incomplete.empty()) return out;
  Declines declines = find_declines(terrain, rivers, constraints);
  embedding.clamped_networks = std::move(declines.clamped);
  declines.drop.resize(edges.size(), 0.0);
  Burning burning =
      burn_rivers(terrain, edges, {declines.drop, constraints.side_slope, constraints.chain.size(), options.quantum});
  out.fault = burning.fault;
  if (burning.fault != BurningFault::none) {
    out.edge = edges[burning.edge];
    return out;
  }
  embedding.height = std::move(burning.height);
  embedding.bound = embedding.objective = burning.objective;
  if (options.quantum > 0) {
    embedding.objective = 0;
    for (const std::uint32_t v : embedding.touched) {
      double& h = embedding.height[v];
      if (h != terrain.height[v]) h = std::round(h / options.quantum) * options.quantum;
      embedding.objective += std::abs(h - terrain.height[v]);
    }
  }
  embedding.optimal = true;
  embedding.rounds = 1;
  embedding.columns = embedding.touched.size();
  embedding.rows = edges.size();
  const TerrainLinks links = link_terrain(terrain);
  for (const auto& [from, to] : rivers)
    embedding.rows += static_cast<std::uint64_t>(wingtips(terrain, links, from, to).count);
  return out;
}

std::vector<double> fractional_declines(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                                        double fraction) {
  RiverConstraints constraints;
  constraints.decline_measure = DeclineMeasure::fraction;
  constraints.decline = fraction;
  return find_declines(terrain, rivers, constraints).drop;
}

}  // namespace hydrotin
