// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <exception>
#include <new>

#include "commands.hpp"
#include "swivel/core/input_error.hpp"

int main(int argc, char** argv) {
  using namespace swivel::cli;
  CLI::App app("Swivel plans joint trajectories of 7-DOF arms along tool paths.", "swivel");
  app.set_version_flag("--version", SWIVEL_VERSION);
  app.require_subcommand(1);
  int exit_code = kOk;
  add_plan(app, exit_code);
  add_campaign(app, exit_code);
  add_check(app, exit_code);
  add_info(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    std::fprintf(stderr, "swivel: %s\n", error.what());
    return kBadInput;
  } catch (const swivel::InputError& error) {
    std::fprintf(stderr, "swivel: %s\n", error.what());
    return kBadInput;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "swivel: out of memory: allowed are coarser resolutions or the planners eager_dp, lazy, parallel\n");
    return kBadInput;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "swivel: internal error: %s\n", error.what());
    return kBadInput;
  }
  return exit_code;
}
