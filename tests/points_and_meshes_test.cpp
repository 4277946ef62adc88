#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "hydrotin/csv_points.h"
#include "hydrotin/error.h"
#include "hydrotin/mesh.h"
#include "temporary_folder.h"

namespace hydrotin {
namespace {

using testing::read_text;
using testing::TemporaryFolder;
using testing::write_text;

constexpr const char* kSquarePly =
    "ply\nformat ascii 1.0\ncomment a square\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "property uchar red\nelement face 2\nproperty list uchar int vertex_index\nend_header\n"
    "0 0 1 255\n1 0 2 255\n1 1 3.5 255\n0 1 4 255\n3 0 1 2\n3 0 2 3\n";

/// The place and reason of the error that reading a mesh with this content gives.
std::string mesh_error(const std::string& content) {
  const TemporaryFolder folder;
  write_text(folder / "m", content);
  try {
    (void)read_mesh(folder / "m");
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    const std::string text = error.what();
    const std::string file = (folder / "m").string() + ":";
    EXPECT_EQ(text.rfind(file, 0), 0U) << text;
    return text.substr(std::min(text.size(), file.size()));
  }
  return "no error";
}

std::string csv_error(const std::string& content) {
  const TemporaryFolder folder;
  write_text(folder / "p.csv", content);
  try {
    (void)read_csv_points(folder / "p.csv");
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    const std::string text = error.what();
    return text.substr(std::min(text.size(), (folder / "p.csv").string().size() + 1));
  }
  return "no error";
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const auto at = text.find(what);
  EXPECT_NE(at, std::string::npos);
  return text.replace(at, what.size(), by);
}

TEST(Ply, WrittenMesh_RoundTripsBitForBit) {
  const TemporaryFolder folder;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> coordinate(0, 7e6);
  std::vector<MeshVertex> vertices(10'000);
  for (auto& vertex : vertices) vertex = {coordinate(random), coordinate(random), coordinate(random)};
  std::vector<MeshTriangle> triangles;
  for (std::uint32_t i = 0; i + 2 < vertices.size(); ++i) triangles.push_back({i, i + 1, i + 2});
  write_ply(folder / "m.ply", vertices, triangles, "LOCAL_CS[\"a\"]");
  const Mesh back = read_mesh(folder / "m.ply");
  EXPECT_EQ(back.vertex, vertices);
  EXPECT_EQ(back.triangle, triangles);
  EXPECT_EQ(back.crs_wkt, "LOCAL_CS[\"a\"]");
  write_ply(folder / "m.ply", vertices, triangles, "");
  EXPECT_EQ(read_mesh(folder / "m.ply").crs_wkt, "") << "the sidecar of the older mesh is gone";
}

TEST(Ply, Streaming_GivesTheBytesOfTheWhole) {
  const TemporaryFolder folder;
  const std::vector<MeshVertex> vertices{{0, 0, 1}, {1, 0, 2}, {0, 1, 3}, {1, 1, 4}};
  const std::vector<MeshTriangle> triangles{{0, 1, 2}, {2, 1, 3}};
  write_ply(folder / "a.ply", vertices, triangles, "");
  {
    PlyWriter writer(folder / "b.ply", 4, 2, "");
    writer.add_vertices(std::span(vertices).first(1));
    writer.add_vertices(std::span(vertices).subspan(1));
    for (const auto& triangle : triangles) writer.add_triangles({&triangle, 1});
    EXPECT_FALSE(std::filesystem::exists(folder / "b.ply"));
    writer.finish();
  }
  EXPECT_EQ(read_text(folder / "a.ply"), read_text(folder / "b.ply"));
  { PlyWriter abandoned(folder / "c.ply", 4, 2, "wkt"); }
  EXPECT_FALSE(std::filesystem::exists(folder / "c.ply"));
  EXPECT_FALSE(std::filesystem::exists(folder / "c.prj"));
}

TEST(Ply, Ascii_WithOtherProperties) {
  const TemporaryFolder folder;
  write_text(folder / "m.ply", kSquarePly);
  const Mesh mesh = read_mesh(folder / "m.ply");
  ASSERT_EQ(mesh.vertex.size(), 4U);
  EXPECT_EQ(mesh.vertex[2], (MeshVertex{1, 1, 3.5}));
  EXPECT_EQ(mesh.triangle, (std::vector<MeshTriangle>{{0, 1, 2}, {0, 2, 3}}));
  write_text(folder / "m.ply", replaced(kSquarePly, "comment a square", "comment offset 100 200 -1"));
  EXPECT_EQ(read_mesh(folder / "m.ply").vertex[2], (MeshVertex{101, 201, 2.5}));
}

template <class T>
void put(std::string& to, T value, bool big) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  if (big) std::reverse(bytes, bytes + sizeof value);
  to.append(bytes, sizeof value);
}

std::string binary_triangle(bool big, std::uint32_t last_index) {
  std::string text = "ply\r\nformat binary_" + std::string(big ? "big" : "little") +
                     "_endian 1.0\r\nelement edge 1\r\nproperty list ushort short w\r\nelement vertex 3\r\n"
                     "property double z\r\nproperty float y\r\nproperty int16 x\r\nelement face 1\r\n"
                     "property list int uint32 vertex_indices\r\nproperty uchar flag\r\nend_header\r\n";
  put<std::uint16_t>(text, 2, big);
  put<std::int16_t>(text, -1, big);
  put<std::int16_t>(text, -1, big);
  for (int i = 0; i < 3; ++i) {
    put<double>(text, 0.1 * i, big);
    put<float>(text, 0.5F * static_cast<float>(i * i), big);
    put<std::int16_t>(text, static_cast<std::int16_t>(-300 * i), big);
  }
  put<std::int32_t>(text, 3, big);
  put<std::uint32_t>(text, 0, big);
  put<std::uint32_t>(text, 1, big);
  put<std::uint32_t>(text, last_index, big);
  put<std::uint8_t>(text, 9, big);
  return text;
}

TEST(Ply, Binary_OfBothByteOrdersAndAnyTypes) {
  const TemporaryFolder folder;
  for (const bool big : {false, true}) {
    write_text(folder / "m.ply", binary_triangle(big, 2));
    const Mesh mesh = read_mesh(folder / "m.ply");
    EXPECT_EQ(mesh.vertex, (std::vector<MeshVertex>{{0, 0, 0}, {-300, 0.5, 0.1}, {-600, 2, 0.2}}));
    EXPECT_EQ(mesh.triangle, (std::vector<MeshTriangle>{{0, 1, 2}}));
    EXPECT_NE(mesh_error(binary_triangle(big, 3)).find("byte "), std::string::npos);
    EXPECT_NE(mesh_error(binary_triangle(big, 1)).find("twice"), std::string::npos);
  }
}

TEST(Ply, CutAnywhere_IsAnErrorOrHasNothingMissing) {
  for (const std::string& whole : {binary_triangle(false, 2), binary_triangle(true, 2), std::string(kSquarePly)})
    for (std::size_t length = 0; length + 3 < whole.size(); ++length) {
      SCOPED_TRACE(length);
      EXPECT_NE(mesh_error(whole.substr(0, length)), "no error");
    }
}

TEST(Ply, FlippedBytes_NeverCrash) {
  const TemporaryFolder folder;
  std::mt19937 random(5);
  for (const std::string& whole : {binary_triangle(false, 2), binary_triangle(true, 2), std::string(kSquarePly)})
    for (int i = 0; i < 500; ++i) {
      std::string broken = whole;
      broken[random() % broken.size()] = static_cast<char>(random());
      write_text(folder / "m.ply", broken);
      try {
        for (const auto& triangle : read_mesh(folder / "m.ply").triangle) EXPECT_LT(triangle[0], 4U);
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
      }
    }
}

TEST(Ply, Errors_NameThePlace) {
  const std::string square = kSquarePly;
  EXPECT_EQ(mesh_error(replaced(square, "1 1 3.5", "1 x 3.5")), "14: 'x' is not a finite number");
  EXPECT_EQ(mesh_error(replaced(square, "1 1 3.5", "1 nan 3.5")), "14: 'nan' is not a finite number");
  EXPECT_EQ(mesh_error(replaced(square, "3 0 2 3", "3 0 2 4")), "17: vertex 4 does not exist: there are 4");
  EXPECT_EQ(mesh_error(replaced(square, "3 0 2 3", "3 0 2 -1")), "17: vertex -1 does not exist: there are 4");
  EXPECT_EQ(mesh_error(replaced(square, "3 0 2 3", "4 0 1 2 3")),
            "17: a face with 4 corners (triangulate the mesh first)");
  EXPECT_EQ(mesh_error(replaced(square, "3 0 2 3", "3 0 2 2")), "17: a face names a vertex twice");
  EXPECT_EQ(mesh_error(replaced(square, "float y", "real y")), "6: 'real' is no type of PLY");
  EXPECT_EQ(mesh_error(replaced(square, "ascii", "text")), "2: 'text' is no format of PLY");
  EXPECT_EQ(mesh_error(replaced(square, "float z", "float h")), "12: vertices have no property z");
  EXPECT_NE(mesh_error(replaced(square, "vertex 4", "vertex 4000000000")).find("more than the file holds"),
            std::string::npos);
  EXPECT_NE(mesh_error(replaced(square, "vertex 4", "vertex -4")).find("needs a name and a count"), std::string::npos);
}

TEST(Obj, VerticesAndFaces) {
  const TemporaryFolder folder;
  write_text(folder / "m.obj",
             "# a\no square\nv 0 0 1\nv 1 0 2 1.0\r\nv 1 1 3.5\nvt 0 0\nvn 0 0 1\nv 0 1 4\ns off\nf 1/1/1 2//1 3/1\nf "
             "-4 -2 -1 # last\n");
  const Mesh mesh = read_mesh(folder / "m.obj");
  ASSERT_EQ(mesh.vertex.size(), 4U);
  EXPECT_EQ(mesh.vertex[2], (MeshVertex{1, 1, 3.5}));
  EXPECT_EQ(mesh.triangle, (std::vector<MeshTriangle>{{0, 1, 2}, {0, 2, 3}}));
}

TEST(Obj, Errors_NameTheLine) {
  const std::string good = "v 0 0 1\nv 1 0 2\nv 1 1 3\nv 0 1 4\n";
  EXPECT_EQ(mesh_error(good + "f 1 2 3 4\n"), "5: a face with more than three corners (triangulate the mesh first)");
  EXPECT_EQ(mesh_error(good + "f 1 2 5\n"), "5: vertex 5 does not exist: 4 vertices come before this face");
  EXPECT_EQ(mesh_error(good + "f 1 2 -5\n"), "5: vertex -5 does not exist: 4 vertices come before this face");
  EXPECT_EQ(mesh_error(good + "f 1 2 0\n"), "5: '0' is no vertex number (OBJ counts from 1)");
  EXPECT_EQ(mesh_error(good + "f 1 2 2\n"), "5: a face names a vertex twice");
  EXPECT_EQ(mesh_error(good + "f 1 2\n"), "5: a face needs three corners");
  EXPECT_EQ(mesh_error(good + "v 1 2\n"), "5: a vertex needs x, y and z");
  EXPECT_EQ(mesh_error("v 0 inf 1\n"), "1: 'inf' is not a finite number");
  EXPECT_NE(mesh_error(good + "curv 1 2\n").find("5: 'curv'"), std::string::npos);
  EXPECT_NE(mesh_error("").find("holds no vertex"), std::string::npos);
  EXPECT_NE(mesh_error(std::string("\x7f"
                                   "ELF\0\1",
                                   6))
                .find("1: '?ELF"),
            std::string::npos);
}

TEST(Mesh, MissingFile_IsAnInputError) {
  const TemporaryFolder folder;
  EXPECT_THROW((void)read_mesh(folder / "none.ply"), Error);
  EXPECT_THROW((void)read_mesh(folder.path()), Error);
}

TEST(Csv, Numbers_AreExactAndDuplicatesKept) {
  const TemporaryFolder folder;
  write_text(folder / "p.csv",
             "\xEF\xBB\xBF"
             "x,y,z\r\n700000.10,6600000.25,1\r\n0.1,+2,-3.5e1\n0.1,2,1e-3\n\n\"7\", 8 ,9.000");
  const CsvPoints points = read_csv_points(folder / "p.csv");
  EXPECT_EQ(points.x, (std::vector<double>{700000.10, 0.1, 0.1, 7}));
  EXPECT_EQ(points.y, (std::vector<double>{6600000.25, 2, 2, 8}));
  EXPECT_EQ(points.z, (std::vector<double>{1, -35, 0.001, 9}));
  EXPECT_EQ(points.decimals_xy, 2);
  EXPECT_EQ(points.decimals_z, 3);
}

TEST(Csv, Columns_InAnyOrder) {
  const TemporaryFolder folder;
  write_text(folder / "p.csv", "id,Z,name,Y,X\n1,30,a,20,1000\n2,31,b,21,1.5e3\n");
  const CsvPoints points = read_csv_points(folder / "p.csv");
  EXPECT_EQ(points.x, (std::vector<double>{1000, 1500}));
  EXPECT_EQ(points.y, (std::vector<double>{20, 21}));
  EXPECT_EQ(points.z, (std::vector<double>{30, 31}));
  EXPECT_EQ(points.decimals_xy, 0);
}

TEST(Csv, Decimals_CountWhatTheValueNeeds) {
  const TemporaryFolder folder;
  for (const auto& [text, decimals] : {std::pair<const char*, int>{"0", 0},
                                       {"0.000", 0},
                                       {"10.50", 1},
                                       {"1.25e-2", 4},
                                       {"1.25e2", 0},
                                       {"12e-1", 1},
                                       {"100", 0},
                                       {"-0.007", 3},
                                       {"1e-2", 2},
                                       {"120e-2", 1}}) {
    SCOPED_TRACE(text);
    write_text(folder / "p.csv", std::string("x,y,z\n0,0,") + text + "\n");
    EXPECT_EQ(read_csv_points(folder / "p.csv").decimals_z, decimals);
  }
}

TEST(Csv, Errors_NameLineAndColumn) {
  EXPECT_EQ(csv_error(""), "1:1: is empty (the first line must be x,y,z)");
  EXPECT_EQ(csv_error("1,2,3\n"), "1:1: the header names no column x (the first line must be x,y,z)");
  EXPECT_EQ(csv_error("x,y,z,x\n"), "1:7: the header names 'x' twice");
  EXPECT_EQ(csv_error("x,y,z\n1,2,3\n1, b,3\n"), "3:4: 'b' is not a finite number");
  EXPECT_EQ(csv_error("x,y,z\n1,nan,3\n"), "2:3: 'nan' is not a finite number");
  EXPECT_EQ(csv_error("x,y,z\n1,1e999,3\n"), "2:3: '1e999' is not a finite number");
  EXPECT_EQ(csv_error("x,y,z\n1,+-1,3\n"), "2:3: '+-1' is not a finite number");
  EXPECT_EQ(csv_error("x,y,z\n1,2\n"), "2:4: the line ends before its z");
  EXPECT_EQ(csv_error("x,y,z\n1,,3\n"), "2:3: '' is not a finite number");
  EXPECT_EQ(csv_error("x,y,z\n1 2 3\n"), "2:1: '1 2 3' is not a finite number");
}

}  // namespace
}  // namespace hydrotin
