// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/backend/bundle_rows.h"

#include <gtest/gtest.h>

#include "sgs/backend/test_room.h"

namespace sgs::backend {
namespace {

/// Two views of the room, a state that is off in everything, and one pixel that both see.
class BundleRowsTest : public testing::Test {
 protected:
  void SetUp() override {
    room.distort = [](double u, double, double q) { return q - 0.002 - 1e-5 * u; };
    keyframes = room.keyframes(2);
    Vector6d velocity;
    velocity << 0.3, -0.2, 0.1, 0.4, 0.3, -0.2;
    for (Keyframe& k : keyframes) {
      k.velocity = velocity;
      problem.keyframes.push_back(&k);
      state.T_world_camera.push_back(TestRoom::tracked_pose(static_cast<int>(k.frame)));
      state.exposures.push_back({0.05 * static_cast<double>(state.exposures.size()), 2});
      state.readout_turns.push_back(Eigen::Vector3d(1e-3, -2e-3, 5e-4));
      auto& depths = state.inverse_depths.emplace_back();
      for (const HostPixel& p : k.pixels) depths.push_back(p.inverse_depth);
    }
    problem.readout_s = 0.02;
    problem.grid = {8, 6};
    state.offsets_per_m = Eigen::VectorXd::Constant(48, 0.001);
    state.shift_px = {0.3, -0.2};
    state.delay_s = 0.003;
  }

  /// The residual of a pixel in the second view, or NaN.
  double residual(std::size_t pixel, bool depth) const {
    const BundleRows rows(problem, state);
    const auto point = rows.point(0, pixel, 0);
    BundleRow row;
    if (!point || !(depth ? rows.depth(*point, 1, row) : rows.grey(*point, 1, 0, row))) return NAN;
    return row.residual;
  }
  BundleRow row_of(std::size_t pixel, bool depth) const {
    const BundleRows rows(problem, state);
    BundleRow row;
    const auto point = rows.point(0, pixel, 0);
    EXPECT_TRUE(depth ? rows.depth(*point, 1, row) : rows.grey(*point, 1, 0, row));
    return row;
  }
  /// Derivative by numbers along `move`, which changes the state by a step.
  template <class Move>
  double numeric(std::size_t pixel, bool depth, double step, Move&& move) {
    const BundleState before = state;
    move(step);
    const double after = residual(pixel, depth);
    state = before;
    move(-step);
    const double low = residual(pixel, depth);
    state = before;
    return (after - low) / (2 * step);
  }
  void turn(std::size_t keyframe, int axis, double step) {
    Vector6d xi = Vector6d::Zero();
    xi[axis] = step;
    state.T_world_camera[keyframe] = state.T_world_camera[keyframe] * SE3::exp(xi);
  }
  std::vector<std::size_t> seen() const {
    std::vector<std::size_t> out;
    for (std::size_t p = 0; p < keyframes[0].pixels.size(); ++p) {
      if (std::isfinite(residual(p, true)) && std::isfinite(residual(p, false))) out.push_back(p);
    }
    return out;
  }

  TestRoom room;
  std::vector<Keyframe> keyframes;
  BundleProblem problem;
  BundleState state;
};

/// The largest slope among a row's derivatives sets the scale of what may be off: pictures and
/// fields of inverse depth are interpolated, so steps cross from one patch into the next.
void expect_near(double analytic, double by_numbers, double scale) {
  EXPECT_NEAR(analytic, by_numbers, 0.1 * std::abs(analytic) + 0.03 * scale);
}

TEST_F(BundleRowsTest, DerivativesAreThoseOfTheNumbers) {
  const auto pixels = seen();
  ASSERT_GT(pixels.size(), 20u);
  int grey_off = 0, grey_all = 0;
  for (std::size_t n = 0; n < pixels.size(); n += 5) {
    const std::size_t p = pixels[n];
    for (const bool depth : {false, true}) {
      const BundleRow row = row_of(p, depth);
      const double scale = row.by_target.head<6>().cwiseAbs().maxCoeff();
      const double step = 1e-5;
      for (int k = 0; k < 6; ++k) {
        const auto host = [&](double s) { turn(0, k, s); };
        const auto target = [&](double s) { turn(1, k, s); };
        if (depth) {
          expect_near(row.by_host[k], numeric(p, depth, step, host), scale);
          expect_near(row.by_target[k], numeric(p, depth, step, target), scale);
        } else {
          // A picture's gradient is a central difference, which a kink of its interpolation is not.
          grey_all += 2;
          const double off = row.by_target[k] - numeric(p, depth, step, target);
          const double off_host = row.by_host[k] - numeric(p, depth, step, host);
          grey_off += (std::abs(off) > 0.25 * scale) + (std::abs(off_host) > 0.25 * scale);
        }
      }
      const auto deeper = [&](double s) { state.inverse_depths[0][p] += s; };
      if (depth) {
        expect_near(row.by_inverse_depth, numeric(p, depth, step, deeper),
                    std::abs(row.by_inverse_depth));
        const auto later = [&](double s) { state.delay_s += s; };
        expect_near(row.by_shift_and_delay[2], numeric(p, depth, step, later), scale);
        const auto aside = [&](double s) { state.shift_px.x() += s; };
        expect_near(row.by_shift_and_delay[0], numeric(p, depth, 1e-3, aside),
                    std::abs(row.by_shift_and_delay[0]) + 1e-5);
        const auto offset = [&](double s) { state.offsets_per_m[row.grid.node[0]] += s; };
        expect_near(row.grid.weight[0], numeric(p, depth, step, offset), 0.1);
      } else {
        const double nearness = row.by_inverse_depth - numeric(p, depth, step, deeper);
        grey_off += std::abs(nearness) > 0.25 * std::abs(row.by_inverse_depth) + 1;
        ++grey_all;
        const auto brighter = [&](double s) { state.exposures[1].offset += s; };
        expect_near(row.by_target[7], numeric(p, depth, 1e-3, brighter), 1);
        const auto gain = [&](double s) { state.exposures[0].log_gain += s; };
        expect_near(row.by_host[6], numeric(p, depth, 1e-4, gain), 1);
        const auto own_offset = [&](double s) { state.exposures[0].offset += s; };
        expect_near(row.by_host[7], numeric(p, depth, 1e-3, own_offset), 1);
      }
    }
  }
  EXPECT_LT(grey_off, grey_all / 5);
}

TEST_F(BundleRowsTest, TheReadoutTurnsBothViews) {
  const auto pixels = seen();
  ASSERT_GT(pixels.size(), 20u);
  for (std::size_t n = 0; n < pixels.size(); n += 7) {
    const std::size_t p = pixels[n];
    const BundleRow row = row_of(p, true);
    const double scale = row.by_target.tail<3>().cwiseAbs().maxCoeff() + 1e-3;
    for (int k = 0; k < 3; ++k) {
      expect_near(row.by_target[8 + k],
                  numeric(p, true, 1e-3, [&](double s) { state.readout_turns[1][k] += s; }), scale);
      expect_near(row.by_host[8 + k],
                  numeric(p, true, 1e-3, [&](double s) { state.readout_turns[0][k] += s; }), scale);
    }
  }
}

TEST_F(BundleRowsTest, AnotherSurfaceIsHidden) {
  const BundleRows rows(problem, state);
  const std::size_t p = seen().front();
  state.inverse_depths[0][p] *= 1.3;
  BundleRow row;
  EXPECT_FALSE(rows.depth(*rows.point(0, p, 0), 1, row));
}

}  // namespace
}  // namespace sgs::backend
