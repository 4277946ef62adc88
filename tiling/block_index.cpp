#include "block_index.h"

#include <algorithm>

namespace hydrotin {

std::vector<std::int32_t> flatten(std::span<const LatticeBox> boxes) {
  std::vector<std::int32_t> out;
  out.reserve(4 * boxes.size());
  for (const LatticeBox& b : boxes) out.insert(out.end(), {b.min.x, b.min.y, b.max.x, b.max.y});
  return out;
}

std::vector<LatticeBox> unflatten(std::span<const std::int32_t> values) {
  std::vector<LatticeBox> out;
  for (std::size_t i = 0; i + 3 < values.size(); i += 4)
    out.push_back({{values[i], values[i + 1]}, {values[i + 2], values[i + 3]}});
  return out;
}

void write_points(store::Writer& out, std::span<const LatticePoint> position, std::span<const std::int32_t> height,
                  const std::string& prefix) {
  std::vector<std::int32_t> column(position.size());
  for (std::size_t i = 0; i < column.size(); ++i) column[i] = position[i].x;
  out.append(prefix + "x", column, "lattice");
  for (std::size_t i = 0; i < column.size(); ++i) column[i] = position[i].y;
  out.append(prefix + "y", column, "lattice");
  out.append(prefix + "z", height, "z lattice, as measured");
  std::vector<LatticeBox> box((position.size() + kBlockPoints - 1) / kBlockPoints);
  for (std::size_t i = 0; i < position.size(); ++i) box[i / kBlockPoints].extend(position[i]);
  out.append(prefix + "block_box", flatten(box), "boxes of runs of 512 points: min x, min y, max x, max y");
}

TilePoints read_points(const store::Reader& in, std::uint64_t first, std::uint64_t count, const std::string& prefix) {
  TilePoints out;
  const auto x = in.read_range<std::int32_t>(prefix + "x", first, count);
  const auto y = in.read_range<std::int32_t>(prefix + "y", first, count);
  out.height = in.read_range<std::int32_t>(prefix + "z", first, count);
  out.position.resize(count);
  for (std::size_t i = 0; i < count; ++i) out.position[i] = {x[i], y[i]};
  return out;
}

std::vector<LatticeBox> read_block_boxes(const store::Reader& in, const std::string& prefix) {
  auto boxes = unflatten(in.read<std::int32_t>(prefix + "block_box"));
  if (boxes.size() != (in.size(prefix + "x") + kBlockPoints - 1) / kBlockPoints)
    throw Error(ErrorKind::storage,
                in.path() + ": the block boxes do not fit the points; delete the file and run again");
  return boxes;
}

}  // namespace hydrotin
