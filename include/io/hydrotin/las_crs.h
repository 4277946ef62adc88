#pragma once

#include <cstdint>
#include <string>
#include <vector>

/// The coordinate reference system of a LAS file.
///
/// LAS 1.4 stores OGC WKT; older files store GeoTIFF keys. Both become one WKT and, where it can be told without doubt,
/// the name "EPSG:n" (an authority code in the file, or the one EPSG entry that is the same system). A vertical system
/// is kept in the WKT; the name is that of the horizontal part.
///
/// Threads  Functions may be called concurrently.

namespace hydrotin {

/// What a file holds about its CRS, as it stands there.
struct LasCrsRecords {
  std::string wkt;                       ///< OGC WKT record (2112)
  std::vector<std::uint16_t> directory;  ///< GeoTIFF key directory (34735)
  std::vector<double> doubles;           ///< GeoTIFF double parameters (34736)
  std::string ascii;                     ///< GeoTIFF text parameters (34737)

  friend bool operator==(const LasCrsRecords&, const LasCrsRecords&) = default;
};

struct LasCrs {
  std::string name;     ///< "EPSG:n", or the WKT where EPSG has no such system, or empty
  std::string wkt;      ///< empty: the file has no CRS
  std::string problem;  ///< not empty: records are there but make no sense; what is wrong with them
};

/// Reads the records of a file. `wkt_first` is the file's word that WKT is the one that counts.
[[nodiscard]] LasCrs las_crs(const LasCrsRecords& records, bool wkt_first);

}  // namespace hydrotin
