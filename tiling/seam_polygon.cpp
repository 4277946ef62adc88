#include "seam_polygon.h"

#include <algorithm>

namespace hydrotin {
namespace {

std::array<std::uint32_t, 3> from_smallest(std::array<std::uint32_t, 3> t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

}  // namespace

void SeamPolygon::clear() {
  number_.clear();
  vertex_.clear();
  position_.clear();
  height_.clear();
  wants_.clear();
  delaunay_.clear();
  fixed_.clear();
  met_.clear();
  others_.clear();
  others_order_.clear();
  reference_.clear();
  hull_.clear();
}

void SeamPolygon::add(const Piece& piece) {
  std::vector<std::uint32_t> local;
  for (std::size_t i = 0; i < piece.vertex.size(); ++i) {
    const auto [found, fresh] =
        number_.try_emplace(piece.vertex[i].point.value, static_cast<std::uint32_t>(vertex_.size()));
    if (fresh) {
      vertex_.push_back(piece.vertex[i]);
      position_.push_back(piece.vertex[i].position);
      height_.push_back(piece.vertex[i].height);
      wants_.push_back(0);
    }
    wants_[found->second] |= piece.wants_lower[i];
    local.push_back(found->second);
  }
  for (ReferencePoint p : piece.reference) {
    p.triangle += static_cast<std::uint32_t>(delaunay_.size());
    reference_.push_back(p);
  }
  for (const auto& t : piece.delaunay) delaunay_.push_back({local[t[0]], local[t[1]], local[t[2]]});
  fixed_.insert(fixed_.end(), piece.fixed.begin(), piece.fixed.end());
  for (std::size_t i = 0; i < piece.others.size(); ++i) {
    const auto& t = piece.others[i];
    met_.push_back({from_smallest({local[t[0]], local[t[1]], local[t[2]]}), piece.others_order[i]});
  }
  hull_.insert(hull_.end(), piece.hull.begin(), piece.hull.end());
}

bool SeamPolygon::adopt(std::span<const std::uint64_t> wanting) {
  bool any = false;
  for (std::size_t v = 0; v < vertex_.size(); ++v) {
    if (wants_[v] != 0 || !std::binary_search(wanting.begin(), wanting.end(), vertex_[v].point.value)) continue;
    wants_[v] = 1;
    any = true;
  }
  return any;
}

PolygonProblem SeamPolygon::problem() {
  std::sort(met_.begin(), met_.end());
  met_.erase(std::unique(met_.begin(), met_.end()), met_.end());
  for (const auto& [triangle, order] : met_) {
    others_.push_back(triangle);
    others_order_.push_back(order);
  }
  return {position_, height_, wants_, delaunay_, fixed_, others_, others_order_, num_components(), reference_};
}

std::uint32_t SeamPolygon::num_components() const {
  std::size_t open_sides = 0;
  for (const std::uint8_t mask : fixed_) open_sides += 3U - ((mask & 1U) + (mask >> 1 & 1U) + (mask >> 2 & 1U));
  return static_cast<std::uint32_t>(open_sides / 2 + 1 - fixed_.size());
}

SeamList::SeamList(const RunContext& context, std::uint32_t tile) : context_(context) {
  const store::Reader join(context.layout.unit(Phase::join, 0));
  const auto range = join.read_range<std::uint64_t>("polygon_begin", tile, 2);
  begin_ = join.read_range<std::uint64_t>("member_begin", range[0], range[1] - range[0] + 1);
  const std::uint64_t first = begin_.front();
  tile_ = join.read_range<std::uint32_t>("member_tile", first, begin_.back() - first);
  piece_ = join.read_range<std::uint32_t>("member_piece", first, begin_.back() - first);
  for (std::uint64_t& b : begin_) b -= first;
}

void SeamList::read(std::uint32_t number, SeamPolygon& polygon) {
  polygon.clear();
  for (std::uint64_t m = begin_[number]; m < begin_[number + 1]; ++m) polygon.add(pieces_of(tile_[m]).piece(piece_[m]));
}

const PieceReader& SeamList::pieces_of(std::uint32_t tile) {
  const auto found = pieces_.find(tile);
  if (found != pieces_.end()) return found->second;
  return pieces_.emplace(tile, PieceReader(store::Reader(context_.layout.unit(Phase::triangulate, tile))))
      .first->second;
}

}  // namespace hydrotin
