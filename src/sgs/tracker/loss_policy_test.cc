// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/loss_policy.h"

#include <gtest/gtest.h>

namespace sgs::tracker {
namespace {

using State = LossPolicy::State;
using Finding = LossPolicy::Finding;

constexpr double kUsual = 2;  // above what noise alone explains
constexpr int kPixels = 1000;

/// A frame whose picture fits as usual, in front of surfaces that see all axes.
Evidence good() { return {true, true, true, true, kPixels, kUsual}; }

/// The same with a picture of so many times the usual cost.
Evidence picture(double times_usual) {
  Evidence e = good();
  e.cost = times_usual * kUsual;
  return e;
}

/// A picture that fits badly, and surfaces that leave an axis open: a corridor.
Evidence corridor(double times_usual) {
  Evidence e = picture(times_usual);
  e.surfaces_see_all_axes = false;
  return e;
}

Evidence dark() {
  Evidence e = corridor(1);
  e.picture_holds = false;
  e.pixels = 10;
  return e;
}

LossPolicy experienced(const LossPolicy::Limits& limits = {}) {
  LossPolicy policy(limits);
  EXPECT_EQ(policy.follow(good()), State::kTracking);
  policy.learn(good());
  return policy;
}

TEST(LossPolicy, NothingIsDoubtedBeforeAPictureDidFit) {
  LossPolicy policy({});
  EXPECT_EQ(policy.usual_cost(), 0);
  Evidence e = corridor(100);
  EXPECT_EQ(policy.follow(e), State::kTracking);
  e.picture_holds = false;
  EXPECT_EQ(policy.follow(e), State::kTracking);
  policy.learn(e);  // does not hold: nothing is learned of it
  EXPECT_EQ(policy.usual_cost(), 0);
}

TEST(LossPolicy, UsualCostFollowsAcceptedPictures) {
  LossPolicy policy = experienced();
  EXPECT_EQ(policy.usual_cost(), kUsual);
  policy.learn(picture(2));
  EXPECT_NEAR(policy.usual_cost(), 1.1 * kUsual, 1e-12);
}

TEST(LossPolicy, PictureThatStoppedFittingIsDoubtedWhereSurfacesLeaveAnAxisOpen) {
  const LossPolicy::Limits limits;
  LossPolicy policy = experienced();
  EXPECT_EQ(policy.follow(corridor(0.99 * limits.deceived)), State::kTracking);
  EXPECT_EQ(policy.follow(corridor(1.01 * limits.deceived)), State::kDoubting);
  EXPECT_TRUE(policy.in_doubt());
  EXPECT_EQ(policy.follow(good()), State::kTracking);  // doubt ends with the first that fits
  EXPECT_FALSE(policy.in_doubt());
}

TEST(LossPolicy, ACostThatNoiseExplainsIsNeverTooHigh) {
  LossPolicy policy({});
  Evidence e = corridor(1);
  e.cost = 0.05;
  policy.follow(e);
  policy.learn(e);
  e.cost = 0.99;  // twenty times the usual
  EXPECT_EQ(policy.follow(e), State::kTracking);
  e.cost = 1.01;
  EXPECT_EQ(policy.follow(e), State::kDoubting);
}

TEST(LossPolicy, SurfacesThatSeeAllAxesAreBelievedBesideAPictureThatIsMerelyWorse) {
  const LossPolicy::Limits limits;
  EXPECT_EQ(experienced().follow(picture(0.99 * limits.elsewhere)), State::kTracking);
  EXPECT_EQ(experienced().follow(picture(1.01 * limits.elsewhere)), State::kDoubting);
}

TEST(LossPolicy, SurfacesDoNotDecideWhereTheyExplainLittleOrNothingIsSeen) {
  Evidence e = picture(3);
  e.explained_by_surfaces = false;
  EXPECT_EQ(experienced().follow(e), State::kDoubting);
  e = picture(3);
  e.pixels = kPixels / 5 - 1;  // of the usual ones
  EXPECT_EQ(experienced().follow(e), State::kDoubting);
}

TEST(LossPolicy, DoubtedFrameIsLostWhereItShowsEnough) {
  LossPolicy policy = experienced();
  const Evidence e = corridor(6);
  ASSERT_EQ(policy.follow(e), State::kDoubting);
  EXPECT_TRUE(policy.can_be_confirmed(e));
  EXPECT_TRUE(policy.searches(e));
  EXPECT_TRUE(policy.loses(e));
  policy.lost();
  EXPECT_EQ(policy.state(), State::kLost);
}

TEST(LossPolicy, DarkFrameGoesOnByItsSurfacesAndLooksForItselfNowAndThen) {
  const LossPolicy::Limits limits;
  LossPolicy policy = experienced();
  for (int i = 0; i < limits.doubt_frames; ++i) {
    ASSERT_EQ(policy.follow(dark()), State::kDoubting) << i;
    EXPECT_FALSE(policy.can_be_confirmed(dark()));
    EXPECT_EQ(policy.searches(dark()), i % limits.search_interval == 0) << i;
    EXPECT_FALSE(policy.loses(dark()));
  }
  // It has been dark for so long: nothing is held against the surfaces any more.
  EXPECT_EQ(policy.follow(dark()), State::kTracking);
  // The light is on again, and out again: a doubt of its own.
  EXPECT_EQ(policy.follow(good()), State::kTracking);
  EXPECT_EQ(policy.follow(dark()), State::kDoubting);

  Evidence unexplained = dark();
  unexplained.explained_by_surfaces = false;
  EXPECT_TRUE(policy.loses(unexplained));
}

TEST(LossPolicy, UntrustedFrameIsLeftToWhatMadeItSo) {
  LossPolicy policy = experienced();
  Evidence e = corridor(6);
  e.trusted = false;
  policy.follow(e);
  EXPECT_FALSE(policy.can_be_confirmed(e));
  EXPECT_FALSE(policy.loses(e));  // it is lost for that reason already
  EXPECT_FALSE(policy.is_confirmed(e));
  EXPECT_FALSE(policy.is_found(e));
  EXPECT_EQ(policy.find(e), Finding::kLost);
}

TEST(LossPolicy, APictureConfirmsByWhatIsUsual) {
  const LossPolicy::Limits limits;
  LossPolicy policy({});
  EXPECT_TRUE(policy.is_confirmed(corridor(100)));  // nothing to compare with
  policy = experienced();
  EXPECT_TRUE(policy.is_confirmed(corridor(0.99 * limits.deceived)));
  EXPECT_FALSE(policy.is_confirmed(corridor(1.01 * limits.deceived)));
  Evidence few = good();
  few.pixels = kPixels / 5 - 1;  // fits anywhere
  EXPECT_FALSE(policy.is_confirmed(few));
  EXPECT_FALSE(policy.is_confirmed(dark()));
}

TEST(LossPolicy, LostCameraIsFoundWhereItsPictureFits) {
  LossPolicy policy = experienced();
  policy.lost();
  EXPECT_EQ(policy.find(good()), Finding::kAccept);
  policy.found();
  EXPECT_EQ(policy.state(), State::kTracking);
}

TEST(LossPolicy, LostCameraHoldsThePictureAgainstSurfacesForAWhile) {
  const LossPolicy::Limits limits;
  LossPolicy policy = experienced();
  policy.lost();
  for (int i = 0; i < limits.patience_frames; ++i) {
    ASSERT_EQ(policy.find(picture(10)), Finding::kAskPicture) << i;
  }
  EXPECT_EQ(policy.find(picture(10)), Finding::kAccept);  // surfaces explain it
  Evidence unexplained = picture(10);
  unexplained.explained_by_surfaces = false;
  EXPECT_EQ(policy.find(unexplained), Finding::kLost);
}

TEST(LossPolicy, PatienceStartsAgainAfterAFrameThatContradictsNothing) {
  const LossPolicy::Limits limits;
  LossPolicy policy = experienced();
  policy.lost();
  for (int i = 0; i < limits.patience_frames; ++i) policy.find(picture(10));
  Evidence untrusted = picture(10);
  untrusted.trusted = false;
  EXPECT_EQ(policy.find(untrusted), Finding::kLost);
  EXPECT_EQ(policy.find(picture(10)), Finding::kAskPicture);
}

TEST(LossPolicy, LostCameraInTheDarkGoesByItsSurfaces) {
  LossPolicy policy = experienced();
  policy.lost();
  EXPECT_EQ(policy.find(dark()), Finding::kAccept);
  Evidence unexplained = dark();
  unexplained.explained_by_surfaces = false;
  EXPECT_EQ(policy.find(unexplained), Finding::kLost);
}

TEST(LossPolicy, LooksForALostCameraNowAndThen) {
  const LossPolicy policy({});
  int looks = 0;
  for (int held = 0; held < 50; ++held) looks += policy.searches_lost(held);
  EXPECT_EQ(looks, 50 / LossPolicy::Limits{}.search_interval);
  EXPECT_TRUE(policy.searches_lost(0));
}

TEST(LossPolicy, PlaceThatFeaturesFoundNeedsSurfacesAndAPictureThatMayBeIt) {
  LossPolicy policy({});
  Evidence e = good();
  policy.learn(Evidence{true, true, true, true, kPixels, 0.3});
  const LossPolicy::Limits limits;
  e.cost = 0.99 * limits.not_strange_cost;
  EXPECT_TRUE(policy.is_found(e));
  e.explained_by_surfaces = false;
  EXPECT_FALSE(policy.is_found(e));
  e.explained_by_surfaces = true;
  e.cost = 1.01 * limits.not_strange_cost;
  EXPECT_FALSE(policy.is_found(e));
  e = good();
  e.explained_by_surfaces = false;
  e.cost = 0.9;  // the picture alone confirms it
  EXPECT_TRUE(policy.is_found(e));
}

TEST(LossPolicy, APictureAboveWhatIsUsualHereIsNoPlaceThatWasFound) {
  LossPolicy policy = experienced();
  const LossPolicy::Limits limits;
  EXPECT_TRUE(policy.is_found(picture(0.99 * limits.strange)));
  EXPECT_FALSE(policy.is_found(picture(1.01 * limits.strange)));
}

TEST(LossPolicy, WondersAboutAStrangeFrameAtOnceAndThenNowAndThen) {
  LossPolicy policy = experienced();
  const LossPolicy::Limits limits;
  EXPECT_EQ(policy.follow(picture(0.99 * limits.strange)), State::kTracking);
  EXPECT_FALSE(policy.wonders(picture(0.99 * limits.strange)));
  const Evidence strange = picture(1.01 * limits.strange);
  int looks = 0;
  for (int k = 0; k < 3 * limits.search_interval; ++k) {
    EXPECT_EQ(policy.follow(strange), State::kTracking);
    if (k == 0) {
      EXPECT_TRUE(policy.wonders(strange));
    }
    looks += policy.wonders(strange);
  }
  EXPECT_EQ(looks, 3);
  EXPECT_EQ(policy.follow(good()), State::kTracking);
  EXPECT_EQ(policy.follow(strange), State::kTracking);
  EXPECT_TRUE(policy.wonders(strange));  // it begins anew
}

TEST(LossPolicy, AnotherPlaceIsBelievedWhereItsPictureIsClearlyBetter) {
  LossPolicy policy = experienced();
  const Evidence strange = picture(2);
  EXPECT_TRUE(policy.is_better(picture(0.9), strange));
  EXPECT_FALSE(policy.is_better(picture(1.1), strange));
  Evidence elsewhere = picture(0.9);
  elsewhere.trusted = false;
  EXPECT_FALSE(policy.is_better(elsewhere, strange));
}

}  // namespace
}  // namespace sgs::tracker
