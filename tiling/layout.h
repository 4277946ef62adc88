#pragma once

#include <cstdint>
#include <string>

#include "hydrotin/options.h"
#include "hydrotin/phase.h"

/// Where files lie.
///
///     <output.dir>/terrain/tile_000000.h5, index.h5     the finished data set
///     <output.dir>/mesh/tile_000000.ply  dem/tile_000000.tif  dem.tif  change/tile_000000.tif  change.tif
///     hillshade.png  layers.gpkg  river_vertices.las|gpkg  pits.csv report.json report.txt <scratch>/<phase>/000000.h5 outputs of the phases
///     before `finish`

namespace hydrotin {

class Layout {
 public:
  explicit Layout(const PipelineOptions& options);
  explicit Layout(std::string output_dir) : out_(std::move(output_dir)), scratch_(out_ + "/work") {}

  /// The file that makes a unit complete.
  [[nodiscard]] std::string unit(Phase phase, std::uint64_t unit) const;
  [[nodiscard]] std::string terrain(std::uint64_t tile) const;
  [[nodiscard]] std::string index() const { return out_ + "/terrain/index.h5"; }
  [[nodiscard]] std::string rivers() const { return out_ + "/terrain/rivers.h5"; }
  [[nodiscard]] std::string mesh(std::uint64_t tile) const;
  [[nodiscard]] std::string dem_tile(std::uint64_t tile) const;
  [[nodiscard]] std::string change_tile(std::uint64_t tile) const;
  [[nodiscard]] std::string change() const { return out_ + "/change.tif"; }
  [[nodiscard]] std::string dem() const { return out_ + "/dem.tif"; }
  [[nodiscard]] std::string hillshade() const { return out_ + "/hillshade.png"; }
  [[nodiscard]] std::string layers() const { return out_ + "/layers.gpkg"; }
  [[nodiscard]] std::string profiles() const { return out_ + "/profiles"; }
  /// River vertices as points; `extension` without dot.
  [[nodiscard]] std::string river_points(const std::string& extension) const {
    return out_ + "/river_vertices." + extension;
  }
  [[nodiscard]] std::string pits_csv() const { return out_ + "/pits.csv"; }
  [[nodiscard]] std::string report_json() const { return out_ + "/report.json"; }
  [[nodiscard]] std::string report_text() const { return out_ + "/report.txt"; }
  [[nodiscard]] const std::string& out() const { return out_; }
  [[nodiscard]] const std::string& scratch() const { return scratch_; }

 private:
  std::string out_, scratch_;
};

}  // namespace hydrotin
