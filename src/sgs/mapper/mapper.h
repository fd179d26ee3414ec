// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "sgs/camera/rgbd_frame.h"
#include "sgs/core/archive.h"
#include "sgs/core/error.h"
#include "sgs/core/stopwatch.h"
#include "sgs/core/thread_pool.h"
#include "sgs/history/view_store.h"
#include "sgs/map/gaussian.h"
#include "sgs/mapper/mapper_config.h"

namespace sgs::mapper {

/// What one call of iterate() did.
struct IterationReport {
  int iterations = 0;
  double loss = 0;  ///< mean loss per pixel of the last iteration's view
};

/// A view of a finished map that is learned from again.
struct KnownKeyframe {
  /// In grey, of the mapper's camera; its index is that of its pose in the path.
  history::StoredViewPtr view;
  Vector6d lag = Vector6d::Zero();  ///< of the camera, from its colour to its depth
  SE3 T_world_camera;               ///< refined
  SE3 T_odom_camera;                ///< where the tracker holds it to be
};

/// Optimises the Gaussian map from keyframes with given poses. Synchronous and deterministic for a
/// given sequence of calls and seed, for any number of threads in the pool. Not thread-safe; what
/// snapshot() returns is immutable and may be read from any thread.
class Mapper {
 public:
  /// `pool` may be null (one thread) and must outlive the mapper. `views`: where frames are
  /// remembered; null: in a store of its own.
  Mapper(const MapperConfig& config, const PinholeCamera& camera, std::uint64_t seed,
         ThreadPool* pool, std::shared_ptr<history::ViewStore> views = nullptr);
  ~Mapper();

  /// Adds a keyframe at `T_world_camera` and inserts Gaussians where the map does not explain it.
  /// Refinement of its pose is pulled towards `T_odom_camera`, where the tracker holds it to be
  /// (by default the same): the map alone would let the poses of a long run drift.
  /// `lag`: motion of the camera from the colour of the frame as it was delivered to its depth,
  /// which `frame` has been corrected for, as by the calibration in force (change_depth()).
  /// Returns the keyframe's index, or -1 when the frame cannot be used (a pose that is not finite,
  /// hardly any depth): nothing changes then.
  int add_keyframe(const std::shared_ptr<const RgbdFrame>& frame, const SE3& T_world_camera);
  int add_keyframe(const std::shared_ptr<const RgbdFrame>& frame, const SE3& T_world_camera,
                   const SE3& T_odom_camera, const Vector6d& lag = Vector6d::Zero());
  /// Goes on with a finished map, before the first keyframe. Its views become the first keyframes,
  /// in order, each of a place that the map shows: nothing is inserted for them, and they are
  /// learned from, so that what they show is not forgotten. Gaussian i hangs on view `view_of[i]`.
  /// Its id is i.
  void know(const std::vector<map::Gaussian>& gaussians, const std::vector<std::int32_t>& view_of,
            const std::vector<KnownKeyframe>& views);
  /// Moves keyframes in the world, all that hangs on them with them: `moves[k]` is that of keyframe
  /// k, one for each. Learning goes on from there.
  void move_keyframes(const std::vector<SE3>& moves);
  /// Depth is known better now: keyframes and what they have inserted follow.
  void change_depth(const history::CalibrationPtr& calibration);
  /// Runs `count` optimisation steps over the keyframes; nothing happens without keyframes.
  IterationReport iterate(int count);

  /// Everything that later steps depend on, but for the keyframes' pictures.
  void save(ArchiveWriter& archive);
  /// Goes on from what save() wrote for the same configuration, camera and seed; this mapper must
  /// be new. The frames of the keyframes have to come again (restore_keyframe()) before anything
  /// else is asked of it. Fails where the bytes are not such a state; the mapper is of no use then.
  Status restore(ArchiveReader& archive);
  /// Index of the frame that restore_keyframe() needs next; empty when all are there.
  std::optional<std::int64_t> awaited_frame() const;
  /// The frame that awaited_frame() named, and its lag.
  void restore_keyframe(const RgbdFrame& frame, const Vector6d& lag = Vector6d::Zero());
  /// A change_depth() from before save(), between the keyframes where it was: what came of it is
  /// restored, but for the pictures. Also before the first keyframe: what is in force from then on.
  void restore_calibration(const history::CalibrationPtr& calibration);

  /// The current averaged map; cheap when nothing changed since the last call.
  map::SnapshotPtr snapshot();
  /// Number of Gaussians now.
  std::size_t size() const;
  /// Total optimisation steps so far.
  std::int64_t iterations() const;
  /// Durations of insertion, iteration, pruning and snapshots.
  const StageTimes& times() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sgs::mapper
