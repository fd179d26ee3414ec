// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "sgs/alignment/known_view.h"
#include "sgs/camera/depth_calibration.h"
#include "sgs/core/error.h"
#include "sgs/core/thread_pool.h"
#include "sgs/geometry/trajectory.h"
#include "sgs/graph/pose_graph.h"
#include "sgs/map/gaussian.h"

namespace sgs::slam {

class Session;  // slam/session.h

/// When something came into a map.
struct Birth {
  std::uint16_t session = 0;
  double time_s = 0;  ///< in that session; not a number where that is not known
};

/// A finished map that a camera is to find itself in.
struct KnownMap {
  map::SnapshotPtr gaussians;
  std::size_t views = 0;
  /// The view of that number; asked for once each, in order.
  std::function<Result<alignment::KnownView>(std::size_t)> view;
  /// Of the depths of the camera that comes, where it is the map's own.
  std::optional<DepthCalibration> calibration;

  // For a session that goes on with it (Session::go_on_with()):
  std::uint16_t sessions = 1;             ///< that were there before
  std::vector<Birth> births;              ///< of the Gaussians
  std::vector<std::uint16_t> session_of;  ///< of each view
  std::vector<SE3> T_map_camera;          ///< from where it looks like each view; may be empty
  std::vector<graph::Edge> edges;         ///< between views: ways from one to the next, loops
};

/// When each Gaussian of a snapshot was born: with the keyframe that inserted it. To be called
/// after Session::finish().
std::vector<Birth> births_of(const Session& session, const map::Snapshot& snapshot);

/// How many views of a finished session others can find themselves by: none without a search for
/// loops, which keeps them.
std::size_t known_views(const Session& session);
/// Such a view, at the pose that the session's trajectory ends with; `path` is that trajectory.
alignment::KnownView known_view(const Session& session, const Trajectory& path, std::size_t number);
/// Poses of all of them that agree with each other (loops::agreeing_poses()).
std::vector<SE3> agreeing_poses(const Session& session, const Trajectory& path, ThreadPool& pool);
/// From where the map looks like each of them.
std::vector<SE3> places_in_map(const Session& session);
/// In which session each of them was seen.
std::vector<std::uint16_t> sessions_of_views(const Session& session);
/// How surely they hang together, by their numbers: the way from each to the next, then loops; at
/// rest where the views are at `poses`.
std::vector<graph::Edge> edges_of_views(const Session& session, const std::vector<SE3>& poses);

/// The view that each Gaussian of a map is moved with: of those of its session the one next to its
/// birth in time.
std::vector<std::int32_t> views_of_gaussians(const KnownMap& map,
                                             const std::vector<double>& view_times_s);

}  // namespace sgs::slam
