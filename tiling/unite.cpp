#include "phases.h"
#include "river_groups.h"

namespace hydrotin {

void unite_groups(const RunContext& context) {
  const RiverNetwork network = read_network(context);
  std::vector<GroupSolution> solutions;
  for (std::uint32_t t = 0; t < context.plan.num_tiles(); ++t)
    for (GroupSolution& s : read_solutions(store::Reader(context.layout.unit(Phase::embed, t))))
      solutions.push_back(std::move(s));
  solutions = unite(GroupSolver(context, network), std::move(solutions));
  for (GroupSolution& s : solutions) s.near.clear();
  store::Writer out(context.layout.unit(Phase::unite, 0));
  out.set("recipe", context.recipe(Phase::unite));
  write_solutions(out, solutions);
  out.commit();
}

}  // namespace hydrotin
