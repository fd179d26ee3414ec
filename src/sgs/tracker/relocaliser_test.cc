// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/relocaliser.h"

#include <gtest/gtest.h>

#include "sgs/alignment/test_textured_wall.h"
#include "sgs/camera/movers.h"

namespace sgs::tracker {
namespace {

constexpr int kPersonLeft = 0, kPersonRight = 135;  // columns

/// Somebody in patterned clothes, nearer than the wall.
RgbdFrame with_person(RgbdFrame frame) {
  for (int v = 0; v < frame.camera.height; ++v) {
    for (int u = kPersonLeft; u < kPersonRight; ++u) {
      const std::uint8_t g = alignment::wallpaper(40 + 0.004 * u, 0.004 * v);
      frame.color(u, v) = {g, g, g};
      frame.depth(u, v) = 1.0f;
    }
  }
  return frame;
}

RgbdFrame without_person(RgbdFrame frame) {
  PixelMask still(frame.camera.width, frame.camera.height, std::uint8_t{1});
  for (int v = 0; v < still.height(); ++v) {
    std::fill(still.row(v) + kPersonLeft, still.row(v) + kPersonRight, std::uint8_t{0});
  }
  leave_out_movers(frame, std::make_shared<const PixelMask>(std::move(still)));
  return frame;
}

/// Where the frame is seen from, by a relocaliser that knows the place of `keyframe` as 0.
std::optional<SE3> found(const RgbdFrame& keyframe, const RgbdFrame& frame) {
  Relocaliser relocaliser{RelocaliserConfig(TrackerConfig{})};
  relocaliser.add_keyframe(keyframe, nullptr);
  history::Revision revision;
  revision.path.append({keyframe.index, keyframe.timestamp_s, SE3{}});
  alignment::LocalPast past;
  past.set_revision(revision);
  return relocaliser.relocalise(frame, past);
}

const SE3 kBeside(Eigen::Matrix3d::Identity(), {0.04, -0.02, 0.01});

TEST(Relocaliser, KnowsAPlaceThatWasSeenWithAPersonInIt) {
  const RgbdFrame keyframe = without_person(with_person(alignment::see_wall(SE3{}, 0)));
  const auto T = found(keyframe, alignment::see_wall(kBeside, 1));
  ASSERT_TRUE(T);
  EXPECT_LT((T->t - kBeside.t).norm(), 0.02);
}

TEST(Relocaliser, TakesNobodyForAPlace) {
  const RgbdFrame seen = with_person(alignment::see_wall(SE3{}, 0));
  const RgbdFrame elsewhere = with_person(alignment::see_wall(SE3{}, 1, /*papered=*/false));
  EXPECT_TRUE(found(seen, elsewhere)) << "all that both show alike is the person";
  EXPECT_FALSE(found(without_person(seen), elsewhere));
}

}  // namespace
}  // namespace sgs::tracker
