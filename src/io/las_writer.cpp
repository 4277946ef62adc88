#include "hydrotin/las_writer.h"

#include <cpl_error.h>
#include <cpl_vsi.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "hydrotin/crs.h"
#include "hydrotin/error.h"
#include "hydrotin/las.h"
#include "las_bytes.h"
#include "las_crs_records.h"
#include "las_header.h"

namespace hydrotin {
namespace {

constexpr std::size_t kHeader12 = 227, kHeader14 = 375;
constexpr std::size_t kBlock = 8192;  // records

void put_text(std::uint8_t* to, std::size_t bytes, const std::string& text) {
  std::memcpy(to, text.data(), std::min(bytes, text.size()));
}

// A variable-length record of the projection family.
std::vector<std::uint8_t> projection_record(std::uint16_t id, const void* payload, std::size_t bytes) {
  constexpr std::size_t kHead = 54;
  std::vector<std::uint8_t> record(kHead + bytes);
  put_text(record.data() + 2, 16, "LASF_Projection");
  store(record.data() + 18, id);
  store(record.data() + 20, static_cast<std::uint16_t>(bytes));
  std::memcpy(record.data() + kHead, payload, bytes);
  return record;
}

// The name of a file in the making: no other process and no other writer has it.
std::string partial_name(const std::string& path) {
  static std::atomic<unsigned> serial{0};
  return path + ".partial-" + std::to_string(getpid()) + "-" + std::to_string(serial++);
}

}  // namespace

struct LasWriter::Impl {
  std::string path, partial;
  LasWriterOptions options;
  bool is_14 = true;
  std::size_t record_length = 0;
  VSILFILE* file = nullptr;
  std::vector<std::uint8_t> header;  // with the records that follow it
  std::vector<std::uint8_t> block;
  std::uint64_t count = 0;
  std::array<std::uint64_t, 16> by_return{};
  std::array<std::int32_t, 3> min, max;

  Impl(std::string to, const LasWriterOptions& with) : path(std::move(to)), options(with) {
    min.fill(std::numeric_limits<std::int32_t>::max());
    max.fill(std::numeric_limits<std::int32_t>::min());
  }
  ~Impl() { discard(); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void open();
  void make_header();
  void check(const LasPoints& points) const;
  void encode(const LasPoints& points, std::size_t first, std::size_t n);
  void put(const std::vector<std::uint8_t>& bytes, std::size_t n);
  void complete_header();
  void close();
  void discard() {
    if (file == nullptr) return;
    VSIFCloseL(file);
    file = nullptr;
    VSIUnlink(partial.c_str());
  }
  [[noreturn]] void fail(ErrorKind kind, const std::string& what) const { throw Error(kind, path + ": " + what); }
};

void LasWriter::Impl::open() {
  const int format = options.point_format;
  if (format < 0 || format > 8 || format == 4 || format == 5)
    fail(ErrorKind::config, "point format " + std::to_string(format) + " cannot be written (choose 0 to 3 or 6 to 8)");
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (!std::isfinite(options.scale[axis]) || options.scale[axis] <= 0 || !std::isfinite(options.offset[axis]))
      fail(ErrorKind::config, "scales must be positive and offsets finite");
  is_14 = format >= 6;
  record_length = kFormatBytes[static_cast<std::size_t>(format)];
  make_header();
  partial = partial_name(path);
  CPLPushErrorHandler(CPLQuietErrorHandler);
  file = VSIFOpenL(partial.c_str(), "wb");
  CPLPopErrorHandler();
  if (file == nullptr) fail(ErrorKind::storage, "cannot be created (does its folder exist, and may it be written to?)");
  put(header, header.size());
  block.resize(kBlock * record_length);
}

void LasWriter::Impl::make_header() {
  header.assign(is_14 ? kHeader14 : kHeader12, 0);
  std::vector<std::uint8_t> record;
  if (!options.crs.empty()) {
    const Crs given = parse_crs(options.crs, path + ": crs");
    const LasCrs crs{given.name, given.wkt, {}};
    if (is_14) {
      const std::string wkt = wkt_for_las14(crs);
      if (wkt.size() >= 0xFFFF) fail(ErrorKind::config, "its CRS has a WKT too long for LAS");
      record = projection_record(2112, wkt.c_str(), wkt.size() + 1);
    } else {
      const auto keys = geokeys_for_las12(crs);
      if (keys.empty())
        fail(ErrorKind::config, "LAS 1.2 can only name a CRS of EPSG's (choose one, or a point format from 6 on)");
      record = projection_record(34735, keys.data(), keys.size() * sizeof(std::uint16_t));
    }
  }
  std::uint8_t* const h = header.data();
  put_text(h, 4, "LASF");
  store<std::uint16_t>(h + 6, is_14 ? 16 : 0);  // the CRS, if any, is WKT
  h[24] = 1;
  h[25] = is_14 ? 4 : 2;
  put_text(h + 26, 32, options.system);
  put_text(h + 58, 32, options.generator);
  store(h + 90, static_cast<std::uint16_t>(options.creation_day));
  store(h + 92, static_cast<std::uint16_t>(options.creation_year));
  store(h + 94, static_cast<std::uint16_t>(header.size()));
  store(h + 96, static_cast<std::uint32_t>(header.size() + record.size()));
  store<std::uint32_t>(h + 100, record.empty() ? 0 : 1);
  h[104] = static_cast<std::uint8_t>(options.point_format);
  store(h + 105, static_cast<std::uint16_t>(record_length));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    store(h + 131 + 8 * axis, options.scale[axis]);
    store(h + 155 + 8 * axis, options.offset[axis]);
  }
  header.insert(header.end(), record.begin(), record.end());
}

void LasWriter::Impl::check(const LasPoints& points) const {
  const std::size_t n = points.x.size();
  const auto length = [&](std::size_t size, const char* name) {
    if (size != 0 && size != n) fail(ErrorKind::config, std::string("there are not as many ") + name + " as points");
  };
  if (points.y.size() != n || points.z.size() != n) fail(ErrorKind::config, "x, y and z differ in length");
  length(points.classification.size(), "classes");
  length(points.flags.size(), "flags");
  length(points.return_number.size(), "return numbers");
  length(points.number_of_returns.size(), "numbers of returns");
  length(points.intensity.size(), "intensities");
  length(points.point_source.size(), "point sources");
  length(points.gps_time.size(), "times");
  length(points.red.size(), "reds");
  length(points.green.size(), "greens");
  length(points.blue.size(), "blues");
  length(points.near_infrared.size(), "infrareds");

  const auto range = [&](std::span<const std::uint8_t> values, int most, const char* name) {
    for (const std::uint8_t value : values)
      if (value > most)
        fail(ErrorKind::config, std::string(name) + " " + std::to_string(value) + " does not fit point format " +
                                    std::to_string(options.point_format) + ", which ends at " + std::to_string(most) +
                                    (is_14 ? "" : " (choose a format from 6 on)"));
  };
  range(points.classification, is_14 ? 255 : 31, "class");
  range(points.flags, is_14 ? 15 : 7, "flags");
  range(points.return_number, is_14 ? 15 : 7, "return number");
  range(points.number_of_returns, is_14 ? 15 : 7, "number of returns");
  if (!is_14 && n > std::numeric_limits<std::uint32_t>::max() - count)
    fail(ErrorKind::config, "LAS 1.2 holds at most 4294967295 points (choose a point format from 6 on)");
}

void LasWriter::Impl::encode(const LasPoints& points, std::size_t first, std::size_t n) {
  const int format = options.point_format;
  const std::size_t at_time = format == 1 || format == 3 ? 20 : is_14 ? 22 : 0;
  const std::size_t at_rgb = format == 2 ? 20 : format == 3 ? 28 : format >= 7 ? 30 : 0;
  std::fill(block.begin(), block.end(), std::uint8_t{0});
  std::uint8_t* p = block.data();
  const auto value = [](const auto& values, std::size_t i, auto absent) { return values.empty() ? absent : values[i]; };
  for (std::size_t i = first; i < first + n; ++i, p += record_length) {
    const std::array<std::int32_t, 3> xyz{points.x[i], points.y[i], points.z[i]};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      store(p + 4 * axis, xyz[axis]);
      min[axis] = std::min(min[axis], xyz[axis]);
      max[axis] = std::max(max[axis], xyz[axis]);
    }
    store(p + 12, value(points.intensity, i, std::uint16_t{0}));
    const unsigned r = value(points.return_number, i, std::uint8_t{1});
    const unsigned of = value(points.number_of_returns, i, std::uint8_t{1});
    const unsigned code = value(points.classification, i, std::uint8_t{0});
    const unsigned flags = value(points.flags, i, std::uint8_t{0});
    ++by_return[r];
    p[14] = static_cast<std::uint8_t>(is_14 ? r | (of << 4U) : r | (of << 3U));
    p[15] = static_cast<std::uint8_t>(is_14 ? flags : code | (flags << 5U));
    if (is_14) p[16] = static_cast<std::uint8_t>(code);
    store(p + (is_14 ? 20 : 18), value(points.point_source, i, std::uint16_t{0}));
    if (at_time != 0) store(p + at_time, value(points.gps_time, i, 0.0));
    if (at_rgb != 0) {
      store(p + at_rgb, value(points.red, i, std::uint16_t{0}));
      store(p + at_rgb + 2, value(points.green, i, std::uint16_t{0}));
      store(p + at_rgb + 4, value(points.blue, i, std::uint16_t{0}));
    }
    if (format == 8) store(p + at_rgb + 6, value(points.near_infrared, i, std::uint16_t{0}));
  }
}

void LasWriter::Impl::put(const std::vector<std::uint8_t>& bytes, std::size_t n) {
  if (VSIFWriteL(bytes.data(), 1, n, file) == n) return;
  discard();
  fail(ErrorKind::storage, "cannot be written (is the disk full?)");
}

void LasWriter::Impl::complete_header() {
  std::uint8_t* const h = header.data();
  if (is_14) {
    store(h + 247, count);
    for (std::size_t r = 1; r <= 15; ++r) store(h + 255 + 8 * (r - 1), by_return[r]);
  } else {
    store(h + 107, static_cast<std::uint32_t>(count));
    for (std::size_t r = 1; r <= 5; ++r) store(h + 111 + 4 * (r - 1), static_cast<std::uint32_t>(by_return[r]));
  }
  for (std::size_t axis = 0; axis < 3 && count > 0; ++axis) {
    store(h + 179 + 16 * axis, max[axis] * options.scale[axis] + options.offset[axis]);
    store(h + 187 + 16 * axis, min[axis] * options.scale[axis] + options.offset[axis]);
  }
}

void LasWriter::Impl::close() {
  complete_header();
  if (VSIFSeekL(file, 0, SEEK_SET) != 0) {
    discard();
    fail(ErrorKind::storage, "its header cannot be completed");
  }
  put(header, header.size());
  VSILFILE* const done = file;
  file = nullptr;
  if (VSIFCloseL(done) != 0 || VSIRename(partial.c_str(), path.c_str()) != 0) {
    VSIUnlink(partial.c_str());
    fail(ErrorKind::storage, "cannot be completed and named (is the disk full, or a folder of that name in the way?)");
  }
}

LasWriter::LasWriter(std::string path, const LasWriterOptions& options)
    : impl_(std::make_unique<Impl>(std::move(path), options)) {
  impl_->open();
}
LasWriter::LasWriter(LasWriter&&) noexcept = default;
LasWriter& LasWriter::operator=(LasWriter&&) noexcept = default;
LasWriter::~LasWriter() = default;

void LasWriter::write(const LasPoints& points) {
  if (impl_->file == nullptr) impl_->fail(ErrorKind::storage, "was closed: nothing can be added");
  impl_->check(points);
  for (std::size_t first = 0; first < points.x.size(); first += kBlock) {
    const std::size_t n = std::min(kBlock, points.x.size() - first);
    impl_->encode(points, first, n);
    impl_->put(impl_->block, n * impl_->record_length);
  }
  impl_->count += points.x.size();
}

void LasWriter::close() {
  if (impl_->file != nullptr) impl_->close();
}

}  // namespace hydrotin
