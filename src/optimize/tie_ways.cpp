#include "tie_ways.h"

#include <algorithm>
#include <limits>

#include "hydrotin/predicates.h"

namespace hydrotin {

bool TieWays::build(const PolygonProblem& problem, const PolygonGraph& graph, const ComponentTies& ties,
                    std::uint64_t most_ways, std::uint64_t most_visits) {
  graph_ = &graph;
  component_ = ties.component;
  if (!list_chains(graph, ties, std::min<std::uint64_t>(most_ways, kMostWays))) return false;
  if (!make_cuts(most_visits) || !make_cells(most_visits)) return false;
  mark_cuts(ties);
  mark_cells(problem, ties);
  return true;
}

// Components stand in the order of their last vertices, and ties lead to later ones: the chains of the component at a
// tie's end are there before.
bool TieWays::list_chains(const PolygonGraph& graph, const ComponentTies& ties, std::uint64_t most) {
  const std::uint32_t num_components = ties.num_components();
  std::vector<std::uint32_t> begin(num_components), end(num_components);
  std::vector<Chain> chain;
  for (std::uint32_t c = num_components; c-- > 0;) {
    begin[c] = static_cast<std::uint32_t>(chain.size());
    for (std::uint32_t tie = ties.begin[c]; tie < ties.begin[c + 1]; ++tie) {
      const std::uint32_t beyond = component_[graph.edge(ties.tie[tie].edge).target];
      if (beyond == kNoEdge) chain.push_back({tie, kNoEdge});
      if (beyond != kNoEdge)
        for (std::uint32_t rest = begin[beyond]; rest < end[beyond]; ++rest) chain.push_back({tie, rest});
      if (chain.size() - begin[c] > most) return false;
    }
    end[c] = static_cast<std::uint32_t>(chain.size());
  }
  // From the last component first to the first one first.
  chain_.resize(chain.size());
  chain_begin_.assign(1, 0);
  std::vector<std::uint32_t> moved(chain.size());
  for (std::uint32_t c = 0; c < num_components; ++c) {
    for (std::uint32_t i = begin[c]; i < end[c]; ++i) moved[i] = chain_begin_[c] + (i - begin[c]);
    chain_begin_.push_back(chain_begin_[c] + end[c] - begin[c]);
  }
  for (std::size_t i = 0; i < chain.size(); ++i)
    chain_[moved[i]] = {chain[i].tie, chain[i].rest == kNoEdge ? kNoEdge : moved[chain[i].rest]};
  return true;
}

bool TieWays::make_cuts(std::uint64_t most_visits) {
  const std::uint32_t num_triangles = graph_->num_triangles();
  const auto count = [&](std::uint32_t v) { return std::uint64_t{num_chains(v)}; };
  visits_ = 0;
  touches_.assign(num_triangles, 0);
  cut_begin_.resize(3 * std::size_t{num_triangles});
  std::uint64_t num_cuts = 0;
  for (std::uint32_t t = 0; t < num_triangles; ++t) {
    const auto& v = graph_->triangle(t);
    if ((component_[v[0]] & component_[v[1]] & component_[v[2]]) == kNoEdge) {
      ++visits_;
      continue;
    }
    touches_[t] = 1;
    visits_ += count(v[0]) * count(v[1]) * count(v[2]);
    if (visits_ > most_visits) return false;
    for (std::size_t i = 0; i < 3; ++i) {
      const bool is_tied = component_[v[i]] != kNoEdge;
      cut_begin_[3 * std::size_t{t} + i] = is_tied ? static_cast<std::uint32_t>(num_cuts) : kNoEdge;
      if (is_tied) num_cuts += count(v[i]);
    }
  }
  cut_.assign(num_cuts, false);
  return visits_ <= most_visits;
}

bool TieWays::make_cells(std::uint64_t most_visits) {
  num_edges_ = graph_->num_edges();
  std::uint64_t num_cells = num_edges_;
  first_cell_.resize(num_edges_);
  place_.clear();
  if (num_cells > most_visits) return false;
  for (std::uint32_t e = 0; e < num_edges_; ++e) {
    const std::uint32_t a = graph_->edge(e).origin, b = graph_->edge(e).target;
    if (!is_tied(a, b)) continue;
    const std::uint32_t at_a = num_chains(a), at_b = num_chains(b);
    num_cells += std::uint64_t{at_a} * at_b - 1;
    if (num_cells > most_visits || num_edges_ + num_cells > std::numeric_limits<std::uint32_t>::max()) return false;
    first_cell_[e] = num_edges_ + static_cast<std::uint32_t>(place_.size());
    for (std::uint32_t i = 0; i < at_a; ++i)
      for (std::uint32_t j = 0; j < at_b; ++j)
        place_.push_back({e, static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(j)});
  }
  return true;
}

void TieWays::mark_cuts(const ComponentTies& ties) {
  for (std::uint32_t c = 0; c < ties.num_components(); ++c)
    for (std::uint32_t first = chain_begin_[c]; first < chain_begin_[c + 1]; ++first)
      for (std::uint32_t i = first; i != kNoEdge; i = chain_[i].rest)
        for (std::uint32_t b = ties.blocked_begin[chain_[i].tie]; b < ties.blocked_begin[chain_[i].tie + 1]; ++b) {
          const auto& v = graph_->triangle(ties.blocked[b]);
          for (std::size_t corner = 0; corner < 3; ++corner)
            if (component_[v[corner]] == c)
              cut_[cut_begin_[3 * std::size_t{ties.blocked[b]} + corner] + first - chain_begin_[c]] = true;
        }
}

void TieWays::mark_cells(const PolygonProblem& problem, const ComponentTies& ties) {
  kind_.resize(place_.size());
  for (std::uint32_t c = 0; c < kind_.size(); ++c) kind_[c] = kind_of(c, problem, ties);
}

TieWays::Kind TieWays::kind_of(std::uint32_t c, const PolygonProblem& problem, const ComponentTies& ties) const {
  const Place& place = place_[c];
  const PolygonEdge& edge = graph_->edge(place.edge);
  const std::uint32_t a = component_[edge.origin], b = component_[edge.target];
  const auto begins_with = [&](std::uint32_t component, std::uint32_t number) {
    if (component == kNoEdge) return false;
    const Tie& tie = ties.tie[chain_[chain_begin_[component] + number].tie];
    return tie.edge == place.edge || tie.twin == place.edge;
  };
  if (a != kNoEdge && b != kNoEdge &&
      !fit(chain_begin_[a] + place.at_origin, chain_begin_[b] + place.at_target, problem, ties))
    return Kind::unfit;
  return edge.is_boundary || begins_with(a, place.at_origin) || begins_with(b, place.at_target) ? Kind::end
                                                                                                : Kind::open;
}

// Whether both chains can be in one triangulation: no component is tied twice, no ties cross.
bool TieWays::fit(std::uint32_t chain, std::uint32_t other, const PolygonProblem& problem,
                  const ComponentTies& ties) const {
  for (std::uint32_t i = chain; i != kNoEdge; i = chain_[i].rest)
    for (std::uint32_t j = other; j != kNoEdge; j = chain_[j].rest) {
      if (chain_[i].tie == chain_[j].tie) continue;
      const PolygonEdge &s = graph_->edge(ties.tie[chain_[i].tie].edge),
                        &t = graph_->edge(ties.tie[chain_[j].tie].edge);
      if (component_[s.origin] == component_[t.origin]) return false;
      const auto at = [&](std::uint32_t v) { return problem.position[v]; };
      if (properly_cross(at(s.origin), at(s.target), at(t.origin), at(t.target))) return false;
    }
  return true;
}

}  // namespace hydrotin
