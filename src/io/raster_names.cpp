#include "hydrotin/raster_names.h"

#include <algorithm>
#include <array>

#include "gdal_calls.h"

namespace hydrotin {

std::optional<SubdatasetName> parse_subdataset(const std::string& name) {
  const auto is_format = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_'; };
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const auto first_not = std::find_if_not(name.begin(), name.end(), is_format);
  auto at = static_cast<std::size_t>(first_not - name.begin());
  if (at < 2 || at + 1 >= name.size() || name[at] != ':' || is_digit(name[0])) return std::nullopt;
  ++at;
  // GTIFF_DIR:2:file, and GTIFF_DIR:off:1234:file
  if (name.starts_with("GTIFF_DIR:")) {
    if (name.compare(at, 4, "off:") == 0) at += 4;
    std::size_t end = at;
    while (end < name.size() && is_digit(name[end])) ++end;
    if (end == at || end + 1 >= name.size() || name[end] != ':') return std::nullopt;
    return SubdatasetName{name.substr(0, end + 1), name.substr(end + 1), ""};
  }
  if (name[at] == '"') {
    const std::size_t end = name.find('"', at + 1);
    if (end == std::string::npos || end == at + 1) return std::nullopt;
    return SubdatasetName{name.substr(0, at + 1), name.substr(at + 1, end - at - 1), name.substr(end)};
  }
  const std::size_t end = std::min(name.find(':', at), name.size());
  if (end == at) return std::nullopt;
  return SubdatasetName{name.substr(0, at), name.substr(at, end - at), name.substr(end)};
}

bool reads_through_hdf5(const std::string& path) {
  gdal::register_drivers();
  const gdal::MessageTrap trap;
  const GDALDriverH driver = GDALIdentifyDriverEx(path.c_str(), GDAL_OF_RASTER, nullptr, nullptr);
  if (driver == nullptr) return false;
  static constexpr std::array<const char*, 6> kDrivers{"netCDF", "HDF5", "HDF5Image", "BAG", "KEA", "VRT"};
  const std::string name = GDALGetDriverShortName(driver);
  return std::any_of(kDrivers.begin(), kDrivers.end(), [&](const char* one) { return name == one; });
}

}  // namespace hydrotin
