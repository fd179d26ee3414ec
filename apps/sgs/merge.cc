// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "commands.h"
#include "log_setup.h"
#include "sgs/core/print.h"
#include "sgs/mapjoin/join_files.h"
#include "sgs/runfolder/folder_lock.h"

namespace sgs::app {
namespace {

namespace fs = std::filesystem;

struct MergeCommand {
  std::vector<std::string> maps;
  std::string output;
  int threads = 2;
  bool quiet = false;
};

/// A run that goes on would put its own map there.
Status check_free(const fs::path& output) {
  const fs::path folder = fs::absolute(output).parent_path();
  if (!run::FolderLock::is_held(folder)) return {};
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("{} is the folder of a run that goes on", folder.string()),
              "wait for it, or write elsewhere");
}

int run_merge(const MergeCommand& command) {
  setup_logging({}, command.quiet);
  if (const auto free = check_free(command.output); !free) return report(free.error());
  const std::vector<fs::path> maps(command.maps.begin(), command.maps.end());
  const auto done = mapjoin::join_files(maps, command.output, command.threads);
  if (!done) return report(done.error());
  for (const std::string& sentence : done->joined) {
    if (!command.quiet) say("sgs: {}\n", sentence);
  }
  for (const std::string& sentence : done->not_joined) say("sgs: not joined: {}\n", sentence);
  if (done->not_joined.empty()) {
    print("{}\n", command.output);
    return kExitDone;
  }
  return kExitLost;
}

}  // namespace

void add_merge(CLI::App& app, Action& action) {
  auto command = std::make_shared<MergeCommand>();
  auto* sub = app.add_subcommand(
      "merge", "Join maps of several runs that have seen the same place into one map file");
  sub->add_option("MAPS", command->maps,
                  "Maps, or run folders with one; the world is that of the first")
      ->required()
      ->expected(2, 1000);
  sub->add_option("-o,--output", command->output, "Map file to write; the maps are only read")
      ->required()
      ->type_name("MAP");
  sub->add_option("--threads", command->threads, "Threads")->check(CLI::Range(1, 256));
  sub->add_flag("--quiet", command->quiet, "No messages but errors");
  sub->callback([command, &action] { action = [command] { return run_merge(*command); }; });
}

}  // namespace sgs::app
