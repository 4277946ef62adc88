#include "command_line.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <new>
#include <string>

#include "commands.h"
#include "hydrotin/error.h"
#include "hydrotin/version.h"

namespace hydrotin::app {
namespace {

constexpr int kOurBug = 70;
constexpr int kUsage = static_cast<int>(ErrorKind::config);

int complain(const std::string& text, int code) {
  std::fflush(stdout);
  std::fprintf(stderr, "hydrotin: %s\n", text.c_str());
  return code;
}

/// What was written to stdout must have arrived: a full disk behind a redirection is an error like any other.
bool output_failed() {
  return std::fflush(stdout) != 0 || std::ferror(stdout) != 0;
}

int finish_output(int code) {
  if (!output_failed()) return code;
  return complain("standard output cannot be written (check the disk's free space)",
                  static_cast<int>(ErrorKind::storage));
}

}  // namespace

int run_command_line(int argc, char** argv) {
  try {
    CLI::App program("hydrotin " + std::string(version()) + ": LiDAR of any size to hydrologically correct TINs",
                     "hydrotin");
    program.set_version_flag("--version", std::string(version()));
    program.require_subcommand(1);
    program.footer(
        "Exit codes: 0 ok, 2 usage or config, 3 input, 4 storage, 5 resources, 6 a check failed, 70 our bug.");
    Action action;
    add_pipeline_commands(program, action);
    add_info_command(program, action);
    add_synth_command(program, action);
    add_triangulate_command(program, action);
    add_orders_command(program, action);
    add_fill_command(program, action);
    add_embed_command(program, action);
    try {
      program.parse(argc, argv);
    } catch (const CLI::ParseError& problem) {
      return program.exit(problem) == 0 ? finish_output(0) : kUsage;
    }
    return finish_output(action());
  } catch (const Error& error) {
    return complain(error.what(), static_cast<int>(error.kind()));
  } catch (const std::bad_alloc&) {
    return complain("out of memory (use smaller tiles, fewer workers, or a machine with more memory)",
                    static_cast<int>(ErrorKind::resource));
  } catch (const std::exception& problem) {
    if (output_failed()) return finish_output(kOurBug);  // printing throws when the disk is full
    return complain(std::string("our bug, please report it: ") + problem.what(), kOurBug);
  } catch (...) {
    return complain("our bug, please report it: an exception of unknown type", kOurBug);
  }
}

}  // namespace hydrotin::app
