// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>

#include "sgs/tracker/tracker.h"

namespace sgs::tracker {

/// A tracker alone, with no session around it that keeps its path: for who wants poses and nothing
/// else.
class Odometry {
 public:
  explicit Odometry(std::unique_ptr<Tracker> tracker) : tracker_(std::move(tracker)) {}

  /// Tracker::track(); frames come in the order of their indices.
  TrackResult track(const RgbdFrame& frame, const map::SnapshotPtr& snapshot) {
    TrackResult result = tracker_->track(frame, revision_, snapshot);
    revision_.path.append({frame.index, frame.timestamp_s, result.T_odom_camera});
    return result;
  }
  /// Tracker::know(); before the first frame.
  void know(const alignment::KnownView& view) {
    revision_.path.append({alignment::known_view_index(revision_.path.size()), view.timestamp_s,
                           view.T_world_camera});
    tracker_->know(view, revision_);
  }
  const PlaceSearch* place_search() const { return tracker_->place_search(); }
  void revise(const history::Update& update) { revision_ = history::revised(revision_, update); }
  const history::Revision& revision() const { return revision_; }
  bool follows_map() const { return tracker_->follows_map(); }

 private:
  std::unique_ptr<Tracker> tracker_;
  history::Revision revision_;
};

}  // namespace sgs::tracker
