#include "hydrotin/las_crs.h"

#include <cpl_error.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <mutex>

#include "hydrotin/error.h"
#include "las_bytes.h"
#include "las_crs_records.h"

namespace hydrotin {
namespace {

class QuietGdal {
 public:
  QuietGdal() { CPLPushErrorHandler(CPLQuietErrorHandler); }
  ~QuietGdal() { CPLPopErrorHandler(); }
  QuietGdal(const QuietGdal&) = delete;
  QuietGdal& operator=(const QuietGdal&) = delete;
};

std::string to_wkt(const OGRSpatialReference& srs) {
  char* text = nullptr;
  const std::array<const char*, 2> options{"FORMAT=WKT2_2019", nullptr};
  srs.exportToWkt(&text, options.data());
  std::string wkt = text == nullptr ? "" : text;
  CPLFree(text);
  return wkt;
}

std::string epsg_name(const OGRSpatialReference& srs) {
  OGRSpatialReference horizontal(srs);
  if (horizontal.IsCompound() != 0) horizontal.StripVertical();
  const auto code_of = [](const OGRSpatialReference& crs) -> std::string {
    const char* authority = crs.GetAuthorityName(nullptr);
    const char* code = crs.GetAuthorityCode(nullptr);
    if (authority == nullptr || code == nullptr || std::strcmp(authority, "EPSG") != 0) return {};
    return std::string("EPSG:") + code;
  };
  if (std::string name = code_of(horizontal); !name.empty()) return name;

  // A match counts only when it is sure (100) and the only one.
  int count = 0;
  int* confidence = nullptr;
  OGRSpatialReferenceH* matches = horizontal.FindMatches(nullptr, &count, &confidence);
  std::string name;
  int sure = 0;
  for (int i = 0; i < count; ++i) {
    if (confidence[i] < 100) continue;
    ++sure;
    name = code_of(*OGRSpatialReference::FromHandle(matches[i]));
  }
  OSRFreeSRSArray(matches);
  CPLFree(confidence);
  return sure == 1 ? name : std::string();
}

LasCrs describe(OGRSpatialReference& srs) {
  LasCrs crs;
  crs.wkt = to_wkt(srs);
  crs.name = epsg_name(srs);
  if (crs.name.empty()) crs.name = crs.wkt;
  return crs;
}

// A TIFF of one pixel that carries the keys: GDAL then reads them by all the rules of GeoTIFF.
std::vector<std::uint8_t> tiff_with_keys(const LasCrsRecords& records) {
  struct Tag {
    std::uint16_t id, type;
    std::uint32_t count, value;
  };
  constexpr std::uint16_t kShort = 3, kLong = 4, kAscii = 2, kDouble = 12;
  std::vector<std::uint8_t> data;
  std::vector<Tag> tags{{256, kShort, 1, 1}, {257, kShort, 1, 1}, {258, kShort, 1, 8},
                        {259, kShort, 1, 1}, {262, kShort, 1, 1}, {273, kLong, 1, 8},
                        {277, kShort, 1, 1}, {278, kShort, 1, 1}, {279, kLong, 1, 1}};
  data.resize(16);  // header of 8 bytes, the pixel, padding
  const auto add = [&](std::uint16_t id, std::uint16_t type, std::size_t count, const void* from, std::size_t bytes) {
    if (count == 0) return;
    tags.push_back({id, type, static_cast<std::uint32_t>(count), static_cast<std::uint32_t>(data.size())});
    const std::size_t begin = data.size();
    data.resize(begin + ((bytes + 7) & ~std::size_t{7}));
    std::memcpy(data.data() + begin, from, bytes);
  };
  const std::string ascii = records.ascii + '|' + '\0';
  add(34735, kShort, records.directory.size(), records.directory.data(), records.directory.size() * 2);
  add(34736, kDouble, records.doubles.size(), records.doubles.data(), records.doubles.size() * 8);
  add(34737, kAscii, records.ascii.empty() ? 0 : ascii.size(), ascii.data(), ascii.size());

  const std::size_t directory = data.size();
  data.resize(directory + 2 + tags.size() * 12 + 4);
  data[0] = data[1] = 'I';
  store<std::uint16_t>(data.data() + 2, 42);
  store<std::uint32_t>(data.data() + 4, static_cast<std::uint32_t>(directory));
  store<std::uint16_t>(data.data() + directory, static_cast<std::uint16_t>(tags.size()));
  std::uint8_t* entry = data.data() + directory + 2;
  for (const Tag& tag : tags) {
    store(entry, tag.id);
    store(entry + 2, tag.type);
    store(entry + 4, tag.count);
    store(entry + 8, tag.value);  // short values are little-endian, hence left-justified as TIFF wants them
    entry += 12;
  }
  return data;
}

// Keys that a damaged directory may claim to hold lie outside it; GDAL is only given a directory that is whole.
bool plausible(const LasCrsRecords& records) {
  const auto& keys = records.directory;
  if (keys.size() < 4 || keys[0] != 1 || keys[3] > (keys.size() - 4) / 4) return false;
  for (std::size_t i = 4; i < 4 + std::size_t{keys[3]} * 4; i += 4) {
    const std::size_t where = keys[i + 1], count = keys[i + 2], first = keys[i + 3];
    if (where == 34736 && first + count > records.doubles.size()) return false;
    if (where == 34737 && first + count > records.ascii.size() + 2) return false;
    if (where == 34735 && first + count > keys.size()) return false;
  }
  return true;
}

LasCrs from_keys(const LasCrsRecords& records) {
  LasCrs crs;
  if (records.directory.size() < 4 || records.directory[3] == 0) return crs;
  if (!plausible(records)) {
    crs.problem = "its GeoTIFF keys are damaged: no CRS is taken from them";
    return crs;
  }
  static std::atomic<unsigned> serial{0};
  GDALAllRegister();
  const QuietGdal quiet;
  const std::string name = "/vsimem/hydrotin_geokeys_" + std::to_string(serial++) + ".tif";
  std::vector<std::uint8_t> tiff = tiff_with_keys(records);
  VSIFCloseL(VSIFileFromMemBuffer(name.c_str(), tiff.data(), tiff.size(), FALSE));
  const std::array<const char*, 2> drivers{"GTiff", nullptr};
  {
    const std::unique_ptr<GDALDataset> image(
        GDALDataset::Open(name.c_str(), GDAL_OF_RASTER, drivers.data(), nullptr, nullptr));
    const OGRSpatialReference* srs = image == nullptr ? nullptr : image->GetSpatialRef();
    if (srs != nullptr && srs->IsLocal() == 0) {
      OGRSpatialReference copy(*srs);
      crs = describe(copy);
    }
  }
  VSIUnlink(name.c_str());
  return crs;
}

LasCrs from_wkt(const std::string& wkt) {
  LasCrs crs;
  if (wkt.empty()) return crs;
  const QuietGdal quiet;
  OGRSpatialReference srs;
  if (srs.importFromWkt(wkt.c_str()) == OGRERR_NONE) return describe(srs);
  crs.problem = "its WKT does not describe a CRS: none is taken from it";
  return crs;
}

LasCrs read_crs(const LasCrsRecords& records, bool wkt_first) {
  LasCrs first = wkt_first ? from_wkt(records.wkt) : from_keys(records);
  if (!first.wkt.empty()) return first;
  LasCrs second = wkt_first ? from_keys(records) : from_wkt(records.wkt);
  if (second.problem.empty() && second.wkt.empty()) second.problem = first.problem;
  return second;
}

}  // namespace

// To find the one EPSG entry that is the same system takes tens of milliseconds, and the files of a survey mostly say
// the same: the last answer is kept.
LasCrs las_crs(const LasCrsRecords& records, bool wkt_first) {
  struct Answer {
    LasCrsRecords records;
    bool wkt_first = false;
    LasCrs crs;
  };
  static std::mutex mutex;
  static Answer last;
  {
    const std::lock_guard lock(mutex);
    if (last.wkt_first == wkt_first && last.records == records) return last.crs;
  }
  const LasCrs crs = read_crs(records, wkt_first);
  const std::lock_guard lock(mutex);
  last = {records, wkt_first, crs};
  return crs;
}

std::string wkt_for_las14(const LasCrs& crs) {
  const QuietGdal quiet;
  OGRSpatialReference srs;
  if (srs.importFromWkt(crs.wkt.c_str()) != OGRERR_NONE) return crs.wkt;
  char* text = nullptr;
  const std::array<const char*, 2> options{"FORMAT=WKT1_GDAL", nullptr};
  const bool ok = srs.exportToWkt(&text, options.data()) == OGRERR_NONE && text != nullptr && *text != '\0';
  std::string wkt = ok ? text : crs.wkt;
  CPLFree(text);
  return wkt;
}

std::vector<std::uint16_t> geokeys_for_las12(const LasCrs& crs) {
  constexpr std::uint16_t kModelType = 1024, kGeographicType = 2048, kProjectedType = 3072, kVerticalType = 4096;
  const QuietGdal quiet;
  OGRSpatialReference srs;
  if (crs.name.rfind("EPSG:", 0) != 0 || srs.importFromWkt(crs.wkt.c_str()) != OGRERR_NONE) return {};
  const unsigned long code = std::strtoul(crs.name.c_str() + 5, nullptr, 10);
  if (code == 0 || code > 32766 || (srs.IsProjected() == 0 && srs.IsGeographic() == 0)) return {};
  const bool projected = srs.IsProjected() != 0;
  std::vector<std::uint16_t> keys{1, 1, 0, 2};
  const auto add = [&](std::uint16_t key, unsigned long value) {
    keys.insert(keys.end(), {key, 0, 1, static_cast<std::uint16_t>(value)});
  };
  add(kModelType, projected ? 1 : 2);
  add(projected ? kProjectedType : kGeographicType, code);
  const char* vertical = srs.IsCompound() != 0 ? srs.GetAuthorityCode("VERT_CS") : nullptr;
  const unsigned long vertical_code = vertical == nullptr ? 0 : std::strtoul(vertical, nullptr, 10);
  if (vertical_code > 0 && vertical_code <= 32766) {
    add(kVerticalType, vertical_code);
    ++keys[3];
  }
  return keys;
}

}  // namespace hydrotin
