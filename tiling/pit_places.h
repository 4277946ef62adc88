#pragma once

#include <memory>
#include <string>

#include "hydrotin/options.h"
#include "hydrotin/place_layer.h"

/// The layers that the options of pits name.

namespace hydrotin {

struct Plan;

struct PitPlaces {
  PlaceLayer outlets, keep;
  std::string hash;
};

/// Empty layers where the options name none. Fails: as PlaceLayer.
[[nodiscard]] std::shared_ptr<const PitPlaces> load_pit_places(const PitOptions& options, const Plan& plan);

}  // namespace hydrotin
