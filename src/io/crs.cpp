#include "hydrotin/crs.h"

#include <cpl_conv.h>
#include <ogr_spatialref.h>

#include <algorithm>

#include "gdal_calls.h"

namespace hydrotin {
namespace {

std::string wkt_of(const OGRSpatialReference& reference) {
  char* text = nullptr;
  const char* const options[] = {"FORMAT=WKT2_2019", "MULTILINE=NO", nullptr};
  const OGRErr result = reference.exportToWkt(&text, options);
  std::string wkt = result == OGRERR_NONE && text != nullptr ? text : "";
  CPLFree(text);
  return wkt;
}

/// EPSG:n of the horizontal part by its own authority, else by identifying its definition with one of EPSG's, else the
/// CRS's name.
std::string name_of(const OGRSpatialReference& reference) {
  const auto code_of = [](const OGRSpatialReference& r) -> std::string {
    const char* authority = r.GetAuthorityName(nullptr);
    const char* code = r.GetAuthorityCode(nullptr);
    if (authority == nullptr || code == nullptr || !EQUAL(authority, "EPSG")) return {};
    return std::string("EPSG:") + code;
  };
  if (auto code = code_of(reference); !code.empty()) return code;
  OGRSpatialReference copy(reference);
  if (copy.IsCompound() != 0) copy.StripVertical();
  if (auto code = code_of(copy); !code.empty()) return code;
  if (copy.AutoIdentifyEPSG() == OGRERR_NONE)
    if (auto code = code_of(copy); !code.empty()) return code;
  const char* name = reference.GetName();
  return name != nullptr && *name != '\0' ? name : "unnamed CRS";
}

Crs describe(const OGRSpatialReference& reference) {
  Crs crs;
  crs.wkt = wkt_of(reference);
  crs.name = name_of(reference);
  crs.is_projected = reference.IsProjected() != 0;
  if (crs.is_projected) crs.metres_per_unit = reference.GetLinearUnits(nullptr);
  return crs;
}

std::string shortened(const std::string& text) {
  return text.size() <= 60 ? text : text.substr(0, 57) + "...";
}

}  // namespace

Crs parse_crs(const std::string& text, const std::string& key) {
  const gdal::MessageTrap trap;
  const auto refuse = [&](const std::string& why) -> Crs {
    throw Error(ErrorKind::config,
                key + ": '" + shortened(text) + "' " + why + " (give EPSG:n, for example EPSG:2154, or WKT)");
  };
  if (std::all_of(text.begin(), text.end(), [](unsigned char c) { return c == ' ' || c == '\t' || c == '\n'; }))
    return refuse("names no coordinate reference system");
  OGRSpatialReference reference;
  reference.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  // Only texts are read, never files or addresses: a config must mean the same on every machine.
  const char* const limits[] = {"ALLOW_NETWORK_ACCESS=NO", "ALLOW_FILE_ACCESS=NO", nullptr};
  if (reference.SetFromUserInput(text.c_str(), limits) != OGRERR_NONE)
    return refuse("names no coordinate reference system");
  Crs crs = describe(reference);
  if (crs.wkt.empty()) return refuse("cannot be written as WKT");
  return crs;
}

Crs crs_from_wkt(const std::string& wkt, const std::string& file) {
  if (wkt.empty()) return {};
  const gdal::MessageTrap trap;
  OGRSpatialReference reference;
  reference.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  if (reference.importFromWkt(wkt.c_str()) != OGRERR_NONE)
    trap.fail(ErrorKind::input, file, "its coordinate reference system cannot be read from '" + shortened(wkt) + "'",
              "set input.crs");
  Crs crs = describe(reference);
  if (crs.wkt.empty()) crs.wkt = wkt;  // not expressible in WKT 2: the file's own words
  return crs;
}

bool same_crs(const Crs& a, const Crs& b) {
  if (a.is_unknown() || b.is_unknown()) return a.is_unknown() == b.is_unknown();
  if (a.wkt == b.wkt) return true;
  const gdal::MessageTrap trap;
  OGRSpatialReference first, second;
  if (first.importFromWkt(a.wkt.c_str()) != OGRERR_NONE || second.importFromWkt(b.wkt.c_str()) != OGRERR_NONE)
    return false;
  for (auto* reference : {&first, &second}) {
    if (reference->IsCompound() != 0) reference->StripVertical();
    reference->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  }
  const char* const criteria[] = {"IGNORE_DATA_AXIS_TO_SRS_AXIS_MAPPING=YES",
                                  "CRITERION=EQUIVALENT_EXCEPT_AXIS_ORDER_GEOGCRS", "IGNORE_COORDINATE_EPOCH=YES",
                                  nullptr};
  return first.IsSame(&second, criteria) != 0;
}

}  // namespace hydrotin
