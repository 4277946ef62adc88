#include "tile_reference.h"

#include <algorithm>
#include <numeric>

#include "block_index.h"
#include "hydrotin/predicates.h"

namespace hydrotin {
namespace {

// Boxes of the owned triangles that leave the core, as far as other tiles' points may lie in them.
std::vector<LatticeBox> boxes_beyond(const LatticeBox& core, const CertifiedTile& certified) {
  const TriangulationView tri = certified.triangulation.view();
  std::vector<LatticeBox> out;
  for (TriangleId t{0}; t.value < tri.num_triangles(); ++t.value) {
    if (!certified.owned[t.value]) continue;
    LatticeBox box;
    for (HalfedgeId h = first_halfedge(t); triangle_of(h) == t; ++h.value) box.extend(tri.position[tri.origin[h]]);
    if (!core.contains(box.min) || !core.contains(box.max)) out.push_back(box);
  }
  return out;
}

// Points of other tiles in blocks that meet one of the boxes.
TilePoints read_around(const RunContext& context, std::uint32_t tile, std::vector<LatticeBox> boxes) {
  TilePoints out;
  const std::string prefix = context.reference_prefix();
  LatticeBox all;
  for (const LatticeBox& box : boxes) all.extend(box);
  const BoxTree tree(std::move(boxes));
  const auto meets_any = [&](const LatticeBox& box) {
    bool found = false;
    tree.for_each([&](const LatticeBox& b) { return b.intersects(box); },
                  [&](std::uint32_t) {
                    found = true;
                    return false;
                  });
    return found;
  };
  context.outline.reference_tree.for_each(
      [&](const LatticeBox& box) { return all.intersects(box); },
      [&](std::uint32_t t) {
        if (t == tile || !meets_any(context.outline.reference_box[t])) return true;
        const store::Reader in(context.points_unit(t));
        const std::vector<LatticeBox> block = read_block_boxes(in, prefix);
        const std::uint64_t total = in.size(prefix + "x");
        for (std::uint64_t b = 0; b < block.size(); ++b) {
          if (!meets_any(block[b])) continue;
          const std::uint64_t first = b * kBlockPoints;
          const TilePoints some = read_points(in, first, std::min<std::uint64_t>(kBlockPoints, total - first), prefix);
          out.position.insert(out.position.end(), some.position.begin(), some.position.end());
          out.height.insert(out.height.end(), some.height.begin(), some.height.end());
        }
        return true;
      });
  return out;
}

std::uint64_t count_outside(const Outline& outline, const std::vector<LatticePoint>& position) {
  const auto& hull = outline.hull;
  return static_cast<std::uint64_t>(std::count_if(position.begin(), position.end(), [&](LatticePoint p) {
    for (std::size_t i = 0; i < hull.size(); ++i)
      if (orientation(hull[i].position, hull[(i + 1) % hull.size()].position, p) < 0) return true;
    return false;
  }));
}

// The points of both in owned triangles.
ReferenceLocation in_owned(const std::vector<std::uint8_t>& owned, const ReferenceLocation& a,
                           const ReferenceLocation& b) {
  ReferenceLocation out;
  out.begin.push_back(0);
  for (std::uint32_t t = 0; t < owned.size(); ++t) {
    if (owned[t])
      for (const ReferenceLocation* from : {&a, &b})
        for (const ReferencePoint& p : from->of(t)) out.point.push_back(p);
    out.begin.push_back(static_cast<std::uint32_t>(out.point.size()));
  }
  return out;
}

}  // namespace

TileReference read_tile_reference(const RunContext& context, std::uint32_t tile, const CertifiedTile& certified,
                                  std::span<const std::int32_t> height, const ErrorLimit* limit) {
  TileReference out;
  const store::Reader arranged(context.points_unit(tile));
  out.points = context.outline.reference_count[tile];
  if (arranged.size(std::string(context.reference_prefix()) + "x") != out.points)
    throw Error(ErrorKind::storage, arranged.path() +
                                        ": its reference points are not those of the outline; delete the "
                                        "file and run again");
  const TilePoints own = read_points(arranged, 0, out.points, context.reference_prefix());
  const TriangulationView tri = certified.triangulation.view();
  if (tri.num_triangles() == 0) {  // a tile without vertices
    out.outside = count_outside(context.outline, own.position);
    out.location.begin.push_back(0);
    return out;
  }
  const ReferenceLocation here = locate_reference(tri, height, own.position, own.height, limit);
  const TilePoints others = read_around(context, tile, boxes_beyond(context.plan.core[tile], certified));
  const ReferenceLocation there = locate_reference(tri, height, others.position, others.height, limit);
  out.location = in_owned(certified.owned, here, there);
  out.outside = here.outside;
  out.at_vertices = here.at_vertices;
  out.beyond_limit = here.beyond_limit;
  out.vertex_error.add(here.vertex_error);
  return out;
}

void ReferenceFigures::add(const ReferenceFigures& other) {
  points += other.points;
  outside += other.outside;
  at_vertices += other.at_vertices;
  beyond_limit += other.beyond_limit;
  vertex_error.add(other.vertex_error);
}

void write_reference_figures(store::Writer& out, const TileReference& reference) {
  out.set("reference_points", static_cast<std::int64_t>(reference.points));
  out.set("reference_outside", static_cast<std::int64_t>(reference.outside));
  out.set("reference_at_vertices", static_cast<std::int64_t>(reference.at_vertices));
  out.set("reference_beyond_limit", static_cast<std::int64_t>(reference.beyond_limit));
  write_errors(out, "vertex_error_", reference.vertex_error);
}

ReferenceFigures read_reference_figures(const store::Reader& in) {
  const auto count = [&](const char* key) { return static_cast<std::uint64_t>(in.integer(key)); };
  return {count("reference_points"), count("reference_outside"), count("reference_at_vertices"),
          count("reference_beyond_limit"), read_errors(in, "vertex_error_")};
}

}  // namespace hydrotin
