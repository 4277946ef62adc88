#include "part_value.h"

#include <algorithm>

#include "hydrotin/measure.h"

namespace hydrotin {
namespace {

ExactSum sum_over(const Part& part, Objective objective) {
  ExactSum sum;
  const auto at = [&](std::size_t corner) { return part.position[part.triangle[corner]]; };
  for (std::size_t t = 0; t < part.triangle.size(); t += 3) {
    const LatticePoint a = at(t), b = at(t + 1), c = at(t + 2);
    if (objective == Objective::min_weight) {
      sum.add(edge_length(a, b));
      sum.add(edge_length(b, c));
      sum.add(edge_length(c, a));
    } else {
      sum.add(inradius(a, b, c));
    }
  }
  // The edges of the hull lie at one triangle only.
  if (objective == Objective::min_weight)
    for (const DirectedEdge& e : part.hull_edge) sum.add(edge_length(part.position[e.origin], part.position[e.target]));
  return sum;
}

double worst_score(const Part& part, Objective objective) {
  double worst = -std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < part.triangle.size(); t += 3)
    worst = std::max(worst, triangle_score(objective, part.position[part.triangle[t]],
                                           part.position[part.triangle[t + 1]], part.position[part.triangle[t + 2]]));
  return worst;
}

}  // namespace

void ObjectiveValue::add(const ObjectiveValue& other) {
  sum.add(other.sum);
  score = std::max(score, other.score);
}

std::vector<ObjectiveValue> values_of(const Part& part, const Objectives& objectives) {
  std::vector<ObjectiveValue> out(objectives.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (needs_reference(objectives[i])) continue;
    const ObjectiveKind kind = kind_of(objectives[i]);
    if (kind == ObjectiveKind::sum) out[i].sum = sum_over(part, objectives[i]);
    if (kind == ObjectiveKind::bottleneck && objectives[i] != Objective::min_max_order)
      out[i].score = worst_score(part, objectives[i]);
  }
  return out;
}

double total(Objective objective, const ObjectiveValue& value) {
  if (kind_of(objective) == ObjectiveKind::sum)
    return objective == Objective::min_weight ? value.sum.value() / 2 : value.sum.value();
  const bool is_over_nothing = value.score == -std::numeric_limits<double>::infinity();
  return is_over_nothing ? 0 : measure_of_score(objective, value.score);
}

void write_values(store::Writer& out, const std::vector<ObjectiveValue>& values) {
  std::vector<std::int64_t> high;
  std::vector<std::uint64_t> low;
  std::vector<double> score;
  for (const ObjectiveValue& value : values) {
    high.push_back(value.sum.high());
    low.push_back(value.sum.low());
    score.push_back(value.score);
  }
  out.append("value_high", high, "sum of each objective over these triangles: (high * 2^64 + low) / 2^40");
  out.append("value_low", low);
  out.append("value_score", score, "score of the worst triangle for each objective");
}

std::vector<ObjectiveValue> read_values(const store::Reader& in, std::size_t num_objectives) {
  const auto high = in.read<std::int64_t>("value_high");
  const auto low = in.read<std::uint64_t>("value_low");
  const auto score = in.read<double>("value_score");
  if (high.size() != num_objectives || low.size() != num_objectives || score.size() != num_objectives)
    throw Error(ErrorKind::storage,
                in.path() + ": its values are not those of the objectives; delete the file and run again");
  std::vector<ObjectiveValue> out(num_objectives);
  for (std::size_t i = 0; i < num_objectives; ++i) {
    out[i].sum = ExactSum(high[i], low[i]);
    out[i].score = score[i];
  }
  return out;
}

}  // namespace hydrotin
