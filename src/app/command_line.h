#pragma once

namespace hydrotin::app {

/// The whole program. Exit codes: 0 ok, 2 usage or config, 3 input, 4 storage, 5 resources, 6 a check failed, 70 our
/// bug.
int run_command_line(int argc, char** argv);

}  // namespace hydrotin::app
