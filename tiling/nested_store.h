#pragma once

#include <cstdint>
#include <vector>

#include "hydrotin/nested_pools.h"
#include "store.h"

/// Reduced pools, their ranking and the answers of the parts in files: tables of i64, row by row. Unsigned values are
/// kept bit by bit.
///
/// Errors  Error(storage) for tables that are cut or refer to rows that do not exist.

namespace hydrotin {

void write_pools(store::Writer& out, const ReducedPools& pools);
[[nodiscard]] ReducedPools read_pools(const store::Reader& in);

void write_ranking(store::Writer& out, const RankedPools& ranked);
/// Without the queries.
[[nodiscard]] RankedPools read_ranking(const store::Reader& in);
[[nodiscard]] std::vector<PoolQuery> read_queries(const store::Reader& ranking, std::uint32_t tile);

void write_answers(store::Writer& out, const std::vector<PoolQuery>& query, const std::vector<PoolContent>& answer);
/// Adds a part's answers to the contents.
void add_answers(const store::Reader& in, RankedPools& ranked);

}  // namespace hydrotin
