#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

/// Reading LAS and LAZ point clouds.
///
/// A file is a header, variable-length records (VLRs), points, and perhaps extended VLRs. The points are cut into
/// chunks that can be decoded independently: those of the LAZ file, or runs of 65,536 records in a plain LAS file. LAZ
/// is decoded here, without a library: arithmetic-coded pointwise (item versions 1 and 2) and layered (versions 3 and
/// 4). COPC is read as the LAZ file it is.
///
/// Source   ASPRS LAS 1.0 to 1.4 R15; the LASzip format (Isenburg, "LASzip: lossless compression of LiDAR data", 2013).
/// Properties
///   (1) The records of a LAZ file are byte for byte those of the LAS file it was made from.
///   (2) Chunk sizes add up to the declared number of points, in file order.
///   (3) Any damage ends in an Error or in a result that the damage did not touch: no crash, no endless loop, and no
///       allocation beyond a constant times the bytes read and the points really decoded.
/// Paths    Any path of GDAL's virtual file system: /vsicurl/, /vsis3/, /vsizip/, /vsimem/ ... besides plain files.
/// Threads  All const members of LasFile may be called concurrently; chunks decode in parallel. Only files without a
///          chunk table (`header().sequential`) take turns, and are fast only when read in order.
/// Errors   Error(input), one sentence: file, place, cause, remedy.

namespace hydrotin {

/// What the file says about itself. Nothing here was checked against the points except `point_count`.
struct LasHeader {
  int version_major = 1, version_minor = 2;
  int point_format = 0;             ///< 0 to 10, without the compression bit
  std::uint16_t record_length = 0;  ///< bytes of one uncompressed record
  std::uint16_t extra_bytes = 0;    ///< bytes of a record beyond its point format
  std::uint64_t point_count = 0;
  std::array<double, 3> scale{1, 1, 1};       ///< coordinate = integer * scale + offset
  std::array<double, 3> offset{0, 0, 0};      ///< [units of the CRS]
  std::array<double, 3> min{0, 0, 0};         ///< declared, often wrong
  std::array<double, 3> max{0, 0, 0};         ///< declared, often wrong
  std::uint64_t offset_to_points = 0;         ///< bytes from the start of the file
  std::uint64_t file_bytes = 0;               ///< size of the file
  std::uint32_t num_vlrs = 0, num_evlrs = 0;  ///< declared
  bool compressed = false;                    ///< LAZ
  bool copc = false;                          ///< has the COPC info record
  bool sequential = false;                    ///< LAZ without chunk table: chunks cannot be decoded in parallel
  std::string compression;                    ///< "none", "pointwise", "pointwise chunked" or "layered chunked"
  std::string system, generator;              ///< system identifier and generating software
  int creation_year = 0, creation_day = 0;
  std::string crs;                    ///< "EPSG:n" where the CRS is one of EPSG's, else its WKT, else empty
  std::string crs_wkt;                ///< WKT, empty where the file has no CRS
  std::vector<std::string> warnings;  ///< oddities that do not stand in the way of the points
};

/// Bits of PointBatch::flags.
struct PointFlag {
  static constexpr std::uint8_t synthetic = 1;
  static constexpr std::uint8_t key_point = 2;
  static constexpr std::uint8_t withheld = 4;  ///< deleted: not to be used
  static constexpr std::uint8_t overlap = 8;   ///< formats 6 to 10 only; older formats say class 12
};

/// What to decode besides x, y, z. In layered files the layers of what is not asked for are not decoded.
struct PointFields {
  bool classification = true;
  bool flags = true;
  bool returns = false;
};

/// Decoded points as flat arrays, in file order. Arrays of fields not asked for are empty.
struct PointBatch {
  std::vector<std::int32_t> x, y, z;            ///< [n] integers of the file
  std::vector<std::uint8_t> classification;     ///< [n]
  std::vector<std::uint8_t> flags;              ///< [n] PointFlag bits
  std::vector<std::uint8_t> return_number;      ///< [n]
  std::vector<std::uint8_t> number_of_returns;  ///< [n]

  [[nodiscard]] std::size_t size() const { return x.size(); }
};

/// Reads header and VLRs only: says what a file declares even where its points are incomplete.
///
/// Fails: not a LAS file, header cut off, values that make no sense (version, format, record length, scale).
/// Complexity: O(VLRs).
[[nodiscard]] LasHeader read_las_header(const std::string& path);

/// An open LAS or LAZ file, checked: header, VLRs, chunk table, and that the declared points are all there.
class LasFile {
 public:
  /// Opens and checks; reads no point. Complexity: O(VLRs + chunks).
  explicit LasFile(std::string path);
  LasFile(LasFile&&) noexcept;
  LasFile& operator=(LasFile&&) noexcept;
  ~LasFile();

  [[nodiscard]] const std::string& path() const;
  [[nodiscard]] const LasHeader& header() const;
  [[nodiscard]] std::size_t num_chunks() const;
  [[nodiscard]] std::uint64_t chunk_point_count(std::size_t chunk) const;
  /// Index in the file of the chunk's first point; for `chunk == num_chunks()` the number of points.
  [[nodiscard]] std::uint64_t chunk_first_point(std::size_t chunk) const;

  /// Replaces `out` with the points of one chunk. Its memory is reused.
  ///
  /// @param chunk  below num_chunks().
  /// Complexity: O(points of the chunk).
  void decode(std::size_t chunk, PointBatch& out, PointFields fields = {}) const;

  /// Replaces `out` with the complete point records of one chunk as an uncompressed LAS file would hold them:
  /// [chunk_point_count * record_length] bytes.
  void decode_records(std::size_t chunk, std::vector<std::byte>& out) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hydrotin
