#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "hydrotin/error.h"
#include "hydrotin/mesh.h"
#include "ply_reader.h"
#include "text_scan.h"

namespace hydrotin {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, std::size_t line, const std::string& what) {
  throw Error(ErrorKind::input, path.string() + ":" + std::to_string(line) + ": " + what);
}

/// The vertex number of one corner of an OBJ face: `v`, `v/vt`, `v//vn` or `v/vt/vn`; negative counts from the end.
std::uint32_t corner_of(const std::filesystem::path& path, std::size_t line, std::string_view word,
                        std::size_t num_vertices) {
  const auto number = parse_integer(word.substr(0, word.find('/')));
  if (!number || *number == 0) fail(path, line, in_quotes(word) + " is no vertex number (OBJ counts from 1)");
  const auto count = static_cast<long long>(num_vertices);
  const long long index = *number > 0 ? *number - 1 : count + *number;
  if (index < 0 || index >= count)
    fail(path, line,
         "vertex " + std::to_string(*number) + " does not exist: " + std::to_string(count) +
             " vertices come before this face");
  return static_cast<std::uint32_t>(index);
}

void read_obj_vertex(const std::filesystem::path& path, std::size_t line, std::string_view rest, Mesh& mesh) {
  MeshVertex vertex;
  for (double& coordinate : vertex) {
    const std::string_view word = next_word(rest);
    const auto value = parse_real(word);
    if (!value)
      fail(path, line, word.empty() ? "a vertex needs x, y and z" : in_quotes(word) + " is not a finite number");
    coordinate = *value;
  }
  if (mesh.vertex.size() >= UINT32_MAX - 1) fail(path, line, "more vertices than 32-bit indices reach");
  mesh.vertex.push_back(vertex);
}

void read_obj_face(const std::filesystem::path& path, std::size_t line, std::string_view rest, Mesh& mesh) {
  MeshTriangle triangle;
  for (std::uint32_t& corner : triangle) {
    const std::string_view word = next_word(rest);
    if (word.empty()) fail(path, line, "a face needs three corners");
    corner = corner_of(path, line, word, mesh.vertex.size());
  }
  if (!next_word(rest).empty()) fail(path, line, "a face with more than three corners (triangulate the mesh first)");
  if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0])
    fail(path, line, "a face names a vertex twice");
  mesh.triangle.push_back(triangle);
}

Mesh read_obj(const std::filesystem::path& path, std::string_view text) {
  static constexpr std::string_view kPassedOver[] = {"vt", "vn", "g", "o", "s", "usemtl", "mtllib", "l", "p", "mg"};
  Mesh mesh;
  LineScanner lines(text);
  while (const auto full = lines.next()) {
    std::string_view line = full->substr(0, full->find('#'));
    const std::string_view keyword = next_word(line);
    if (keyword.empty()) continue;
    if (trimmed(line).ends_with('\\'))
      fail(path, lines.line_number(), "a line continued with a backslash (write one element per line)");
    if (keyword == "v") {
      read_obj_vertex(path, lines.line_number(), line, mesh);
    } else if (keyword == "f") {
      read_obj_face(path, lines.line_number(), line, mesh);
    } else if (std::find(std::begin(kPassedOver), std::end(kPassedOver), keyword) == std::end(kPassedOver)) {
      fail(path, lines.line_number(),
           in_quotes(keyword) + " is no element of a triangle mesh in OBJ (v and f are read)");
    }
  }
  return mesh;
}

}  // namespace

Mesh read_mesh(const std::filesystem::path& path) {
  const std::string text = read_whole_file(path);
  const bool is_ply = text.starts_with("ply\n") || text.starts_with("ply\r");
  Mesh mesh = is_ply ? read_ply(path, text) : read_obj(path, text);
  if (mesh.vertex.empty())
    throw Error(ErrorKind::input, path.string() + ": holds no vertex (a TIN is a PLY or OBJ file with triangles)");
  auto sidecar = path;
  sidecar.replace_extension(".prj");
  if (std::filesystem::exists(sidecar))
    mesh.crs_wkt = std::string(trimmed(read_whole_file(sidecar, std::size_t{1} << 20)));
  while (!mesh.crs_wkt.empty() && (mesh.crs_wkt.back() == '\n' || mesh.crs_wkt.back() == '\r')) mesh.crs_wkt.pop_back();
  return mesh;
}

}  // namespace hydrotin
