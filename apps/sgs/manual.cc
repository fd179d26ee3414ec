// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "manual.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "self_description.h"
#include "sgs/core/config.h"
#include "sgs/core/print.h"
#include "sgs/io/atomic_file.h"
#include "sgs/runfolder/run_config.h"

namespace sgs::app {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> config_keys() {
  run::RunConfig config;
  ParameterList list;
  config.declare(list);
  std::vector<std::string> keys;
  for (const Parameter& parameter : list.parameters()) keys.push_back(parameter.key);
  return keys;
}

/// Where packages look: share/man/man1 and share/bash-completion/completions below a folder.
Status write_manual(const CLI::App& program, const fs::path& folder) {
  const fs::path pages = folder / "man" / "man1";
  const fs::path completions = folder / "bash-completion" / "completions";
  SGS_RETURN_IF_ERROR(io::make_folder(pages));
  SGS_RETURN_IF_ERROR(io::make_folder(completions));
  SGS_RETURN_IF_ERROR(io::write_file(pages / "sgs.1", man_page(program, nullptr)));
  for (const CLI::App* command : commands_of(program)) {
    SGS_RETURN_IF_ERROR(io::write_file(pages / fmt::format("sgs-{}.1", command->get_name()),
                                       man_page(program, command)));
  }
  return io::write_file(completions / "sgs", bash_completion(program, config_keys()));
}

int print_manual(const CLI::App& program, const std::string& name) {
  if (name.empty()) {
    print("{}", man_page(program, nullptr));
    return kExitDone;
  }
  for (const CLI::App* command : commands_of(program)) {
    if (command->get_name() != name) continue;
    print("{}", man_page(program, command));
    return kExitDone;
  }
  return report({ErrorCode::kInvalidArgument, fmt::format("there is no command '{}'", name),
                 "see `sgs --help`"});
}

}  // namespace

void add_manual(CLI::App& app, Action& action) {
  struct Manual {
    std::string command, folder;
  };
  auto manual = std::make_shared<Manual>();
  auto* sub = app.add_subcommand("man", "The manual as a man page: sgs man run | man -l -");
  sub->add_option("COMMAND", manual->command, "Of this command");
  sub->add_option("--write", manual->folder,
                  "Write all pages and the bash completion below this folder, as in share/");
  sub->callback([manual, &app, &action] {
    action = [manual, &app]() -> int {
      if (manual->folder.empty()) return print_manual(app, manual->command);
      const Status status = write_manual(app, manual->folder);
      return status ? static_cast<int>(kExitDone) : report(status.error());
    };
  });
  auto* completion = app.add_subcommand(
      "completion", "Completion for bash: source <(sgs completion), also in zsh's bashcompinit");
  completion->callback([&app, &action] {
    action = [&app]() -> int {
      print("{}", bash_completion(app, config_keys()));
      return kExitDone;
    };
  });
}

}  // namespace sgs::app
