// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/viewer/board.h"

#include <algorithm>

namespace sgs::viewer {
namespace {

PathPoint::Status path_status(tracker::TrackingStatus status) {
  switch (status) {
    case tracker::TrackingStatus::kOk:
      return PathPoint::kOk;
    case tracker::TrackingStatus::kDegenerate:
      return PathPoint::kDegenerate;
    case tracker::TrackingStatus::kLost:
      break;
  }
  return PathPoint::kLost;
}

}  // namespace

PathPoint::Pose to_pose(const SE3& T) {
  const Eigen::Quaterniond q = T.quaternion();
  const std::array<double, 7> values = {T.t.x(), T.t.y(), T.t.z(), q.x(), q.y(), q.z(), q.w()};
  PathPoint::Pose pose;
  std::transform(values.begin(), values.end(), pose.begin(),
                 [](double v) { return static_cast<float>(v); });
  return pose;
}

void Board::post(FrameUpdatePtr update) {
  PathPoint point;
  point.estimate = to_pose(update->T_world_camera);
  point.has_truth = update->truth.has_value();
  if (point.has_truth) point.truth = to_pose(*update->truth);
  point.status = path_status(update->record.status);
  const auto index = static_cast<std::size_t>(std::max<std::int64_t>(0, update->record.index));
  FrameUpdatePtr old;  // dies after the lock: it may hold the last reference to a whole map
  const std::scoped_lock lock(mutex_);
  // A file may claim any number; a gap of nearly an hour of frames is none that a camera leaves.
  constexpr std::size_t kLongestGap = 100'000;
  if (index >= path_.size() && index - path_.size() <= kLongestGap) {
    PathPoint missing;
    missing.estimate = path_.empty() ? point.estimate : path_.back().estimate;
    while (path_.size() < index) path_.push_back(missing);
    path_.push_back(point);
  }
  old = std::exchange(state_.update, std::move(update));
  ++state_.sequence;
}

void Board::restart() {
  const std::scoped_lock lock(mutex_);
  path_.clear();
  state_.update.reset();
  ++state_.generation;
  ++state_.sequence;
}

void Board::touch() {
  const std::scoped_lock lock(mutex_);
  ++state_.sequence;
}

void Board::set_refinement(RefinementNote note) {
  const std::scoped_lock lock(mutex_);
  ++refinement_.first;
  refinement_.second = std::move(note);
}

std::pair<std::uint64_t, RefinementNote> Board::refinement() const {
  const std::scoped_lock lock(mutex_);
  return refinement_;
}

void Board::set_session(SessionNote note) {
  const std::scoped_lock lock(mutex_);
  ++session_.first;
  session_.second = std::move(note);
}

std::pair<std::uint64_t, SessionNote> Board::session() const {
  const std::scoped_lock lock(mutex_);
  return session_;
}

std::uint64_t Board::session_number() const {
  const std::scoped_lock lock(mutex_);
  return session_.first;
}

void Board::set_final_word(FinalWord word) {
  const std::scoped_lock lock(mutex_);
  final_word_ = std::move(word);
}

Board::State Board::state() const {
  const std::scoped_lock lock(mutex_);
  return state_;
}

std::vector<PathPoint> Board::path(std::size_t first, std::size_t limit) const {
  const std::scoped_lock lock(mutex_);
  if (first >= path_.size()) return {};
  const auto begin = path_.begin() + static_cast<std::ptrdiff_t>(first);
  return {begin, begin + static_cast<std::ptrdiff_t>(std::min(limit, path_.size() - first))};
}

std::optional<FinalWord> Board::final_word() const {
  const std::scoped_lock lock(mutex_);
  return final_word_;
}

}  // namespace sgs::viewer
