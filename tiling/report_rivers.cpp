#include "report_rivers.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numeric>
#include <ostream>

#include "hydrotin/profile_svg.h"
#include "hydrotin/river_statistics.h"
#include "river_input.h"

namespace hydrotin {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kMostRivers = 25;

void add(RiverRow& sum, const RiverRow& row) {
  sum.edges += row.edges;
  sum.length += row.length;
  sum.drop_before += row.drop_before;
  sum.drop_after += row.drop_after;
  sum.wrong_flow_before += row.wrong_flow_before;
  sum.not_valley_before += row.not_valley_before;
  sum.flat_before += row.flat_before;
  sum.leaks_before += row.leaks_before;
  sum.wrong_flow_after += row.wrong_flow_after;
  sum.not_valley_after += row.not_valley_after;
  sum.flat_after += row.flat_after;
  sum.leaks_after += row.leaks_after;
  sum.moved += row.moved;
  sum.total += row.total;
  sum.largest = std::max(sum.largest, row.largest);
}

RiverRow sum_of(const RiverFigures& f) {
  RiverRow all;
  for (const RiverRow& row : f.row) add(all, row);
  return all;
}

// Final heights at rivers, and edges that are not valid, as the files of the tiles say.
void read_files(const RunContext& context, RiverFigures& out) {
  for (std::uint32_t t = 0; t < context.plan.num_tiles(); ++t) {
    const store::Reader in(context.layout.terrain(t));
    const auto edge = in.read<std::uint32_t>("river_edge"), invalid = in.read<std::uint32_t>("invalid_river_edge");
    out.slopes_beyond_limit += static_cast<std::uint64_t>(in.integer("slopes_beyond_limit"));
    const auto source = in.read<std::uint32_t>("river_source");
    const auto steepest = in.read<double>("steepest_way");
    if (edge.empty() && source.empty()) continue;
    const auto height = in.read<std::int32_t>("height"), foreign_height = in.read<std::int32_t>("foreign_height");
    const auto foreign = in.read<std::uint64_t>("foreign_point");
    const auto check = [&](std::uint32_t v) {
      if (v >= height.size() + foreign.size() || foreign.size() != foreign_height.size())
        throw Error(ErrorKind::storage,
                    in.path() + ": a river edge refers to a vertex that is not listed; delete the file and run again");
    };
    const auto id = [&](std::uint32_t v) {
      return v < height.size() ? PointId(t, v).value : foreign[v - height.size()];
    };
    for (const std::uint32_t v : edge) {
      check(v);
      out.height[id(v)] = v < height.size() ? height[v] : foreign_height[v - height.size()];
    }
    const auto take = [&](const std::vector<std::uint32_t>& flat, RiverFigures::Edges& edges) {
      for (std::size_t i = 0; i + 1 < flat.size(); i += 2) {
        check(flat[i]);
        check(flat[i + 1]);
        edges.emplace_back(id(flat[i]), id(flat[i + 1]));
      }
    };
    take(invalid, out.invalid);
    take(in.read<std::uint32_t>("no_valley_edge"), out.no_valley);
    for (std::size_t i = 0; i < source.size() && i < steepest.size(); ++i) {
      check(source[i]);
      double& most = out.steepest.emplace(id(source[i]), steepest[i]).first->second;
      most = std::max(most, steepest[i]);
    }
  }
  for (RiverFigures::Edges* edges : {&out.invalid, &out.no_valley}) {
    std::sort(edges->begin(), edges->end());
    edges->erase(std::unique(edges->begin(), edges->end()), edges->end());
  }
}

// The states of the tables after everything, from what the files say.
void count_final_states(const RunContext& context, RiverFigures& out) {
  const EmbeddedRivers& rivers = *context.rivers;
  const RiverNetwork& network = rivers.network;
  const Lattice& l = context.plan.lattice;
  for (RiverRow& row : out.row)
    row.drop_after = 0, row.wrong_flow_after = row.not_valley_after = row.flat_after = row.leaks_after = 0;
  struct Source {
    std::uint32_t river = 0;
    double steepest = -HUGE_VAL, shortest = HUGE_VAL;
  };
  std::unordered_map<std::uint64_t, Source> sources;
  for (std::size_t e = 0; e < network.river.size(); ++e) {
    const auto [from, to] = network.river[e];
    const std::uint32_t river = out.names.river[e];
    const double drop = final_height(rivers, out, from) * l.scale_z - final_height(rivers, out, to) * l.scale_z;
    RiverRow& row = out.row[river];
    row.drop_after += drop;
    row.wrong_flow_after += drop < 0 ? 1 : 0;
    row.flat_after += drop == 0 ? 1 : 0;
    row.not_valley_after += std::binary_search(out.no_valley.begin(), out.no_valley.end(),
                                               std::pair(network.point[from], network.point[to]))
                                ? 1
                                : 0;
    const double length = std::hypot(network.position[to].x * l.scale_xy - network.position[from].x * l.scale_xy,
                                     network.position[to].y * l.scale_xy - network.position[from].y * l.scale_xy);
    Source& source = sources.emplace(network.point[from], Source{river}).first->second;
    source.river = std::min(source.river, river);
    source.steepest = std::max(source.steepest, drop / length);
    source.shortest = std::min(source.shortest, length);
  }
  for (const auto& [point, source] : sources) {
    const auto way = out.steepest.find(point);
    if (way != out.steepest.end() && is_leak(way->second, source.steepest, source.shortest, 0))
      ++out.row[source.river].leaks_after;
  }
}

}  // namespace

std::int32_t embedded_height(const EmbeddedRivers& rivers, std::uint32_t v) {
  const std::uint64_t point = rivers.network.point[v];
  const auto at = std::lower_bound(rivers.moved.begin(), rivers.moved.end(), point,
                                   [](const auto& entry, std::uint64_t id) { return entry.first < id; });
  return at != rivers.moved.end() && at->first == point ? at->second : rivers.network.height[v];
}

std::int32_t final_height(const EmbeddedRivers& rivers, const RiverFigures& figures, std::uint32_t v) {
  const auto found = figures.height.find(rivers.network.point[v]);
  return found != figures.height.end() ? found->second : embedded_height(rivers, v);
}

namespace {

ordered_json to_json(const std::string& name, const RiverRow& r) {
  return {{"name", name},
          {"edges", r.edges},
          {"length", r.length},
          {"drop_before", r.drop_before},
          {"drop_after", r.drop_after},
          {"wrong_flow_before", r.wrong_flow_before},
          {"not_valley_before", r.not_valley_before},
          {"flat_before", r.flat_before},
          {"leak_vertices_before", r.leaks_before},
          {"wrong_flow_after", r.wrong_flow_after},
          {"not_valley_after", r.not_valley_after},
          {"flat_after", r.flat_after},
          {"leak_vertices_after", r.leaks_after},
          {"vertices_moved", r.moved},
          {"total_change", r.total},
          {"average_change", r.moved > 0 ? r.total / static_cast<double>(r.moved) : 0.0},
          {"max_change", r.largest}};
}

}  // namespace

std::vector<std::uint64_t> laid_rim_minima(const RunContext& context) {
  std::vector<std::pair<std::uint64_t, std::uint8_t>> rim;
  for (std::uint32_t t = 0; t < context.plan.num_tiles(); ++t) {
    const store::Reader in(context.layout.unit(Phase::lay, t));
    const auto point = in.read<std::uint64_t>("rim");
    const auto has_lower = in.read<std::uint8_t>("rim_has_lower");
    for (std::size_t i = 0; i < point.size() && i < has_lower.size(); ++i) {
      if (PointId(point[i]).tile() >= context.plan.num_tiles())
        throw Error(ErrorKind::storage,
                    in.path() + ": a rim vertex is of a tile that does not exist; delete the file and run again");
      rim.emplace_back(point[i], has_lower[i]);
    }
  }
  std::sort(rim.begin(), rim.end());
  std::vector<std::uint64_t> out(context.plan.num_tiles());
  for (std::size_t i = 0; i < rim.size(); ++i) {
    if (i + 1 < rim.size() && rim[i + 1].first == rim[i].first) continue;
    out[PointId(rim[i].first).tile()] += rim[i].second == 0;  // the last entry of a point knows of a lower one, if any
  }
  return out;
}

RiverFigures collect_river_figures(const RunContext& context) {
  const EmbeddedRivers& rivers = *context.rivers;
  RiverFigures out;
  read_files(context, out);
  out.edges = rivers.network.river.size();
  out.chain_edges = rivers.network.chain.size();
  out.lakes = rivers.network.lake.size();
  out.groups = rivers.network.num_groups();
  out.names = name_rivers(context, rivers.network);
  out.row.resize(out.names.name.size());
  for (const auto& edge : out.invalid)
    out.unexpected += std::binary_search(rivers.contradicted.begin(), rivers.contradicted.end(), edge) ? 0 : 1;
  std::unordered_map<std::uint64_t, std::uint8_t> seen;
  for (const auto& edge : rivers.network.river)
    for (const std::uint32_t v : {edge.from, edge.to}) {
      const auto final_height = out.height.find(rivers.network.point[v]);
      if (final_height == out.height.end() || !seen.emplace(rivers.network.point[v], 1).second) continue;
      out.raised += final_height->second != embedded_height(rivers, v) ? 1 : 0;
    }
  for (const GroupSolution& s : rivers.solution) {
    out.solved_together += s.group.size() > 1 ? s.group.size() : 0;
    out.moved += s.moved.size();
    out.rows += s.rows;
    out.columns += s.columns;
    out.broken += s.broken.size();
    out.clamped += s.clamped;
    out.total += s.objective;
    out.bound += s.bound;
    out.optimal = out.optimal && s.optimal;
    for (const MovedVertex& v : s.moved)
      out.largest = std::max(
          out.largest, std::abs(static_cast<double>(std::int64_t{v.after} - v.before)) * context.plan.lattice.scale_z);
    for (const RiverShare& share : s.table) {
      if (share.river >= out.row.size())
        throw Error(ErrorKind::storage,
                    context.layout.unit(Phase::unite, 0) +
                        ": a table is of a river that does not exist; delete the file and run again");
      add(out.row[share.river], share.row);
    }
  }
  count_final_states(context, out);
  out.order.resize(out.row.size());
  std::iota(out.order.begin(), out.order.end(), 0u);
  std::stable_sort(out.order.begin(), out.order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return out.row[a].length > out.row[b].length; });
  return out;
}

void write_river_store(const RunContext& context) {
  const RiverNetwork& network = context.rivers->network;
  std::vector<std::int32_t> xyz;
  for (std::uint32_t v = network.num_vertices() - network.num_new; v < network.num_vertices(); ++v)
    xyz.insert(xyz.end(), {network.position[v].x, network.position[v].y, network.height[v]});
  std::vector<std::uint64_t> edge;
  for (const auto& [from, to] : context.rivers->contradicted) edge.insert(edge.end(), {from, to});
  store::Writer out(context.layout.rivers());
  out.set("recipe", context.recipe(Phase::report));
  out.append("new_xyz", xyz,
             "vertices that rivers added, lattice; entry i is the point (number of tiles) << 32 | i of the files");
  out.append("contradicted_edge", edge, "river edges that no heights make valid: from, to; tile << 32 | index");
  out.commit();
}

void write_to_index(const RunContext& context, const RiverFigures& figures, store::Writer& out) {
  const RiverConstraints& rows = context.options.rivers.constraints;
  out.set("river_edges", static_cast<std::int64_t>(figures.edges));
  out.set("invalid_river_edges", static_cast<std::int64_t>(figures.invalid.size()));
  out.set("river_flow", std::int64_t{rows.flow});
  out.set("river_valley", std::int64_t{rows.valley});
}

std::string rivers_json(const RunContext& context, const RiverFigures& f) {
  const double time_limit = context.options.rivers.time_limit;
  ordered_json steps = ordered_json::object(), table = ordered_json::array(), broken = ordered_json::object();
  for (const auto& [name, number] : context.rivers->network.counts) steps[name] = number;
  for (const std::uint32_t r : f.order) table.push_back(to_json(f.names.name[r], f.row[r]));
  for (const GroupSolution& s : context.rivers->solution)
    for (const BrokenPlace& place : s.broken) {
      auto& count = broken[name_of(place.kind)];
      count = count.is_null() ? 1 : count.get<int>() + 1;
    }
  const ordered_json out = {{"river_edges", f.edges},
                            {"invalid_river_edges", f.invalid.size()},
                            {"outlet_chain_edges", f.chain_edges},
                            {"lakes", f.lakes},
                            {"groups", f.groups},
                            {"groups_solved_together", f.solved_together},
                            {"vertices_added", context.rivers->network.num_new},
                            {"vertices_moved", f.moved},
                            {"river_vertices_moved_by_pits", f.raised},
                            {"slopes_beyond_limit_by_pits", f.slopes_beyond_limit},
                            {"objective", f.total},
                            {"bound", f.bound},
                            {"optimal", f.optimal},
                            {"method", context.options.rivers.method == RiverMethod::dp ? "dp" : "lp"},
                            {"time_limit", time_limit > 0 ? ordered_json(time_limit) : ordered_json()},
                            {"max_change", f.largest},
                            {"rows", f.rows},
                            {"columns", f.columns},
                            {"contradictions", f.broken},
                            {"contradictions_by_constraint", broken},
                            {"clamped_networks", f.clamped},
                            {"all", to_json("all", sum_of(f))},
                            {"rivers", table},
                            {"lines", steps}};
  return out.dump();
}

void write_text(const RunContext& context, const RiverFigures& f, std::ostream& out) {
  char line[256];
  const auto row = [&](const char* label, auto value) {
    out << label
        << std::string(std::max<std::size_t>(std::char_traits<char>::length(label), 27) + 1 -
                           std::char_traits<char>::length(label),
                       ' ')
        << value << '\n';
  };
  const RiverRow all = sum_of(f);
  out << "\nRivers\n";
  row("  river edges", f.edges);
  row("  invalid in the end", f.invalid.size());
  row("  wrong flow before", all.wrong_flow_before);
  row("  not valley before", all.not_valley_before);
  row("  edges of outlet chains", f.chain_edges);
  row("  vertices added", context.rivers->network.num_new);
  row("  vertices moved", f.moved);
  row("  total change", f.total);
  row("  largest change", f.largest);
  row("  slopes beyond the limit by pit removal", f.slopes_beyond_limit);
  row("  optimal", f.optimal ? "yes" : "no");
  if (context.options.rivers.time_limit > 0)
    row("  time limit", std::to_string(context.options.rivers.time_limit) + " s a group" +
                            (f.optimal ? "" : " (met: another machine may come further)"));
  row("  contradictions", f.broken);
  out << "\nLines\n";
  for (const auto& [name, number] : context.rivers->network.counts) {
    std::string words = "  " + name;
    std::replace(words.begin(), words.end(), '_', ' ');
    row(words.c_str(), number);
  }
  std::snprintf(line, sizeof line, "\n%-28s %7s %11s %15s %15s %11s %11s %8s %11s %9s\n", "river", "edges", "length",
                "wrong flow", "not valley", "flat", "leaks", "moved", "change", "average");
  out << line;
  for (std::size_t i = 0; i < f.order.size(); ++i) {
    if (i == kMostRivers) {
      out << "and " << f.order.size() - i << " more: see report.json\n";
      break;
    }
    const RiverRow& r = f.row[f.order[i]];
    const auto pair = [](std::uint64_t a, std::uint64_t b) { return std::to_string(a) + " > " + std::to_string(b); };
    std::snprintf(line, sizeof line, "%-28.28s %7llu %11.0f %15s %15s %11s %11s %8llu %11.2f %9.3f\n",
                  f.names.name[f.order[i]].c_str(), static_cast<unsigned long long>(r.edges), r.length,
                  pair(r.wrong_flow_before, r.wrong_flow_after).c_str(),
                  pair(r.not_valley_before, r.not_valley_after).c_str(), pair(r.flat_before, r.flat_after).c_str(),
                  pair(r.leaks_before, r.leaks_after).c_str(), static_cast<unsigned long long>(r.moved), r.total,
                  r.moved > 0 ? r.total / static_cast<double>(r.moved) : 0.0);
    out << line;
  }
}

std::vector<std::string> write_river_profiles(const RunContext& context, const RiverFigures& f) {
  constexpr std::size_t kMostProfiles = 40;
  const EmbeddedRivers& rivers = *context.rivers;
  const RiverNetwork& network = rivers.network;
  const Lattice& l = context.plan.lattice;
  // Rivers by length, as the stems are asked for.
  std::vector<std::uint32_t> place(f.order.size()), river;
  for (std::uint32_t i = 0; i < f.order.size(); ++i) place[f.order[i]] = i;
  for (const std::uint32_t r : f.names.river) river.push_back(place[r]);
  std::vector<std::array<double, 2>> position;
  std::vector<double> before, after;
  for (std::uint32_t v = 0; v < network.num_vertices(); ++v) {
    position.push_back({network.position[v].x * l.scale_xy, network.position[v].y * l.scale_xy});
    before.push_back(l.z(network.height[v]));
    after.push_back(l.z(final_height(rivers, f, v)));
  }
  const MainStems stems =
      main_stems({position, before, {}}, network.river, river, static_cast<std::uint32_t>(f.order.size()));
  std::vector<std::string> out;
  for (std::size_t g = 0; g < f.order.size() && g < kMostProfiles; ++g) {
    std::vector<double> along, then, now;
    for (std::size_t i = stems.begin[g]; i < stems.begin[g + 1]; ++i) {
      const std::uint32_t v = stems.vertex[i], u = i > stems.begin[g] ? stems.vertex[i - 1] : v;
      along.push_back((along.empty() ? 0 : along.back()) +
                      std::hypot(position[v][0] - position[u][0], position[v][1] - position[u][1]));
      then.push_back(before[v]);
      now.push_back(after[v]);
    }
    if (along.empty()) continue;
    const std::string& name = f.names.name[f.order[g]];
    out.push_back(context.layout.profiles() + "/" + profile_file_name(g, name));
    write_profile_svg(out.back(), name, along, then, now);
  }
  return out;
}

}  // namespace hydrotin
