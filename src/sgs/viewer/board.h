// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sgs/eval/metrics.h"
#include "sgs/viewer/frame_update.h"

namespace sgs::viewer {

/// One point of the path, in the precision the page needs.
struct PathPoint {
  /// tx ty tz qx qy qz qw
  using Pose = std::array<float, 7>;
  enum Status : std::uint8_t { kOk = 0, kDegenerate = 1, kLost = 2, kNoFrame = 3 };

  Pose estimate{};
  Pose truth{};
  bool has_truth = false;
  Status status = kNoFrame;
};
PathPoint::Pose to_pose(const SE3& T);

/// What there is to see, between the thread that makes it and the thread that serves it. The maker
/// only ever appends one path point and replaces one pointer under a lock that readers hold for a
/// bounded copy: SLAM never waits for a client, and what nobody fetched in time is replaced by
/// what is newer. Thread-safe.
class Board {
 public:
  /// Replaces the newest update and appends its pose to the path. The path's index is the frame's
  /// index: frames that are missing in between get a point of status kNoFrame.
  void post(FrameUpdatePtr update);
  /// Forgets path and newest update: a replay starts again.
  void restart();
  /// Marks the state as new although no frame came (paused, resumed, finished).
  void touch();
  /// How the refinement fares.
  void set_refinement(RefinementNote note);
  /// How the session fares.
  void set_session(SessionNote note);
  /// Scores of the finished run, and how it stands.
  void set_final_word(FinalWord word);

  struct State {
    std::uint64_t sequence = 0;    ///< counts what was posted or touched; 0 = nothing yet
    std::uint64_t generation = 0;  ///< counts restarts
    FrameUpdatePtr update;         ///< null before the first frame
  };
  State state() const;
  /// At most `limit` points from index `first` on.
  std::vector<PathPoint> path(std::size_t first, std::size_t limit) const;
  /// The newest note; its number counts them, 0 = none yet.
  std::pair<std::uint64_t, RefinementNote> refinement() const;
  std::pair<std::uint64_t, SessionNote> session() const;
  /// The number alone of the newest note of the session.
  std::uint64_t session_number() const;
  /// Empty while the run is not finished.
  std::optional<FinalWord> final_word() const;

 private:
  mutable std::mutex mutex_;
  State state_;
  std::deque<PathPoint> path_;
  std::optional<FinalWord> final_word_;
  std::pair<std::uint64_t, RefinementNote> refinement_;
  std::pair<std::uint64_t, SessionNote> session_;
};

}  // namespace sgs::viewer
