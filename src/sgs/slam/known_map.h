// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "sgs/camera/depth_calibration.h"
#include "sgs/core/error.h"
#include "sgs/core/thread_pool.h"
#include "sgs/geometry/trajectory.h"
#include "sgs/map/gaussian.h"
#include "sgs/tracker/known_view.h"

namespace sgs::slam {

class Session;  // slam/session.h

/// A finished map that a camera is to find itself in.
struct KnownMap {
  map::SnapshotPtr gaussians;
  std::size_t views = 0;
  /// The view of that number; asked for once each, in order.
  std::function<Result<tracker::KnownView>(std::size_t)> view;
  /// Of the depths of the camera that comes, where it is the map's own.
  std::optional<DepthCalibration> calibration;
};

/// When each Gaussian of a snapshot was born: the time of the keyframe that inserted it; not a
/// number where that is not known. To be called after Session::finish().
std::vector<double> births_of(const Session& session, const map::Snapshot& snapshot);

/// How many views of a finished session others can find themselves by: none without a search for
/// loops, which keeps them.
std::size_t known_views(const Session& session);
/// Such a view, at the pose that the session's trajectory ends with; `path` is that trajectory.
tracker::KnownView known_view(const Session& session, const Trajectory& path, std::size_t number);
/// Poses of all of them that agree with each other (loops::agreeing_poses()).
std::vector<SE3> agreeing_poses(const Session& session, const Trajectory& path, ThreadPool& pool);

}  // namespace sgs::slam
