// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/map_worker.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sgs::slam {
namespace {

constexpr int kHelperNice = 19;
constexpr int kIterationsPerSnapshot = 20;  // where nobody waits for them

}  // namespace

MapWorker::MapWorker(const SessionConfig& config, const PinholeCamera& camera,
                     bool tracker_follows_map, WorkerMode mode, int threads,
                     std::shared_ptr<history::ViewStore> views)
    : config_(config),
      tracker_follows_map_(tracker_follows_map),
      mode_(mode),
      // Beside a tracker all but one of the mapper's threads take what the tracker leaves.
      pool_(threads, mode == WorkerMode::kInline ? 0 : kHelperNice),
      mapper_(config.mapper, camera, config.seed, &pool_, std::move(views)),
      worker_(mode, tasks()) {}

LaggedWorker<MapWorker::Order>::Tasks MapWorker::tasks() {
  LaggedWorker<Order>::Tasks tasks;
  tasks.work = [this](Order& order) { process(order); };
  tasks.publish = [this](const Order* order) { show(order); };
  // A live mapper with at least one keyframe of its own always has something to do.
  tasks.has_idle_work = [this] { return keyframes_.size() > known_keyframes_; };
  tasks.idle_work = [this] { iterate_live(); };
  return tasks;
}

// The thread has nothing to do before the first job, live before it can ask for the lock: its state
// is free to be set here.
void MapWorker::know(const std::vector<map::Gaussian>& gaussians,
                     const std::vector<std::int32_t>& view_of,
                     const std::vector<mapper::KnownKeyframe>& views,
                     const history::Revision& revision) {
  SGS_CHECK(submitted_ == 0 && keyframes_.empty(), "to be called before anything else");
  const auto lock = worker_.lock();
  mapper_.restore_calibration(revision.calibration);
  mapper_.know(gaussians, view_of, views);
  revision_ = revision;
  submitted_revision_ = revision.number();
  for (const mapper::KnownKeyframe& view : views) {
    keyframes_.push_back({view.view->index(), view.view->timestamp_s(), view.T_world_camera});
  }
  known_keyframes_ = keyframes_.size();
  publish();
  live_view_ = newest_;
}

// Both worlds move alike: what refinement has found stays.
void MapWorker::follow(const history::Revision& revision) {
  const history::Revision before = std::exchange(revision_, revision);
  if (before.calibration != revision.calibration) {
    keyframes_.empty() ? mapper_.restore_calibration(revision.calibration)
                       : mapper_.change_depth(revision.calibration);
  }
  if (before.number() == revision.number()) return;
  std::vector<SE3> moves;
  moves.reserve(keyframes_.size());
  for (const KeyframePose& k : keyframes_) {
    moves.push_back(revision.path.at(k.frame_index) * before.path.at(k.frame_index).inverse());
  }
  mapper_.move_keyframes(moves);
  revised_at_ = mapper_.iterations();
  publish();
}

// The newest one; where there are only views of a map that is gone on with, the nearest of these.
const KeyframePose& MapWorker::keyframe_before(const SE3& T_odom_camera) const {
  if (keyframes_.size() > known_keyframes_) return keyframes_.back();
  const auto unlikeness = [&](const KeyframePose& k) {
    const SE3 T = revision_.path.at(k.frame_index).inverse() * T_odom_camera;
    return T.t.norm() + T.angle();  // a turn of 1 rad like a metre
  };
  return *std::min_element(keyframes_.begin(), keyframes_.end(), [&](const auto& a, const auto& b) {
    return unlikeness(a) < unlikeness(b);
  });
}

// What a revision has moved, and what it makes of depth, is learnt by as many steps as keyframes
// have while frames come; one of the last second leaves no time for that. Views of a map that is
// gone on with have had their steps in its old place, and new keyframes came before them: they get
// more, in all no more than the session has made.
void MapWorker::catch_up() {
  constexpr double kTurnsOfKnown = 8;
  if (revised_at_ < 0) return;
  const double a_turn = config_.mapper.iterations_per_frame;
  const auto known = static_cast<double>(known_keyframes_);
  const double wanted =
      a_turn * (static_cast<double>(keyframes_.size()) - known) +
      std::min(a_turn * kTurnsOfKnown * known, static_cast<double>(mapper_.iterations()));
  const std::int64_t made = mapper_.iterations() - revised_at_;
  for (std::int64_t left = std::llround(wanted) - made; left > 0; left -= kIterationsPerSnapshot) {
    mapper_.iterate(static_cast<int>(std::min<std::int64_t>(left, kIterationsPerSnapshot)));
    publish();
  }
}

void MapWorker::process(const MapJob& job) {
  follow(job.revision);
  if (job.catches_up) return catch_up();
  if (job.keyframe) {
    const SE3& T_odom_camera = revision_.path.at(job.keyframe->index);
    KeyframePose keyframe{job.keyframe->index, job.keyframe->timestamp_s, T_odom_camera};
    // A tracker with a world of its own does not notice that keyframes move; the newest keyframe's
    // correction carries its poses into the refined map.
    if (!tracker_follows_map_ && !keyframes_.empty()) {
      keyframe.T_world_camera =
          T_world_odom(keyframe_before(T_odom_camera), revision_.path) * T_odom_camera;
    }
    if (mapper_.add_keyframe(job.keyframe, keyframe.T_world_camera, T_odom_camera, job.lag) >= 0) {
      keyframes_.push_back(keyframe);
    }
  }
  if (mode_ != WorkerMode::kLive) {
    budget_ += config_.mapper.iterations_per_frame * job.frames;
    const int count = static_cast<int>(budget_);
    budget_ -= count;
    mapper_.iterate(count);
  }
  if (job.keyframe || ++jobs_since_snapshot_ >= config_.snapshot_interval) publish();
}

void MapWorker::publish() {
  jobs_since_snapshot_ = 0;
  newest_.snapshot = mapper_.snapshot();
  newest_.gaussians = static_cast<std::int64_t>(newest_.snapshot->gaussians.size());
  newest_.iterations = mapper_.iterations();
  const auto& refined = newest_.snapshot->T_world_keyframe;
  for (std::size_t i = 0; i < std::min(refined.size(), keyframes_.size()); ++i) {
    keyframes_[i].T_world_camera = refined[i];
  }
}

// A state that there is no memory for is the concern of who asked for it.
void MapWorker::process(Order& order) {
  if (!order.state) return process(order.job);
  try {
    order.state->set_value(state(std::move(order.before)));
  } catch (...) {
    order.state->set_exception(std::current_exception());
  }
}

void MapWorker::iterate_live() {
  mapper_.iterate(1);
  if (++live_iterations_ % kIterationsPerSnapshot == 0) publish();
}

// What is there counts now; called under the lock.
void MapWorker::show(const Order* order) {
  live_view_ = newest_;
  const bool frame_is_done = order != nullptr && !order->state;
  if (!frame_is_done || mode_ == WorkerMode::kLive) return;
  sizes_.push_back({newest_.gaussians, newest_.iterations});
  views_.push_back(newest_);
  ++jobs_done_;
}

void MapWorker::submit(MapJob job) {
  if (left_to_replay() > 0) return replay(job);
  ++submitted_;
  worker_.rethrow_failure();
  const int number = job.revision.number();
  const bool is_revised = std::exchange(submitted_revision_, number) != number;
  const bool is_work = job.keyframe || is_revised || job.catches_up;
  if (mode_ == WorkerMode::kLive && !is_work) return;
  worker_.submit({.job = std::move(job)});
}

std::string MapWorker::state(std::string before) {
  ArchiveWriter bytes(std::move(before));
  mapper_.save(bytes);
  archive(bytes);
  return bytes.take();
}

std::future<std::string> MapWorker::save(std::string before) {
  SGS_CHECK(mode_ != WorkerMode::kLive && left_to_replay() <= 0,
            "nothing that could be gone on from");
  Order order{{}, std::promise<std::string>(), std::move(before)};
  auto future = order.state->get_future();
  if (!worker_.failed()) worker_.submit(std::move(order));
  return future;
}

// The thread has nothing to do before the replay is over, so its state is free to be set here.
Status MapWorker::restore(ArchiveReader& bytes) {
  SGS_CHECK(mode_ != WorkerMode::kLive && submitted_ == 0, "to be called before anything else");
  SGS_RETURN_IF_ERROR(mapper_.restore(bytes));
  archive(bytes);
  const bool makes_sense =
      budget_ >= 0 && budget_ < 1 && revised_at_ >= -1 && revised_at_ <= mapper_.iterations();
  if (bytes.failed() || !makes_sense) {
    return fail(ErrorCode::kInvalidFormat, "the state of the mapping makes no sense");
  }
  const auto lock = worker_.lock();
  for (const ViewSize& size : sizes_) {
    newest_ = {nullptr, size.gaussians, size.iterations};
    views_.push_back(newest_);
  }
  jobs_done_ = replayed_until_ = std::ssize(sizes_);
  return {};
}

void MapWorker::replay(const MapJob& job) {
  ++submitted_;
  const history::Revision before = std::exchange(revision_, job.revision);
  if (before.calibration != revision_.calibration) {
    mapper_.restore_calibration(revision_.calibration);
  }
  if (job.keyframe && mapper_.awaited_frame() == job.keyframe->index) {
    mapper_.restore_keyframe(*job.keyframe, job.lag);
  }
  if (left_to_replay() > 0) return;
  SGS_CHECK(!mapper_.awaited_frame(), "not all keyframes came again");
  // For those who watch; which map a frame was tracked against is another matter.
  if (newest_.gaussians > 0) newest_.snapshot = mapper_.snapshot();
  const auto lock = worker_.lock();
  live_view_ = newest_;
}

MapView MapWorker::view_for(std::int64_t n) {
  if (mode_ == WorkerMode::kLive) {
    const auto lock = worker_.lock();
    return live_view_;
  }
  const std::int64_t wanted = n - config_.snapshot_lag;
  if (wanted < 0) return {};
  const auto lock = worker_.wait([&] { return jobs_done_ > wanted; });
  while (first_view_ < wanted) {
    views_.pop_front();
    ++first_view_;
  }
  return views_.front();
}

std::unique_ptr<ThreadPool::Recess> MapWorker::leave_core() {
  const auto cores = static_cast<int>(std::thread::hardware_concurrency());
  if (mode_ == WorkerMode::kInline || pool_.threads() < cores) return nullptr;
  return std::make_unique<ThreadPool::Recess>(pool_);
}

void MapWorker::finish() {
  worker_.finish();
  // A mapper that failed in the middle of a step is not asked again: what it published last stays.
  final_snapshot_ = newest_.snapshot;
  if (!worker_.failed()) {
    publish();
    final_snapshot_ = newest_.snapshot;
  }
  {
    const auto lock = worker_.lock();
    live_view_ = newest_;
  }
  if (mode_ != WorkerMode::kInline) worker_.rethrow_failure();
}

map::SnapshotPtr MapWorker::newest_snapshot() const {
  const auto lock = worker_.lock();
  return live_view_.snapshot;
}

}  // namespace sgs::slam
