// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sgs/core/thread_pool.h"
#include "sgs/history/revision.h"
#include "sgs/mapper/mapper.h"
#include "sgs/slam/keyframe_pose.h"
#include "sgs/slam/lagged_worker.h"
#include "sgs/slam/session_config.h"

namespace sgs::slam {

/// What the tracker hands to the mapper for every frame, in frame order.
struct MapJob {
  std::shared_ptr<const RgbdFrame> keyframe;  ///< null when the frame is no mapping keyframe
  history::Revision revision;                 ///< its path has the frame
  double frames = 1;  ///< of a video that this one stands for: its steps are so many times more
  /// After the last frame: the steps that keyframes have not had since the past was revised last.
  bool catches_up = false;
  Vector6d lag = Vector6d::Zero();  ///< of the keyframe's depth (Mapper::add_keyframe())
};

/// Map state that one frame may see.
struct MapView {
  map::SnapshotPtr snapshot;    ///< null before the first keyframe, and in a replay
  std::int64_t gaussians = 0;   ///< in it
  std::int64_t iterations = 0;  ///< mapping iterations behind it
};

/// Runs a Mapper beside the tracker. Offline every job gets the configured number of iterations and
/// frame t sees exactly the state after job t - snapshot_lag; live the mapper iterates whenever it
/// has no new keyframe and the tracker sees the newest snapshot.
class MapWorker {
 public:
  /// `views`: where frames are remembered; null: in a store of the mapper's own.
  MapWorker(const SessionConfig& config, const PinholeCamera& camera, bool tracker_follows_map,
            WorkerMode mode, int threads, std::shared_ptr<history::ViewStore> views = nullptr);

  /// Goes on with a finished map (Mapper::know()); to be called before anything else. The path of
  /// `revision` has the views.
  void know(const std::vector<map::Gaussian>& gaussians, const std::vector<std::int32_t>& view_of,
            const std::vector<mapper::KnownKeyframe>& views, const history::Revision& revision);
  /// Queues the job of the next frame; every frame has one. Rethrows a failure of the mapping
  /// thread.
  void submit(MapJob job);
  /// The state that frame number `n` is to be tracked against; waits for job n - snapshot_lag
  /// offline, never waits live.
  MapView view_for(std::int64_t n);
  /// While it lives the mapper leaves a core to the caller, where it would otherwise take them all.
  std::unique_ptr<ThreadPool::Recess> leave_core();
  /// Finishes all queued jobs and stops; the map is final afterwards.
  void finish();

  /// The state behind the jobs submitted so far, appended to `before`, as soon as they are done;
  /// not live. Where the mapper fails before that the promise is broken; where the memory does not
  /// suffice the future says so, and the worker goes on.
  std::future<std::string> save(std::string before);
  /// Goes on from what save() appended, for the same configuration; to be called before anything
  /// else, not live. The jobs that were behind it have to be submitted again (replay): they only
  /// bring back the pictures of keyframes, nothing is computed.
  Status restore(ArchiveReader& archive);
  /// How many jobs of the replay are still to come.
  std::int64_t left_to_replay() const { return replayed_until_ - submitted_; }

  /// Seconds this worker has been busy so far (thread-safe).
  double busy_s() const { return worker_.busy_s(); }
  /// Newest published snapshot (thread-safe); null before the first keyframe.
  map::SnapshotPtr newest_snapshot() const;
  /// Valid after finish().
  map::SnapshotPtr final_snapshot() const { return final_snapshot_; }
  const std::vector<KeyframePose>& keyframes() const { return keyframes_; }
  std::int64_t iterations() const { return mapper_.iterations(); }
  const StageTimes& times() const { return mapper_.times(); }

 private:
  /// What the thread is asked for: the job of a frame, or the state behind those before.
  struct Order {
    MapJob job;
    std::optional<std::promise<std::string>> state = {};
    std::string before = {};  // goes before the state
  };
  /// Sizes of the view behind a job.
  struct ViewSize {
    std::int64_t gaussians = 0, iterations = 0;

    template <class Archive>
    void archive(Archive& a) {
      a(gaussians, iterations);
    }
  };
  /// Everything but the mapper.
  template <class Archive>
  void archive(Archive& a) {
    a(keyframes_, budget_, jobs_since_snapshot_, revised_at_, sizes_);
  }

  LaggedWorker<Order>::Tasks tasks();
  void process(const MapJob& job);
  void catch_up();
  void process(Order& order);
  void iterate_live();
  void show(const Order* order);
  void replay(const MapJob& job);
  std::string state(std::string before);
  void follow(const history::Revision& revision);
  const KeyframePose& keyframe_before(const SE3& T_odom_camera) const;
  void publish();

  SessionConfig config_;
  bool tracker_follows_map_;
  WorkerMode mode_;
  ThreadPool pool_;
  mapper::Mapper mapper_;
  history::Revision revision_;  // of the last job
  std::vector<KeyframePose> keyframes_;
  std::size_t known_keyframes_ = 0;  // of them: views of a map that is gone on with
  double budget_ = 0;
  std::int64_t jobs_since_snapshot_ = 0;
  std::int64_t revised_at_ = -1;  // steps made when the past was revised last; -1: it was not
  MapView newest_;
  map::SnapshotPtr final_snapshot_;
  std::vector<ViewSize> sizes_;  // behind each job
  int live_iterations_ = 0;
  std::int64_t submitted_ = 0;  // jobs; of the submitting thread, and so is:
  std::int64_t replayed_until_ = 0;
  int submitted_revision_ = 0;  // its number
  // Guarded by the worker's lock:
  std::deque<MapView> views_;  // views_[i] is the state after job first_view_ + i
  std::int64_t first_view_ = 0;
  std::int64_t jobs_done_ = 0;
  MapView live_view_;

  LaggedWorker<Order> worker_;  // last: its thread uses all of the above
};

}  // namespace sgs::slam
