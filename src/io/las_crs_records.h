#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hydrotin/las_crs.h"

// The records that tell a reader a CRS.

namespace hydrotin {

// OGC WKT of the first edition, as LAS 1.4 wants it; a later edition where the first has no words for the CRS.
[[nodiscard]] std::string wkt_for_las14(const LasCrs& crs);

// GeoTIFF key directory, or empty when the horizontal system is none of EPSG's.
[[nodiscard]] std::vector<std::uint16_t> geokeys_for_las12(const LasCrs& crs);

}  // namespace hydrotin
