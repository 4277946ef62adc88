#include "tiled_groups.h"

#include <algorithm>
#include <numeric>

namespace hydrotin {

std::uint32_t GroupJoiner::add_piece(std::uint32_t tile, std::uint64_t size) {
  index_.push_back(!tile_.empty() && tile_.back() == tile ? index_.back() + 1 : 0);
  tile_.push_back(tile);
  size_.push_back(size);
  return static_cast<std::uint32_t>(tile_.size() - 1);
}

JoinedGroups GroupJoiner::join() {
  std::vector<std::uint32_t> parent(tile_.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto find = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  const auto unite = [&](std::uint32_t a, std::uint32_t b) {
    a = find(a), b = find(b);
    parent[std::max(a, b)] = std::min(a, b);
  };
  std::sort(vertex_.begin(), vertex_.end());
  for (std::size_t i = 1; i < vertex_.size(); ++i)
    if (vertex_[i].first == vertex_[i - 1].first) unite(vertex_[i].second, vertex_[i - 1].second);
  for (const auto& [a, b] : union_) unite(a, b);

  JoinedGroups out;
  out.tile = std::move(tile_);
  out.index = std::move(index_);
  out.group.resize(parent.size());
  std::vector<std::uint64_t> largest;
  for (std::uint32_t p = 0; p < parent.size(); ++p) {
    const std::uint32_t root = find(p);
    if (root == p) {
      out.group[p] = static_cast<std::uint32_t>(out.owner.size());
      out.owner.push_back(out.tile[p]);
      out.size.push_back(0);
      largest.push_back(size_[p]);
    } else {
      out.group[p] = out.group[root];
    }
    const std::uint32_t g = out.group[p];
    out.size[g] += size_[p];
    if (size_[p] > largest[g]) {
      largest[g] = size_[p];
      out.owner[g] = out.tile[p];
    }
  }
  for (std::size_t i = 1; i < vertex_.size(); ++i) {
    if (vertex_[i].first != vertex_[i - 1].first) continue;
    std::uint64_t& size = out.size[out.group[vertex_[i].second]];
    if (size > 0) --size;
  }
  out.piece_begin.assign(out.owner.size() + 1, 0);
  for (const std::uint32_t g : out.group) ++out.piece_begin[g + 1];
  std::partial_sum(out.piece_begin.begin(), out.piece_begin.end(), out.piece_begin.begin());
  out.piece.resize(out.group.size());
  std::vector<std::uint32_t> next(out.piece_begin.begin(), out.piece_begin.end() - 1);
  for (std::uint32_t p = 0; p < out.group.size(); ++p) out.piece[next[out.group[p]]++] = p;
  for (std::uint32_t g = 0; g < out.owner.size(); ++g) {
    if (out.owner[g] >= out.groups_of.size()) out.groups_of.resize(std::size_t{out.owner[g]} + 1);
    out.groups_of[out.owner[g]].push_back(g);
  }
  return out;
}

}  // namespace hydrotin
