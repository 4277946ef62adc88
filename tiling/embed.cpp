#include "phases.h"
#include "river_groups.h"

namespace hydrotin {

void embed_groups(const RunContext& context, std::uint32_t tile) {
  const RiverNetwork network = read_network(context);
  std::vector<GroupSolution> solutions;
  const GroupSolver solver(context, network);
  for (std::uint32_t g = 0; g < network.num_groups(); ++g)
    if (network.group_tile[g] == tile) solutions.push_back(solver.solve({g}));
  store::Writer out(context.layout.unit(Phase::embed, tile));
  out.set("recipe", context.recipe(Phase::embed));
  write_solutions(out, solutions);
  out.commit();
}

}  // namespace hydrotin
