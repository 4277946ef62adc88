#include <algorithm>
#include <limits>
#include <optional>
#include <tuple>

#include "edits_file.h"
#include "filled_lakes.h"
#include "group_parts.h"
#include "hydrotin/group_cut.h"
#include "hydrotin/lifting.h"
#include "path_members.h"
#include "phases.h"
#include "pit_options.h"
#include "surface.h"

namespace hydrotin {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// The vertices of a tile's surface that may move.
class TileMembers {
 public:
  TileMembers(const RunContext& context, std::uint32_t tile, const Surface& surface, const ChangeableTerrain& terrain,
              std::span<const std::uint8_t> is_filled)
      : context_(context), tile_(tile), surface_(surface), terrain_(terrain), is_filled_(is_filled) {
    components.level = surface.level;
    components.breached = surface.height;
    for (std::uint32_t v = 0; v < surface.num_vertices(); ++v)
      is_member_.push_back(surface.level[v] != surface.height[v]);
    add_paths();
    flats = add_flats_without_descent(terrain, surface.level, surface.is_rim, is_member_);
    label_pieces();
  }

  PitComponents components;  // of the groups inside the tile
  OpenFlats flats;
  std::vector<std::uint32_t> label;  // [n] piece, or pieces + flat that does not drain here; kNone
  std::vector<std::uint64_t> piece_size;
  GroupParts parts;  // of pieces and flats, in case that the group is too large
  std::vector<std::pair<std::uint32_t, std::uint32_t>> contact;  // flat, piece

 private:
  void add_paths() {
    if (context_.options.pits.method == PitMethod::lift) return;
    // Points are two ascending runs: the tile's own, then those of others.
    const auto middle = std::is_sorted_until(surface_.point.begin(), surface_.point.end());
    const auto add = [&](const std::vector<std::pair<std::uint64_t, std::int32_t>>& members) {
      for (const auto& [first, last] : {std::pair{surface_.point.begin(), middle}, {middle, surface_.point.end()}}) {
        auto at = first;
        for (const auto& [point, level] : members) {
          at = std::lower_bound(at, last, point);
          if (at == last) break;
          if (*at != point) continue;
          const auto v = static_cast<std::size_t>(at - surface_.point.begin());
          if (is_filled_[v]) continue;
          is_member_[v] = 1;
          components.breached[v] = std::min(components.breached[v], level);
        }
      }
    };
    add(read_path_members(store::Reader(context_.layout.unit(Phase::pools, tile_))));
    std::optional<store::Reader> in;
    std::uint32_t open_unit = kNone;
    for (const MemberRange& range : ranges_of_breaches()) {
      if (range.unit != open_unit) in.emplace(context_.layout.unit(Phase::breach, range.unit));
      open_unit = range.unit;
      add(read_path_members(*in, range.first, range.count));
    }
  }

  // Where the outputs of `breach` have members among the points of the tiles that this one has points of.
  [[nodiscard]] std::vector<MemberRange> ranges_of_breaches() const {
    std::vector<std::uint32_t> owners;
    for (const std::uint64_t point : surface_.point)
      if (owners.empty() || owners.back() != PointId(point).tile()) owners.push_back(PointId(point).tile());
    std::sort(owners.begin(), owners.end());
    owners.erase(std::unique(owners.begin(), owners.end()), owners.end());
    std::vector<MemberRange> out;
    for (const std::uint32_t owner : owners) {
      const auto ranges = context_.breach_index->ranges_of(owner, context_.layout, context_.plan.num_tiles());
      out.insert(out.end(), ranges.begin(), ranges.end());
    }
    std::sort(out.begin(), out.end(), [](const MemberRange& a, const MemberRange& b) {
      return std::tie(a.unit, a.first) < std::tie(b.unit, b.first);
    });
    return out;
  }

  // Groups that other tiles may belong to become pieces; the others are components.
  void label_pieces() {
    const std::uint32_t n = surface_.num_vertices();
    label.assign(n, kNone);
    std::vector<std::uint32_t> open_flat(n, kNone);
    for (std::uint32_t f = 0; f < flats.drains.size(); ++f)
      for (std::uint32_t i = flats.begin[f]; !flats.drains[f] && i < flats.begin[f + 1]; ++i)
        open_flat[flats.vertex[i]] = f;
    std::vector<std::uint8_t> is_closed(n, 0), is_seen(n, 0);
    std::vector<std::uint32_t> group;
    for (std::uint32_t seed = 0; seed < n; ++seed) {
      if (!is_member_[seed] || is_seen[seed]) continue;
      bool is_open = false;
      const std::size_t first_contact = contact.size();
      const auto piece = static_cast<std::uint32_t>(piece_size.size());
      group.assign(1, seed);
      is_seen[seed] = 1;
      for (std::size_t next = 0; next < group.size(); ++next) {
        is_open = is_open || surface_.is_rim[group[next]];
        for (const std::uint32_t w : surface_.graph.neighbors(group[next])) {
          if (open_flat[w] != kNone) contact.emplace_back(open_flat[w], piece);
          if (!is_member_[w] || is_seen[w]) continue;
          is_seen[w] = 1;
          group.push_back(w);
        }
      }
      std::sort(contact.begin() + static_cast<std::ptrdiff_t>(first_contact), contact.end());
      contact.erase(std::unique(contact.begin() + static_cast<std::ptrdiff_t>(first_contact), contact.end()),
                    contact.end());
      is_open = is_open || contact.size() > first_contact;
      for (const std::uint32_t v : group) {
        is_closed[v] = !is_open;
        if (is_open) label[v] = piece;
      }
      if (is_open) piece_size.push_back(group.size());
    }
    for (std::uint32_t v = 0; v < n; ++v)
      if (open_flat[v] != kNone) label[v] = static_cast<std::uint32_t>(piece_size.size()) + open_flat[v];
    const bool cuts = context_.options.pits.method != PitMethod::lift;
    const CutGrid grid = cut_grid(context_.outline.bounds(), context_.outline.vertices);
    if (cuts)
      components.num_cut =
          cut_large_groups(terrain_, components.level, grid, context_.options.pits.largest_group, is_closed);
    collect_components(terrain_, is_closed, {}, components);
    parts = cuts ? parts_of(surface_, terrain_, label, grid) : whole_parts(surface_, label);
  }

  const RunContext& context_;
  std::uint32_t tile_;
  const Surface& surface_;
  const ChangeableTerrain& terrain_;
  std::span<const std::uint8_t> is_filled_;
  std::vector<std::uint8_t> is_member_;
};

// What other tiles must know of the open groups, and what whoever solves them needs.
void write_open(store::Writer& out, const Surface& surface, const TileMembers& members) {
  const auto num_pieces = static_cast<std::uint32_t>(members.piece_size.size());
  std::vector<std::uint64_t> rim_point, size = members.piece_size;
  std::vector<std::uint32_t> rim_label, rim_part, contact_flat, contact_piece;
  for (std::uint32_t v = 0; v < surface.num_vertices(); ++v)
    if (surface.is_rim[v] && members.label[v] < num_pieces) {
      rim_point.push_back(surface.point[v]);
      rim_label.push_back(members.label[v]);
      rim_part.push_back(members.parts.of[v]);
    }
  for (std::uint32_t f = 0; f < members.flats.drains.size(); ++f) {
    size.push_back(members.flats.begin[f + 1] - members.flats.begin[f]);
    for (std::uint32_t i = members.flats.begin[f]; i < members.flats.begin[f + 1]; ++i) {
      if (!surface.is_rim[members.flats.vertex[i]]) continue;
      rim_point.push_back(surface.point[members.flats.vertex[i]]);
      rim_label.push_back(num_pieces + f);
      rim_part.push_back(members.parts.of[members.flats.vertex[i]]);
    }
  }
  for (const auto& [flat, piece] : members.contact) {
    contact_flat.push_back(num_pieces + flat);
    contact_piece.push_back(piece);
  }
  out.set("pieces", std::int64_t{num_pieces});
  out.append("piece_size", size, "vertices of the groups that reach other tiles, then of the flats that do");
  out.append("flat_touches", members.flats.touches, "1: the flat has a neighbour here that may move");
  out.append("flat_drains", members.flats.drains, "1: the flat has an outlet or a way down here");
  out.append("rim_point", rim_point, "vertices of them that other parts have too: tile << 32 | index");
  out.append("rim_label", rim_label, "index into piece_size");
  out.append("rim_part", rim_part, "index into part_size");
  out.append("contact_flat", contact_flat, "flats beside groups: index into piece_size");
  out.append("contact_piece", contact_piece, "the group: index into piece_size");

  write_parts(out, members.parts);

  std::vector<std::uint32_t> number(surface.num_vertices(), kNone), triangle, part;
  std::vector<std::uint64_t> point;
  std::vector<std::int32_t> xyz, level, breached;
  std::vector<std::uint8_t> outlet;
  for (std::size_t t = 0; t < surface.triangle.size(); t += 3) {
    const std::uint32_t* v = &surface.triangle[t];
    if (members.label[v[0]] == kNone && members.label[v[1]] == kNone && members.label[v[2]] == kNone) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      if (number[v[i]] == kNone) {
        number[v[i]] = static_cast<std::uint32_t>(point.size());
        point.push_back(surface.point[v[i]]);
        xyz.insert(xyz.end(), {surface.position[v[i]].x, surface.position[v[i]].y, surface.height[v[i]]});
        level.push_back(surface.level[v[i]]);
        breached.push_back(members.components.breached[v[i]]);
        outlet.push_back(surface.is_outlet[v[i]]);
        part.push_back(members.parts.of[v[i]]);
      }
      triangle.push_back(number[v[i]]);
    }
  }
  out.append("patch_point", point, "vertices of the triangles around these groups: tile << 32 | index");
  out.append("patch_xyz", xyz, "lattice; z as measured");
  out.append("patch_level", level, "z lattice: where the water stands when all pits are full");
  out.append("patch_breached", breached, "z lattice: the lowest level of the breaches through it, or its height");
  out.append("patch_outlet", outlet, "1: water may leave");
  out.append("patch_part", part, "index into part_size; 4294967295: stays where it is");
  out.append("patch_triangle", triangle, "vertices, counter-clockwise");
}

}  // namespace

void find_members(const RunContext& context, std::uint32_t tile) {
  Surface surface = read_surface(store::Reader(context.layout.unit(Phase::pools, tile)));
  const bool lifts = context.options.pits.method == PitMethod::lift;
  ChangeFigures figures;
  const std::vector<std::uint8_t> is_filled =
      lifts ? std::vector<std::uint8_t>() : fill_largest_lakes(context, tile, surface, figures);
  const ChangeableSurface changeable(context, surface);
  const TileMembers members(context, tile, surface, changeable.view(), is_filled);
  std::vector<std::int32_t> height = surface.height;
  figures.groups = static_cast<std::int64_t>(members.components.size());
  if (lifts)
    height = surface.level;
  else
    figures.unguaranteed = static_cast<std::int64_t>(
        solve_components(changeable.view(), members.components, removal_options(context), height));
  if (lifts) {
    // Of vertices on the rim `drain` knows the displacements, and each tile the volume of its own triangles.
    std::vector<std::int64_t> star(surface.num_vertices(), 0);
    for (std::uint32_t v = 0; v < surface.num_vertices(); ++v) {
      if (!surface.is_rim[v])
        figures.add(height[v] - surface.height[v], changeable.star()[v]);
      else
        figures.volume.add(static_cast<double>(changeable.star()[v]) *
                           (static_cast<double>(height[v]) - surface.height[v]));
    }
  } else {
    for (const std::uint32_t v : members.components.member)
      figures.add(std::int64_t{height[v]} - surface.height[v], changeable.star()[v]);
  }
  store::Writer out(context.layout.unit(Phase::members, tile));
  out.set("recipe", context.recipe(Phase::members));
  out.append("point", surface.point, "vertices of the tile's triangles: tile << 32 | index");
  out.append("height", height, "z lattice: final, but for what `settle` moves");
  write_figures(out, figures);
  out.set("cut", static_cast<std::int64_t>(members.components.num_cut));
  write_open(out, surface, members);
  write_edits(out, changeable.view(), surface.triangle, members.components, height, changeable.star());
  out.commit();
}

}  // namespace hydrotin
