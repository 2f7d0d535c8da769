// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <string>
#include <vector>

#include "options/commands.hpp"

namespace swivel::cli {

namespace {

constexpr const char* kSeparator = " | ";  // between the values of an option, in its description

/// Returns the long names of a command's options, --help among them, with a space before each.
std::string options_of(const CLI::App& command) {
  std::string words;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) words += " --" + name;
  return words;
}

/// Returns the values of an option whose description is a list of them, as in "continuous | nodes",
/// with a space before each; nothing for others.
std::string values_of(const CLI::Option& option) {
  std::string left = option.get_description(), words;
  if (left.find(kSeparator) == std::string::npos) return "";
  for (std::size_t end = 0; end != std::string::npos;) {
    end = left.find(kSeparator);
    const std::string word = left.substr(0, end);
    if (word.empty() || word.find(' ') != std::string::npos) return "";
    words += ' ' + word;
    if (end != std::string::npos) left.erase(0, end + std::string(kSeparator).size());
  }
  return words;
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

/// Returns the lines of a case statement of bash over values of options.
std::string value_cases(const CLI::App& app) {
  std::string text;
  for (const CLI::App* command : commands_of(app))
    for (const CLI::Option* option : command->get_options())
      if (const std::string values = values_of(*option); !values.empty())
        text += "    '" + command->get_name() + " --" + option->get_lnames().front() +
                "') words='" + values.substr(1) + "' ;;\n";
  return text;
}

/// Returns a script that completes the words of swivel's command line: commands, their options, the
/// values of options that have a list of them, and names of files.
std::string completion_script(const CLI::App& app) {
  std::string commands, cases;
  for (const CLI::App* command : commands_of(app)) {
    commands += command->get_name() + ' ';
    cases += "    " + command->get_name() + ") words='" + options_of(*command).substr(1) + "' ;;\n";
  }
  return "# Completes the words of swivel's command line in bash, and in zsh after\n"
         "# autoload -U bashcompinit && bashcompinit\n"
         "_swivel() {\n"
         "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}\n"
         "  local command=${COMP_WORDS[1]} words=\n"
         "  COMPREPLY=()\n"
         "  if ((COMP_CWORD == 1)); then\n"
         "    COMPREPLY=($(compgen -W '" +
         commands + options_of(app).substr(1) +
         "' -- \"$word\"))\n"
         "    return\n"
         "  fi\n"
         "  case \"$command $before\" in\n" +
         value_cases(app) +
         "  esac\n"
         "  if [[ -z $words && $word == -* ]]; then\n"
         "    case $command in\n" +
         cases +
         "    esac\n"
         "  fi\n"
         "  if [[ -n $words ]]; then\n"
         "    COMPREPLY=($(compgen -W \"$words\" -- \"$word\"))\n"
         "  else\n"
         "    compopt -o filenames 2>/dev/null\n"
         "    local IFS=$'\\n'\n"
         "    COMPREPLY=($(compgen -f -- \"$word\"))\n"
         "  fi\n"
         "}\n"
         "complete -F _swivel swivel ./swivel\n";
}

}  // namespace

void add_completion(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "completion", "Print a script that completes this program's command lines in bash and zsh");
  command->callback([&app, &exit_code] {
    std::fputs(completion_script(app).c_str(), stdout);
    exit_code = kOk;
  });
}

}  // namespace swivel::cli
