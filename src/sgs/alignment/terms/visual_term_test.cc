// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/alignment/terms/visual_term.h"

#include <gtest/gtest.h>

#include "sgs/alignment/test_textured_wall.h"

namespace sgs::alignment {
namespace {

SE3 beside(double x_m) { return SE3(Eigen::Matrix3d::Identity(), {x_m, 0, 0}); }

/// Shows the wall from `beside(x_m)`, held to be seen from `drift_m` further on, and aligns
/// nothing: the fit is linearized where the camera is held to be.
VisualTerm::Fit look(VisualTerm& term, const RgbdFrame& frame, const LocalPast& past, double x_m,
                     double drift_m) {
  const SE3 T = beside(x_m + drift_m);
  term.set_frame(frame, past);
  VisualTerm::Fit fit = term.start(T);
  if (fit.has_references()) {
    for (int step = 0; step < 3; ++step) {
      fit.linearize(0, T);
      fit.back_substitute(Vector6d::Zero());
    }
  }
  return fit;
}

/// Two keyframes that see the same: the second one is held to be further on than it is.
class DriftedWall : public ::testing::Test {
 protected:
  void make(double drift_m) {
    add(0, 0);
    add(0.9, 0);  // away from it
    add(0, drift_m);
    ASSERT_EQ(term_.keyframes(), 3);
  }
  void add(double x_m, double drift_m) {
    const RgbdFrame frame = see_wall(beside(x_m), frames_++);
    term_.set_frame(frame, past());
    term_.insert_keyframe(beside(x_m + drift_m), {}, Vector6d::Zero(), {}, {});
    revision_.path.append({frame.index, frame.timestamp_s, beside(x_m + drift_m)});
  }
  int references(double drift_m) {
    const RgbdFrame frame = see_wall(beside(0.02), frames_++);
    const VisualTerm::Fit fit = look(term_, frame, past(), 0.02, drift_m);
    term_.compare_references(fit);
    return fit.references();
  }

  LocalPast past() const {
    LocalPast out;
    out.set_revision(revision_);
    return out;
  }

  history::Revision revision_;
  VisualTerm term_{VisionConfig{}};
  int frames_ = 0;
};

TEST_F(DriftedWall, AnOldKeyframeThatAgreesStays) {
  make(0);
  for (int k = 0; k < 12; ++k) EXPECT_EQ(references(0), 2) << k;
}

TEST_F(DriftedWall, AnOldKeyframeThatContradictsIsLeftOutUntilThePastIsRevised) {
  constexpr double kDrift_m = 0.06;
  make(kDrift_m);
  EXPECT_EQ(references(kDrift_m), 2);
  for (int k = 0; k < 12; ++k) references(kDrift_m);
  EXPECT_EQ(references(kDrift_m), 1);
  revision_ = history::revised(revision_, {PoseCorrection({{0, {}, {}}, {1, {}, {}}})});
  EXPECT_EQ(references(kDrift_m), 2);
}

TEST_F(DriftedWall, WhatOneFrameHasShownToContradictIsLeftOut) {
  constexpr double kDrift_m = 0.06;
  make(kDrift_m);
  const RgbdFrame frame = see_wall(beside(0.02), frames_++);
  const VisualTerm::Fit both = look(term_, frame, past(), 0.02, kDrift_m);
  EXPECT_EQ(both.references(), 2);
  const SE3 T = beside(0.02 + kDrift_m);
  VisualTerm::Fit alone = term_.start(T, VisualTerm::References::kNewest);
  EXPECT_EQ(alone.references(), 1);
  alone.linearize(0, T);
  EXPECT_LT(alone.mean_cost(), 0.5 * both.mean_cost());
  term_.leave_out_older(both);
  EXPECT_EQ(references(kDrift_m), 1);
}

TEST_F(DriftedWall, ACameraThatWasCarriedOffIsAlignedToTheNearestKeyframe) {
  constexpr double kDrift_m = 0.06;
  make(kDrift_m);
  for (int k = 0; k < 12; ++k) references(kDrift_m);  // the first one contradicts
  EXPECT_EQ(term_.newest_keyframe(), 2u);
  EXPECT_EQ(term_.nearest_keyframe(beside(0.8)), 1u);
  EXPECT_EQ(term_.nearest_keyframe(beside(0.02)), 0u);
  const RgbdFrame frame = see_wall(beside(0.02), frames_++);
  const double before = look(term_, frame, past(), 0.02, 0).mean_cost();
  term_.carry_to(0);
  const VisualTerm::Fit fit = look(term_, frame, past(), 0.02, 0);
  EXPECT_EQ(fit.references(), 2);  // that one, and what lies beside it
  EXPECT_GT(fit.newest_share(), 0.9);
  EXPECT_LT(fit.mean_cost(), 0.6 * before);
}

// Of the same wall: a drawing serves who is carried to it, and nobody else.
TEST_F(DriftedWall, ADrawingIsNoReferenceBesideAPicture) {
  add(0, 0);
  const RgbdFrame drawing = see_wall(beside(0.9), frames_++);
  revision_.path.append({drawing.index, drawing.timestamp_s, beside(0.9)});
  term_.set_frame(drawing, past());
  term_.insert_drawing(beside(0.9), {});
  ASSERT_EQ(term_.keyframes(), 2);
  EXPECT_EQ(term_.nearest_keyframe(beside(0.9), true), 1u);
  EXPECT_EQ(term_.nearest_keyframe(beside(0.9)), 0u);

  const RgbdFrame frame = see_wall(beside(0.88), frames_++);
  VisualTerm::Fit fit = look(term_, frame, past(), 0.88, 0);  // the drawing is the newest
  EXPECT_TRUE(fit.to_drawing());
  EXPECT_EQ(fit.finest_level(), 1);
  EXPECT_TRUE(term_.wants_keyframe(beside(0.88), fit)) << "a picture takes its place";

  term_.carry_to(0);
  fit = look(term_, frame, past(), 0.88, 0);
  EXPECT_FALSE(fit.to_drawing());
  EXPECT_EQ(fit.finest_level(), 0);
  EXPECT_EQ(fit.references(), 1);
}

}  // namespace
}  // namespace sgs::alignment
