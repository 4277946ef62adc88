#include <hydrotin/csv_points.h>
#include <hydrotin/error.h>
#include <hydrotin/lifting.h>
#include <hydrotin/triangulation.h>

#include <cstdio>
#include <vector>

// Calls one function of each room, so that its libraries must link.
int main() {
  const std::vector<hydrotin::LatticePoint> square{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  const auto triangulation = hydrotin::delaunay(square);
  const auto graph = hydrotin::make_vertex_graph(3, std::vector<std::uint32_t>{0, 1, 2});
  const auto level = hydrotin::lift(graph, std::vector<std::int32_t>{5, 1, 3}, std::vector<std::uint8_t>{1, 0, 0});
  try {
    (void)hydrotin::read_csv_points("/no/such/file.csv");
    return 1;
  } catch (const hydrotin::Error& error) {
    if (error.kind() != hydrotin::ErrorKind::input) return 2;
  }
  std::printf("%u triangles, lifted to %d\n", triangulation.view().num_triangles(), level[1]);
  return triangulation.view().num_triangles() == 2 && level[1] == 5 ? 0 : 3;
}
