#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

/// Writing LAS files.
///
/// LAS 1.2 for point formats 0 to 3, LAS 1.4 for formats 6 to 8, uncompressed. Points are appended; the header is
/// completed on close. The file appears under its name only then: until then, and for ever if the program dies, it lies
/// beside it under a name with ".partial". The same calls give the same bytes.
///
/// Properties
///   (1) What LasFile reads is what was written, for every value that the point format can hold.
///   (2) Without close() nothing appears and nothing stays behind.
/// Paths    As for reading: any writable path of GDAL's virtual file system in which a file can be renamed.
/// Threads  A writer belongs to one thread.
/// Errors   Error(config) for values that the point format cannot hold; Error(storage) where the file cannot be
/// written.

namespace hydrotin {

struct LasWriterOptions {
  int point_format = 6;  ///< 0 to 3: LAS 1.2; 6 to 8: LAS 1.4
  std::array<double, 3> scale{0.01, 0.01, 0.01};
  std::array<double, 3> offset{0, 0, 0};
  std::string crs;                     ///< "EPSG:n" or WKT; LAS 1.2 needs one of EPSG's; empty: none
  std::string system = "hydrotin";     ///< at most 32 bytes
  std::string generator = "hydrotin";  ///< at most 32 bytes
  int creation_year = 0, creation_day = 0;
};

/// Points to write. x, y, z have n entries; any other array has n entries or none, which means zero (returns: 1 of 1).
/// Fields that the point format lacks are not written.
struct LasPoints {
  std::span<const std::int32_t> x, y, z;            ///< [n] coordinate = integer * scale + offset
  std::span<const std::uint8_t> classification;     ///< [n] at most 31 in formats 0 to 3
  std::span<const std::uint8_t> flags;              ///< [n] PointFlag bits; no overlap in formats 0 to 3
  std::span<const std::uint8_t> return_number;      ///< [n] at most 7 in formats 0 to 3, else 15
  std::span<const std::uint8_t> number_of_returns;  ///< [n] likewise
  std::span<const std::uint16_t> intensity;         ///< [n]
  std::span<const std::uint16_t> point_source;      ///< [n] flight line
  std::span<const double> gps_time;                 ///< [n]
  std::span<const std::uint16_t> red, green, blue;  ///< [n]
  std::span<const std::uint16_t> near_infrared;     ///< [n]
};

class LasWriter {
 public:
  LasWriter(std::string path, const LasWriterOptions& options);
  LasWriter(LasWriter&&) noexcept;
  LasWriter& operator=(LasWriter&&) noexcept;
  ~LasWriter();  ///< Removes what was not closed.

  /// Appends n points. Complexity: O(n) time, O(1) memory.
  void write(const LasPoints& points);
  /// Completes the header and gives the file its name, replacing an older one.
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hydrotin
