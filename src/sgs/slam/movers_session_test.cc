// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "sgs/slam/known_map.h"
#include "sgs/slam/session.h"

namespace sgs::slam {
namespace {

const PinholeCamera kRoomCamera{80, 60, 67, 67, 39.5, 29.5};
constexpr int kWalker = 40;  // columns from here on show somebody

/// Goes to the right, and takes for moving what it is told to.
class SeeingTracker : public tracker::Tracker {
 public:
  explicit SeeingTracker(std::shared_ptr<const PixelMask> still) : still_(std::move(still)) {}
  tracker::TrackResult track(const RgbdFrame& frame, const history::Revision&,
                             const map::SnapshotPtr&) override {
    tracker::TrackResult result;
    result.T_odom_camera =
        SE3(Eigen::Matrix3d::Identity(), {0.1 * static_cast<double>(frame.index), 0, 0});
    result.information = 1e6 * Matrix6d::Identity();
    result.still = still_;
    return result;
  }
  bool follows_map() const override { return false; }

 private:
  std::shared_ptr<const PixelMask> still_;
};

std::shared_ptr<const RgbdFrame> room_frame(int index) {
  auto frame = std::make_shared<RgbdFrame>();
  frame->index = index;
  frame->timestamp_s = index / 30.0;
  frame->camera = kRoomCamera;
  frame->color = ColorImage(kRoomCamera.width, kRoomCamera.height, {90, 100, 110});
  frame->depth = DepthImage(kRoomCamera.width, kRoomCamera.height, 2.0f);
  return frame;
}

std::unique_ptr<Session> session_with(std::shared_ptr<const PixelMask> still) {
  auto config = make_session_config("default");
  EXPECT_TRUE(config);
  config->mapper.iterations_per_frame = 0;
  auto session =
      Session::create(*config, kRoomCamera, {}, std::make_unique<SeeingTracker>(std::move(still)));
  EXPECT_TRUE(session) << session.error().text();
  for (int i = 0; i < 8; ++i) (*session)->feed(room_frame(i));
  (*session)->finish();
  return std::move(*session);
}

std::shared_ptr<const PixelMask> left_half() {
  PixelMask still(kRoomCamera.width, kRoomCamera.height, std::uint8_t{1});
  for (int v = 0; v < still.height(); ++v) {
    std::fill(still.row(v) + kWalker, still.row(v) + still.width(), std::uint8_t{0});
  }
  return std::make_shared<const PixelMask>(std::move(still));
}

// What loops compare and a map file keeps.
TEST(SessionWithMovers, RemembersPlacesWithoutThem) {
  const auto session = session_with(left_half());
  const std::size_t views = known_views(*session);
  ASSERT_GT(views, 1u);
  for (std::size_t i = 0; i < views; ++i) {
    const RgbdFrame frame = known_view(*session, session->trajectory(), i).frame;
    EXPECT_NEAR(frame.depth(kWalker - 1, 30), 2, 1e-3);
    EXPECT_EQ(frame.depth(kWalker, 30), 0);
    EXPECT_TRUE(frame.sees(kWalker - 1, 30));
    EXPECT_FALSE(frame.sees(kWalker, 30));
  }
}

TEST(SessionWithMovers, MapsNothingOfThem) {
  const auto behind = [](const Session& session) {  // Gaussians that the first frame shows there
    std::size_t count = 0;
    for (const map::Gaussian& g : session.final_snapshot()->gaussians) {
      const Eigen::Vector3d at(g.mean[0], g.mean[1], g.mean[2]);
      count += kRoomCamera.project(at).x() > kWalker + 28 ? 1 : 0;  // no frame sees it still
    }
    return count;
  };
  EXPECT_GT(behind(*session_with(nullptr)), 0u);
  EXPECT_EQ(behind(*session_with(left_half())), 0u);
}

}  // namespace
}  // namespace sgs::slam
