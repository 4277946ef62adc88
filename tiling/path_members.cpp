#include "path_members.h"

#include <algorithm>

namespace hydrotin {

void PathMembers::add(const Surface& surface, const LakeBreaches& found) {
  for (std::size_t i = 0; i < found.vertex.size(); ++i)
    member.emplace_back(surface.point[found.vertex[i]], found.level[i]);
  num_pits += static_cast<std::int64_t>(found.pit.size());
  num_unbreached += static_cast<std::int64_t>(found.num_unbreached);
  num_unfinished += static_cast<std::int64_t>(found.num_unfinished);
  dearest = std::max(dearest, found.dearest);
}

void PathMembers::write(store::Writer& out) {
  std::sort(member.begin(), member.end());
  std::vector<std::uint64_t> point;
  std::vector<std::int32_t> level;
  for (const auto& [p, l] : member) {
    if (!point.empty() && point.back() == p) continue;  // the first of them is the lowest
    point.push_back(p);
    level.push_back(l);
  }
  out.append("member_point", point, "vertices that breaches lower or may lower: tile << 32 | index, ascending");
  out.append("member_level", level, "z lattice: the lowest level to which a breach lowers it; 2147483647: to none");
  out.set("lake_pits", num_pits);
  out.set("pits_unbreached", num_unbreached);
  out.set("pits_unfinished", num_unfinished);
  out.set("dearest_breach", dearest);
}

std::vector<std::pair<std::uint64_t, std::int32_t>> read_path_members(const store::Reader& in) {
  const auto point = in.read<std::uint64_t>("member_point");
  const auto level = in.read<std::int32_t>("member_level");
  if (point.size() != level.size())
    throw Error(ErrorKind::storage, in.path() + ": its members are cut; delete the file and run again");
  std::vector<std::pair<std::uint64_t, std::int32_t>> out;
  for (std::size_t i = 0; i < point.size(); ++i) out.emplace_back(point[i], level[i]);
  return out;
}

OutletHeights lowest_outlets_of(const RunContext& context) {
  const store::Reader in(context.layout.unit(Phase::drain, 0));
  OutletHeights out;
  out.lowest_outlet = static_cast<std::int32_t>(in.integer("lowest_outlet"));
  return out;
}

}  // namespace hydrotin
