#include "pieces.h"

#include <algorithm>

namespace hydrotin {
namespace {

Error damaged(const std::string& path) {
  return {ErrorKind::storage, path + ": the pieces of polygons contradict each other; delete the file and run again"};
}

std::vector<std::uint32_t> read_offsets(const store::Reader& in, const std::string& name, std::uint64_t total) {
  auto begin = in.read<std::uint32_t>(name);
  if (begin.empty() || begin.front() != 0 || begin.back() != total || !std::is_sorted(begin.begin(), begin.end()))
    throw damaged(in.path());
  return begin;
}

}  // namespace

std::uint32_t PieceWriter::add(const Piece& piece) {
  for (const PieceVertex& v : piece.vertex) {
    point_.push_back(v.point.value);
    xyz_.insert(xyz_.end(), {v.position.x, v.position.y, v.height});
  }
  wants_.insert(wants_.end(), piece.wants_lower.begin(), piece.wants_lower.end());
  fixed_.insert(fixed_.end(), piece.fixed.begin(), piece.fixed.end());
  for (const auto& t : piece.delaunay) delaunay_.insert(delaunay_.end(), t.begin(), t.end());
  for (const auto& t : piece.others) others_.insert(others_.end(), t.begin(), t.end());
  others_order_.insert(others_order_.end(), piece.others_order.begin(), piece.others_order.end());
  for (const ReferencePoint& p : piece.reference) {
    reference_xyz_.insert(reference_xyz_.end(), {p.position.x, p.position.y, p.height});
    reference_triangle_.push_back(p.triangle);
    reference_on_rim_.push_back(p.on_rim);
  }
  reference_begin_.push_back(static_cast<std::uint32_t>(reference_triangle_.size()));
  vertex_begin_.push_back(static_cast<std::uint32_t>(point_.size()));
  delaunay_begin_.push_back(static_cast<std::uint32_t>(fixed_.size()));
  others_begin_.push_back(static_cast<std::uint32_t>(others_.size() / 3));
  return static_cast<std::uint32_t>(vertex_begin_.size() - 2);
}

void PieceWriter::add_border(PointId a, PointId b, std::uint32_t piece) {
  border_a_.push_back(std::min(a, b).value);
  border_b_.push_back(std::max(a, b).value);
  border_piece_.push_back(piece);
}

void PieceWriter::add_hull(PointId origin, PointId target, std::uint32_t piece) {
  hull_.push_back({piece, origin, target});
}

void PieceWriter::write(store::Writer& out) const {
  std::vector<HullEdge> hull = hull_;
  std::sort(hull.begin(), hull.end());
  std::vector<std::uint32_t> hull_piece;
  std::vector<std::uint64_t> hull_edge;
  for (const HullEdge& e : hull) {
    hull_piece.push_back(e.piece);
    hull_edge.insert(hull_edge.end(), {e.origin.value, e.target.value});
  }
  out.append("piece_hull_piece", hull_piece, "piece of each hull edge, ascending");
  out.append("piece_hull_edge", hull_edge, "directed edges of the hull at pieces, as pairs of points");
  out.append("piece_vertex_begin", vertex_begin_, "first vertex of each piece");
  out.append("piece_point", point_, "tile << 32 | index");
  out.append("piece_xyz", xyz_);
  out.append("piece_wants_lower", wants_);
  out.append("piece_delaunay_begin", delaunay_begin_, "first Delaunay triangle of each piece");
  out.append("piece_delaunay", delaunay_, "vertices of the piece, three per triangle");
  out.append("piece_fixed", fixed_, "bit i: the side from corner i is fixed");
  out.append("piece_others_begin", others_begin_, "first other order-k triangle of each piece");
  out.append("piece_others", others_);
  out.append("piece_others_order", others_order_);
  out.append("piece_reference_begin", reference_begin_, "first reference point of each piece");
  out.append("piece_reference_xyz", reference_xyz_);
  out.append("piece_reference_triangle", reference_triangle_, "Delaunay triangle of the piece that owns it");
  out.append("piece_reference_on_rim", reference_on_rim_, "1: on an edge of the hull");
  out.append("border_a", border_a_, "ends of the edges between pieces of different tiles");
  out.append("border_b", border_b_);
  out.append("border_piece", border_piece_);
}

PieceReader::PieceReader(const store::Reader& in)
    : path_(in.path()),
      vertex_begin_(read_offsets(in, "piece_vertex_begin", in.size("piece_point"))),
      delaunay_begin_(read_offsets(in, "piece_delaunay_begin", in.size("piece_fixed"))),
      others_begin_(read_offsets(in, "piece_others_begin", in.size("piece_others") / 3)),
      point_(in.read<std::uint64_t>("piece_point")),
      xyz_(in.read<std::int32_t>("piece_xyz")),
      wants_(in.read<std::uint8_t>("piece_wants_lower")),
      fixed_(in.read<std::uint8_t>("piece_fixed")),
      delaunay_(in.read<std::uint32_t>("piece_delaunay")),
      others_(in.read<std::uint32_t>("piece_others")) {
  others_order_ = in.read<std::uint8_t>("piece_others_order");
  reference_triangle_ = in.read<std::uint32_t>("piece_reference_triangle");
  reference_begin_ = read_offsets(in, "piece_reference_begin", reference_triangle_.size());
  reference_xyz_ = in.read<std::int32_t>("piece_reference_xyz");
  reference_on_rim_ = in.read<std::uint8_t>("piece_reference_on_rim");
  if (reference_begin_.size() != delaunay_begin_.size() || reference_xyz_.size() != 3 * reference_triangle_.size() ||
      reference_on_rim_.size() != reference_triangle_.size())
    throw damaged(path_);
  const auto hull_piece = in.read<std::uint32_t>("piece_hull_piece");
  const auto hull_edge = in.read<std::uint64_t>("piece_hull_edge");
  if (hull_edge.size() != 2 * hull_piece.size() || !std::is_sorted(hull_piece.begin(), hull_piece.end()))
    throw damaged(path_);
  for (std::size_t i = 0; i < hull_piece.size(); ++i)
    hull_.push_back({hull_piece[i], PointId(hull_edge[2 * i]), PointId(hull_edge[2 * i + 1])});
  if (vertex_begin_.size() != delaunay_begin_.size() || others_begin_.size() != delaunay_begin_.size() ||
      xyz_.size() != 3 * point_.size() || wants_.size() != point_.size() || delaunay_.size() != 3 * fixed_.size() ||
      others_.size() != 3 * others_order_.size())
    throw damaged(path_);
}

std::vector<std::array<std::uint32_t, 3>> PieceReader::triangles(const std::vector<std::uint32_t>& flat,
                                                                 std::uint32_t begin, std::uint32_t end,
                                                                 std::size_t num_vertices) const {
  std::vector<std::array<std::uint32_t, 3>> out;
  for (std::size_t i = std::size_t{3} * begin; i < std::size_t{3} * end; i += 3) {
    if (std::max({flat[i], flat[i + 1], flat[i + 2]}) >= num_vertices) throw damaged(path_);
    out.push_back({flat[i], flat[i + 1], flat[i + 2]});
  }
  return out;
}

Piece PieceReader::piece(std::uint32_t number) const {
  if (number >= num_pieces()) throw damaged(path_);
  Piece out;
  const std::uint32_t v0 = vertex_begin_[number], v1 = vertex_begin_[number + 1];
  for (std::size_t i = v0; i < v1; ++i)
    out.vertex.push_back({PointId(point_[i]), {xyz_[3 * i], xyz_[3 * i + 1]}, xyz_[3 * i + 2]});
  out.wants_lower.assign(wants_.begin() + v0, wants_.begin() + v1);
  const std::uint32_t t0 = delaunay_begin_[number], t1 = delaunay_begin_[number + 1];
  out.delaunay = triangles(delaunay_, t0, t1, out.vertex.size());
  out.fixed.assign(fixed_.begin() + t0, fixed_.begin() + t1);
  const std::uint32_t c0 = others_begin_[number], c1 = others_begin_[number + 1];
  out.others = triangles(others_, c0, c1, out.vertex.size());
  out.others_order.assign(others_order_.begin() + c0, others_order_.begin() + c1);
  for (std::size_t i = reference_begin_[number]; i < reference_begin_[number + 1]; ++i) {
    if (reference_triangle_[i] >= out.delaunay.size()) throw damaged(path_);
    out.reference.push_back({{reference_xyz_[3 * i], reference_xyz_[3 * i + 1]},
                             reference_xyz_[3 * i + 2],
                             reference_triangle_[i],
                             reference_on_rim_[i] != 0});
  }
  const auto by_piece = [](const HullEdge& a, const HullEdge& b) { return a.piece < b.piece; };
  const auto [first, last] = std::equal_range(hull_.begin(), hull_.end(), HullEdge{number, {}, {}}, by_piece);
  for (auto e = first; e != last; ++e) out.hull.push_back({e->origin, e->target});
  return out;
}

PieceSummary read_piece_summary(const store::Reader& in) {
  PieceSummary out;
  const auto begin = read_offsets(in, "piece_delaunay_begin", in.size("piece_fixed"));
  for (std::size_t i = 0; i + 1 < begin.size(); ++i) out.num_triangles.push_back(begin[i + 1] - begin[i]);
  const auto a = in.read<std::uint64_t>("border_a"), b = in.read<std::uint64_t>("border_b");
  const auto piece = in.read<std::uint32_t>("border_piece");
  if (a.size() != b.size() || a.size() != piece.size()) throw damaged(in.path());
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (piece[i] >= out.num_triangles.size()) throw damaged(in.path());
    out.border.push_back({PointId(a[i]), PointId(b[i]), piece[i]});
  }
  return out;
}

}  // namespace hydrotin
