// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <thread>

#include "interrupt.h"
#include "sgs/core/print.h"
#include "sgs/dataset/imu.h"
#include "sgs/runfolder/run_files.h"
#include "sgs/runfolder/version.h"
#include "sgs/tracker/tracker_kind.h"
#include "sgs/upright/gravity.h"
#include "sgs/upright/upright.h"
#include "sgs/viewer/server.h"
#include "sgs/viewer/session_feed.h"
#include "viewer/start.h"
#include "viewer_link.h"

namespace sgs::app {

Result<std::unique_ptr<viewer::Server>> start_viewer(const ViewerRequest& request,
                                                     const viewer::RunInfo& info) {
  viewer::ServerOptions options;
  options.address = request.address;
  options.names = request.names;
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

class Link : public ViewerLink {
 public:
  Link(std::unique_ptr<viewer::Server> server, bool stay)
      : server_(std::move(server)), stay_(stay) {}

  double before_frame() override {
    return server_->control().wait_turn([this] {
      if (session_ != nullptr) server_->update_map(session_->snapshot());
      return interrupted();
    });
  }

  void after_frame(slam::Session& session, const dataset::FeedItem& item,
                   const slam::FrameRecord& record) override {
    server_->post(feed_.update(session, item, record));
    session_ = &session;  // there until after the last frame
  }

  void finish(slam::Session& session) override { server_->finish(session.snapshot()); }

  void close(const eval::Metrics& metrics, const std::filesystem::path& folder) override {
    constexpr double kDrain_s = 2;
    const auto upright = run::load_upright(folder / run::files::kUpright);
    server_->set_final_word({metrics, upright ? std::optional(upright->up) : std::nullopt});
    server_->drain(kDrain_s);
    if (stay_ && !interrupted()) say("viewer stays until Ctrl-C\n");
    while (stay_ && !interrupted()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    server_.reset();
    say("viewer closed; see the run again with: sgs view {}\n", folder.string());
  }

 private:
  std::unique_ptr<viewer::Server> server_;
  viewer::SessionFeed feed_;
  slam::Session* session_ = nullptr;
  bool stay_;
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
                                                     const slam::SessionConfig& config) {
  if (!request.wanted) return nullptr;
  viewer::RunInfo info;
  info.version = run::version();
  info.input = input.info.name;
  info.tracker = to_string(config.tracker.type);
  info.preset = to_string(config.preset);
  info.live = true;
  info.camera = input.source->camera();
  info.frames_total = input.source->size();
  info.up = up_at_start(input, config);
  SGS_ASSIGN_OR_RETURN(auto server, start_viewer(request, info));
  return std::make_unique<Link>(std::move(server), request.stay);
}

}  // namespace sgs::app
