#include "terrain_file.h"

#include <algorithm>

#include "store_arrays.h"

namespace hydrotin {
namespace {

[[noreturn]] void damaged(const store::Reader& in, const std::string& what) {
  throw Error(ErrorKind::storage, in.path() + ": " + what + "; delete the file and run again");
}

// The triangles of the runs that meet the box, neighbouring runs read together.
std::vector<std::uint32_t> read_runs(const store::Reader& in, const LatticeBox& box,
                                     std::vector<std::uint32_t>& number) {
  const auto boxes = unflatten(in.read<std::int32_t>("triangle_box"));
  const std::uint64_t size = in.size("triangle");
  if (size % 3 != 0 || boxes.size() != (size / 3 + kRunTriangles - 1) / kRunTriangles)
    damaged(in, "the boxes do not fit the triangles");
  constexpr std::uint64_t kRun = std::uint64_t{3} * kRunTriangles;
  std::vector<std::uint32_t> out;
  for (std::size_t first = 0; first < boxes.size(); ++first) {
    if (!boxes[first].intersects(box)) continue;
    std::size_t last = first + 1;
    while (last < boxes.size() && boxes[last].intersects(box)) ++last;
    const std::uint64_t begin = first * kRun, end = std::min<std::uint64_t>(last * kRun, size);
    const auto piece = in.read_range<std::uint32_t>("triangle", begin, end - begin);
    out.insert(out.end(), piece.begin(), piece.end());
    for (std::uint64_t t = begin / 3; t < end / 3; ++t) number.push_back(static_cast<std::uint32_t>(t));
    first = last;
  }
  return out;
}

// Positions and heights of ascending own points, in stretches without wide gaps.
void read_own(const store::Reader& in, std::span<const std::uint32_t> index, bool with_measured, TrianglePatch& patch) {
  constexpr std::uint32_t kGap = 4096;
  const auto read = [&](std::uint64_t begin, std::uint64_t count, std::span<const std::uint32_t> some) {
    const auto x = in.read_range<std::int32_t>("x", begin, count);
    const auto y = in.read_range<std::int32_t>("y", begin, count);
    const auto height = in.read_range<std::int32_t>("height", begin, count);
    const auto measured = with_measured ? in.read_range<std::int32_t>("z", begin, count) : std::vector<std::int32_t>();
    for (const std::uint32_t v : some) {
      const std::size_t i = v - begin;
      if (height[i] == kUnusedHeight) damaged(in, "a triangle uses a point without a height");
      patch.position.push_back({x[i], y[i]});
      patch.height.push_back(height[i]);
      if (with_measured) patch.measured.push_back(measured[i]);
    }
  };
  store::for_stretches(index, kGap, read);
}

void read_foreign(const store::Reader& in, std::span<const std::uint32_t> number, bool with_measured,
                  TrianglePatch& patch) {
  if (number.empty()) return;
  const auto xyz = in.read<std::int32_t>("foreign_xyz");
  const auto height = in.read<std::int32_t>("foreign_height");
  if (xyz.size() != 3 * height.size()) damaged(in, "the arrays of its foreign points differ in length");
  for (const std::uint32_t f : number) {
    if (f >= height.size()) damaged(in, "a triangle refers to a vertex that is not listed");
    patch.position.push_back({xyz[3 * std::size_t{f}], xyz[3 * std::size_t{f} + 1]});
    patch.height.push_back(height[f]);
    if (with_measured) patch.measured.push_back(xyz[3 * std::size_t{f} + 2]);
  }
}

}  // namespace

void write_lattice(store::Writer& out, const Lattice& l) {
  out.append("lattice_scale_offset", std::vector<double>{l.scale_xy, l.scale_z, l.offset_x, l.offset_y, l.offset_z},
             "scale of x and y, scale of z, offsets of x, y, z: coordinate = (base + integer) * scale + offset");
  out.append("lattice_base", std::vector<std::int64_t>{l.base_x, l.base_y, l.base_z}, "base of x, y, z");
}

Lattice read_lattice(const store::Reader& in) {
  const auto scale = in.read<double>("lattice_scale_offset");
  const auto base = in.read<std::int64_t>("lattice_base");
  if (scale.size() != 5 || base.size() != 3) damaged(in, "its lattice has a wrong shape");
  return {scale[0], scale[1], scale[2], scale[3], scale[4], base[0], base[1], base[2]};
}

TrianglePatch read_patch(const store::Reader& in, const LatticeBox& box, bool with_measured) {
  TrianglePatch patch;
  std::vector<std::uint32_t> number_in_file;
  patch.triangle = read_runs(in, box, number_in_file);
  if (with_measured) {
    const auto added =
        in.has("added_triangle") ? in.read<std::uint32_t>("added_triangle") : std::vector<std::uint32_t>();
    for (const std::uint32_t t : number_in_file)
      patch.is_added.push_back(std::binary_search(added.begin(), added.end(), t) ? 1 : 0);
  }
  const std::uint64_t num_own = in.size("x"), num_vertices = num_own + in.size("foreign_point");
  if (num_vertices > std::numeric_limits<std::uint32_t>::max()) damaged(in, "it claims too many vertices");
  if (std::any_of(patch.triangle.begin(), patch.triangle.end(), [&](std::uint32_t v) { return v >= num_vertices; }))
    damaged(in, "a triangle refers to a vertex that is not listed");
  // Numbers the references in use by a table of all: triangles of a tile use most of them.
  constexpr std::uint32_t kUnused = 0, kUsed = 1;
  std::vector<std::uint32_t> number(patch.triangle.empty() ? 0 : num_vertices, kUnused);
  for (const std::uint32_t v : patch.triangle) number[v] = kUsed;
  std::vector<std::uint32_t> own, foreign;
  for (std::uint32_t v = 0; v < number.size(); ++v) {
    if (number[v] == kUnused) continue;
    number[v] = static_cast<std::uint32_t>(own.size() + foreign.size());
    if (v < num_own)
      own.push_back(v);
    else
      foreign.push_back(static_cast<std::uint32_t>(v - num_own));
  }
  for (std::uint32_t& v : patch.triangle) v = number[v];
  read_own(in, own, with_measured, patch);
  read_foreign(in, foreign, with_measured, patch);
  return patch;
}

}  // namespace hydrotin
