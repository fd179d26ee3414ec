// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/session.h"

#include <algorithm>
#include <cmath>
#include <exception>

#include "sgs/camera/depth_lag.h"
#include "sgs/camera/fingerprint.h"
#include "sgs/camera/movers.h"
#include "sgs/camera/resample.h"
#include "sgs/core/log.h"
#include "sgs/core/thread_pool.h"
#include "sgs/slam/calibration_back_end.h"
#include "sgs/slam/loop_back_end.h"
#include "sgs/slam/second_look_back_end.h"
#include "sgs/slam/track_stopwatch.h"
#include "sgs/slam/video_gap.h"

namespace sgs::slam {
namespace {

Status check_arguments(const SessionConfig& config, const PinholeCamera& camera,
                       const SessionOptions& options) {
  if (!camera.valid()) {
    return fail(ErrorCode::kInvalidArgument, "the camera's intrinsics are not usable",
                "focal lengths and image size must be positive");
  }
  if (options.threads < 1) {
    return fail(ErrorCode::kInvalidArgument, "at least one thread is needed", "use --threads 1");
  }
  return check(config);
}

/// Of an item and of what became of it.
std::uint64_t hash_of(const FrameRecord& record, std::int64_t depth_print) {
  ArchiveWriter bytes;
  auto index = record.index, fingerprint = record.fingerprint;
  auto bad = record.bad;
  auto status = record.status;
  auto loops = record.loops, calibrations = record.calibrations;
  auto correction_m = record.correction_m;
  SE3 T = record.T_online_camera;
  bytes(index, fingerprint, depth_print, bad, status, loops, calibrations, correction_m, T);
  return std::hash<std::string>{}(bytes.take());
}

}  // namespace

Result<std::unique_ptr<Session>> Session::create(const SessionConfig& config,
                                                 const PinholeCamera& camera,
                                                 const SessionOptions& options) {
  SGS_RETURN_IF_ERROR(check_arguments(config, camera, options));
  SGS_ASSIGN_OR_RETURN(auto tracker,
                       tracker::make_tracker(config.tracker, camera, options.T_world_first));
  return create(config, camera, options, std::move(tracker));
}

Result<std::unique_ptr<Session>> Session::create(const SessionConfig& config,
                                                 const PinholeCamera& camera,
                                                 const SessionOptions& options,
                                                 std::unique_ptr<tracker::Tracker> tracker) {
  SGS_CHECK(tracker != nullptr, "create() needs a tracker");
  SGS_RETURN_IF_ERROR(check_arguments(config, camera, options));
  return std::unique_ptr<Session>(new Session(config, camera, options, std::move(tracker)));
}

Session::Session(const SessionConfig& config, const PinholeCamera& camera,
                 const SessionOptions& options, std::unique_ptr<tracker::Tracker> tracker)
    : config_(effective(config, *tracker)),
      camera_(camera),
      live_(options.live),
      views_(std::make_shared<history::ViewStore>(config_.history,
                                                  config_.mapper.insertion.max_depth_m)),
      tracker_(std::move(tracker)),
      threads_(options.threads) {
  const auto mode = options.live           ? WorkerMode::kLive
                    : options.threads == 1 ? WorkerMode::kInline
                                           : WorkerMode::kThread;
  tracker_->remember_in(views_);
  worker_ = std::make_unique<MapWorker>(config_, camera_, tracker_->follows_map(), mode,
                                        options.threads, views_);
  if (config_.loops.enabled) {
    auto back_end = std::make_unique<LoopBackEnd>(config_, views_);
    loop_back_end_ = back_end.get();
    loops_ = std::make_unique<BackEndWorker>(std::move(back_end), config_.loops.lag, mode);
  }
  const alignment::MoversConfig& movers = config_.tracker.movers;
  if (movers.clusters && movers.second_look) {
    constexpr int kLag = 10;  // frames: before the next look
    second_look_ = std::make_unique<BackEndWorker>(
        std::make_unique<SecondLookBackEnd>(config_.tracker), kLag, mode);
  }
  if (config_.backend.calibration.online) {
    calibrator_ = std::make_unique<BackEndWorker>(std::make_unique<CalibrationBackEnd>(config_),
                                                  config_.backend.calibration.lag, mode);
  }
}

Session::~Session() = default;

Status Session::check_can_be_given_a_map() const {
  SGS_CHECK(records_.empty() && revision_.path.empty(), "a map is given before the first frame");
  if (tracker_->finds_itself()) return {};
  return fail(
      ErrorCode::kInvalidArgument,
      fmt::format("the tracker {} cannot find itself in a map", to_string(config_.tracker.type)),
      "leave out --tracker and --preset, or use --tracker spectral");
}

void Session::know(std::size_t number, double time_s, const alignment::KnownView& view) {
  revision_.path.append({alignment::known_view_index(number), time_s, view.T_world_camera});
  tracker_->know(view, revision_);
  if (!view.drawn) metre_.know(revision_.path.back().frame, view.frame);
}

// What the map shows from where no view was taken: after its views, at the time of the last one.
void Session::know_drawn(const DrawnViews& drawn) {
  const std::size_t views = revision_.path.size();
  const double time_s = revision_.path.back().timestamp_s;
  ThreadPool pool(threads_);
  drawn.draw(pool,
             [&](const alignment::KnownView& view) { know(revision_.path.size(), time_s, view); });
  log().debug("{} views of the map are drawn from where none was taken",
              revision_.path.size() - views);
}

// One line where the camera's metre is not that of the map.
void Session::compare_metres(const RgbdFrame& frame, const FrameRecord& record) {
  constexpr double kAnother = 0.015;
  if (record.status == tracker::TrackingStatus::kLost || !has_place(record.index)) return;
  if (!metre_.add(frame, revision_.path.back().T_odom_camera, revision_.path)) return;
  const auto ratio = metre_.ratio();
  if (!ratio || std::abs(*ratio - 1) < kAnother) return;
  log().warn(
      "depth of this camera is {:.1f} % {} than that of the map: poses and what is added to the "
      "map are off by as much of the distance. Calibrate the camera (`sgs calibrate`) and run "
      "again "
      "with --calibration",
      100 * std::abs(*ratio - 1), *ratio > 1 ? "longer" : "shorter");
}

Status Session::go_on_with(const KnownMap& map) {
  SGS_CHECK(map.gaussians != nullptr && map.session_of.size() == map.views && map.views > 0 &&
                map.births.size() == map.gaussians->gaussians.size(),
            "a map that can be gone on with");
  SGS_CHECK(!calibrator_, "the metre is that of the map");
  SGS_RETURN_IF_ERROR(check_can_be_given_a_map());
  if (!loops_) {
    return fail(ErrorCode::kInvalidArgument, "without loops a map cannot be gone on with",
                "leave out loops.enabled=false and settings of the tracker that switch loops off");
  }
  if (map.calibration) {
    revision_.calibration = std::make_shared<const DepthCalibration>(*map.calibration);
  }
  std::vector<const graph::Edge*> ways(map.views, nullptr);  // to each view
  for (const graph::Edge& e : map.edges) {
    if (!e.doubtful && e.to == e.from + 1) ways[static_cast<std::size_t>(e.to)] = &e;
  }
  std::vector<mapper::KnownKeyframe> keyframes;
  std::vector<double> times_s;
  loops::LoopCloser& closer = loop_back_end_->closer();
  DrawnViews drawn(camera_, map.views, drawn_views());
  for (std::size_t i = 0; i < map.views; ++i) {
    SGS_ASSIGN_OR_RETURN(const alignment::KnownView view, map.view(i));
    know(i, alignment::known_view_time_s(i), view);
    drawn.know(view);
    earlier_.views.push_back({map.session_of[i], view.timestamp_s});
    times_s.push_back(view.timestamp_s);
    RgbdFrame frame = resampled(view.frame, camera_);
    frame.index = alignment::known_view_index(i);
    frame.timestamp_s = alignment::known_view_time_s(i);
    std::optional<graph::UncertainPose> way;
    if (ways[i] != nullptr) way = {ways[i]->T_from_to, ways[i]->information.inverse()};
    closer.know(view, frame, revision_, way);
    const SE3& T_map_camera = map.T_map_camera.empty() ? view.T_world_camera : map.T_map_camera[i];
    keyframes.push_back({views_->keep(frame, revision_.calibration), view.motion.lag(),
                         T_map_camera, view.T_world_camera});
  }
  for (const graph::Edge& e : map.edges) {
    if (ways[static_cast<std::size_t>(e.to)] != &e) closer.know(e);
  }
  worker_->know(map.gaussians->gaussians, views_of_gaussians(map, times_s), keyframes, revision_);
  know_drawn(drawn);
  earlier_.sessions = map.sessions;
  earlier_.births = map.births;
  return {};
}

Status Session::localise_in(const KnownMap& map) {
  SGS_CHECK(map.gaussians != nullptr, "a map");
  SGS_CHECK(!loops_ && !calibrator_, "what is known stays where it is");
  second_look_.reset();
  SGS_RETURN_IF_ERROR(check_can_be_given_a_map());
  if (map.calibration) {
    revision_.calibration = std::make_shared<const DepthCalibration>(*map.calibration);
  }
  DrawnViews drawn(camera_, map.views, drawn_views());
  for (std::size_t i = 0; i < map.views; ++i) {
    SGS_ASSIGN_OR_RETURN(const alignment::KnownView view, map.view(i));
    know(i, view.timestamp_s, view);
    drawn.know(view);
  }
  if (map.views > 0) know_drawn(drawn);
  known_ = map.gaussians;
  return {};
}

const FrameRecord& Session::feed(const std::shared_ptr<const RgbdFrame>& raw) {
  SGS_CHECK(raw != nullptr, "feed() needs a frame");
  SGS_CHECK(raw->color.width() == camera_.width && raw->color.height() == camera_.height &&
                raw->depth.width() == camera_.width && raw->depth.height() == camera_.height,
            "frame size differs from the session's camera");
  SGS_CHECK(revision_.path.empty() || raw->index > revision_.path.back().frame,
            "frames come in the order of their indices");
  const double moved_m = revise_past();
  auto frame = without_movers(calibrated(raw), raw->still);
  const bool of_one_time = !tracker_->knows_depth_lag();
  registration::FrameMotion motion;
  if (of_one_time) {
    motion.velocity = last_velocity();
    motion.depth_delay_s = frame->depth_delay_s;
    frame = frame_of_one_time(frame, motion.lag());
  }
  const MapView view = wait_for_map();
  double cpu_ms = 0;
  tracker::TrackResult result = track(*frame, view.snapshot, cpu_ms);
  if (of_one_time) result.motion = motion;
  revision_.path.append({frame->index, frame->timestamp_s, result.T_odom_camera});
  FrameRecord record = make_record(*frame, view, result);
  record.correction_m = moved_m;
  record.track_ms = cpu_ms;
  if (tracker_->knows_depth_lag() && result.status != tracker::TrackingStatus::kLost) {
    record.diagnostics.depth_delay_s = result.motion.depth_delay_s - raw->depth_delay_s;
  }
  record.fingerprint = fingerprint(*raw);  // as the recording has it
  // What moves belongs neither to the map nor to a place that is known again.
  const auto still = in_both(raw->still, result.still);
  if (still) record.movers = mover_blocks(*still);
  const auto scene = without_movers(frame, result.still);
  ask_back_ends({frame == raw ? scene : without_movers(raw, still), frame, scene}, result, record);
  if (comes_as_before(record, depth_fingerprint(*raw))) hand_to_mapper(scene, result, record);
  report_loss(record);
  compare_metres(*scene, record);
  const FrameRecord& added = records_.add(std::move(record));
  if (on_frame_) on_frame_(added);
  return added;
}

// Before a frame is tracked: from the next revision on go the tracker and, with the jobs of this
// frame, map and back ends. One at a time: what another back end has found waits for the next
// frame. Returns by how much the camera moves where it moves most.
double Session::revise_past() {
  std::optional<history::Update> update;
  for (BackEndWorker* worker : {second_look_.get(), loops_.get(), calibrator_.get()}) {
    if (worker == nullptr) continue;
    worker->wait_before(frames_fed_);
    if (!update) update = worker->take_before(frames_fed_);
  }
  if (!update) return 0;
  const ScopedTimer timer(track_times_, "revise the past");
  revise(*update);
  return update->poses.largest_translation_m();
}

std::shared_ptr<const RgbdFrame> Session::calibrated(
    const std::shared_ptr<const RgbdFrame>& raw) const {
  const auto& calibration = revision_.calibration;
  if (!calibration) return raw;
  auto frame = copy_to_change(raw);
  frame->depth = calibration->apply(raw->depth);
  frame->depth_delay_s += calibration->delay_s;  // beside what its stamp says
  return frame;
}

// Of the camera from the last tracked frame but one to the last, twist per second.
Vector6d Session::last_velocity() const {
  constexpr double kLongest_s = 0.25;
  const auto& past = records_.briefs();
  if (past.size() < 2) return Vector6d::Zero();
  const FrameBrief &last = past.back(), &before = past[past.size() - 2];
  const double dt = last.timestamp_s - before.timestamp_s;
  if (!last.tracked || !before.tracked || !(dt > 0) || dt > kLongest_s) return Vector6d::Zero();
  const history::Path& path = revision_.path;
  return (path.at(before.index).inverse() * path.at(last.index)).log() / dt;
}

void Session::ask_back_ends(const Forms& frame, const tracker::TrackResult& result,
                            FrameRecord& record) {
  if (loops_) {
    record.loops = loops_->found_before(frames_fed_);
    loops_->submit(frame.scene, result, revision_);
  }
  if (calibrator_) {
    record.calibrations = calibrator_->found_before(frames_fed_);
    calibrator_->submit(frame.raw, result, revision_);
  }
  if (second_look_) second_look_->submit(frame.tracked, result, revision_);
}

void Session::revise(const history::Update& update) {
  revision_ = history::revised(revision_, update);
  const MovedPose& newest = update.poses.poses().back();
  log().info("{}: the past moves by up to {:.1f} cm, the camera by {:.1f} cm",
             update.calibration ? "depth is calibrated" : "the path is corrected",
             100 * update.poses.largest_translation_m(),
             100 * (newest.after.t - newest.before.t).norm());
}

MapView Session::wait_for_map() {
  if (known_) return {known_, static_cast<std::int64_t>(known_->gaussians.size()), 0};
  const ScopedTimer timer(track_times_, "wait for map");
  return worker_->view_for(frames_fed_);
}

std::unique_ptr<ThreadPool::Recess> Session::take_core() {
  const double since_s = wall_time_s();
  auto recess = worker_->leave_core();
  if (recess) track_times_.add_interval("wait for core", since_s, 1e3 * (wall_time_s() - since_s));
  return recess;
}

tracker::TrackResult Session::track(const RgbdFrame& frame, const map::SnapshotPtr& snapshot,
                                    double& cpu_ms) {
  const auto recess = take_core();
  const TrackStopwatch stopwatch;
  tracker::TrackResult result = tracker_->track(frame, revision_, snapshot);
  cpu_ms = stopwatch.note(result.diagnostics, track_times_);
  return result;
}

FrameRecord Session::make_record(const RgbdFrame& frame, const MapView& view,
                                 const tracker::TrackResult& result) const {
  FrameRecord record;
  record.index = frame.index;
  record.timestamp_s = frame.timestamp_s;
  record.heldout = is_heldout(frame.index, config_.heldout_interval);
  record.gaussians = view.gaussians;
  record.iterations = view.iterations;
  record.T_online_camera = result.T_odom_camera;
  record.status = result.status;
  record.lost_reason = result.lost_reason;
  record.tracking_keyframe = result.keyframe;
  record.diagnostics = result.diagnostics;
  return record;
}

// How many frames of a video a frame stands for, its own and those of the gap before it.
double Session::video_frames(const FrameRecord& record) const {
  if (tracker_->needs_video() || record.status == tracker::TrackingStatus::kLost) return 1;
  const auto& past = records_.briefs();
  const auto last =
      std::find_if(past.rbegin(), past.rend(), [](const FrameBrief& f) { return f.tracked; });
  if (last == past.rend()) return 1;
  const history::Path& path = revision_.path;
  return video_frames_between({last->timestamp_s, path.at(last->index)},
                              {record.timestamp_s, path.at(record.index)}, config_.max_gap_frames);
}

bool Session::wants_mapping_keyframe(const FrameRecord& record) const {
  if (record.heldout || record.status == tracker::TrackingStatus::kLost) return false;
  return keyframe_pending_ || last_mapping_keyframe_ < 0 ||
         video_time_ - last_mapping_keyframe_ >= config_.keyframe_interval;
}

void Session::hand_to_mapper(const std::shared_ptr<const RgbdFrame>& frame,
                             const tracker::TrackResult& result, FrameRecord& record) {
  if (!found_at_ && record.status != tracker::TrackingStatus::kLost) found_at_ = record.index;
  if (known_) {
    ++frames_fed_;
    return;
  }
  keyframe_pending_ = keyframe_pending_ || record.tracking_keyframe;
  MapJob job;
  job.frames = has_place() ? video_frames(record) : 0;
  // Where it stands on the video's clock: as far behind the frame before as the gap is long.
  if (frames_fed_ > 0) video_time_ += job.frames;
  if (wants_mapping_keyframe(record)) {
    record.mapping_keyframe = true;
    last_mapping_keyframe_ = video_time_;
    keyframe_pending_ = false;
    job.lag = result.motion.lag();
    job.keyframe = tracker_->knows_depth_lag() ? frame_of_one_time(frame, job.lag) : frame;
  }
  job.revision = revision_;
  worker_->submit(std::move(job));
  ++frames_fed_;
}

// Notes what became of an item; false where that is not what became of it before (replay).
bool Session::comes_as_before(const FrameRecord& record, std::int64_t depth_print) {
  const std::uint64_t hash = hash_of(record, depth_print);
  if (left_to_replay() == 0) {
    hashes_.push_back(hash);
  } else if (hash != hashes_[records_.size()] && !differs_at_) {
    differs_at_ = records_.size();
  }
  return !differs_at_;
}

std::future<std::string> Session::save() {
  SGS_CHECK(can_be_saved() && left_to_replay() == 0, "nothing that could be gone on from");
  ArchiveWriter own;
  own(hashes_);
  return worker_->save(own.take());
}

Status Session::restore(std::string_view state) {
  SGS_CHECK(can_be_saved() && records_.empty(), "to be called before the first frame");
  ArchiveReader archive(state);
  archive(hashes_);
  SGS_RETURN_IF_ERROR(worker_->restore(archive));
  const auto jobs = static_cast<std::size_t>(worker_->left_to_replay());
  if (archive.complete() && jobs <= hashes_.size()) return {};
  return fail(ErrorCode::kInvalidFormat, "the state of the frames makes no sense");
}

// One line when tracking is lost and one when it is back, however long that takes.
void Session::report_loss(const FrameRecord& record) {
  if (record.status != tracker::TrackingStatus::kLost) {
    if (frames_lost_ > 0) {
      log().info("frame {} ({:.3f} s): tracking is back after {} lost frames", record.index,
                 record.timestamp_s, frames_lost_);
    }
    frames_lost_ = 0;
  } else if (frames_lost_++ == 0) {
    log().warn("frame {} ({:.3f} s): tracking is lost. {}", record.index, record.timestamp_s,
               alignment::explain(record.lost_reason));
  }
}

void Session::feed_bad(std::int64_t index, double timestamp_s, const std::string& reason) {
  FrameRecord record;
  record.index = index;
  record.timestamp_s = timestamp_s;
  record.bad = true;
  record.bad_reason = reason;
  comes_as_before(record, 0);
  records_.add(std::move(record));
}

void Session::finish() {
  // What fails here must not cost the map.
  std::exception_ptr failure;
  try {
    for (BackEndWorker* back_end : {second_look_.get(), loops_.get(), calibrator_.get()}) {
      if (back_end == nullptr) continue;
      if (const auto update = back_end->finish(revision_)) revise(*update);
    }
    MapJob last;
    last.revision = revision_;
    last.catches_up = true;
    worker_->submit(std::move(last));
  } catch (...) {
    failure = std::current_exception();
  }
  worker_->finish();
  if (failure) std::rethrow_exception(failure);
}

std::optional<loops::LoopCounts> Session::loop_counts() const {
  return loop_back_end_ ? std::optional(loop_back_end_->closer().counts()) : std::nullopt;
}

const loops::PoseGraph* Session::pose_graph() const {
  return loop_back_end_ ? &loop_back_end_->closer().pose_graph() : nullptr;
}

map::SnapshotPtr Session::snapshot() { return known_ ? known_ : worker_->newest_snapshot(); }

// Before the camera has found itself in a map that it was given it could be anywhere; and that
// map's own views are no frames of this session.
bool Session::has_place(std::int64_t frame) const {
  return place_search() == nullptr || (found_at_ && frame >= *found_at_);
}

std::uint64_t Session::fern_seed() const {
  return loop_back_end_ != nullptr ? loop_back_end_->closer().fern_seed() : config_.seed;
}

Trajectory Session::trajectory() const {
  // Refined poses make better pictures, not a truer path (docs/decisions/0042-views.md), unless the
  // path was made in the refined map, or refining it was asked for.
  const PoseCorrection to_world = tracker_->path_follows_refinement()
                                      ? odom_to_world(worker_->keyframes(), revision_.path)
                                      : PoseCorrection();
  std::vector<StampedPose> poses;
  for (std::size_t k = 0; k < revision_.path.size(); ++k) {
    const history::Path::Entry& f = revision_.path[k];
    if (!has_place(f.frame)) continue;
    poses.push_back({f.timestamp_s, to_world.corrected(f.T_odom_camera, f.timestamp_s)});
  }
  return Trajectory(std::move(poses));
}

Trajectory Session::trajectory_so_far() const {
  std::vector<StampedPose> poses;
  for (std::size_t k = 0; k < revision_.path.size(); ++k) {
    const history::Path::Entry& f = revision_.path[k];
    if (has_place(f.frame)) poses.push_back({f.timestamp_s, f.T_odom_camera});
  }
  return Trajectory(std::move(poses));
}

Trajectory Session::online_trajectory() const {
  std::vector<StampedPose> poses;
  for (const FrameRecord& r : records_.all()) {
    if (!r.bad && has_place(r.index)) poses.push_back({r.timestamp_s, r.T_online_camera});
  }
  return Trajectory(std::move(poses));
}

Trajectory Session::keyframe_trajectory() const {
  std::vector<StampedPose> poses;
  for (const KeyframePose& k : keyframes()) {
    poses.push_back({k.timestamp_s, k.T_world_camera});
  }
  return Trajectory(std::move(poses));
}

StageTimes Session::times() const {
  StageTimes all = track_times_;
  all.merge(worker_->times());
  return all;
}

}  // namespace sgs::slam
