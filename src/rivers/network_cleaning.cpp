#include "hydrotin/network_cleaning.h"

#include <algorithm>
#include <numeric>
#include <queue>
#include <tuple>

namespace hydrotin {
namespace {

constexpr auto kNone = static_cast<std::uint32_t>(-1);

class Cleaner {
 public:
  Cleaner(std::span<const LatticePoint> position, std::span<const double> height, const RiverPaths& paths)
      : position_(position),
        height_(height),
        stamp_(position.size(), 0),
        first_out_(position.size(), kNone),
        laid_(position.size(), 0) {
    for (std::size_t i = 0; i < paths.size(); ++i) add_without_loops(paths.path(i), paths.line[i]);
    sort_reaches();
  }

  CleanNetwork run() {
    link_nodes();
    cut_cycles();
    measure_upstream();
    lay_all();
    sort_edges();
    return std::move(result_);
  }

 private:
  [[nodiscard]] std::uint32_t source(std::uint32_t r) const { return reach_[r].vertex.front(); }
  [[nodiscard]] std::uint32_t mouth(std::uint32_t r) const { return reach_[r].vertex.back(); }

  // Of a vertex that comes again, everything since the first time goes.
  void add_without_loops(std::span<const std::uint32_t> path, std::uint32_t line) {
    ++generation_;
    Reach reach{{}, line, 0, false};
    for (const std::uint32_t v : path) {
      if (stamp_[v] == generation_) {
        while (reach.vertex.back() != v) {
          stamp_[reach.vertex.back()] = 0;
          reach.vertex.pop_back();
          ++result_.counts.loop_edges;
        }
        ++result_.counts.loop_edges;  // the edge back
        continue;
      }
      stamp_[v] = generation_;
      reach.vertex.push_back(v);
    }
    if (reach.vertex.size() > 1) reach_.push_back(std::move(reach));
  }

  void sort_reaches() {
    const auto by_place = [&](std::uint32_t a, std::uint32_t b) { return position_[a] < position_[b]; };
    std::sort(reach_.begin(), reach_.end(), [&](const Reach& a, const Reach& b) {
      if (a.vertex == b.vertex) return a.line < b.line;
      return std::lexicographical_compare(a.vertex.begin(), a.vertex.end(), b.vertex.begin(), b.vertex.end(), by_place);
    });
    const auto same = std::unique(reach_.begin(), reach_.end(), [&](const Reach& a, const Reach& b) {
      if (a.vertex != b.vertex) return false;
      result_.counts.repeated_edges += a.vertex.size() - 1;
      return true;
    });
    reach_.erase(same, reach_.end());
  }

  void link_nodes() {
    for (std::uint32_t r = 0; r < reach_.size(); ++r) {
      node_.push_back(source(r));
      node_.push_back(mouth(r));
    }
    const auto by_place = [&](std::uint32_t a, std::uint32_t b) { return position_[a] < position_[b]; };
    std::sort(node_.begin(), node_.end(), by_place);
    node_.erase(std::unique(node_.begin(), node_.end()), node_.end());
    node_of_.assign(position_.size(), kNone);
    for (std::uint32_t i = 0; i < node_.size(); ++i) node_of_[node_[i]] = i;
    out_.resize(node_.size());
    in_.resize(node_.size());
    for (std::uint32_t r = 0; r < reach_.size(); ++r) {
      out_[node_of_[source(r)]].push_back(r);
      in_[node_of_[mouth(r)]].push_back(r);
    }
  }

  // Peels nodes without reaches up to them; where none is left there is a circle.
  void cut_cycles() {
    std::vector<std::uint32_t> open_in(node_.size()), ready;
    std::size_t left = 0;
    for (std::uint32_t i = 0; i < node_.size(); ++i) {
      open_in[i] = static_cast<std::uint32_t>(in_[i].size());
      left += in_[i].size();
      if (open_in[i] == 0) ready.push_back(i);
    }
    std::vector<std::uint8_t> is_done(reach_.size(), 0);
    std::uint32_t next_node = 0;
    const auto finish = [&](std::uint32_t r) {
      is_done[r] = 1;
      --left;
      const std::uint32_t below = node_of_[mouth(r)];
      if (--open_in[below] == 0) ready.push_back(below);
    };
    while (left > 0) {
      while (!ready.empty()) {
        const std::uint32_t i = ready.back();
        ready.pop_back();
        order_.push_back(i);
        for (const std::uint32_t r : out_[i])
          if (is_done[r] == 0) finish(r);
      }
      if (left == 0) break;
      while (open_in[next_node] == 0) ++next_node;
      finish(cut_cycle_above(next_node, is_done));
    }
    for (const std::uint32_t i : ready) order_.push_back(i);
  }

  // Upstream from a node, each node on the way has a reach above it that is not done: the way closes.
  std::uint32_t cut_cycle_above(std::uint32_t node, const std::vector<std::uint8_t>& is_done) {
    const auto above = [&](std::uint32_t i) {
      return *std::find_if(in_[i].begin(), in_[i].end(), [&](std::uint32_t r) { return is_done[r] == 0; });
    };
    std::vector<std::uint8_t> is_seen(node_.size(), 0);
    while (is_seen[node] == 0) {
      is_seen[node] = 1;
      node = node_of_[source(above(node))];
    }
    std::vector<std::uint32_t> cycle;
    for (std::uint32_t i = node; cycle.empty() || i != node; i = node_of_[source(cycle.back())])
      cycle.push_back(above(i));
    std::reverse(cycle.begin(), cycle.end());
    const auto rise = [&](std::uint32_t r) { return height_[mouth(r)] - height_[source(r)]; };
    const auto worst = std::max_element(cycle.begin(), cycle.end(), [&](std::uint32_t a, std::uint32_t b) {
      return rise(a) != rise(b) ? rise(a) < rise(b) : a > b;
    });
    std::rotate(cycle.begin(), worst, cycle.end());
    for (const std::uint32_t r : cycle) result_.cycle.push_back(reach_[r].line);
    result_.cycle_begin.push_back(result_.cycle.size());
    reach_[cycle.front()].is_cut = true;
    result_.counts.cycle_edges += reach_[cycle.front()].vertex.size() - 1;
    return cycle.front();
  }

  // Edges above and in each reach (some twice where rivers part and meet again): what makes a river large.
  void measure_upstream() {
    for (const std::uint32_t i : order_) {
      double sum = 0;
      for (const std::uint32_t r : in_[i]) sum += reach_[r].is_cut ? 0 : reach_[r].upstream;
      for (const std::uint32_t r : out_[i]) reach_[r].upstream = sum + static_cast<double>(reach_[r].vertex.size());
    }
  }

  void lay_all() {
    const auto later = [&](std::uint32_t a, std::uint32_t b) {
      return reach_[a].upstream != reach_[b].upstream ? reach_[a].upstream < reach_[b].upstream : a > b;
    };
    std::priority_queue<std::uint32_t, std::vector<std::uint32_t>, decltype(later)> ready(later);
    std::vector<std::uint32_t> open_out(node_.size(), 0);
    const auto open_node = [&](std::uint32_t i) {
      for (const std::uint32_t r : in_[i])
        if (!reach_[r].is_cut) ready.push(r);
    };
    for (std::uint32_t i = 0; i < node_.size(); ++i)
      for (const std::uint32_t r : out_[i]) open_out[i] += reach_[r].is_cut ? 0 : 1;
    for (std::uint32_t i = 0; i < node_.size(); ++i)
      if (open_out[i] == 0) open_node(i);
    while (!ready.empty()) {
      const std::uint32_t r = ready.top();
      ready.pop();
      lay(reach_[r].vertex, reach_[r].line);
      const std::uint32_t above = node_of_[source(r)];
      if (--open_out[above] == 0) open_node(above);
    }
  }

  void lay(const std::vector<std::uint32_t>& path, std::uint32_t line) {
    CleaningCounts& counts = result_.counts;
    const std::size_t last = path.size() - 1;
    for (std::size_t i = 0, j; i < last; i = j) {
      for (j = i + 1; j < last && laid_[path[j]] == 0;) ++j;
      const std::uint32_t from = path[i], to = path[j];
      if (laid_[from] != 0 && j == i + 1) {
        if (has_edge(from, to)) {
          ++counts.repeated_edges;
          continue;
        }
        if (has_edge(to, from)) {
          ++counts.opposed_edges;
          continue;
        }
      }
      if (i > 0 && reaches(from, path[last])) {
        counts.joined_edges += last - i;
        return;
      }
      if (laid_[from] != 0 && j == i + 1 && laid_[to] != 0 && reaches(from, to)) {
        ++counts.shortcut_edges;
        continue;
      }
      if (laid_[from] != 0 && reaches(to, from)) {
        counts.cycle_edges += j - i;
        continue;
      }
      for (std::size_t k = i; k < j; ++k) add_edge(path[k], path[k + 1], line);
    }
  }

  void add_edge(std::uint32_t from, std::uint32_t to, std::uint32_t line) {
    const auto e = static_cast<std::uint32_t>(result_.edge.size());
    result_.edge.push_back({from, to});
    result_.line.push_back(line);
    next_out_.push_back(first_out_[from]);
    first_out_[from] = e;
    laid_[from] = laid_[to] = 1;
  }

  [[nodiscard]] bool has_edge(std::uint32_t from, std::uint32_t to) const {
    for (std::uint32_t e = first_out_[from]; e != kNone; e = next_out_[e])
      if (result_.edge[e].to == to) return true;
    return false;
  }

  // Whether water gets from one vertex to another over the edges laid.
  bool reaches(std::uint32_t from, std::uint32_t to) {
    if (from == to) return true;
    ++generation_;
    std::vector<std::uint32_t> open{from};
    while (!open.empty()) {
      const std::uint32_t v = open.back();
      open.pop_back();
      for (std::uint32_t e = first_out_[v]; e != kNone; e = next_out_[e]) {
        const std::uint32_t w = result_.edge[e].to;
        if (w == to) return true;
        if (stamp_[w] == generation_) continue;
        stamp_[w] = generation_;
        open.push_back(w);
      }
    }
    return false;
  }

  void sort_edges() {
    std::vector<std::uint32_t> order(result_.edge.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(position_[result_.edge[a].from], position_[result_.edge[a].to]) <
             std::pair(position_[result_.edge[b].from], position_[result_.edge[b].to]);
    });
    CleanNetwork sorted;
    for (const std::uint32_t e : order) {
      sorted.edge.push_back(result_.edge[e]);
      sorted.line.push_back(result_.line[e]);
    }
    result_.edge = std::move(sorted.edge);
    result_.line = std::move(sorted.line);
  }

  struct Reach {
    std::vector<std::uint32_t> vertex;
    std::uint32_t line;
    double upstream;
    bool is_cut;
  };
  std::span<const LatticePoint> position_;
  std::span<const double> height_;
  std::vector<Reach> reach_;
  std::vector<std::uint32_t> node_, node_of_, order_;  // order: nodes, upstream ones first
  std::vector<std::vector<std::uint32_t>> out_, in_;   // reaches of each node
  std::vector<std::uint64_t> stamp_;
  std::uint64_t generation_ = 0;
  std::vector<std::uint32_t> first_out_, next_out_;
  std::vector<std::uint8_t> laid_;
  CleanNetwork result_;
};

}  // namespace

CleanNetwork clean_network(std::span<const LatticePoint> position, std::span<const double> height,
                           const RiverPaths& paths) {
  return Cleaner(position, height, paths).run();
}

}  // namespace hydrotin
