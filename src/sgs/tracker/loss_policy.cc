// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/loss_policy.h"

#include <algorithm>

namespace sgs::tracker {

bool LossPolicy::fits(const Evidence& e, double times_usual) const {
  return e.picture_holds && e.cost <= std::max(limits_.explained_cost, times_usual * usual_cost_);
}

bool LossPolicy::is_doubtful(const Evidence& e) const {
  if (usual_cost_ <= 0) return false;
  if (fits(e, limits_.deceived)) return false;
  const bool surfaces_decide = e.surfaces_see_all_axes && e.explained_by_surfaces;
  return !surfaces_decide || !sees_enough(e) || e.cost > limits_.elsewhere * usual_cost_;
}

bool LossPolicy::is_strange(const Evidence& e) const {
  return usual_cost_ > 0 && e.pixels >= limits_.min_pixels && !fits(e, limits_.strange);
}

bool LossPolicy::sees_enough(const Evidence& e) const {
  return e.pixels >= limits_.min_pixels && e.pixels >= limits_.enough_pixels * usual_pixels_;
}

LossPolicy::State LossPolicy::follow(const Evidence& e) {
  strange_frames_ = is_strange(e) ? strange_frames_ + 1 : 0;
  doubted_frames_ = is_doubtful(e) ? doubted_frames_ + 1 : 0;
  // A picture that has not fitted for so long is held against nothing any more: it has become dark.
  const bool doubted = doubted_frames_ > 0 && doubted_frames_ <= limits_.doubt_frames;
  return state_ = doubted ? State::kDoubting : State::kTracking;
}

bool LossPolicy::wonders(const Evidence& e) const {
  return is_strange(e) && (strange_frames_ - 1) % limits_.search_interval == 0;
}

bool LossPolicy::is_better(const Evidence& found, const Evidence& followed) const {
  return is_found(found) && found.cost <= limits_.clearly_better * followed.cost;
}

// A frame that shows enough is lost otherwise; a dark one may go on by its surfaces for a while.
bool LossPolicy::searches(const Evidence& e) const {
  return can_be_confirmed(e) || (doubted_frames_ - 1) % limits_.search_interval == 0;
}

bool LossPolicy::loses(const Evidence& e) const {
  return e.trusted && (sees_enough(e) || !e.explained_by_surfaces);
}

LossPolicy::Finding LossPolicy::find(const Evidence& e) {
  const bool confirmed = is_confirmed(e);
  const bool contradicted = e.trusted && sees_enough(e) && !confirmed;
  contradicted_frames_ = contradicted ? contradicted_frames_ + 1 : 0;
  if (confirmed) return Finding::kAccept;
  if (!e.trusted) return Finding::kLost;
  if (contradicted && contradicted_frames_ <= limits_.patience_frames) return Finding::kAskPicture;
  return e.explained_by_surfaces ? Finding::kAccept : Finding::kLost;
}

bool LossPolicy::is_confirmed(const Evidence& e) const {
  const double times_usual = state_ == State::kLost ? limits_.strange : limits_.deceived;
  return e.trusted && sees_enough(e) && (usual_cost_ <= 0 ? e.picture_holds : fits(e, times_usual));
}

bool LossPolicy::is_found(const Evidence& e) const {
  const bool agreed = e.trusted && e.explained_by_surfaces && e.picture_holds && sees_enough(e) &&
                      e.cost <= limits_.not_strange_cost;
  const bool as_usual = is_confirmed(e) && (usual_cost_ <= 0 || fits(e, limits_.strange));
  return agreed || as_usual;
}

void LossPolicy::found() {
  doubted_frames_ = strange_frames_ = contradicted_frames_ = 0;
  state_ = State::kTracking;
}

void LossPolicy::learn(const Evidence& e) {
  if (!e.picture_holds) return;
  const bool first = usual_cost_ <= 0;
  const auto learn = [&](double& usual, double now) {
    usual = first ? now : usual + limits_.forget * (now - usual);
  };
  learn(usual_cost_, e.cost);
  learn(usual_pixels_, e.pixels);
}

}  // namespace sgs::tracker
