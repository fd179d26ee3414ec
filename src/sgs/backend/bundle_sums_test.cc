// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/backend/bundle_sums.h"

#include <gtest/gtest.h>

#include "sgs/core/random.h"

namespace sgs::backend {
namespace {

constexpr std::size_t kBlocks = 4, kCalibration = 12;
constexpr Eigen::Index kKeyframes = kKeyframeUnknowns * kBlocks;
constexpr Eigen::Index kUnknowns = kKeyframes + kCalibration;

class BundleSumsTest : public testing::Test {
 protected:
  double number() { return 2 * random.uniform() - 1; }

  /// A depth or a grey value of a pixel in one of its targets, or its own depth.
  WeightedRow row(std::size_t block, bool is_depth) {
    WeightedRow r;
    r.block = block;
    r.is_depth = is_depth;
    r.weight = 0.5 + random.uniform();
    r.residual = number();
    r.by_inverse_depth = number();
    for (std::size_t k = 0; block > 0 && k < kKeyframeUnknowns; ++k) {
      r.by_host[k] = number();
      r.by_target[k] = number();
    }
    for (std::size_t n = 0; is_depth && n < kTouchedCalibration; ++n) {
      r.calibration[n] = n < 4 ? (2 * block + n) % 9 : 5 + n;  // the shift and the delay come last
      r.by_calibration[n] = number();
    }
    return r;
  }

  /// Its derivatives by all unknowns, the inverse depth last.
  static Eigen::VectorXd jacobian(const WeightedRow& r) {
    Eigen::VectorXd J = Eigen::VectorXd::Zero(kUnknowns + 1);
    for (Eigen::Index k = 0; k < kKeyframeUnknowns; ++k) {
      J[k] += r.by_host[static_cast<std::size_t>(k)];
      J[kKeyframeUnknowns * static_cast<Eigen::Index>(r.block) + k] +=
          r.by_target[static_cast<std::size_t>(k)];
    }
    for (std::size_t n = 0; r.is_depth && n < kTouchedCalibration; ++n) {
      J[kKeyframes + static_cast<Eigen::Index>(r.calibration[n])] += r.by_calibration[n];
    }
    J[kUnknowns] = r.by_inverse_depth;
    return J;
  }

  /// Adds a pixel to the sums and, by dense algebra, to H and b.
  void add(const std::vector<WeightedRow>& rows) {
    Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(kUnknowns + 1, kUnknowns + 1);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(kUnknowns + 1);
    for (const WeightedRow& r : rows) {
      const Eigen::VectorXd J = jacobian(r);
      whole += r.weight * J * J.transpose();
      gradient += r.weight * r.residual * J;
    }
    const Eigen::VectorXd coupling = whole.col(kUnknowns).head(kUnknowns);
    const double pivot = whole(kUnknowns, kUnknowns);
    H += whole.topLeftCorner(kUnknowns, kUnknowns) - coupling * coupling.transpose() / pivot;
    b += gradient.head(kUnknowns) - coupling * gradient[kUnknowns] / pivot;
    sums.add_pixel(rows, elimination);
    EXPECT_NEAR(elimination.H, pivot, 1e-12);
    EXPECT_NEAR(elimination.b, gradient[kUnknowns], 1e-12);
  }

  SplitMix64 random{7};
  BundleSums sums{kCalibration};
  Elimination elimination;
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(kUnknowns, kUnknowns);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(kUnknowns);
};

TEST_F(BundleSumsTest, AreThoseOfDenseAlgebra) {
  sums.begin_host(kBlocks);
  for (int pixel = 0; pixel < 5; ++pixel) {
    std::vector<WeightedRow> rows{row(0, true)};
    for (std::size_t block = 1; block < kBlocks; ++block) {
      if (pixel == 2 && block == 2) continue;  // not seen there
      rows.push_back(row(block, true));
      rows.push_back(row(block, false));
    }
    add(rows);
  }
  for (std::size_t a = 0; a < kBlocks; ++a) {
    const auto at_a = kKeyframeUnknowns * static_cast<Eigen::Index>(a);
    for (std::size_t other = a; other < kBlocks; ++other) {
      const auto at_b = kKeyframeUnknowns * static_cast<Eigen::Index>(other);
      EXPECT_TRUE(sums.H(a, other).isApprox(
          H.block(at_a, at_b, kKeyframeUnknowns, kKeyframeUnknowns), 1e-10))
          << a << " " << other;
    }
    for (std::size_t g = 0; g < kCalibration; ++g) {
      const Eigen::VectorXd expected =
          H.block(at_a, kKeyframes + static_cast<Eigen::Index>(g), kKeyframeUnknowns, 1);
      EXPECT_LT((sums.cross(a, g) - expected).norm(), 1e-10) << a << " " << g;
    }
    EXPECT_LT((sums.b(a) - b.segment(at_a, kKeyframeUnknowns)).norm(), 1e-10) << a;
  }
  const Eigen::MatrixXd corner = H.bottomRightCorner(kCalibration, kCalibration);
  const Eigen::MatrixXd summed = sums.calibration_H().triangularView<Eigen::Upper>();
  EXPECT_LT((summed - Eigen::MatrixXd(corner.triangularView<Eigen::Upper>())).norm(), 1e-10);
  EXPECT_LT((sums.calibration_b() - b.tail(kCalibration)).norm(), 1e-10);
}

TEST_F(BundleSumsTest, BeginAnewWithEachHostButForTheCalibration) {
  sums.begin_host(kBlocks);
  add({row(0, true), row(1, true), row(1, false)});
  EXPECT_GT(sums.H(0, 1).norm(), 0);
  sums.begin_host(2);
  EXPECT_EQ(sums.H(0, 1).norm(), 0);
  EXPECT_EQ(sums.cross(1, 3).norm(), 0);
  EXPECT_GT(sums.calibration_H().norm(), 0);
}

TEST_F(BundleSumsTest, APixelThatNobodySeesAddsNothing) {
  sums.begin_host(kBlocks);
  sums.add_pixel({}, elimination);
  EXPECT_EQ(elimination.H, 0);
  EXPECT_EQ(sums.H(0, 0).norm(), 0);
}

}  // namespace
}  // namespace sgs::backend
