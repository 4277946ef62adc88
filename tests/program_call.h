#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <string>

#include "temporary_folder.h"

/// The program as users call it.

namespace hydrotin::testing {

struct Outcome {
  int code = -1;
  std::string out, err;
};

/// Calls the program as a shell would.
inline Outcome call(const TemporaryFolder& folder, const std::string& arguments) {
  const auto out = folder / "stdout", err = folder / "stderr";
  const std::string command = "cd '" + folder.path().string() + "' && '" HYDROTIN_PROGRAM "' " + arguments + " >'" +
                              out.string() + "' 2>'" + err.string() + "' </dev/null";
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read_text(out), read_text(err)};
}

}  // namespace hydrotin::testing
