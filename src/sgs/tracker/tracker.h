// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "sgs/alignment/known_view.h"
#include "sgs/camera/rgbd_frame.h"
#include "sgs/core/error.h"
#include "sgs/history/revision.h"
#include "sgs/history/view_store.h"
#include "sgs/map/gaussian.h"
#include "sgs/tracker/place_search.h"
#include "sgs/tracker/track_result.h"

namespace sgs::tracker {

struct TrackerConfig;  // tracker/tracker_config.h

/// Estimates the pose of each frame in the world of the first one. Synchronous, single-threaded,
/// deterministic; the first frame gets the initial pose. Never throws on bad data: a frame
/// that cannot be tracked comes back as kLost, with the reason and the best guess at its pose (the
/// last one, which some trackers carry on at constant velocity for a moment).
class Tracker {
 public:
  virtual ~Tracker() = default;
  /// `revision`: what is believed of the past; its path has all frames before this one. Where it is
  /// another one than that of the frame before, what is remembered moves, and tracking goes on from
  /// there. Only poses whose results carry TrackResult::information are revised. `snapshot`: the
  /// newest map state the schedule allows this frame to see; null before the first one exists.
  /// Frames must come in the order of their times and indices.
  virtual TrackResult track(const RgbdFrame& frame, const history::Revision& revision,
                            const map::SnapshotPtr& snapshot) = 0;
  /// True when poses are relative to the (moving) Gaussians of the snapshots; false when the
  /// tracker keeps target points of its own that refinement of keyframes does not move.
  virtual bool follows_map() const = 0;
  /// Whether poses rest on the frame before, so that views must follow each other as in a video.
  /// Where they do not, frames may be far apart, and there is no drift that loops could take back.
  virtual bool needs_video() const { return true; }
  /// Whether the mapper may refine the poses of keyframes, which are then not those that track()
  /// returned.
  virtual bool moves_keyframes() const { return true; }
  /// Whether the trajectory of a run is told in the map as refined, not as track() returned it.
  virtual bool path_follows_refinement() const { return follows_map(); }
  /// Mapping steps a frame without which the tracker finds too little in the map; offline.
  virtual double least_mapping_steps() const { return 0; }
  /// Whether depth may lag behind colour (RgbdFrame::depth_delay_s): else track() is given frames
  /// of one time.
  virtual bool knows_depth_lag() const { return false; }

  /// Where frames that the tracker remembers are kept, with those of others; before the first
  /// frame.
  virtual void remember_in(const std::shared_ptr<history::ViewStore>& /*views*/) {}

  /// Whether the tracker can be given a finished map by know().
  virtual bool finds_itself() const { return false; }
  /// Takes in a view of a finished map, before the first frame. From the first one on the camera is
  /// somewhere in that world: frames are lost (kNotInMap) until it has found itself there. The path
  /// of `revision` ends with this view, after those that were taken in before, and that of every
  /// later revision begins with all of them; depths of the view are as its calibration has them.
  virtual void know(const alignment::KnownView& /*view*/, const history::Revision& /*revision*/) {}
  /// What became of that; null where there is no map to be found in.
  virtual const PlaceSearch* place_search() const { return nullptr; }
};

/// Makes the tracker that `config.type` names. Fails on settings out of range and cameras without a
/// size.
Result<std::unique_ptr<Tracker>> make_tracker(const TrackerConfig& config,
                                              const PinholeCamera& camera,
                                              const SE3& T_world_first);

}  // namespace sgs::tracker
