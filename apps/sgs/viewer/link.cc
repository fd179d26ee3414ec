// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <mutex>
#include <thread>

#include "interrupt.h"
#include "sgs/core/print.h"
#include "sgs/core/stopwatch.h"
#include "sgs/dataset/imu.h"
#include "sgs/run/recorded_run.h"
#include "sgs/runfolder/run_files.h"
#include "sgs/runfolder/version.h"
#include "sgs/stream/address.h"
#include "sgs/tracker/tracker_kind.h"
#include "sgs/upright/gravity.h"
#include "sgs/upright/upright.h"
#include "sgs/viewer/server.h"
#include "sgs/viewer/session_feed.h"
#include "viewer/shown_refinement.h"
#include "viewer/start.h"
#include "viewer_link.h"

namespace sgs::app {

Result<std::unique_ptr<viewer::Server>> start_viewer(const ViewerRequest& request,
                                                     const viewer::RunInfo& info) {
  viewer::ServerOptions options;
  options.address = request.address;
  options.names = request.names;
  options.token = request.token;
  options.resume_when_alone = info.live;
  const auto end = request.port.data() + request.port.size();
  const auto parsed = std::from_chars(request.port.data(), end, options.port);
  if (parsed.ec != std::errc{} || parsed.ptr != end) {
    return fail(ErrorCode::kInvalidArgument, fmt::format("'{}' is no port", request.port),
                "give a number up to 65535; 0 takes any free port");
  }
  SGS_ASSIGN_OR_RETURN(auto server, viewer::Server::start(options, info));
  say("viewer  {}\n", server->url());
  return server;
}

namespace {

/// Why frames are dropped, where they are.
std::string why_dropped(const run::LiveStatus& now) {
  if (now.dropped == 0) return {};
  std::string why = "frames come faster than they are tracked";
  if (now.track_ms > 0 && now.camera_fps > 0) {
    why = fmt::format("tracking takes {:.0f} ms, a frame comes every {:.0f}", now.track_ms,
                      1e3 / now.camera_fps);
  }
  return why;
}

void show_status(const run::LiveStatus& now, viewer::SessionNote& note) {
  note.at_camera_rate = now.at_camera_rate;
  note.dropped = now.dropped;
  note.left_out = now.left_out;
  note.camera_fps = now.camera_fps;
  note.why_dropped = why_dropped(now);
  note.trouble = now.trouble;
  note.warnings.clear();
  for (const auto& w : now.warnings) note.warnings.push_back({to_string(w.what), w.text});
  note.recording = now.recording.on;
  note.recording_trouble = now.recording.trouble;
  note.recorded.clear();
  if (now.recording.folder.empty()) return;
  note.recorded = fmt::format("{} frames in {}", now.recording.frames,
                              now.recording.folder.filename().string());
  if (now.recording.lost > 0) note.recorded += fmt::format(", {} left out", now.recording.lost);
}

class Link : public ViewerLink {
 public:
  Link(std::unique_ptr<viewer::Server> server, bool stay, const run::InputSpec& spec)
      : server_(std::move(server)),
        stay_(stay),
        streamed_(stream::is_stream(spec.input)),
        given_map_(!spec.map.empty()) {
    note_.refinable = refinable();
    tell();
  }

  ViewerRequest same_address(ViewerRequest request) const override {
    request.port = std::to_string(port_);
    request.token = token_;
    return request;
  }
  std::stop_token enough() const override { return server_->control().finished(); }

  double before_frame(const std::function<void()>& held) override {
    return server_->control().wait_turn([&] {
      held();
      if (session_ != nullptr) server_->update_map(session_->snapshot());
      return interrupted();
    });
  }

  void after_frame(slam::Session& session, const dataset::FeedItem& item,
                   const slam::FrameRecord& record) override {
    last_ = feed_.update(session, item, record);
    server_->post(last_);
    session_ = &session;  // there until after the last frame
  }

  bool take_save() override { return server_->control().take_save(); }
  std::optional<bool> take_recording() override { return server_->control().take_recording(); }

  void on_saved(const run::SaveNote& saved) override {
    const std::scoped_lock lock(mutex_);
    note_.saved = saved.text;
    if (saved.done) offer(saved.folder);
    tell();
  }

  void on_status(const run::LiveStatus& now) override {
    const std::scoped_lock lock(mutex_);
    recorded_frames_ = now.recording.frames;
    show_status(now, note_);
    note_.refinable = refinable();
    tell();
  }

  void finish(slam::Session& session) override {
    session_ = nullptr;
    last_.map = session.snapshot();
    server_->finish(last_.map);
  }

  bool close(const eval::Metrics& metrics, const std::filesystem::path& folder,
             const std::filesystem::path& recording) override {
    constexpr double kDrain_s = 2;
    const auto upright = run::load_upright(folder / run::files::kUpright);
    server_->set_final_word({metrics, upright ? std::optional(upright->up) : std::nullopt});
    show_end(folder);
    server_->drain(kDrain_s);
    const bool stays = stay_ || enough().stop_requested();
    if (stay_ && !interrupted()) say("viewer stays until Ctrl-C\n");
    if (stays) serve_end(folder, recording);
    const bool again =
        !interrupted() && server_->control().after() == viewer::AfterRun::kStartAgain;
    port_ = server_->port();
    token_ = server_->token();
    server_.reset();
    if (!again) say("viewer closed; see the run again with: sgs view {}\n", folder.string());
    return again;
  }

 private:
  /// The frames can be had once more, and the map may change.
  bool refinable() const { return (!streamed_ || recorded_frames_ > 0) && !given_map_; }
  void tell() { server_->set_session(note_); }
  void offer(const std::filesystem::path& folder) {
    note_.downloads.clear();
    for (const char* name : {run::files::kMap, run::files::kTrajectory}) {
      std::error_code unreadable;
      if (!std::filesystem::exists(folder / name, unreadable)) continue;
      server_->offer_file(name, folder / name);
      note_.downloads.emplace_back(name);
    }
  }
  void show_end(const std::filesystem::path& folder) {
    const std::scoped_lock lock(mutex_);
    note_.warnings.clear();
    note_.trouble.clear();
    note_.camera_fps = viewer::FrameUpdate::kNone;
    note_.recording = false;
    note_.ended = true;
    note_.refinable = refinable();
    offer(folder);
    tell();
  }

  /// Until nobody watches any more, or, where it stays, until Ctrl-C; or the run is to start again.
  void serve_end(const std::filesystem::path& folder, const std::filesystem::path& recording) {
    constexpr double kAlone_s = 10;
    viewer::RunControl& control = server_->control();
    double seen_s = wall_time_s();
    while (!interrupted() && control.after() != viewer::AfterRun::kStartAgain) {
      if (server_->clients() > 0) seen_s = wall_time_s();
      if (!stay_ && wall_time_s() - seen_s > kAlone_s) return;
      if (control.after() == viewer::AfterRun::kRefine) {
        control.take_after();
        refine(folder, recording);
      } else if (control.after() == viewer::AfterRun::kNothing) {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
      }
    }
  }

  void refine(const std::filesystem::path& folder, const std::filesystem::path& recording) {
    if (!refinable()) {
      return server_->set_refinement({false, 0, "its frames were not kept, or its map is given"});
    }
    auto run = run::load_run(folder, run::kAllParts);
    if (run && streamed_) run = run::run_of_recording(std::move(*run), recording);
    if (!run) return server_->set_refinement({false, 0, run.error().text()});
    server_->set_refinement({true, 0, "begins"});
    last_.finished = true;
    std::uint64_t version = last_.map ? last_.map->version : 0;
    const auto refined = refine_shown(*run, folder, last_, version, *server_);
    if (!refined) return;
    const std::scoped_lock lock(mutex_);
    offer(*refined);
    tell();
  }

  std::unique_ptr<viewer::Server> server_;
  viewer::SessionFeed feed_;
  viewer::FrameUpdate last_;
  slam::Session* session_ = nullptr;
  bool stay_, streamed_, given_map_;
  int port_ = 0;
  std::string token_;

  std::mutex mutex_;  // what follows is told from several threads
  viewer::SessionNote note_;
  std::int64_t recorded_frames_ = 0;
};

/// Which way is up when a run begins, in the axes of its first camera: as an accelerometer in a
/// file of its own feels it, unless that would hang the camera upside down. Else the page goes by
/// its pictures.
std::optional<Eigen::Vector3d> up_at_start(const run::Input& input,
                                           const slam::SessionConfig& config) {
  const bool in_first_camera = !tracker::takes_given_poses(config.tracker);
  if (!in_first_camera || dataset::accelerometer_file(input.info.folder).empty()) return {};
  const auto up = run::felt_up(dataset::read_imu(input.info), input.info.first_time_s);
  constexpr double kUpsideDown = 0.5;
  return up && up->y() < kUpsideDown ? up : std::nullopt;
}

}  // namespace

Result<std::unique_ptr<ViewerLink>> ViewerLink::open(const ViewerRequest& request,
                                                     const run::Input& input,
                                                     const run::InputSpec& spec,
                                                     const slam::SessionConfig& config,
                                                     bool starts_again) {
  if (!request.wanted) return nullptr;
  viewer::RunInfo info;
  info.version = run::version();
  info.input = input.info.name;
  info.tracker = to_string(config.tracker.type);
  info.preset = to_string(config.preset);
  info.live = true;
  info.session = true;
  info.records = stream::is_stream(spec.input);
  info.starts_again = starts_again;
  info.camera = input.source->camera();
  info.frames_total = input.source->size();
  info.up = up_at_start(input, config);
  SGS_ASSIGN_OR_RETURN(auto server, start_viewer(request, info));
  return std::make_unique<Link>(std::move(server), request.stay, spec);
}

}  // namespace sgs::app
