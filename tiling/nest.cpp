#include <algorithm>

#include "hydrotin/lifting.h"
#include "hydrotin/nested_pools.h"
#include "nested_store.h"
#include "part.h"
#include "phases.h"
#include "reduced_store.h"

namespace hydrotin {

void nest_pools(const RunContext& context, std::uint32_t tile) {
  const Part part = load_part(context, tile);
  const std::vector<std::uint8_t> is_outlet = outlet_flags(context, part);
  std::vector<std::uint64_t> rim;
  for (const std::uint32_t v : part.rim()) rim.push_back(part.point[v]);
  std::int64_t lowest_outlet = kNoLevel;
  for (std::uint32_t v = 0; v < part.num_vertices(); ++v)
    if (is_outlet[v]) lowest_outlet = std::min<std::int64_t>(lowest_outlet, part.height[v]);
  store::Writer out(context.layout.unit(Phase::nest, tile));
  out.set("recipe", context.recipe(Phase::nest));
  out.set("lowest_outlet", lowest_outlet);
  out.append("rim", rim, "vertices that other parts have too: tile << 32 | index, ascending");
  write_pools(out,
              reduce_pools(part.graph, part.triangle, part.height, part.position, part.point, part.is_rim, is_outlet));
  write_plateaus(out, "",
                 summarize_plateaus(part.graph, part.height, part.position, is_outlet, part.point, part.is_rim));
  out.commit();
}

void weigh_pools_of(const RunContext& context, std::uint32_t tile) {
  const store::Reader ranking(context.layout.unit(Phase::rank, 0));
  const std::vector<PoolQuery> query = read_queries(ranking, tile);
  std::vector<PoolContent> answer;
  if (!query.empty()) {
    const Part part = load_part(context, tile);
    const std::vector<std::uint32_t> rim = part.rim();
    const auto begin = ranking.read_range<std::uint64_t>("count_begin", tile, 2);
    const auto counted = ranking.read_range<std::uint8_t>("rim_counts", begin[0], begin[1] - begin[0]);
    const bool fits = counted.size() == rim.size() && std::all_of(query.begin(), query.end(), [&](const PoolQuery& q) {
                        return part.find(PointId(q.vertex)).has_value();
                      });
    if (!fits)
      throw Error(ErrorKind::storage, ranking.path() + ": its questions do not fit tile " + std::to_string(tile) +
                                          "; delete the scratch folder's nest and rank and run again");
    std::vector<std::uint8_t> counts(part.num_vertices(), 1);
    for (std::size_t i = 0; i < rim.size(); ++i) counts[rim[i]] = counted[i];
    answer = weigh_pools(part.graph, part.triangle, part.height, part.position, part.point, counts, query);
  }
  store::Writer out(context.layout.unit(Phase::weigh, tile));
  out.set("recipe", context.recipe(Phase::weigh));
  write_answers(out, query, answer);
  out.commit();
}

}  // namespace hydrotin
