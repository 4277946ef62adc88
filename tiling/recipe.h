#pragma once

#include <cstdint>
#include <string>

#include "hydrotin/options.h"
#include "hydrotin/phase.h"

/// What a unit's output was made from: a hash that every file of the store carries. An output whose recipe is not the
/// one asked for counts as absent.

namespace hydrotin {

/// Collects what matters and hashes it (FNV-1a, 64 bits).
class RecipeHash {
 public:
  RecipeHash& add(const std::string& text);
  RecipeHash& add(std::int64_t value) { return add(std::to_string(value)); }
  RecipeHash& add(double value);
  [[nodiscard]] std::string hex() const;

 private:
  std::uint64_t state_ = 0xcbf29ce484222325ULL;
};

/// Recipe of a phase's outputs: that of the plan and the options which the phase and those before it depend on.
[[nodiscard]] std::string recipe(const std::string& plan_recipe, const PipelineOptions& options, Phase phase);

}  // namespace hydrotin
