#include <algorithm>
#include <limits>

#include "edits_file.h"
#include "hydrotin/group_cut.h"
#include "hydrotin/lifting.h"
#include "phases.h"
#include "pit_options.h"
#include "settled_heights.h"
#include "surface.h"

namespace hydrotin {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// The share of one tile in the groups that `owner` solves.
struct Share {
  Surface surface;
  std::vector<std::uint8_t> is_member;  // [n]
  std::vector<std::uint32_t> unit;      // [n] of whoever solves it
  std::vector<std::int32_t> breached;   // [n]
};

Share read_share(const RunContext& context, const store::Reader& groups, std::uint32_t tile, std::uint32_t owner) {
  const auto begin = groups.read_range<std::uint64_t>("part_begin", tile, 2);
  const auto owner_of = groups.read_range<std::uint32_t>("part_owner", begin[0], begin[1] - begin[0]);
  const auto unit_of = groups.read_range<std::uint32_t>("part_unit", begin[0], begin[1] - begin[0]);
  const store::Reader in(context.layout.unit(Phase::members, tile));
  const auto point = in.read<std::uint64_t>("patch_point");
  const auto xyz = in.read<std::int32_t>("patch_xyz");
  const auto level = in.read<std::int32_t>("patch_level");
  const auto breached = in.read<std::int32_t>("patch_breached");
  const auto outlet = in.read<std::uint8_t>("patch_outlet");
  const auto part = in.read<std::uint32_t>("patch_part");
  const auto triangle = in.read<std::uint32_t>("patch_triangle");
  const std::size_t n = point.size();
  if (xyz.size() != 3 * n || level.size() != n || breached.size() != n || outlet.size() != n || part.size() != n ||
      triangle.size() % 3 != 0 ||
      std::any_of(triangle.begin(), triangle.end(), [&](std::uint32_t v) { return v >= n; }) ||
      std::any_of(part.begin(), part.end(), [&](std::uint32_t p) { return p != kNone && p >= owner_of.size(); }))
    throw Error(ErrorKind::storage, in.path() + ": its patches contradict each other; delete the file and run again");
  const auto is_mine = [&](std::uint32_t v) { return part[v] != kNone && owner_of[part[v]] == owner; };
  Share out;
  std::vector<std::uint32_t> number(n, kNone);
  for (std::size_t t = 0; t < triangle.size(); t += 3) {
    if (!is_mine(triangle[t]) && !is_mine(triangle[t + 1]) && !is_mine(triangle[t + 2])) continue;
    for (std::size_t i = t; i < t + 3; ++i) {
      const std::uint32_t v = triangle[i];
      if (number[v] == kNone) {
        number[v] = out.surface.num_vertices();
        out.surface.point.push_back(point[v]);
        out.surface.position.push_back({xyz[3 * v], xyz[3 * v + 1]});
        out.surface.height.push_back(xyz[3 * v + 2]);
        out.surface.level.push_back(level[v]);
        out.surface.is_outlet.push_back(outlet[v]);
        out.is_member.push_back(is_mine(v));
        out.unit.push_back(part[v] == kNone ? kNone : unit_of[part[v]]);
        out.breached.push_back(breached[v]);
      }
      out.surface.triangle.push_back(number[v]);
    }
  }
  return out;
}

}  // namespace

void settle_groups(const RunContext& context, std::uint32_t tile) {
  const store::Reader groups(context.layout.unit(Phase::groups, 0));
  const auto begin = groups.read_range<std::uint64_t>("tile_begin", tile, 2);
  std::vector<Share> shares;
  for (const std::uint32_t t : groups.read_range<std::uint32_t>("tile_list", begin[0], begin[1] - begin[0]))
    shares.push_back(read_share(context, groups, t, tile));
  std::vector<Surface> parts;
  for (Share& share : shares) parts.push_back(std::move(share.surface));
  const Surface surface = merged(parts, context.layout.unit(Phase::members, tile));
  PitComponents components;
  components.level = surface.level;
  components.breached = surface.height;
  std::vector<std::uint8_t> is_member(surface.num_vertices(), 0);
  std::vector<std::uint32_t> unit(surface.num_vertices(), kNoVertexNumber);
  for (std::size_t s = 0; s < shares.size(); ++s)
    for (std::uint32_t v = 0; v < parts[s].num_vertices(); ++v) {
      const auto at = static_cast<std::size_t>(
          std::lower_bound(surface.position.begin(), surface.position.end(), parts[s].position[v]) -
          surface.position.begin());
      is_member[at] |= shares[s].is_member[v];
      unit[at] = std::min(unit[at], shares[s].unit[v]);
      components.breached[at] = std::min(components.breached[at], shares[s].breached[v]);
    }
  parts = {};
  shares = {};
  const ChangeableSurface changeable(context, surface);
  hold_borders(changeable.view(), surface.level, unit, is_member);
  collect_components(changeable.view(), is_member, {}, components);
  std::vector<std::int32_t> height = surface.height;
  ChangeFigures figures;
  figures.groups = static_cast<std::int64_t>(components.size());
  figures.unguaranteed =
      static_cast<std::int64_t>(solve_components(changeable.view(), components, removal_options(context), height));
  std::vector<std::pair<std::uint64_t, std::int32_t>> moved;
  const bool lifts = context.options.pits.method == PitMethod::lift;
  for (const std::uint32_t v : components.member) {
    if (height[v] == surface.height[v]) continue;
    moved.emplace_back(surface.point[v], height[v]);
    if (!lifts) figures.add(std::int64_t{height[v]} - surface.height[v], changeable.star()[v]);
  }
  std::sort(moved.begin(), moved.end());
  store::Writer out(context.layout.unit(Phase::settle, tile));
  out.set("recipe", context.recipe(Phase::settle));
  std::vector<std::uint64_t> point;
  std::vector<std::int32_t> to;
  for (const auto& [p, h] : moved) {
    point.push_back(p);
    to.push_back(h);
  }
  out.append("moved_point", point, "vertices that were moved: tile << 32 | index, ascending");
  out.append("moved_height", to, "z lattice: their final heights");
  write_figures(out, figures);
  write_edits(out, changeable.view(), surface.triangle, components, height, changeable.star());
  out.commit();
}

std::vector<std::int32_t> settled_heights(const RunContext& context, std::uint32_t tile, const Part& part) {
  if (context.options.pits.method == PitMethod::none) return part.height;
  const store::Reader in(context.layout.unit(Phase::members, tile));
  const auto point = in.read<std::uint64_t>("point");
  std::vector<std::int32_t> height = in.read<std::int32_t>("height");
  if (point != part.point || height.size() != point.size())
    throw Error(ErrorKind::storage, in.path() +
                                        ": its heights are not those of the tile's vertices; delete the file "
                                        "and run again");
  const store::Reader groups(context.layout.unit(Phase::groups, 0));
  const auto begin = groups.read_range<std::uint64_t>("part_begin", tile, 2);
  auto owners = groups.read_range<std::uint32_t>("part_owner", begin[0], begin[1] - begin[0]);
  std::sort(owners.begin(), owners.end());
  owners.erase(std::unique(owners.begin(), owners.end()), owners.end());
  for (const std::uint32_t owner : owners) {
    if (owner == kNone) continue;
    const store::Reader settled(context.layout.unit(Phase::settle, owner));
    const auto moved = settled.read<std::uint64_t>("moved_point");
    const auto to = settled.read<std::int32_t>("moved_height");
    if (moved.size() != to.size())
      throw Error(ErrorKind::storage, settled.path() + ": its heights are cut; delete the file and run again");
    for (std::size_t i = 0; i < moved.size(); ++i)
      if (const auto v = part.find(PointId(moved[i]))) height[*v] = to[i];
  }
  return height;
}

}  // namespace hydrotin
