#include "las_header.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "hydrotin/error.h"
#include "hydrotin/las_crs.h"
#include "las_bytes.h"
#include "laz_layout.h"

namespace hydrotin {
namespace {

constexpr std::uint64_t kVlrBytes = 54, kEvlrBytes = 60;
constexpr std::uint64_t kMaxWanted = std::uint64_t{1} << 20;  // no record we use is longer

[[noreturn]] void fail(const LasSource& source, const std::string& what) {
  throw Error(ErrorKind::input, source.path() + ": " + what);
}

std::string text_field(const std::uint8_t* from, std::size_t count) {
  const std::string_view field(reinterpret_cast<const char*>(from), count);
  std::string text(field.substr(0, field.find('\0')));
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

struct Record {
  std::string user;
  std::uint16_t id = 0;
  std::uint64_t begin = 0, bytes = 0;  // payload
};

// Keeps what one of the known records says.
class RecordReader {
 public:
  RecordReader(const LasSource& source, ParsedLas& parsed) : source_(source), parsed_(parsed) {}

  void take(const Record& record) {
    if (record.user == "laszip encoded" && record.id == 22204) {
      parsed_.laszip = payload(record);
    } else if (record.user == "LASF_Projection" && record.id == 2112) {
      if (keys_.wkt.empty()) keys_.wkt = text(record);
    } else if (record.user == "LASF_Projection" && record.id == 34735) {
      keys_.directory = numbers<std::uint16_t>(record);
    } else if (record.user == "LASF_Projection" && record.id == 34736) {
      keys_.doubles = numbers<double>(record);
    } else if (record.user == "LASF_Projection" && record.id == 34737) {
      keys_.ascii = text(record);
    } else if (record.user == "copc" && record.id == 1) {
      parsed_.header.copc = true;
    } else if (record.user == "lascompatible" && record.id == 22204) {
      parsed_.header.warnings.emplace_back(
          "written in LAS 1.4 compatibility mode: classes above 31 and the overlap flag are in its extra bytes");
    }
  }

  [[nodiscard]] const LasCrsRecords& crs_records() const { return keys_; }

 private:
  std::vector<std::uint8_t> payload(const Record& record) const {
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(std::min(record.bytes, kMaxWanted)));
    source_.read(record.begin, bytes.data(), bytes.size());
    return bytes;
  }
  std::string text(const Record& record) const {
    const auto bytes = payload(record);
    std::string all(bytes.begin(), bytes.end());
    while (!all.empty() && (all.back() == '\0' || all.back() == ' ')) all.pop_back();
    return all;
  }
  template <class T>
  std::vector<T> numbers(const Record& record) const {
    const auto bytes = payload(record);
    std::vector<T> values(bytes.size() / sizeof(T));
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = load<T>(bytes.data() + i * sizeof(T));
    return values;
  }

  const LasSource& source_;
  ParsedLas& parsed_;
  LasCrsRecords keys_;
};

// VLRs are metadata: a wrong count or length costs what follows it, never the points.
void read_vlrs(const LasSource& source, std::uint64_t header_bytes, ParsedLas& parsed, RecordReader& reader) {
  LasHeader& header = parsed.header;
  std::uint64_t at = header_bytes;
  for (std::uint32_t i = 0; i < header.num_vlrs; ++i) {
    std::uint64_t next = at + kVlrBytes;
    Record record;
    if (next <= header.offset_to_points) {
      std::array<std::uint8_t, kVlrBytes> head;
      source.read(at, head.data(), head.size());
      record = {text_field(head.data() + 2, 16), load<std::uint16_t>(head.data() + 18), next,
                load<std::uint16_t>(head.data() + 20)};
      next += record.bytes;
    }
    if (next > header.offset_to_points) {
      header.warnings.push_back("record " + std::to_string(i + 1) + " of " + std::to_string(header.num_vlrs) +
                                " before the points does not fit between byte " + std::to_string(at) + " and byte " +
                                std::to_string(header.offset_to_points) + ": it and those after it are ignored");
      return;
    }
    reader.take(record);
    at = next;
  }
}

void read_evlrs(const LasSource& source, std::uint64_t at, ParsedLas& parsed, RecordReader& reader) {
  LasHeader& header = parsed.header;
  for (std::uint32_t i = 0; i < header.num_evlrs; ++i) {
    std::array<std::uint8_t, kEvlrBytes> head;
    Record record;
    bool fits = at <= source.size() && source.size() - at >= kEvlrBytes;
    if (fits) {
      source.read(at, head.data(), head.size());
      record = {text_field(head.data() + 2, 16), load<std::uint16_t>(head.data() + 18), at + kEvlrBytes,
                load<std::uint64_t>(head.data() + 20)};
      fits = record.bytes <= source.size() - record.begin;
    }
    if (!fits) {
      header.warnings.push_back("record " + std::to_string(i + 1) + " of " + std::to_string(header.num_evlrs) +
                                " after the points, at byte " + std::to_string(at) +
                                ", reaches beyond the end of the file: it and those after it are ignored");
      return;
    }
    reader.take(record);
    at = record.begin + record.bytes;
  }
}

void check_sane(const LasSource& source, const LasHeader& header, std::uint64_t header_bytes) {
  if (header.offset_to_points < header_bytes || header.offset_to_points > source.size())
    fail(source, "its header puts the points at byte " + std::to_string(header.offset_to_points) +
                     ", which is not between the header's end at byte " + std::to_string(header_bytes) +
                     " and the file's end at byte " + std::to_string(source.size()) +
                     " (damaged or cut off: get it again)");
  if (header.point_format >= kNumPointFormats)
    fail(source, "point format " + std::to_string(header.point_format) + " is unknown (formats 0 to 10 can be read)");
  const auto least = kFormatBytes[static_cast<std::size_t>(header.point_format)];
  if (header.record_length < least)
    fail(source, "records of " + std::to_string(header.record_length) + " bytes are too short for point format " +
                     std::to_string(header.point_format) + ", which needs " + std::to_string(least) +
                     " (the header is damaged: get the file again)");
  for (const double scale : header.scale)
    if (!std::isfinite(scale) || scale <= 0)
      fail(source, "a coordinate scale is " + std::to_string(scale) +
                       ", but scales must be positive (the header is damaged: get the file again)");
  for (const double offset : header.offset)
    if (!std::isfinite(offset)) fail(source, "a coordinate offset is not a number (damaged: get the file again)");
}

}  // namespace

ParsedLas parse_las(const LasSource& source) {
  constexpr std::uint64_t kMinHeader = 227, kHeader14 = 375;
  std::array<std::uint8_t, kHeader14> bytes{};
  const std::uint64_t present = std::min<std::uint64_t>(source.size(), bytes.size());
  source.read(0, bytes.data(), static_cast<std::size_t>(present));
  if (present < 4 || std::string_view(reinterpret_cast<const char*>(bytes.data()), 4) != "LASF")
    fail(source,
         present == 0 ? "is empty (get the file again)" : "is not a LAS or LAZ file: it does not begin with LASF");
  if (present < kMinHeader)
    fail(source, "ends inside its header after " + std::to_string(present) + " bytes (cut off: get the file again)");

  ParsedLas parsed;
  LasHeader& header = parsed.header;
  const std::uint8_t* const b = bytes.data();
  header.file_bytes = source.size();
  header.version_major = b[24];
  header.version_minor = b[25];
  if (header.version_major != 1 || header.version_minor > 5)
    fail(source, "LAS version " + std::to_string(header.version_major) + "." + std::to_string(header.version_minor) +
                     " is unknown (1.0 to 1.4 can be read)");
  header.system = text_field(b + 26, 32);
  header.generator = text_field(b + 58, 32);
  header.creation_day = load<std::uint16_t>(b + 90);
  header.creation_year = load<std::uint16_t>(b + 92);
  const std::uint64_t header_bytes = load<std::uint16_t>(b + 94);
  const bool is_14 = header.version_minor >= 4;
  if (header_bytes < (is_14 ? kHeader14 : kMinHeader) || header_bytes > source.size())
    fail(source, "a header of " + std::to_string(header_bytes) + " bytes is impossible for LAS 1." +
                     std::to_string(header.version_minor) + " in a file of " + std::to_string(source.size()) +
                     " bytes (damaged or cut off: get the file again)");
  header.offset_to_points = load<std::uint32_t>(b + 96);
  header.num_vlrs = load<std::uint32_t>(b + 100);
  header.compressed = (b[104] & 0x80U) != 0;
  header.point_format = b[104] & 0x3F;
  header.record_length = load<std::uint16_t>(b + 105);
  header.point_count = load<std::uint32_t>(b + 107);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    header.scale[axis] = load<double>(b + 131 + 8 * axis);
    header.offset[axis] = load<double>(b + 155 + 8 * axis);
    header.max[axis] = load<double>(b + 179 + 16 * axis);
    header.min[axis] = load<double>(b + 187 + 16 * axis);
  }
  std::uint64_t evlrs_at = 0;
  if (is_14) {
    evlrs_at = load<std::uint64_t>(b + 235);
    header.num_evlrs = load<std::uint32_t>(b + 243);
    const auto count = load<std::uint64_t>(b + 247);
    if (count != 0) header.point_count = count;
  }
  check_sane(source, header, header_bytes);
  header.extra_bytes =
      static_cast<std::uint16_t>(header.record_length - kFormatBytes[static_cast<std::size_t>(header.point_format)]);

  RecordReader reader(source, parsed);
  read_vlrs(source, header_bytes, parsed, reader);
  if (header.num_evlrs > 0) read_evlrs(source, evlrs_at, parsed, reader);
  const bool has_laszip = header.compressed && parsed.laszip.size() >= 2;
  header.compression = has_laszip          ? compressor_name(load<std::uint16_t>(parsed.laszip.data()))
                       : header.compressed ? "unknown"
                                           : "none";
  const bool wkt_first = (load<std::uint16_t>(b + 6) & 16U) != 0;
  const LasCrs crs = las_crs(reader.crs_records(), wkt_first);
  header.crs = crs.name;
  header.crs_wkt = crs.wkt;
  if (!crs.problem.empty()) header.warnings.push_back(crs.problem);
  return parsed;
}

LasHeader read_las_header(const std::string& path) {
  return parse_las(LasSource(path)).header;
}

}  // namespace hydrotin
