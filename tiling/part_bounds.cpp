#include "part_bounds.h"

#include <string>

#include "block_index.h"
#include "store.h"

namespace hydrotin {

const BoxTree& PartBounds::tree(const Layout& layout, std::uint32_t num_tiles) {
  std::call_once(once_, [&] {
    const store::Reader in(layout.unit(Phase::drain, 0));
    auto bounds = unflatten(in.read<std::int32_t>("tile_bounds"));
    if (bounds.size() != num_tiles)
      throw Error(ErrorKind::storage, in.path() + ": its bounds are not one per tile; delete the file and run again");
    tree_.emplace(std::move(bounds));
  });
  return *tree_;
}

}  // namespace hydrotin
