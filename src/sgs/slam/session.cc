// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/session.h"

#include <algorithm>

namespace sgs::slam {

Result<std::unique_ptr<Session>> Session::create(const SessionConfig& config,
                                                 const PinholeCamera& camera,
                                                 const SessionOptions& options) {
  if (!camera.valid()) {
    return fail(ErrorCode::kInvalidArgument, "the camera's intrinsics are not usable",
                "focal lengths and image size must be positive");
  }
  if (options.threads < 1) {
    return fail(ErrorCode::kInvalidArgument, "at least one thread is needed", "use --threads 1");
  }
  SGS_RETURN_IF_ERROR(check(config));
  SGS_ASSIGN_OR_RETURN(auto tracker,
                       tracker::make_tracker(config.tracker, camera, options.T_world_first));
  return std::unique_ptr<Session>(new Session(config, camera, options, std::move(tracker)));
}

Session::Session(const SessionConfig& config, const PinholeCamera& camera,
                 const SessionOptions& options, std::unique_ptr<tracker::Tracker> tracker)
    : config_(config), camera_(camera), live_(options.live), tracker_(std::move(tracker)) {
  const auto mode = options.live           ? MapWorker::Mode::kLive
                    : options.threads == 1 ? MapWorker::Mode::kInline
                                           : MapWorker::Mode::kThread;
  worker_ =
      std::make_unique<MapWorker>(config_, camera_, tracker_->follows_map(), mode, options.threads);
}

Session::~Session() = default;

bool Session::wants_mapping_keyframe(const FrameRecord& record) const {
  if (record.heldout || record.status == tracker::TrackingStatus::kLost) return false;
  return keyframe_pending_ || last_mapping_keyframe_ < 0 ||
         frames_fed_ - last_mapping_keyframe_ >= config_.keyframe_interval;
}

const FrameRecord& Session::feed(const std::shared_ptr<const RgbdFrame>& frame) {
  SGS_CHECK(frame != nullptr, "feed() needs a frame");
  SGS_CHECK(frame->color.width() == camera_.width && frame->color.height() == camera_.height &&
                frame->depth.width() == camera_.width && frame->depth.height() == camera_.height,
            "frame size differs from the session's camera");
  const double waiting_since_s = wall_time_s();
  const MapView view = worker_->view_for(frames_fed_);
  track_times_.add_interval("wait for map", waiting_since_s,
                            1e3 * (wall_time_s() - waiting_since_s));

  FrameRecord record;
  record.index = frame->index;
  record.timestamp_s = frame->timestamp_s;
  record.heldout = is_heldout(frame->index, config_.heldout_interval);
  record.gaussians = view.snapshot ? static_cast<std::int64_t>(view.snapshot->gaussians.size()) : 0;
  record.iterations = view.iterations;

  const double leaving_since_s = wall_time_s();
  auto recess = worker_->leave_core();
  if (recess != nullptr) {
    track_times_.add_interval("wait for core", leaving_since_s,
                              1e3 * (wall_time_s() - leaving_since_s));
  }
  const double wall_start_s = wall_time_s(), start_s = thread_cpu_time_s();
  const tracker::TrackResult result = tracker_->track(*frame, view.snapshot);
  record.track_ms = 1e3 * (thread_cpu_time_s() - start_s);
  const double wall_ms = 1e3 * (wall_time_s() - wall_start_s);
  recess.reset();
  record.T_world_tracked = result.T_world_camera;
  record.status = result.status;
  record.tracking_keyframe = result.keyframe;
  record.diagnostics = result.diagnostics;
  keyframe_pending_ = keyframe_pending_ || result.keyframe;

  MapJob job;
  if (wants_mapping_keyframe(record)) {
    record.mapping_keyframe = true;
    last_mapping_keyframe_ = frames_fed_;
    keyframe_pending_ = false;
    job = {frame, result.T_world_camera};
  }
  worker_->submit(std::move(job));
  ++frames_fed_;

  note_times(record, wall_start_s, wall_ms);
  records_.push_back(std::move(record));
  if (on_frame_) on_frame_(records_.back());
  return records_.back();
}

/// Stage times are CPU time of the thread; their place on the time line is where they would lie had
/// nothing interrupted them.
void Session::note_times(const FrameRecord& record, double wall_start_s, double wall_ms) {
  const tracker::Diagnostics& d = record.diagnostics;
  track_times_.add("track", record.track_ms);
  track_times_.add_trace_only("track", wall_start_s, wall_ms);
  double at_s = wall_start_s;
  const std::pair<const char*, double> parts[] = {{"track/points", d.ms_points},
                                                  {"track/index", d.ms_index},
                                                  {"track/geometry", d.ms_geometry},
                                                  {"track/visual", d.ms_visual},
                                                  {"track/update", d.ms_update}};
  for (const auto& [name, ms] : parts) {
    track_times_.add_interval(name, at_s, ms);
    at_s += 1e-3 * ms;
  }
}

void Session::feed_bad(std::int64_t index, double timestamp_s, const std::string& reason) {
  FrameRecord record;
  record.index = index;
  record.timestamp_s = timestamp_s;
  record.bad = true;
  record.bad_reason = reason;
  records_.push_back(std::move(record));
}

void Session::finish() { worker_->finish(); }

map::SnapshotPtr Session::snapshot() {
  if (const auto& final_snapshot = worker_->final_snapshot()) return final_snapshot;
  return worker_->newest_snapshot();
}

Trajectory Session::trajectory() const {
  std::vector<StampedPose> poses;
  for (const FrameRecord& r : records_) {
    if (r.bad) continue;
    poses.push_back(
        {r.timestamp_s, corrected_pose(r.T_world_tracked, r.timestamp_s, worker_->keyframes())});
  }
  return Trajectory(std::move(poses));
}

Trajectory Session::keyframe_trajectory() const {
  std::vector<StampedPose> poses;
  for (const KeyframePose& k : worker_->keyframes()) {
    poses.push_back({k.timestamp_s, k.T_world_refined});
  }
  return Trajectory(std::move(poses));
}

StageTimes Session::times() const {
  StageTimes all = track_times_;
  all.merge(worker_->times());
  return all;
}

}  // namespace sgs::slam
