#include "path_members.h"

#include <algorithm>

namespace hydrotin {
namespace {

constexpr Wide kLowBits = (Wide{1} << 62) - 1;

}  // namespace

void PathMembers::add(const Surface& surface, const LakeBreaches& found, std::int64_t lake_bound) {
  for (std::size_t i = 0; i < found.vertex.size(); ++i)
    member.emplace_back(surface.point[found.vertex[i]], found.level[i]);
  num_pits += static_cast<std::int64_t>(found.pit.size());
  num_unbreached += static_cast<std::int64_t>(found.num_unbreached);
  num_unfinished += static_cast<std::int64_t>(found.num_unfinished);
  dearest = std::max(dearest, found.dearest);
  bound += lake_bound;
}

void PathMembers::write(store::Writer& out) {
  std::sort(member.begin(), member.end());
  const auto same_point = [](const auto& a, const auto& b) { return a.first == b.first; };
  member.erase(std::unique(member.begin(), member.end(), same_point), member.end());  // the first of them is the lowest
  std::vector<std::uint64_t> point;
  std::vector<std::int32_t> level;
  for (const auto& [p, l] : member) {
    point.push_back(p);
    level.push_back(l);
  }
  out.append("member_point", point, "vertices that breaches lower or may lower: tile << 32 | index, ascending");
  out.append("member_level", level, "z lattice: the lowest level to which a breach lowers it; 2147483647: to none");
  out.set("lake_pits", num_pits);
  out.set("pits_unbreached", num_unbreached);
  out.set("pits_unfinished", num_unfinished);
  out.set("dearest_breach", dearest);
  out.set("bound_high", static_cast<std::int64_t>(bound >> 62));
  out.set("bound_low", static_cast<std::int64_t>(bound & kLowBits));
}

void PathMembers::write_tiles(store::Writer& out) const {
  std::vector<std::uint32_t> tile;
  std::vector<std::uint64_t> begin;
  for (std::size_t i = 0; i < member.size(); ++i) {
    const std::uint32_t t = PointId(member[i].first).tile();
    if (!tile.empty() && tile.back() == t) continue;
    tile.push_back(t);
    begin.push_back(i);
  }
  begin.push_back(member.size());
  out.append("member_tile", tile, "tiles whose points are members, ascending");
  out.append("member_tile_begin", begin, "offsets of these tiles into member_point, one more than tiles");
}

std::vector<std::pair<std::uint64_t, std::int32_t>> read_path_members(const store::Reader& in) {
  return read_path_members(in, 0, in.size("member_point"));
}

std::vector<std::pair<std::uint64_t, std::int32_t>> read_path_members(const store::Reader& in, std::uint64_t first,
                                                                      std::uint64_t count) {
  if (in.size("member_point") != in.size("member_level"))
    throw Error(ErrorKind::storage, in.path() + ": its members are cut; delete the file and run again");
  const auto point = in.read_range<std::uint64_t>("member_point", first, count);
  const auto level = in.read_range<std::int32_t>("member_level", first, count);
  std::vector<std::pair<std::uint64_t, std::int32_t>> out;
  for (std::size_t i = 0; i < point.size(); ++i) out.emplace_back(point[i], level[i]);
  return out;
}

Wide read_bound(const store::Reader& in) {
  return static_cast<Wide>(in.integer("bound_high")) << 62 | in.integer("bound_low");
}

OutletHeights lowest_outlets_of(const RunContext& context) {
  const store::Reader in(context.layout.unit(Phase::drain, 0));
  OutletHeights out;
  out.lowest_outlet = static_cast<std::int32_t>(in.integer("lowest_outlet"));
  return out;
}

}  // namespace hydrotin
