#include "triangle_runs.h"

#include <algorithm>
#include <limits>

#include "block_index.h"
#include "store_arrays.h"
#include "terrain_file.h"

namespace hydrotin {

std::vector<std::uint32_t> read_triangle_runs(const store::Reader& in, const CellGrid& grid,
                                              std::span<const Cell> cells) {
  const auto boxes = unflatten(in.read<std::int32_t>("triangle_box"));
  const std::uint64_t size = in.size("triangle"), num_vertices = in.size("point");
  if (size % 3 != 0 || boxes.size() != (size / 3 + kRunTriangles - 1) / kRunTriangles)
    store::contradicts(in.path(), "its arrays have different lengths");
  std::vector<std::uint32_t> wanted;
  for (std::uint32_t run = 0; run < boxes.size(); ++run)
    if (meets(boxes[run], grid, cells)) wanted.push_back(run);
  constexpr std::uint64_t kRun = std::uint64_t{3} * kRunTriangles;
  constexpr std::uint32_t kRunGap = 5;  // a chunk of the store has so many runs
  std::vector<std::uint32_t> triangle;
  store::for_stretches(
      wanted, kRunGap, [&](std::uint64_t begin, std::uint64_t count, std::span<const std::uint32_t> runs) {
        const std::uint64_t first = begin * kRun, end = std::min((begin + count) * kRun, size);
        const auto piece = in.read_range<std::uint32_t>("triangle", first, end - first);
        for (const std::uint64_t run : runs)
          triangle.insert(triangle.end(), piece.begin() + static_cast<std::ptrdiff_t>(run * kRun - first),
                          piece.begin() + static_cast<std::ptrdiff_t>(std::min((run + 1) * kRun, size) - first));
      });
  if (std::any_of(triangle.begin(), triangle.end(), [&](std::uint32_t v) { return v >= num_vertices; }))
    store::contradicts(in.path(), "a triangle refers to a vertex that is not listed");
  return triangle;
}

UsedVertices number_used(std::span<const std::uint32_t> triangle, std::uint64_t num_vertices) {
  constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  UsedVertices out{{}, std::vector<std::uint32_t>(num_vertices, kUnused)};
  for (const std::uint32_t v : triangle) out.number[v] = 0;
  for (std::uint32_t v = 0; v < num_vertices; ++v) {
    if (out.number[v] == kUnused) continue;
    out.number[v] = static_cast<std::uint32_t>(out.vertex.size());
    out.vertex.push_back(v);
  }
  return out;
}

}  // namespace hydrotin
