#include "nested_store.h"

#include <bit>
#include <span>
#include <string>

namespace hydrotin {
namespace {

using Table = std::vector<std::int64_t>;

std::int64_t bits(std::uint64_t value) {
  return static_cast<std::int64_t>(value);
}

void put(Table& row, const RankedVertex& v) {
  row.insert(row.end(), {v.height, v.position.x, v.position.y, bits(v.vertex)});
}

void put(Table& row, const PoolContent& c) {
  row.insert(row.end(),
             {c.num_vertices, c.num_below, c.sum_of_heights, c.doubled_area, c.sixfold_high, bits(c.sixfold_low)});
}

/// Takes values off a row.
class Row {
 public:
  explicit Row(const std::int64_t* at) : at_(at) {}
  std::int64_t next() { return *at_++; }
  std::uint64_t next_u64() { return static_cast<std::uint64_t>(next()); }
  std::uint32_t next_u32() { return static_cast<std::uint32_t>(next()); }
  std::int32_t next_i32() { return static_cast<std::int32_t>(next()); }
  LatticePoint point() {
    const std::int32_t x = next_i32(), y = next_i32();
    return {x, y};
  }
  RankedVertex vertex() {
    RankedVertex v;
    v.height = next_i32();
    v.position = point();
    v.vertex = next_u64();
    return v;
  }
  PoolContent content() {
    PoolContent c;
    c.num_vertices = next();
    c.num_below = next();
    c.sum_of_heights = next();
    c.doubled_area = next();
    c.sixfold_high = next();
    c.sixfold_low = next_u64();
    return c;
  }

 private:
  const std::int64_t* at_;
};

[[noreturn]] void contradicts(const store::Reader& in, const std::string& name) {
  throw Error(ErrorKind::storage,
              in.path() + ": the table '" + name + "' contradicts the others; delete the file and run again");
}

/// Calls use(row) for each row of a table.
template <class Use>
void for_rows(const store::Reader& in, const std::string& name, std::size_t columns, Use use) {
  const auto table = in.read<std::int64_t>(name);
  if (table.size() % columns != 0) contradicts(in, name);
  for (std::size_t i = 0; i < table.size(); i += columns) use(Row(table.data() + i));
}

}  // namespace

void write_pools(store::Writer& out, const ReducedPools& pools) {
  Table pit, node, content;
  for (const DecidedPit& p : pools.pit) {
    const PitBasin& b = p.basin;
    pit.insert(pit.end(), {b.pit.representative.x, b.pit.representative.y, bits(b.pit.vertex), b.pit.height,
                           b.spill_position.x, b.spill_position.y, b.spill_level, bits(b.num_vertices), b.displacement,
                           b.doubled_area, bits(std::bit_cast<std::uint64_t>(b.volume)), b.price, bits(p.parent)});
  }
  for (const PoolNode& n : pools.node) {
    put(node, n.at);
    node.insert(node.end(), {n.parent, n.content, static_cast<std::int64_t>(n.kind)});
  }
  for (std::size_t i = 0; i < pools.content.size(); ++i) {
    put(content, pools.content[i]);
    content.insert(content.end(), {pools.spent[i], pools.leader_price[i], pools.bottom_price[i]});
    put(content, pools.leader[i]);
  }
  out.append("pool_pit", pit,
             "pits decided in this part: x, y, vertex, height; spill: x, y, level; basin: vertices, displacement, "
             "doubled area, volume (bits of a double), price; vertex of the parent");
  out.append("pool_node", node, "height, x, y, vertex; parent; row of pool_content; kind");
  out.append("pool_content", content,
             "vertices, those below the level, sum of heights, doubled area, sixfold volume (2); spent, price of the "
             "leader and of the bottom; leader: height, x, y, vertex");
}

ReducedPools read_pools(const store::Reader& in) {
  ReducedPools out;
  for_rows(in, "pool_pit", 13, [&](Row row) {
    DecidedPit& p = out.pit.emplace_back();
    p.basin.pit.representative = row.point();
    p.basin.pit.vertex = row.next_u64();
    p.basin.pit.height = row.next_i32();
    p.basin.spill_position = row.point();
    p.basin.spill_vertex = 0;
    p.basin.spill_level = row.next_i32();
    p.basin.num_vertices = row.next_u64();
    p.basin.displacement = row.next();
    p.basin.doubled_area = row.next();
    p.basin.volume = std::bit_cast<double>(row.next_u64());
    p.basin.price = row.next();
    p.parent = row.next_u64();
  });
  for_rows(in, "pool_content", 13, [&](Row row) {
    out.content.push_back(row.content());
    out.spent.push_back(row.next());
    out.leader_price.push_back(row.next());
    out.bottom_price.push_back(row.next());
    out.leader.push_back(row.vertex());
  });
  for_rows(in, "pool_node", 7, [&](Row row) {
    PoolNode& n = out.node.emplace_back();
    n.at = row.vertex();
    n.parent = row.next_u32();
    n.content = row.next_u32();
    const std::int64_t kind = row.next();
    if (kind < 0 || kind > static_cast<std::int64_t>(PoolNode::Kind::outlet)) contradicts(in, "pool_node");
    n.kind = static_cast<PoolNode::Kind>(kind);
    if (n.kind == PoolNode::Kind::leaf && n.content >= out.content.size()) contradicts(in, "pool_node");
  });
  for (std::size_t i = 0; i < out.node.size(); ++i)
    if (out.node[i].parent != kNoPit && (out.node[i].parent >= out.node.size() || out.node[i].parent <= i))
      contradicts(in, "pool_node");
  return out;
}

void write_ranking(store::Writer& out, const RankedPools& ranked) {
  Table content, pit, step, pool, bottom;
  for (const PoolContent& c : ranked.content) put(content, c);
  for (const EndedPit& p : ranked.pit) {
    put(pit, p.bottom);
    put(pit, p.spill);
    pit.insert(pit.end(), {bits(p.parent), p.content});
  }
  for (const PriceStep& s : ranked.step)
    step.insert(step.end(), {s.pool, s.other, s.level, static_cast<std::int64_t>(s.kind)});
  for (std::size_t i = 0; i < ranked.pool_leader.size(); ++i) {
    put(pool, ranked.pool_leader[i]);
    pool.insert(pool.end(), {ranked.pool_price[i], ranked.pool_spent[i]});
  }
  for (const auto& [vertex, price] : ranked.bottom_price) bottom.insert(bottom.end(), {bits(vertex), price});
  out.append("content", content, "vertices, those below the level, sum of heights, doubled area, sixfold volume (2)");
  out.append("pit", pit, "bottom: height, x, y, vertex; spill: the same; parent; row of content");
  out.append("step", step, "prices: pool, other pool or row of content, level, kind");
  out.append("pool", pool, "leader: height, x, y, vertex; its price; spent");
  out.append("bottom_price", bottom, "vertex, price");
  std::vector<std::uint64_t> begin{0};
  for (const auto& queries : ranked.query) {
    Table table;
    for (const PoolQuery& q : queries) {
      table.push_back(bits(q.vertex));
      put(table, q.moment);
      table.push_back(q.answer_to);
    }
    begin.push_back(begin.back() + queries.size());
    out.append("query", table, "vertex; moment: height, x, y, vertex; row of content");
  }
  out.append("query_begin", begin, "offsets of the tiles into the rows of query, one more than tiles");
}

RankedPools read_ranking(const store::Reader& in) {
  RankedPools out;
  for_rows(in, "content", 6, [&](Row row) { out.content.push_back(row.content()); });
  for_rows(in, "pit", 10, [&](Row row) {
    EndedPit& p = out.pit.emplace_back();
    p.bottom = row.vertex();
    p.spill = row.vertex();
    p.parent = row.next_u64();
    p.content = row.next_u32();
    if (p.content >= out.content.size()) contradicts(in, "pit");
  });
  for_rows(in, "pool", 6, [&](Row row) {
    out.pool_leader.push_back(row.vertex());
    out.pool_price.push_back(row.next());
    out.pool_spent.push_back(row.next());
  });
  for_rows(in, "step", 4, [&](Row row) {
    PriceStep& s = out.step.emplace_back();
    s.pool = row.next_u32();
    s.other = row.next_u32();
    s.level = row.next_i32();
    const std::int64_t kind = row.next();
    if (kind < 0 || kind > static_cast<std::int64_t>(PriceStep::Kind::absorb)) contradicts(in, "step");
    s.kind = static_cast<PriceStep::Kind>(kind);
    const std::size_t others = s.kind == PriceStep::Kind::raise ? out.content.size() : out.pool_leader.size();
    if (s.pool >= out.pool_leader.size() || (s.kind != PriceStep::Kind::end_without_pit && s.other >= others))
      contradicts(in, "step");
  });
  for_rows(in, "bottom_price", 2, [&](Row row) {
    const std::uint64_t vertex = row.next_u64();
    out.bottom_price.emplace_back(vertex, row.next());
  });
  return out;
}

std::vector<PoolQuery> read_queries(const store::Reader& ranking, std::uint32_t tile) {
  const auto begin = ranking.read_range<std::uint64_t>("query_begin", tile, 2);
  if (begin[0] > begin[1] || 6 * begin[1] > ranking.size("query")) contradicts(ranking, "query_begin");
  const auto table = ranking.read_range<std::int64_t>("query", 6 * begin[0], 6 * (begin[1] - begin[0]));
  std::vector<PoolQuery> out;
  for (std::size_t i = 0; i < table.size(); i += 6) {
    Row row(table.data() + i);
    PoolQuery& q = out.emplace_back();
    q.vertex = row.next_u64();
    q.moment = row.vertex();
    q.answer_to = row.next_u32();
  }
  return out;
}

void write_answers(store::Writer& out, const std::vector<PoolQuery>& query, const std::vector<PoolContent>& answer) {
  Table table;
  for (std::size_t i = 0; i < query.size(); ++i) {
    table.push_back(query[i].answer_to);
    put(table, answer[i]);
  }
  out.append("answer", table,
             "row of content; vertices, those below the level, sum of heights, doubled area, sixfold volume (2)");
}

void add_answers(const store::Reader& in, RankedPools& ranked) {
  for_rows(in, "answer", 7, [&](Row row) {
    const std::uint64_t to = row.next_u64();
    if (to >= ranked.content.size()) contradicts(in, "answer");
    ranked.content[to].add(row.content());
  });
}

}  // namespace hydrotin
