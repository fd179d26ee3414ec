// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <thread>

#include "commands.h"
#include "interrupt.h"
#include "log_setup.h"
#include "sgs/core/print.h"
#include "sgs/core/stopwatch.h"
#include "viewer/replay.h"
#include "viewer/shown_refinement.h"
#include "viewer/start.h"

namespace sgs::app {
namespace {

struct ViewCommand {
  std::string folder;
  ViewerRequest viewer;
};

/// The recorded images beside the replay; gives nothing where the input is gone or out of step.
class ReplayImages {
 public:
  explicit ReplayImages(const run::InputSpec& spec) : spec_(spec) { rewind(); }

  void rewind() {
    auto input = run::reopen_input(spec_, 1);
    source_ = input ? std::move(input->source) : nullptr;
    waiting_.reset();
  }
  bool available() const { return source_ != nullptr; }
  std::shared_ptr<const RgbdFrame> frame(std::int64_t index) {
    while (source_ && !interrupted() && (!waiting_ || waiting_->index < index)) {
      auto item = dataset::read_item(*source_);
      if (!item) {
        source_.reset();
        return nullptr;
      }
      waiting_ = std::move(*item);
    }
    return waiting_ && waiting_->index == index ? waiting_->frame : nullptr;
  }

 private:
  run::InputSpec spec_;
  std::unique_ptr<dataset::FrameSource> source_;
  std::optional<dataset::FeedItem> waiting_;
};

void nap_until(double time_s) {
  while (!interrupted() && wall_time_s() < time_s) {
    const double left_s = std::min(0.05, time_s - wall_time_s());
    std::this_thread::sleep_for(std::chrono::duration<double>(std::max(0.0, left_s)));
  }
}

/// Shows every frame at its time; a held replay goes on from where it was.
void play_once(const Replay& replay, ReplayImages& images, viewer::Server& server) {
  constexpr double kLongestGap_s = 1;
  double due_s = wall_time_s();
  const auto enough = [&] { return interrupted() || server.control().refinement_asked(); };
  for (std::size_t i = 0; i < replay.updates.size() && !enough(); ++i) {
    if (server.control().wait_turn(enough) > 0) due_s = wall_time_s();
    nap_until(due_s);
    viewer::FrameUpdate update = replay.updates[i];
    update.frame = images.frame(update.record.index);
    update.finished = i + 1 == replay.updates.size();
    server.post(std::move(update));
    if (i + 1 == replay.updates.size()) break;
    const double gap_s =
        replay.updates[i + 1].record.timestamp_s - replay.updates[i].record.timestamp_s;
    // Late frames (slow disk, slow decoding) do not make the following ones hurry.
    due_s = std::max(due_s + std::clamp(gap_s, 0.0, kLongestGap_s), wall_time_s());
  }
}

Status view(const ViewCommand& command) {
  note_state(command.folder);
  SGS_ASSIGN_OR_RETURN(auto replay, load_replay(command.folder));
  ReplayImages images(replay.input);
  if (!images.available()) {
    say("sgs: the input '{}' is not there any more: no camera pictures\n", replay.input.input);
  }
  // A run that is still going on is refined when it is over.
  replay.info.refines = images.available() && !replay.unfinished;
  SGS_ASSIGN_OR_RETURN(const auto server, start_viewer(command.viewer, replay.info));
  server->set_final_word({replay.metrics, replay.info.up});
  say("Ctrl-C ends\n");
  while (!interrupted() && server->clients() == 0) nap_until(wall_time_s() + 0.05);
  std::filesystem::path folder = command.folder;
  std::uint64_t map_version = 1;
  while (!interrupted()) {
    play_once(replay, images, *server);
    server->control().pause();
    server->touch();
    // Resume: once more.
    server->control().wait_turn(
        [&] { return interrupted() || server->control().refinement_asked(); });
    if (interrupted()) break;
    if (server->control().take_refinement()) {
      SGS_ASSIGN_OR_RETURN(const auto run, run::load_run(folder, run::kAllParts));
      const auto refined = refine_shown(run, folder, replay.updates.back(), map_version, *server);
      if (refined) {
        folder = *refined;
        SGS_ASSIGN_OR_RETURN(auto better, load_replay(folder, ++map_version));
        replay = std::move(better);
        server->set_final_word({replay.metrics, replay.info.up});
      }
      server->control().resume();
    }
    server->restart();
    images.rewind();
  }
  return {};
}

}  // namespace

void add_view(CLI::App& app, Action& action) {
  auto command = std::make_shared<ViewCommand>();
  auto* sub = app.add_subcommand("view", "Show a finished run in the browser");
  sub->add_option("RUN", command->folder, "Run folder")->required();
  command->viewer.add_view_options(*sub);
  sub->callback([command, &action] {
    action = [command]() -> int {
      setup_logging({}, false);
      const Status status = view(*command);
      return status ? kExitDone : report(status.error());
    };
  });
}

}  // namespace sgs::app
