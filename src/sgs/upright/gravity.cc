// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/upright/gravity.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "sgs/core/stopwatch.h"

namespace sgs::run {
namespace {

using dataset::ImuRecording;
using Directions = std::vector<Eigen::Vector3d>;

constexpr double kDegrees = 180 / std::numbers::pi;

/// An acceleration in the unit's axes, and how the camera stood then.
struct Felt {
  Eigen::Vector3d acceleration;
  Eigen::Matrix3d R_world_camera;
};

double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return kDegrees * std::atan2(a.cross(b).norm(), a.dot(b));
}

/// The samples during which the path is known, thinned to a number that is plenty for a mean.
std::vector<Felt> felt_along(const ImuRecording& imu, const Trajectory& path) {
  constexpr double kMaxGap_s = 0.2;
  constexpr std::size_t kEnough = 20000;
  constexpr double kLargest = 1e6;  // in whatever unit; its square must be a number
  const std::size_t step = 1 + imu.samples.size() / kEnough;
  std::vector<Felt> felt;
  for (std::size_t i = 0; i < imu.samples.size(); i += step) {
    const ImuSample& sample = imu.samples[i];
    const auto pose = path.at(sample.timestamp_s, kMaxGap_s);
    const bool sane = sample.acceleration.cwiseAbs().maxCoeff() < kLargest;
    if (pose && sane) felt.push_back({sample.acceleration, pose->R});
  }
  return felt;
}

/// Mean that far ones do not pull: each weighs as Huber's loss says, its threshold taken from the
/// median distance (iteratively reweighted least squares).
Eigen::Vector3d robust_mean(const Directions& vectors) {
  constexpr int kIterations = 10;
  constexpr double kHuberMedians = 2;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& v : vectors) mean += v;
  mean /= static_cast<double>(vectors.size());
  for (int i = 0; i < kIterations; ++i) {
    std::vector<double> distances;
    for (const Eigen::Vector3d& v : vectors) distances.push_back((v - mean).norm());
    const double threshold = kHuberMedians * quantile(distances, 0.5);
    if (!(threshold > 0)) break;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double weights = 0;
    for (const Eigen::Vector3d& v : vectors) {
      const double weight = std::min(1.0, threshold / std::max(1e-12, (v - mean).norm()));
      sum += weight * v;
      weights += weight;
    }
    mean = sum / weights;
  }
  return mean;
}

Gravity gravity_with(const std::vector<Felt>& felt, const Eigen::Matrix3d& R_camera_imu) {
  Directions in_world;
  for (const Felt& f : felt) {
    in_world.push_back(f.R_world_camera * (R_camera_imu * f.acceleration));
  }
  Gravity gravity;
  const Eigen::Vector3d mean = robust_mean(in_world);
  gravity.samples = felt.size();
  if (!(mean.norm() > 0)) {
    gravity.scatter_deg = 180;
    return gravity;
  }
  gravity.up = mean.normalized();
  std::vector<double> angles;
  for (const Eigen::Vector3d& v : in_world) angles.push_back(angle_deg(v, gravity.up));
  gravity.scatter_deg = quantile(angles, 0.5);
  return gravity;
}

/// The 24 rotations that bring a box onto itself.
std::vector<Eigen::Matrix3d> box_rotations() {
  std::vector<Eigen::Matrix3d> all;
  std::array<int, 3> axes = {0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Eigen::Matrix3d R = Eigen::Matrix3d::Zero();
      for (int row = 0; row < 3; ++row) {
        R(row, axes[static_cast<std::size_t>(row)]) = (signs >> row & 1) != 0 ? -1 : 1;
      }
      if (R.determinant() > 0) all.push_back(R);
    }
  } while (std::next_permutation(axes.begin(), axes.end()));
  return all;
}

/// The mounting that fits best, of those that fit about as well the one with the likeliest up.
Gravity best_mounting(const std::vector<Felt>& felt, const Eigen::Vector3d& likely_up) {
  constexpr double kAsGood = 1.3;
  std::vector<Gravity> all;
  double least_deg = 180;
  for (const Eigen::Matrix3d& R : box_rotations()) {
    all.push_back(gravity_with(felt, R));
    least_deg = std::min(least_deg, all.back().scatter_deg);
  }
  std::erase_if(all, [&](const Gravity& g) { return g.scatter_deg > kAsGood * least_deg + 1e-9; });
  return *std::max_element(all.begin(), all.end(), [&](const Gravity& a, const Gravity& b) {
    return a.up.dot(likely_up) < b.up.dot(likely_up);
  });
}

/// Whether the lengths of the accelerations are those of gravity, in whatever unit.
bool check_length(const ImuRecording& imu, const std::vector<Felt>& felt,
                  std::vector<std::string>& warnings) {
  constexpr double kStandard = 9.80665, kNear = 0.15;  // relative
  constexpr double kLargestSpread = 0.5;               // of a hand, over the median
  std::vector<double> lengths;
  for (const Felt& f : felt) lengths.push_back(f.acceleration.norm());
  const double median = quantile(lengths, 0.5);
  for (double& length : lengths) length = std::abs(length - median);
  const double spread = quantile(lengths, 0.5);
  const auto near = [&](double unit) { return std::abs(median / unit - 1) < kNear; };
  if (!(median > 0) || spread > kLargestSpread * median) {
    warnings.push_back(
        fmt::format("{}: lengths of {:.3g} +- {:.3g} are not those of gravity (9.8 m/s2): it is "
                    "not used. An accelerometer at rest must measure gravity; if the file has "
                    "motion alone, write what the sensor felt",
                    imu.source, median, spread));
    return false;
  }
  if (near(kStandard)) return true;
  const bool known = near(1) || near(1000);
  warnings.push_back(fmt::format(
      "{}: lengths of {:.4g} are {}, not m/s2: only the direction is used. Multiply the values by "
      "{:.5g}",
      imu.source, median,
      near(1)      ? "in g"
      : near(1000) ? "in thousandths of g"
                   : "in an unknown unit",
      known ? (near(1) ? kStandard : kStandard / 1000) : kStandard / median));
  return true;
}

/// Whether samples and path are of the same time.
bool check_clock(const ImuRecording& imu, const Trajectory& path, const std::vector<Felt>& felt,
                 std::vector<std::string>& warnings) {
  constexpr std::size_t kFewest = 10;
  if (felt.size() >= kFewest) return true;
  warnings.push_back(fmt::format(
      "{}: of its {} samples, from {:.6f} to {:.6f} s, {} lie within the path, from {:.6f} to "
      "{:.6f} s: it is not used. Both must be on one clock, in seconds",
      imu.source, imu.samples.size(), imu.samples.front().timestamp_s,
      imu.samples.back().timestamp_s, felt.size(), path.poses().front().timestamp_s,
      path.poses().back().timestamp_s));
  return false;
}

}  // namespace

std::optional<Gravity> estimate_gravity(const ImuRecording& imu, const Trajectory& path,
                                        const Eigen::Vector3d& likely_up,
                                        std::vector<std::string>& warnings) {
  if (imu.samples.empty() || path.empty()) return std::nullopt;
  const std::vector<Felt> felt = felt_along(imu, path);
  if (!check_clock(imu, path, felt, warnings) || !check_length(imu, felt, warnings)) {
    return std::nullopt;
  }
  const Gravity other = best_mounting(felt, likely_up);
  if (!imu.R_camera_imu) return other;
  const Gravity usual = gravity_with(felt, *imu.R_camera_imu);
  // A hand's motion alone scatters by some degrees in any axes.
  constexpr double kSurely_deg = 15, kMarkedly = 0.5;
  if (usual.scatter_deg < kSurely_deg || other.scatter_deg > kMarkedly * usual.scatter_deg) {
    return usual;
  }
  warnings.push_back(
      fmt::format("{}: in the axes that it should have, single measurements lie {:.0f} degrees off "
                  "their mean, in others {:.0f}: those are taken",
                  imu.source, usual.scatter_deg, other.scatter_deg));
  return other;
}

std::optional<Eigen::Vector3d> felt_up(const ImuRecording& imu, double time_s) {
  constexpr double kAround_s = 0.5;
  if (!imu.R_camera_imu) return std::nullopt;
  Directions near;
  for (const ImuSample& sample : imu.samples) {
    if (std::abs(sample.timestamp_s - time_s) <= kAround_s) near.push_back(sample.acceleration);
  }
  if (near.empty()) return std::nullopt;
  const Eigen::Vector3d mean = *imu.R_camera_imu * robust_mean(near);
  if (!(mean.norm() > 0) || !std::isfinite(mean.norm())) return std::nullopt;
  return mean.normalized();
}

}  // namespace sgs::run
