#include "pieces.h"

#include <algorithm>

namespace hydrotin {
namespace {

Error damaged(const store::Reader& in) {
  return {ErrorKind::storage,
          in.path() + ": the pieces of polygons contradict each other; delete the file and run again"};
}

std::vector<std::uint32_t> read_offsets(const store::Reader& in, const std::string& name, std::uint64_t total) {
  auto begin = in.read<std::uint32_t>(name);
  if (begin.empty() || begin.front() != 0 || begin.back() != total || !std::is_sorted(begin.begin(), begin.end()))
    throw damaged(in);
  return begin;
}

std::vector<std::array<std::uint32_t, 3>> read_triangles(const store::Reader& in, const std::string& name,
                                                         std::uint32_t begin, std::uint32_t end,
                                                         std::size_t num_vertices) {
  const auto flat = in.read_range<std::uint32_t>(name, std::uint64_t{3} * begin, std::uint64_t{3} * (end - begin));
  if (std::any_of(flat.begin(), flat.end(), [&](std::uint32_t v) { return v >= num_vertices; })) throw damaged(in);
  std::vector<std::array<std::uint32_t, 3>> out;
  for (std::size_t i = 0; i < flat.size(); i += 3) out.push_back({flat[i], flat[i + 1], flat[i + 2]});
  return out;
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
  out.append("border_a", border_a_, "ends of the edges between pieces of different tiles");
  out.append("border_b", border_b_);
  out.append("border_piece", border_piece_);
}

PieceReader::PieceReader(const store::Reader& in)
    : in_(in),
      vertex_begin_(read_offsets(in, "piece_vertex_begin", in.size("piece_point"))),
      delaunay_begin_(read_offsets(in, "piece_delaunay_begin", in.size("piece_fixed"))),
      others_begin_(read_offsets(in, "piece_others_begin", in.size("piece_others") / 3)) {
  if (vertex_begin_.size() != delaunay_begin_.size() || others_begin_.size() != delaunay_begin_.size())
    throw damaged(in);
}

Piece PieceReader::read(std::uint32_t piece) const {
  if (piece >= num_pieces()) throw damaged(in_);
  Piece out;
  const std::uint32_t v0 = vertex_begin_[piece], count = vertex_begin_[piece + 1] - v0;
  const auto point = in_.read_range<std::uint64_t>("piece_point", v0, count);
  const auto xyz = in_.read_range<std::int32_t>("piece_xyz", std::uint64_t{3} * v0, std::uint64_t{3} * count);
  for (std::size_t i = 0; i < count; ++i)
    out.vertex.push_back({PointId(point[i]), {xyz[3 * i], xyz[3 * i + 1]}, xyz[3 * i + 2]});
  out.wants_lower = in_.read_range<std::uint8_t>("piece_wants_lower", v0, count);
  const std::uint32_t t0 = delaunay_begin_[piece], t1 = delaunay_begin_[piece + 1];
  out.delaunay = read_triangles(in_, "piece_delaunay", t0, t1, count);
  out.fixed = in_.read_range<std::uint8_t>("piece_fixed", t0, t1 - t0);
  out.others = read_triangles(in_, "piece_others", others_begin_[piece], others_begin_[piece + 1], count);
  return out;
}

PieceSummary read_piece_summary(const store::Reader& in) {
  PieceSummary out;
  const auto begin = read_offsets(in, "piece_delaunay_begin", in.size("piece_fixed"));
  for (std::size_t i = 0; i + 1 < begin.size(); ++i) out.num_triangles.push_back(begin[i + 1] - begin[i]);
  const auto a = in.read<std::uint64_t>("border_a"), b = in.read<std::uint64_t>("border_b");
  const auto piece = in.read<std::uint32_t>("border_piece");
  if (a.size() != b.size() || a.size() != piece.size()) throw damaged(in);
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (piece[i] >= out.num_triangles.size()) throw damaged(in);
    out.border.push_back({PointId(a[i]), PointId(b[i]), piece[i]});
  }
  return out;
}

}  // namespace hydrotin
