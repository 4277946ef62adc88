#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include "hydrotin/hilbert.h"
#include "hydrotin/mesh.h"
#include "hydrotin/raster.h"
#include "hydrotin/triangulation.h"

/// The TIN of all cells of a DEM, for tests and experiments.
namespace hydrotin::testing {

/// Cell centres as vertices, Delaunay; heights rounded to `quantum` if it is positive.
inline Mesh dem_mesh(const std::filesystem::path& path, double quantum, std::uint32_t step = 1) {
  const Raster raster = read_raster(path);
  struct Cell {
    LatticePoint at;
    std::uint32_t column, row;
  };
  std::vector<Cell> cells;
  for (std::uint32_t row = 0; row < raster.grid.num_rows; row += step)
    for (std::uint32_t column = 0; column < raster.grid.num_columns; column += step)
      if (!raster.is_nodata(std::size_t{row} * raster.grid.num_columns + column))
        cells.push_back({{static_cast<std::int32_t>(column), -static_cast<std::int32_t>(row)}, column, row});
  std::sort(cells.begin(), cells.end(),
            [](const Cell& a, const Cell& b) { return hilbert_key(a.at) < hilbert_key(b.at); });
  std::vector<LatticePoint> points;
  Mesh mesh;
  for (const Cell& cell : cells) {
    points.push_back(cell.at);
    double z = raster.value[std::size_t{cell.row} * raster.grid.num_columns + cell.column];
    if (quantum > 0) z = std::round(z / quantum) / std::round(1 / quantum);
    mesh.vertex.push_back({raster.grid.center_x(cell.column), raster.grid.center_y(cell.row), z});
  }
  const Triangulation triangulation = delaunay(points);
  for (std::size_t t = 0; t < triangulation.origin.size(); t += 3)
    mesh.triangle.push_back(
        {triangulation.origin[t].value, triangulation.origin[t + 1].value, triangulation.origin[t + 2].value});
  mesh.crs_wkt = raster.crs_wkt;
  return mesh;
}

}  // namespace hydrotin::testing
