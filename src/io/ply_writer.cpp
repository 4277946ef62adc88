#include <algorithm>
#include <bit>
#include <cassert>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

#include "hydrotin/error.h"
#include "hydrotin/finished_file.h"
#include "hydrotin/mesh.h"
#include "hydrotin/version.h"

namespace hydrotin {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays go to the file as they lie in memory");

constexpr std::size_t kFaceBytes = 1 + 3 * sizeof(std::uint32_t);
constexpr std::size_t kFacesAtOnce = 4096;

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

[[noreturn]] void fail(const std::filesystem::path& path, const char* what) {
  throw Error(ErrorKind::storage,
              path.string() + ": " + what + ": " + std::strerror(errno) + " (check the disk's free space)");
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  FinishedFile file(path);
  File out(std::fopen(file.temporary().c_str(), "wb"), std::fclose);
  if (!out || std::fwrite(text.data(), 1, text.size(), out.get()) != text.size()) fail(path, "cannot be written");
  if (std::fclose(out.release()) != 0) fail(path, "cannot be written");
  file.publish();
}

}  // namespace

struct PlyWriter::State {
  FinishedFile file;
  File out;
  std::size_t vertices_left, triangles_left;
  std::string crs_wkt;
  std::vector<unsigned char> face_bytes;

  void write(const void* data, std::size_t bytes) {
    if (std::fwrite(data, 1, bytes, out.get()) != bytes) fail(file.final_path(), "cannot be written");
  }
};

PlyWriter::PlyWriter(const std::filesystem::path& path, std::size_t num_vertices, std::size_t num_triangles,
                     const std::string& crs_wkt)
    : state_(new State{.file = FinishedFile(path),
                       .out = File(nullptr, std::fclose),
                       .vertices_left = num_vertices,
                       .triangles_left = num_triangles,
                       .crs_wkt = crs_wkt,
                       .face_bytes = {}}) {
  state_->out.reset(std::fopen(state_->file.temporary().c_str(), "wb"));
  if (!state_->out) fail(path, "cannot be created");
  const std::string header = "ply\nformat binary_little_endian 1.0\ncomment made by hydrotin " +
                             std::string(version()) + "\ncomment offset 0 0 0\nelement vertex " +
                             std::to_string(num_vertices) +
                             "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
                             std::to_string(num_triangles) + "\nproperty list uchar uint vertex_indices\nend_header\n";
  state_->write(header.data(), header.size());
}

PlyWriter::~PlyWriter() = default;

void PlyWriter::add_vertices(std::span<const MeshVertex> vertices) {
  assert(vertices.size() <= state_->vertices_left);
  state_->vertices_left -= vertices.size();
  state_->write(vertices.data(), vertices.size_bytes());
}

void PlyWriter::add_triangles(std::span<const MeshTriangle> triangles) {
  assert(state_->vertices_left == 0 && triangles.size() <= state_->triangles_left);
  state_->triangles_left -= triangles.size();
  auto& bytes = state_->face_bytes;
  while (!triangles.empty()) {
    const auto batch = triangles.first(std::min(triangles.size(), kFacesAtOnce));
    bytes.resize(batch.size() * kFaceBytes);
    unsigned char* to = bytes.data();
    for (const MeshTriangle& triangle : batch) {
      *to = 3;
      std::memcpy(to + 1, triangle.data(), sizeof triangle);
      to += kFaceBytes;
    }
    state_->write(bytes.data(), bytes.size());
    triangles = triangles.subspan(batch.size());
  }
}

void PlyWriter::finish() {
  assert(state_->vertices_left == 0 && state_->triangles_left == 0);
  if (std::fclose(state_->out.release()) != 0) fail(state_->file.final_path(), "cannot be written");
  auto sidecar = state_->file.final_path();
  sidecar.replace_extension(".prj");
  // The mesh comes last: when it is there, its CRS is there too.
  std::error_code ignored;
  if (state_->crs_wkt.empty()) std::filesystem::remove(sidecar, ignored);  // of an older mesh: it would lie
  if (!state_->crs_wkt.empty()) write_text(sidecar, state_->crs_wkt + "\n");
  state_->file.publish();
}

void write_ply(const std::filesystem::path& path, std::span<const MeshVertex> vertices,
               std::span<const MeshTriangle> triangles, const std::string& crs_wkt) {
  PlyWriter writer(path, vertices.size(), triangles.size(), crs_wkt);
  writer.add_vertices(vertices);
  writer.add_triangles(triangles);
  writer.finish();
}

}  // namespace hydrotin
