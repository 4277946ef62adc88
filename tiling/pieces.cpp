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

void PieceWriter::write(store::Writer& out) const {
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
