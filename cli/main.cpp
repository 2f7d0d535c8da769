// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>

#include "commands.hpp"
#include "large_pages.hpp"
#include "swivel/core/input_error.hpp"

namespace swivel::cli {

namespace {

/// A closed standard stream would lend its number to the next file that is opened, and what is printed would end up in it.
/// Opened the wrong way round, so that printing fails as it should.
void occupy_standard_streams() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(descriptor, F_GETFD) < 0) static_cast<void>(open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY));
}

int run(int argc, char** argv) {
  CLI::App app("Swivel plans joint trajectories along tool paths, for arms with a degree of freedom to spare.", "swivel");
  app.set_version_flag("--version", SWIVEL_VERSION);
  app.require_subcommand(1);
  int exit_code = kOk;
  add_plan(app, exit_code);
  add_campaign(app, exit_code);
  add_place(app, exit_code);
  add_merge(app, exit_code);
  add_check(app, exit_code);
  add_time(app, exit_code);
  add_info(app, exit_code);
  add_fit(app, exit_code);
  add_schema(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) throw InputError(error.what());
    exit_code = app.exit(error);  // --help, --version
  }
  flush_standard_output();
  return exit_code;
}

}  // namespace

void flush_standard_output() {
  errno = 0;
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return;
  const std::string reason = errno != 0 ? std::strerror(errno) : "cannot be written";
  throw InputError("standard output: " + reason + ": allowed is one that takes what is printed");
}

void report_removed(const std::vector<std::filesystem::path>& files, const std::string& reason) {
  for (const auto& file : files) std::fprintf(stderr, "swivel: removed the earlier %s: %s\n", file.c_str(), reason.c_str());
}

}  // namespace swivel::cli

int main(int argc, char** argv) {
  using namespace swivel::cli;
  use_large_pages();
  occupy_standard_streams();
  // A reader that has left, or a file that may not grow, is an error of the write and not the end of the program.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    return run(argc, argv);
  } catch (const swivel::InputError& error) {
    std::fprintf(stderr, "swivel: %s\n", error.what());
    return kBadInput;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "swivel: out of memory: allowed are coarser resolutions or the planners eager_dp, lazy, parallel\n");
    return kBadInput;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "swivel: internal error: %s\n", error.what());
    return kInternalError;
  }
}
