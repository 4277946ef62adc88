#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "hydrotin/exact_sum.h"
#include "part.h"
#include "store.h"

/// What the final triangles of a part are worth under each objective of the run, so that parts can be added up.

namespace hydrotin {

struct ObjectiveValue {
  ExactSum sum;                                             ///< sums: over triangles; min_weight counts an inner edge
                                                            ///< twice
  double score = -std::numeric_limits<double>::infinity();  ///< bottlenecks of shape: of the worst triangle

  void add(const ObjectiveValue& other);
  friend bool operator==(const ObjectiveValue&, const ObjectiveValue&) = default;
};

/// One value per objective; of local-minima, min-max-order and errors, which triangles do not tell, nothing.
/// Complexity: O(objectives * triangles).
[[nodiscard]] std::vector<ObjectiveValue> values_of(const Part& part, const Objectives& objectives);

/// The value as `evaluate` has it, in lattice units. Precondition: a sum or a bottleneck of shape.
[[nodiscard]] double total(Objective objective, const ObjectiveValue& value);

void write_values(store::Writer& out, const std::vector<ObjectiveValue>& values);
/// Fails: Error(storage) unless there is one for each of `num_objectives`.
[[nodiscard]] std::vector<ObjectiveValue> read_values(const store::Reader& in, std::size_t num_objectives);

}  // namespace hydrotin
