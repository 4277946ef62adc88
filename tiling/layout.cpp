#include "layout.h"

#include <cstdio>

namespace hydrotin {
namespace {

std::string six_digits(std::uint64_t number) {
  char text[24];
  std::snprintf(text, sizeof text, "%06llu", static_cast<unsigned long long>(number));
  return text;
}

}  // namespace

Layout::Layout(const PipelineOptions& options)
    : out_(options.output.dir), scratch_(options.run.scratch.empty() ? out_ + "/work" : options.run.scratch) {}

std::string Layout::unit(Phase phase, std::uint64_t unit) const {
  if (phase == Phase::finish) return terrain(unit);
  if (phase == Phase::report) return index();
  return scratch_ + "/" + std::string(name(phase)) + "/" + six_digits(unit) + ".h5";
}

std::string Layout::terrain(std::uint64_t tile) const {
  return out_ + "/terrain/tile_" + six_digits(tile) + ".h5";
}
std::string Layout::mesh(std::uint64_t tile) const {
  return out_ + "/mesh/tile_" + six_digits(tile) + ".ply";
}
std::string Layout::dem_tile(std::uint64_t tile) const {
  return out_ + "/dem/tile_" + six_digits(tile) + ".tif";
}

std::string Layout::change_tile(std::uint64_t tile) const {
  return out_ + "/change/tile_" + six_digits(tile) + ".tif";
}

}  // namespace hydrotin
