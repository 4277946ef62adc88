#include "river_need.h"

#include <algorithm>
#include <cmath>

#include "hydrotin/error.h"
#include "river_input.h"
#include "river_window.h"

namespace hydrotin {
namespace {

// What is known of the terrain's extent: boxes and counts of tiles, or what the headers say.
Outline known_outline(const RunContext& context) {
  if (context.outline.vertices > 0) return context.outline;
  Outline out;
  out.box = {context.plan.data};
  for (const std::uint64_t points : context.plan.expected) out.vertices += points;
  return out;
}

double length_of(const RiverLines& lines) {
  double length = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto line = lines.line(i);
    for (std::size_t p = 1; p < line.size(); ++p)
      length += std::hypot(static_cast<double>(std::int64_t{line[p].x} - line[p - 1].x),
                           static_cast<double>(std::int64_t{line[p].y} - line[p - 1].y));
  }
  return length;
}

}  // namespace

RiverNeed river_need(const RunContext& context) {
  RiverNeed out;
  if (!context.has_rivers()) return out;
  const Outline outline = known_outline(context);
  const LatticeBox box = outline.bounds();
  if (box.is_empty() || outline.vertices == 0) return out;
  const double area =
      (static_cast<double>(box.max.x) - box.min.x + 1) * (static_cast<double>(box.max.y) - box.min.y + 1);
  const double density = static_cast<double>(outline.vertices) / area;
  const RiverLines lines = lines_on_lattice(*context.river_input, context.plan.lattice, box);
  CellSet cells(outline);
  add_river_cells(context, lines, box, cells);
  const LatticeBox cell = cells.grid().box({0, 0});
  const double side = static_cast<double>(cell.max.x) - cell.min.x + 1;
  const double vertices = std::min(static_cast<double>(outline.vertices),
                                   static_cast<double>(cells.cells().size()) * side * side * density);
  constexpr double kSecondsPerEdge = 2e-4;
  out.edges = static_cast<std::uint64_t>(std::ceil(length_of(lines) * std::sqrt(density)));
  out.triangles = static_cast<std::uint64_t>(2 * vertices);
  out.bytes = out.triangles * kBytesPerRiverTriangle;
  out.seconds = kSecondsPerEdge * static_cast<double>(out.edges);
  return out;
}

void require_river_memory(const RunContext& context) {
  const RiverNeed need = river_need(context);
  const std::uint64_t budget = context.options.run.memory_bytes;
  if (need.bytes <= budget) return;
  throw Error(ErrorKind::resource, context.options.rivers.lines + ": about " + std::to_string(need.edges) +
                                       " river edges need " + std::to_string(need.bytes >> 20) +
                                       " MiB while they are matched (" +
                                       std::to_string(need.bytes / std::max<std::uint64_t>(need.edges, 1)) +
                                       " bytes an edge), but run.memory is " + std::to_string(budget >> 20) +
                                       " MiB; raise run.memory, give fewer lines at once, or thin the points "
                                       "(thin.vertical_error_m)");
}

}  // namespace hydrotin
