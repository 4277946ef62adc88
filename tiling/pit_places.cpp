#include "pit_places.h"

#include "plan.h"

namespace hydrotin {

std::shared_ptr<const PitPlaces> load_pit_places(const PitOptions& options, const Plan& plan) {
  auto places = std::make_shared<PitPlaces>();
  if (options.outlets == OutletPolicy::layer) {
    places->outlets = PlaceLayer(options.outlet_layer, plan.lattice, plan.crs_wkt, false);
    places->hash = places->outlets.hash();
  }
  if (!options.keep.inside.empty()) {
    places->keep = PlaceLayer(options.keep.inside, plan.lattice, plan.crs_wkt, true);
    places->hash += places->keep.hash();
  }
  return places;
}

}  // namespace hydrotin
