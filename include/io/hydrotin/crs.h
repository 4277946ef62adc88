#pragma once

#include <string>
#include <string_view>

/// Coordinate reference systems: what users write, what files hold, and whether two are the same.
///
/// WKT is what travels through the program; "EPSG:n" is what people read. A CRS is never transformed here: all inputs
/// of a run share one.
///
/// Threads  Functions are pure: safe to call concurrently.

namespace hydrotin {

/// A CRS in the two forms the program needs; both empty = unknown.
struct Crs {
  std::string wkt;             ///< WKT 2 of the CRS, or WKT 1 where a file held that
  std::string name;            ///< "EPSG:n" if the CRS is one of them, else its own name
  bool is_projected = false;   ///< a plane: x and y are lengths
  double metres_per_unit = 1;  ///< of x and y; 1 for a CRS that is not projected

  [[nodiscard]] bool is_unknown() const { return wkt.empty(); }
};

/// What a user wrote for `key` ("EPSG:2154", WKT, PROJJSON, PROJ string), for messages named `key`.
/// Fails: Error(config) when it names no CRS.
[[nodiscard]] Crs parse_crs(const std::string& text, const std::string& key);

/// What a file held; an empty text gives the unknown CRS. Fails: Error(input) naming `file`.
[[nodiscard]] Crs crs_from_wkt(const std::string& wkt, const std::string& file);

/// Whether x and y in both mean the same place: names, axis order, the vertical part and metadata are ignored. Two
/// unknown CRSs are the same; an unknown one is never the same as a known one. Both texts must come from the functions
/// above.
[[nodiscard]] bool same_crs(const Crs& a, const Crs& b);

}  // namespace hydrotin
