// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sgs/camera/rgbd_frame.h"
#include "sgs/core/error.h"
#include "sgs/core/stopwatch.h"
#include "sgs/geometry/trajectory.h"
#include "sgs/history/revision.h"
#include "sgs/history/view_store.h"
#include "sgs/loops/loop_closer.h"
#include "sgs/map/gaussian.h"
#include "sgs/slam/back_end_worker.h"
#include "sgs/slam/drawn_views.h"
#include "sgs/slam/frame_record.h"
#include "sgs/slam/keyframe_pose.h"
#include "sgs/slam/known_map.h"
#include "sgs/slam/map_worker.h"
#include "sgs/slam/metre_check.h"
#include "sgs/slam/record_log.h"
#include "sgs/slam/session_config.h"
#include "sgs/tracker/tracker.h"

namespace sgs::slam {

/// How a session uses time and threads; never changes an offline result.
struct SessionOptions {
  int threads = 2;    ///< 1: everything in feed(); 2 and more: the mapper has its own threads
  bool live = false;  ///< map as long as there is time instead of a fixed budget per frame
  SE3 T_world_first;  ///< pose given to the first frame
};

class LoopBackEnd;

/// What a session remembers of those whose map it goes on with.
struct EarlierSessions {
  std::uint16_t sessions = 0;
  std::vector<Birth> births;  ///< of the Gaussians, by their ids
  std::vector<Birth> views;   ///< when they were seen

  /// When the view was seen that stands in the path as `frame`; null for frames of this session.
  const Birth* view(std::int64_t frame) const {
    const std::int64_t k = frame - alignment::known_view_index(0);
    return k >= 0 && k < std::ssize(views) ? &views[static_cast<std::size_t>(k)] : nullptr;
  }
};

/// SLAM from frames to trajectory and map: tracker and mapper side by side, meeting only in
/// immutable snapshots. feed() and finish() belong to one thread; snapshot() may be called from
/// any.
///
///     auto session = Session::create(config, camera, {});
///     while (source.next(*frame, error) == FrameRead::kOk) (*session)->feed(frame);
///     (*session)->finish();
class Session {
 public:
  static Result<std::unique_ptr<Session>> create(const SessionConfig& config,
                                                 const PinholeCamera& camera,
                                                 const SessionOptions& options);
  /// The same with a tracker of the caller's own; `config.tracker` and options.T_world_first are
  /// not read then.
  static Result<std::unique_ptr<Session>> create(const SessionConfig& config,
                                                 const PinholeCamera& camera,
                                                 const SessionOptions& options,
                                                 std::unique_ptr<tracker::Tracker> tracker);
  ~Session();

  /// Before the first frame: the camera is somewhere in this map and has to find itself there.
  /// Nothing is learned: poses are in the map's world, and its Gaussians are those of the session.
  /// Frames before it is found are lost and have no place in trajectory(). Fails where the tracker
  /// cannot be given a map, or where a view cannot be had; needs a configuration without loops and
  /// online calibration, which would move what is known.
  Status localise_in(const KnownMap& map);
  /// Before the first frame: the camera is somewhere in this map and has to find itself there, and
  /// then goes on with it. Until it is found, nothing is learned; from then on this is a session
  /// like any other, in the map's world: the Gaussians go on being learned, views and loops of all
  /// sessions are one graph. Fails where the tracker cannot be given a map, where a view cannot be
  /// had and where no loops are looked for; needs a configuration without online calibration: the
  /// metre is that of the map.
  Status go_on_with(const KnownMap& map);
  /// Whether the camera is where it knows to be: always, but for maps of others before it is found.
  bool has_place() const { return place_search() == nullptr || place_search()->found; }
  /// What there was before this session; empty where it began a map of its own.
  const EarlierSessions& earlier() const { return earlier_; }
  /// Depth of this camera over that of the map it was given, where a second of tracking in it could
  /// tell.
  std::optional<double> metre_ratio() const { return metre_.ratio(); }
  /// How far it has come; null in a session with a map of its own.
  const tracker::PlaceSearch* place_search() const { return tracker_->place_search(); }

  /// Tracks one frame and hands it to the mapper; offline it waits when the mapper is more than
  /// snapshot_lag frames behind. The record stays valid until the next frame.
  const FrameRecord& feed(const std::shared_ptr<const RgbdFrame>& frame);
  /// Event: called in feed(), on its thread, after each frame has been tracked and handed on.
  using FrameEvent = std::function<void(const FrameRecord&)>;
  void on_frame(FrameEvent event) { on_frame_ = std::move(event); }
  /// Notes a frame that could not be read.
  void feed_bad(std::int64_t index, double timestamp_s, const std::string& reason);
  /// Waits for the mapper to complete what was fed. Call once, then read the results below.
  void finish();

  /// Whether save() works: not live, where everything depends on time, and not with a tracker that
  /// follows the map, and not where there was a map before.
  bool can_be_saved() const {
    return !live_ && !tracker_->follows_map() && place_search() == nullptr;
  }
  /// What restore() needs, behind the frames fed so far; ready as soon as the mapper is there, and
  /// an exception where it fails before that or where the memory does not suffice.
  std::future<std::string> save();
  /// Goes on from what save() gave for the same configuration and camera, with any number of
  /// threads; to be called before the first frame. The items fed before that have to be fed again:
  /// the tracker and the search for loops do their work anew, the mapper does not, so this takes a
  /// fraction of the time. From then on everything is as it would have been, to the bit. Fails
  /// where `state` is not such a state; the session is of no use then.
  Status restore(std::string_view state);
  /// How many items have to be fed again.
  std::size_t left_to_replay() const {
    return hashes_.size() > records_.size() ? hashes_.size() - records_.size() : 0;
  }
  /// Position of the first item that came to something else than before: the input has changed, or
  /// the processor. Empty where all is well.
  std::optional<std::size_t> replay_differs_at() const { return differs_at_; }

  /// Every value as used, which may differ from what create() was given (effective()).
  const SessionConfig& config() const { return config_; }
  const tracker::Tracker& tracker() const { return *tracker_; }
  /// Newest published map; null before the first keyframe.
  map::SnapshotPtr snapshot();
  /// The finished map (after finish()); null where no keyframe was mapped.
  map::SnapshotPtr final_snapshot() const { return known_ ? known_ : worker_->final_snapshot(); }
  const RecordLog& records() const { return records_; }
  /// What is believed of the past now: poses of all frames so far, after those of the map's views
  /// (alignment::known_view_index()) where the session was given one, and the calibration in force.
  const history::Revision& revision() const { return revision_; }
  /// Poses of all tracked frames, loops closed and depth calibrated (after finish()); frames that
  /// were lost carry the tracker's guess at their pose. Those of a tracker that follows the map,
  /// and given poses that are to be refined, are carried into the refined map.
  Trajectory trajectory() const;
  /// Poses of the frames so far as they are known now, on the thread of feed(); a path that follows
  /// the refined map is carried there by finish() only.
  Trajectory trajectory_so_far() const;
  /// Poses of all tracked frames as they were said when the frames came.
  Trajectory online_trajectory() const;
  /// Poses of the mapping keyframes as refined (after finish()): from there the map looks like
  /// their pictures.
  Trajectory keyframe_trajectory() const;
  std::span<const KeyframePose> keyframes() const {
    return std::span(worker_->keyframes()).subspan(earlier_.views.size());
  }
  /// Carries poses of the path to where the map looks like what was seen from them (after
  /// finish()).
  PoseCorrection odom_to_map() const { return odom_to_world(worker_->keyframes(), revision_.path); }
  /// Seed of the questions that the codes of nodes answer.
  std::uint64_t fern_seed() const;
  std::int64_t iterations() const { return worker_->iterations(); }
  /// What became of loops (after finish()); empty where none are looked for.
  std::optional<loops::LoopCounts> loop_counts() const;
  /// Edges of the pose graph that close loops, and its nodes (after finish()); null as above.
  const loops::PoseGraph* pose_graph() const;
  /// What was learned about the depth camera (docs/calibration.md); empty where nothing was.
  std::optional<DepthCalibration> calibration() const {
    return revision_.calibration ? std::optional(*revision_.calibration) : std::nullopt;
  }
  /// Seconds the mapper has been busy so far (any thread).
  double mapper_busy_s() const { return worker_->busy_s(); }
  /// Durations of tracking and mapping stages (after finish()).
  StageTimes times() const;

 private:
  Session(const SessionConfig& config, const PinholeCamera& camera, const SessionOptions& options,
          std::unique_ptr<tracker::Tracker> tracker);
  // The steps of a frame.
  double revise_past();
  void revise(const history::Update& update);
  std::shared_ptr<const RgbdFrame> calibrated(const std::shared_ptr<const RgbdFrame>& raw) const;
  Vector6d last_velocity() const;
  /// A frame as it was delivered but for what moves, as it was tracked, and without what moves.
  struct Forms {
    std::shared_ptr<const RgbdFrame> raw, tracked, scene;
  };
  void ask_back_ends(const Forms& frame, const tracker::TrackResult& result, FrameRecord& record);
  MapView wait_for_map();
  tracker::TrackResult track(const RgbdFrame& frame, const map::SnapshotPtr& snapshot,
                             double& cpu_ms);
  std::unique_ptr<ThreadPool::Recess> take_core();
  FrameRecord make_record(const RgbdFrame& frame, const MapView& view,
                          const tracker::TrackResult& result) const;
  double video_frames(const FrameRecord& record) const;
  bool wants_mapping_keyframe(const FrameRecord& record) const;
  void hand_to_mapper(const std::shared_ptr<const RgbdFrame>& frame,
                      const tracker::TrackResult& result, FrameRecord& record);
  void report_loss(const FrameRecord& record);
  void compare_metres(const RgbdFrame& frame, const FrameRecord& record);
  bool has_place(std::int64_t frame) const;
  Status check_can_be_given_a_map() const;
  void know(std::size_t number, double time_s, const alignment::KnownView& view);
  void know_drawn(const DrawnViews& drawn);
  std::size_t drawn_views() const {
    return static_cast<std::size_t>(config_.tracker.relocalisation.drawn_views);
  }
  bool comes_as_before(const FrameRecord& record, std::int64_t depth_print);

  SessionConfig config_;
  PinholeCamera camera_;
  bool live_;
  std::shared_ptr<history::ViewStore> views_;
  std::unique_ptr<tracker::Tracker> tracker_;
  std::unique_ptr<MapWorker> worker_;
  // Null where the tracker cannot be corrected, or shall not:
  std::unique_ptr<BackEndWorker> loops_, calibrator_, second_look_;
  LoopBackEnd* loop_back_end_ = nullptr;  // that of loops_
  history::Revision revision_;            // views of a map that is known come first
  map::SnapshotPtr known_;  // the map that stays as it is; null: it makes its own, or goes on
  EarlierSessions earlier_;
  MetreCheck metre_;
  std::optional<std::int64_t> found_at_;  // index of the first frame that was found there
  RecordLog records_;
  std::int64_t frames_fed_ = 0;
  double video_time_ = 0;              // frames fed, gaps of single views filled up
  double last_mapping_keyframe_ = -1;  // as video_time_
  bool keyframe_pending_ = true;       // a tracking keyframe waits for a frame the mapper may use
  std::int64_t frames_lost_ = 0;       // in a row, up to the last frame
  std::vector<std::uint64_t> hashes_;  // of each item; of all there were, in a replay
  std::optional<std::size_t> differs_at_;
  StageTimes track_times_{"tracking"};
  FrameEvent on_frame_;
  int threads_;
};

}  // namespace sgs::slam
