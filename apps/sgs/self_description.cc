// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "self_description.h"

#include <fmt/format.h>

#include "sgs/runfolder/version.h"

namespace sgs::app {
namespace {

/// Text that roff prints as it is.
std::string roff(const std::string& text) {
  std::string out;
  bool line_begins = true;
  for (const char c : text) {
    if (line_begins && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
    line_begins = c == '\n';
  }
  return out;
}

std::vector<const CLI::Option*> options_of(const CLI::App& app, bool positional) {
  std::vector<const CLI::Option*> options;
  for (const CLI::Option* option : app.get_options()) {
    const bool is_positional = !option->nonpositional();
    if (is_positional == positional) options.push_back(option);
  }
  return options;
}

bool takes_value(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

/// "{a,b}" in the description of a check: the words that an option allows.
std::vector<std::string> words_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const auto begin = type.find('{'), end = type.find('}');
  if (begin == std::string::npos || end == std::string::npos || end < begin) return {};
  return CLI::detail::split(type.substr(begin + 1, end - begin - 1), ',');
}

std::string value_name(const CLI::Option& option) {
  return takes_value(option) ? " " + option.get_type_name() : "";
}

std::string synopsis(const CLI::App& command) {
  std::string text;
  for (const CLI::Option* option : options_of(command, true)) {
    const std::string& name = option->get_name(true);
    text += option->get_required() ? name + " " : "[" + name + "] ";
  }
  return text + "[options]";
}

std::string option_entries(const CLI::App& app) {
  std::string text;
  for (const CLI::Option* option : options_of(app, true)) {
    text += fmt::format(".TP\n.I {}\n{}\n", roff(option->get_name(true)),
                        roff(option->get_description()));
  }
  for (const CLI::Option* option : options_of(app, false)) {
    text += fmt::format(".TP\n.B {}{}\n{}\n", roff(option->get_name(false, true)),
                        roff(value_name(*option)), roff(option->get_description()));
  }
  return text;
}

constexpr const char* kExitStatus =
    ".SH EXIT STATUS\n"
    ".TP\n0\ndone\n.TP\n1\nfailed while running; what was computed is saved\n"
    ".TP\n2\nthe command line or a configuration value makes no sense\n"
    ".TP\n3\nfinished, but tracking was lost at the end or for more than half of the frames\n"
    ".TP\n130\nstopped by Ctrl\\-C; what was done so far is complete\n";

std::string spaced(const std::vector<std::string>& words) { return CLI::detail::join(words, " "); }

/// The words that may stand where a command is asked for.
std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : options_of(app, false)) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

/// One branch of the script: what may follow an option of a command.
std::string value_branches(const CLI::App& command, const std::vector<std::string>& keys) {
  std::string text;
  for (const CLI::Option* option : options_of(command, false)) {
    if (!takes_value(*option)) continue;
    const bool assigns = option->check_lname("set");
    const std::string names = CLI::detail::join(
        option->get_lnames(), [&](const std::string& n) { return command.get_name() + ":--" + n; },
        "|");
    const std::string words = spaced(assigns ? keys : words_of(*option));
    text += fmt::format("    {}) values=1; words=\"{}\"{} ;;\n", names, words,
                        assigns ? "; compopt -o nospace" : "");
  }
  return text;
}

std::string command_branch(const CLI::App& command) {
  std::vector<std::string> words;
  for (const CLI::Option* option : options_of(command, true)) {
    for (std::string& word : words_of(*option)) words.push_back(std::move(word));
  }
  return fmt::format("    {}) options=\"{}\"; words=\"{}\" ;;\n", command.get_name(),
                     spaced(option_names(command)), spaced(words));
}

}  // namespace

std::vector<const CLI::App*> commands_of(const CLI::App& program) {
  return program.get_subcommands([](const CLI::App* app) { return !app->get_name().empty(); });
}

std::string man_page(const CLI::App& program, const CLI::App* command) {
  const std::string name =
      program.get_name() + (command != nullptr ? "-" + command->get_name() : std::string());
  const CLI::App& described = command != nullptr ? *command : program;
  std::string text =
      fmt::format(".TH \"{}\" 1 \"\" \"sgs {}\" \"User Commands\"\n", name, run::version());
  text += fmt::format(".SH NAME\n{} \\- {}\n.SH SYNOPSIS\n.B {}\n", roff(name),
                      roff(described.get_description()), roff(program.get_name()));
  if (command == nullptr) {
    text += roff("COMMAND ...") + "\n.SH COMMANDS\n";
    for (const CLI::App* each : commands_of(program)) {
      text += fmt::format(".TP\n.BR {}\\-{} (1)\n{}\n", program.get_name(), each->get_name(),
                          roff(each->get_description()));
    }
  } else {
    text += fmt::format(".B {}\n{}\n", roff(command->get_name()), roff(synopsis(*command)));
  }
  return text + ".SH OPTIONS\n" + option_entries(described) + kExitStatus;
}

std::string bash_completion(const CLI::App& program, const std::vector<std::string>& keys) {
  std::vector<std::string> assignments;
  for (const std::string& key : keys) assignments.push_back(key + "=");
  std::vector<std::string> names;
  std::string branches, values;
  for (const CLI::App* command : commands_of(program)) {
    names.push_back(command->get_name());
    branches += command_branch(*command);
    values += value_branches(*command, assignments);
  }
  const std::string options = spaced(option_names(program));
  std::string script =
      "# Made by `sgs completion` from the options of sgs " + run::version() + ".\n_sgs() {\n";
  script +=
      "  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]}\n"
      "  local command= word values= options=\"" +
      options + "\" words=\"" + spaced(names) +
      "\"\n  for word in \"${COMP_WORDS[@]:1:COMP_CWORD-1}\"; do\n"
      "    [[ \" " +
      spaced(names) +
      " \" == *\" $word \"* ]] && { command=$word; break; }\n"
      "  done\n  case \"$command\" in\n" +
      branches +
      "  esac\n"
      "  case \"$command:$prev\" in\n" +
      values +
      "  esac\n"
      "  [[ -z $values && $cur == -* ]] && words=$options\n"
      "  COMPREPLY=($(compgen -W \"$words\" -- \"$cur\"))\n}\n"
      "complete -o default -F _sgs sgs\n";
  return script;
}

}  // namespace sgs::app
