#pragma once

#include <functional>

namespace CLI {
class App;
}

/// The subcommands: each adds itself to the command line and, when chosen, sets what is to be done. Numbers go to
/// stdout, talk to stderr. An action returns the exit code.

namespace hydrotin::app {

using Action = std::function<int()>;

void add_pipeline_commands(CLI::App& program, Action& action);    ///< run, plan, phase, status, check, report
void add_info_command(CLI::App& program, Action& action);         ///< info
void add_synth_command(CLI::App& program, Action& action);        ///< synth
void add_fill_command(CLI::App& program, Action& action);         ///< fill
void add_embed_command(CLI::App& program, Action& action);        ///< embed
void add_triangulate_command(CLI::App& program, Action& action);  ///< triangulate
void add_orders_command(CLI::App& program, Action& action);       ///< orders

}  // namespace hydrotin::app
