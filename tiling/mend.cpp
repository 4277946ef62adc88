#include "mend.h"

#include <algorithm>
#include <numeric>
#include <unordered_map>

#include "seam_polygon.h"
#include "whole_array.h"

namespace hydrotin {
namespace {

using Corners = std::array<std::uint32_t, 3>;

[[noreturn]] void contradicts(const std::string& path) {
  throw Error(ErrorKind::storage, path + ": its arrays contradict each other; delete the file and run again");
}

// Points that any unit lists under a name, ascending.
std::vector<std::uint64_t> listed_points(const RunContext& context, const char* name) {
  std::vector<std::vector<std::uint64_t>> found(2 * std::size_t{context.plan.num_tiles()});
  for_all(context, found.size(), [&](std::uint64_t i) {
    const Phase phase = i % 2 == 0 ? Phase::triangulate : Phase::seam;
    found[i] = store::Reader(context.layout.unit(phase, i / 2)).read<std::uint64_t>(name);
  });
  std::vector<std::uint64_t> out;
  for (const auto& some : found) out.insert(out.end(), some.begin(), some.end());
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

bool contains(const std::vector<std::uint64_t>& sorted, std::uint64_t value) {
  return std::binary_search(sorted.begin(), sorted.end(), value);
}

std::vector<Corners> canonical(std::vector<Corners> triangles) {
  for (Corners& t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

// Mends one tile's seam polygons.
class Mender {
 public:
  Mender(const RunContext& context, std::uint32_t tile, const std::vector<std::uint64_t>& unserved)
      : context_(context), tile_(tile), unserved_(unserved), solver_(polygon_options(context)) {}

  [[nodiscard]] Mending mend() {
    const store::Reader in(context_.layout.unit(Phase::seam, tile_));
    const auto point = in.read<std::uint64_t>("point");
    std::vector<std::uint8_t> is_unserved(point.size());
    for (std::size_t i = 0; i < point.size(); ++i) is_unserved[i] = contains(unserved_, point[i]);
    if (std::find(is_unserved.begin(), is_unserved.end(), std::uint8_t{1}) == is_unserved.end()) return {};
    for (std::size_t i = 0; i < point.size(); ++i) number_.emplace(point[i], static_cast<std::uint32_t>(i));
    triangle_ = in.read<std::uint32_t>("triangle");
    begin_ = in.read<std::uint64_t>("triangle_begin");
    SeamList seams(context_, tile_);
    if (begin_.size() != std::size_t{seams.size()} + 1 || 3 * begin_.back() != triangle_.size() ||
        !std::is_sorted(begin_.begin(), begin_.end()) ||
        std::any_of(triangle_.begin(), triangle_.end(), [&](std::uint32_t v) { return v >= point.size(); }))
      contradicts(in.path());
    for (std::uint32_t f = 0; f < seams.size(); ++f)
      if (std::any_of(triangle_.begin() + static_cast<std::ptrdiff_t>(3 * begin_[f]),
                      triangle_.begin() + static_cast<std::ptrdiff_t>(3 * begin_[f + 1]),
                      [&](std::uint32_t v) { return is_unserved[v] != 0; }))
        solve_again(seams, f);
    return std::move(out_);
  }

 private:
  void solve_again(SeamList& seams, std::uint32_t f) {
    seams.read(f, polygon_);
    std::uint32_t served = 0;  // by the first answer
    for (std::size_t v = 0; v < polygon_.vertices().size(); ++v)
      served += polygon_.wants_lower()[v] == 2 && !contains(unserved_, polygon_.vertices()[v].point.value);
    if (!polygon_.adopt(unserved_)) return;
    const PolygonProblem problem = polygon_.problem();
    answer_.clear();
    const PolygonResult result = solver_.solve(problem, answer_);
    if (result.served >= served) keep(f, result);
  }

  void keep(std::uint32_t f, const PolygonResult& result) {
    for (Corners& t : answer_)
      for (std::uint32_t& v : t) v = number_.at(polygon_.vertices()[v].point.value);
    std::vector<Corners> before;
    for (std::uint64_t t = begin_[f]; t < begin_[f + 1]; ++t)
      before.push_back({triangle_[3 * t], triangle_[3 * t + 1], triangle_[3 * t + 2]});
    out_.changed += canonical(answer_) != canonical(before);
    out_.polygon.push_back(f);
    out_.result.add(result);
    for (std::size_t i = 0; i < answer_.size(); ++i) {
      out_.position.push_back(begin_[f] + i);
      out_.triangle.insert(out_.triangle.end(), answer_[i].begin(), answer_[i].end());
    }
  }

  const RunContext& context_;
  std::uint32_t tile_;
  const std::vector<std::uint64_t>& unserved_;
  PolygonSolver solver_;
  SeamPolygon polygon_;
  std::unordered_map<std::uint64_t, std::uint32_t> number_;  // of points in the seam file
  std::vector<std::uint32_t> triangle_;
  std::vector<std::uint64_t> begin_;
  std::vector<Corners> answer_;
  Mending out_;
};

// The slice of tile t in arrays of all tiles.
std::array<std::uint64_t, 2> slice(const store::Reader& in, const std::string& begin, std::uint32_t tile,
                                   std::uint64_t total) {
  const auto ends = in.read_range<std::uint64_t>(begin, tile, 2);
  if (ends[0] > ends[1] || ends[1] > total) contradicts(in.path());
  return {ends[0], ends[1] - ends[0]};
}

// Under a limit on errors, vertices of each tile that no polygon has an admissible edge down for.
std::vector<std::uint64_t> hopeless_points(const RunContext& context) {
  std::vector<std::uint64_t> out(context.plan.num_tiles());
  if (!context.options.triangulation.max_error_m) return out;
  const std::vector<std::uint64_t> servable = listed_points(context, "servable");
  for_all(context, out.size(), [&](std::uint64_t t) {
    const store::Reader in(context.layout.unit(Phase::triangulate, t));
    for (const std::uint64_t point : in.read<std::uint64_t>("doubtful")) out[t] += !contains(servable, point);
  });
  return out;
}

}  // namespace

void write_mendings(const RunContext& context, const std::vector<Mending>& tiles,
                    const std::vector<std::uint64_t>& hopeless) {
  Mending all;
  std::vector<std::uint64_t> polygon_begin{0}, triangle_begin{0};
  for (const Mending& tile : tiles) {
    all.polygon.insert(all.polygon.end(), tile.polygon.begin(), tile.polygon.end());
    all.result.append(tile.result);
    all.position.insert(all.position.end(), tile.position.begin(), tile.position.end());
    all.triangle.insert(all.triangle.end(), tile.triangle.begin(), tile.triangle.end());
    all.changed += tile.changed;
    polygon_begin.push_back(all.polygon.size());
    triangle_begin.push_back(all.position.size());
  }
  store::Writer out(context.layout.unit(Phase::mend, 0));
  out.set("recipe", context.recipe(Phase::mend));
  out.append("polygon_begin", polygon_begin, "first entry of each tile in `polygon`");
  out.append("polygon", all.polygon, "polygons of the tile's seam file with new answers");
  all.result.write(out);
  out.append("triangle_begin", triangle_begin, "first entry of each tile in `position`");
  out.append("position", all.position, "triangle of the tile's seam file to be replaced");
  out.append("triangle", all.triangle, "by this: numbers of points of that file");
  out.append("hopeless", hopeless, "points of each tile that no polygon can save under the limit on errors");
  out.set("changed", static_cast<std::int64_t>(all.changed));
  out.commit();
}

Mending read_mended_triangles(const RunContext& context, std::uint32_t tile) {
  const store::Reader in(context.layout.unit(Phase::mend, 0));
  const std::uint64_t total = in.size("position");
  if (in.size("triangle") != 3 * total) contradicts(in.path());
  const auto [first, count] = slice(in, "triangle_begin", tile, total);
  Mending out;
  if (count == 0) return out;
  out.position = in.read_range<std::uint64_t>("position", first, count);
  out.triangle = in.read_range<std::uint32_t>("triangle", 3 * first, 3 * count);
  return out;
}

MendedResults read_mended_results(const RunContext& context) {
  const store::Reader in(context.layout.unit(Phase::mend, 0));
  MendedResults out{in.read<std::uint64_t>("polygon_begin"), in.read<std::uint32_t>("polygon"), ResultTable(in),
                    in.read<std::uint64_t>("hopeless")};
  if (out.begin.size() != std::size_t{context.plan.num_tiles()} + 1 || out.hopeless.size() + 1 != out.begin.size() ||
      out.begin.back() != out.polygon.size() || out.result.size() != out.polygon.size() ||
      !std::is_sorted(out.begin.begin(), out.begin.end()))
    contradicts(in.path());
  return out;
}

PolygonFigures MendedResults::figures(const RunContext& context, std::uint32_t tile) const {
  const store::Reader in(context.layout.unit(Phase::seam, tile));
  PolygonFigures out = read_figures(in);
  const ResultTable first(in);
  if (first.size() != out.polygons) contradicts(in.path());
  std::uint64_t at = begin[tile];
  for (std::uint32_t f = 0; f < first.size(); ++f) {
    const bool is_mended = at < begin[tile + 1] && polygon[at] == f;
    out.add(is_mended ? result[at++] : first[f]);
  }
  if (at != begin[tile + 1]) contradicts(context.layout.unit(Phase::mend, 0));
  return out;
}

void mend_minima(const RunContext& context) {
  std::vector<Mending> tiles(context.plan.num_tiles());
  const std::vector<std::uint64_t> unserved = listed_points(context, "unserved");
  if (!unserved.empty())
    for_all(context, tiles.size(),
            [&](std::uint64_t t) { tiles[t] = Mender(context, static_cast<std::uint32_t>(t), unserved).mend(); });
  write_mendings(context, tiles, hopeless_points(context));
}

}  // namespace hydrotin
