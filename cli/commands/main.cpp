// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include "options/commands.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/nearest_name.hpp"
#include "swivel/io/io.hpp"
#include "terminal/large_pages.hpp"
#include "terminal/terminal.hpp"
#include "terminal/wrapped_output.hpp"

namespace swivel::cli {

namespace {

/// Opens standard streams that are closed, since the next file to be opened would get the number of
/// one, and what is printed would end up in that file. Each is opened in the wrong direction, so
/// that printing fails as it should.
void occupy_standard_streams() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(descriptor, F_GETFD) < 0)
      static_cast<void>(open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY));
}

/// Returns a message about the first word that was not expected, options before other words;
/// nothing if there is none.
std::optional<std::string> unexpected_word(const CLI::App& app) {
  const std::vector<const CLI::App*> parsed =
      app.get_subcommands([](const CLI::App* command) { return command->parsed(); });
  const CLI::App& at = parsed.empty() ? app : *parsed.front();
  const std::vector<std::string> left = at.remaining();
  if (left.empty()) return std::nullopt;
  const auto option = std::find_if(left.begin(), left.end(), [](const std::string& word) {
    return word.size() > 1 && word[0] == '-';
  });
  const bool command = &at == &app && option == left.end();
  const std::string name = command                ? left.front()
                           : option == left.end() ? ""
                                                  : option->substr(0, option->find('='));
  const std::string help =
      command || &at == &app ? "swivel --help" : "swivel " + at.get_name() + " --help";
  if (name.empty())
    return "unexpected word '" + left.front() + "': allowed is what `" + help + "` lists";
  std::vector<std::string> known;
  if (command)
    for (const CLI::App* one : app.get_subcommands([](const CLI::App*) { return true; }))
      known.push_back(one->get_name());
  else
    for (const CLI::Option* one : at.get_options())
      for (const std::string& long_name : one->get_lnames()) known.push_back("--" + long_name);
  const std::string& nearest = nearest_name(name, known);
  const bool alike = edit_distance(name, nearest) <= std::max<std::size_t>(1, nearest.size() / 3);
  return std::string("unknown ") + (command ? "command " : "option ") + name +
         (alike ? "; did you mean " + nearest + "?" : "") + " (allowed are those of `" + help +
         "`)";
}

/// Makes all commands refuse values that CLI11 accepts and nobody means: an empty value (of a shell
/// variable that is not set), which CLI11 would skip, and a negative count or seed, which would
/// wrap around.
void refuse_odd_values(CLI::App& app) {
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; }))
    for (CLI::Option* option : command->get_options()) {
      option->check([name = command->get_name()](const std::string& value) {
        return value.empty() ? "is empty: allowed is what `swivel " + name + " --help` says"
                             : std::string();
      });
      if (option->get_type_name() == "UINT")
        option->check([](const std::string& value) {
          return value.starts_with('-') ? value + ": allowed are whole numbers from 0"
                                        : std::string();
        });
    }
}

int run(int argc, char** argv) {
  CLI::App app(
      "Swivel plans joint trajectories along tool paths, for arms with a degree of freedom to "
      "spare.",
      "swivel");
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
  add_completion(app, exit_code);
  app.set_help_all_flag("--help-all", "Print the help of all commands and exit");
  app.footer(exit_codes_text());
  refuse_odd_values(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) throw InputError(unexpected_word(app).value_or(error.what()));
    exit_code = app.exit(error);  // only --help and --version
  }
  flush_standard_output();
  return exit_code;
}

}  // namespace

std::string exit_codes_text() {
  std::string text = "Exit codes:\n";
  for (const auto& [code, meaning] : kExitCodes)
    text += "  " + std::to_string(code) + "  " + meaning + '\n';
  return text;
}

void flush_standard_output() {
  errno = 0;
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return;
  if (errno == EPIPE || io::reader_has_left()) throw io::ReaderLeft();
  const std::string reason = errno != 0 ? std::strerror(errno) : "cannot be written";
  throw InputError("standard output: " + reason + ": allowed is one that takes what is printed");
}

void require_table_name(const std::string& option, const std::string& file, const std::string& what,
                        const std::string& instead) {
  const std::filesystem::path end = std::filesystem::path(file).extension();
  for (const char* other : {".json", ".yaml", ".yml", ".mcap", ".html", ".svg"})
    if (end == other)
      throw InputError(option + ": " + file + ": " + what +
                       " would be in it as CSV: allowed is a name that ends in .csv, or " +
                       instead);
}

void report_removed(const std::vector<std::filesystem::path>& files, const std::string& reason) {
  for (const auto& file : files)
    complain("swivel: removed the earlier %s: %s\n", file.c_str(), reason.c_str());
}

}  // namespace swivel::cli

int main(int argc, char** argv) {
  using namespace swivel::cli;
  use_large_pages();
  occupy_standard_streams();
  wrap_standard_output();
  // A reader that has left, or a file that may not grow, must make the write fail rather than end
  // the program.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    return run(argc, argv);
  } catch (const swivel::io::ReaderLeft&) {
    // End as a program does that leaves SIGPIPE at its default.
    std::signal(SIGPIPE, SIG_DFL);
    std::raise(SIGPIPE);
    return kBadInput;
  } catch (const swivel::InputError& error) {
    complain("swivel: %s\n", error.what());
    return kBadInput;
  } catch (const std::bad_alloc&) {
    complain(
        "swivel: out of memory: allowed are coarser resolutions or the planners eager_dp, lazy, "
        "parallel\n");
    return kBadInput;
  } catch (const std::exception& error) {
    complain("swivel: internal error: %s\n", error.what());
    return kInternalError;
  }
}
