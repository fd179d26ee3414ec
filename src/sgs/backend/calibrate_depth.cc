// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/backend/calibrate_depth.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "sgs/backend/descent.h"
#include "sgs/core/log.h"

namespace sgs::backend {
namespace {

/// Factors that take the place of what is factored.
using Factors = Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>, Eigen::Upper>;

/// What a solution says of the calibration.
struct Solution {
  Eigen::MatrixXd covariance;  // of offsets, shift and delay, everything else marginalised
  double mean = 0, mean_sigma = 0;
  double shape_rms = 0, shape_sigma = 0;
  BundleEquations equations;
};

std::optional<Solution> solution_of(Bundle& bundle, const BundleNoise& noise) {
  Solution out;
  out.equations = bundle.linearize(0, noise);
  const int n = bundle.grid_size(), globals = n + 3;
  const Factors factors(out.equations.H);
  if (factors.info() != Eigen::Success) return {};
  // The last corner of the factor is that of the Schur complement: all else is marginalised there.
  const auto corner =
      factors.matrixLLT().bottomRightCorner(globals, globals).triangularView<Eigen::Upper>();
  const Eigen::MatrixXd inverse = corner.solve(Eigen::MatrixXd::Identity(globals, globals));
  out.covariance.noalias() = inverse * inverse.transpose();
  bundle.reuse(std::move(out.equations));
  const std::vector<double> areas = bundle.problem().grid.area();
  const Eigen::Map<const Eigen::VectorXd> area(areas.data(), n);
  const Eigen::VectorXd& offsets = bundle.state().offsets_per_m;
  const Eigen::VectorXd with_mean = out.covariance.topLeftCorner(n, n) * area;
  const double mean_variance = area.dot(with_mean);
  out.mean = area.dot(offsets);
  out.mean_sigma = std::sqrt(mean_variance);
  // The shape: a node against the mean of all.
  double square = 0, variance = 0;
  for (int k = 0; k < n; ++k) {
    square += area[k] * (offsets[k] - out.mean) * (offsets[k] - out.mean);
    variance += area[k] * (out.covariance(k, k) - 2 * with_mean[k] + mean_variance);
  }
  out.shape_rms = std::sqrt(square);
  out.shape_sigma = std::sqrt(variance);
  return out;
}

/// The same for whoever compares it with another's.
FreeEstimate free_estimate(const Bundle& bundle, const Solution& solution) {
  FreeEstimate out;
  const int n = bundle.grid_size();
  out.mean_per_m = solution.mean;
  out.mean_sigma_per_m = solution.mean_sigma;
  out.area = bundle.problem().grid.area();
  const Eigen::Map<const Eigen::VectorXd> area(out.area.data(), n);
  const Eigen::VectorXd with_mean = solution.covariance.topLeftCorner(n, n) * area;
  for (int k = 0; k < n; ++k) {
    out.shape_per_m.push_back(bundle.state().offsets_per_m[k] - solution.mean);
    const double variance =
        solution.covariance(k, k) - 2 * with_mean[k] + solution.mean_sigma * solution.mean_sigma;
    out.shape_sigma_per_m.push_back(std::sqrt(std::max(0.0, variance)));
  }
  out.shift_px = bundle.state().shift_px;
  out.shift_covariance = solution.covariance.block<2, 2>(n, n);
  out.delay_s = bundle.state().delay_s;
  out.delay_sigma_s = std::sqrt(solution.covariance(n + 2, n + 2));
  return out;
}

constexpr double kSignificant = 3;  // standard deviations

bool shift_is_significant(const Bundle& bundle, const Solution& solution) {
  const Eigen::Vector2d s = bundle.state().shift_px;
  const Eigen::Matrix2d covariance =
      solution.covariance.block<2, 2>(bundle.grid_size(), bundle.grid_size());
  return s.dot(covariance.inverse() * s) > kSignificant * kSignificant;
}

bool delay_is_significant(const Bundle& bundle, const Solution& solution) {
  const Eigen::Index last = solution.covariance.rows() - 1;
  return std::abs(bundle.state().delay_s) >
         kSignificant * std::sqrt(solution.covariance(last, last));
}

constexpr double kHeld_per_m = 1e-7, kHeldShift_px = 1e-3, kHeldDelay_s = 1e-6;

/// Priors that hold some parts near nothing.
CalibrationConfig holding(CalibrationConfig config, const CalibrationParts& held) {
  if (held.mean) config.mean_sigma = kHeld_per_m;
  if (held.shape) config.smooth_sigma = kHeld_per_m;
  if (held.shift) config.shift_sigma_px = kHeldShift_px;
  if (held.delay) config.delay_sigma_s = kHeldDelay_s;
  return config;
}

/// The priors of the second solution: what the first has not shown is held near nothing. A camera
/// whose offsets vary over the image is likely to have a mean of that size, too.
CalibrationConfig held_where_unknown(CalibrationConfig config, const Bundle& bundle,
                                     const Solution& first) {
  if (std::abs(first.mean) < kSignificant * first.mean_sigma) {
    const double shape = first.shape_rms > first.shape_sigma ? first.shape_rms : 0;
    config.mean_sigma = std::min(config.mean_sigma, std::max(shape, 0.1 * first.mean_sigma));
  }
  if (!shift_is_significant(bundle, first)) config.shift_sigma_px = kHeldShift_px;
  if (!delay_is_significant(bundle, first)) config.delay_sigma_s = kHeldDelay_s;
  return config;
}

/// What was held in the second solution is known as well as the first one knew it.
void fill(const Bundle& bundle, const Solution& first, const Solution& solution,
          const CalibrationParts& held, DepthEstimate& out) {
  const BundleState& state = bundle.state();
  const int n = bundle.grid_size();
  DepthCalibration& c = out.calibration;
  out.shape_rms_per_m = solution.shape_rms;
  out.shape_sigma_per_m = solution.shape_sigma;
  out.known.shape = !held.shape && solution.shape_rms > solution.shape_sigma;
  out.known.mean = !held.mean && solution.mean_sigma < 0.5 * bundle.problem().config.mean_sigma;
  out.known.shift = !held.shift && shift_is_significant(bundle, solution);
  out.known.delay = !held.delay && delay_is_significant(bundle, solution);
  for (int k = 0; k < n; ++k) {
    c.offset_per_m.push_back((out.known.shape ? state.offsets_per_m[k] - solution.mean : 0) +
                             (out.known.mean ? solution.mean : 0));
    c.sigma_per_m.push_back(std::sqrt(std::max(first.covariance(k, k), solution.covariance(k, k))));
  }
  c.mean_sigma_per_m = std::max(first.mean_sigma, solution.mean_sigma);
  const Eigen::Vector3d sigmas = first.covariance.diagonal()
                                     .tail<3>()
                                     .cwiseMax(solution.covariance.diagonal().tail<3>())
                                     .cwiseSqrt();
  if (out.known.shift) c.shift_px = state.shift_px;
  c.shift_sigma_px = sigmas.head<2>();
  if (out.known.delay) c.delay_s = state.delay_s;
  c.delay_sigma_s = sigmas.z();
  out.grey_residuals = solution.equations.grey_residuals;
  out.depth_residuals = solution.equations.depth_residuals;
  out.noise = solution.equations.measured;
  for (std::size_t k = 0; k < out.poses.size(); ++k) out.poses[k].after = state.T_world_camera[k];
}

/// Coarse to fine; what starts near the solution is there sooner.
std::optional<Solution> solve_freely(Bundle& bundle, bool near, BundleNoise& noise) {
  if (!near && !descend(bundle, 2, 3, noise)) return {};
  if (!descend(bundle, 1, near ? 2 : 3, noise) || !descend(bundle, 0, 5, noise)) return {};
  return solution_of(bundle, noise);
}

/// Both solutions, coarse to fine, then the second from the first. False when they lead nowhere.
bool solve(Bundle& bundle, bool near, const CalibrationParts& held, DepthEstimate& out) {
  BundleNoise noise;
  const auto first = solve_freely(bundle, near, noise);
  if (!first) return false;
  out.free = free_estimate(bundle, *first);
  bundle.set_priors(held_where_unknown(bundle.problem().config, bundle, *first));
  if (!descend(bundle, 0, 3, noise)) return false;
  const auto second = solution_of(bundle, noise);
  if (second) fill(bundle, *first, *second, held, out);
  return second.has_value();
}

}  // namespace

bool DepthEstimate::is_delay_suspicious() const {
  constexpr double kLate_s = 0.015, kFrame_s = 0.033, kSame_s = 0.005;
  const double delay = calibration.delay_s;
  if (std::abs(delay) > kFrame_s) return true;
  if (std::abs(delay) <= kLate_s || stamped) return false;
  return !tracked_delay_s || std::abs(delay - *tracked_delay_s) > kSame_s;
}

std::vector<std::string> DepthEstimate::warnings() const {
  std::vector<std::string> out;
  constexpr double kSuspicious_px = 4;
  if (calibration.shift_px.norm() > kSuspicious_px) {
    out.push_back(fmt::format(
        "depth lies {:.1f} px off colour: the registration of the two cameras is probably wrong "
        "(their extrinsics, or the image size that the intrinsics are for)",
        calibration.shift_px.norm()));
  }
  if (is_delay_suspicious()) {
    out.push_back(fmt::format(
        "depth comes {:.0f} ms after colour: the time stamps of one of the two are probably wrong",
        1e3 * calibration.delay_s));
  }
  return out;
}

DepthEstimate calibrate_depth(const KeyframeList& useful, double readout_s,
                              const CalibrationConfig& config, const CalibrationParts& held,
                              const DepthEstimate* known, int fewest) {
  DepthEstimate out;
  const KeyframeList keyframes = thinned(useful, config.keyframes);
  out.keyframes = static_cast<int>(keyframes.size());
  if (out.keyframes < fewest) {
    out.why_not =
        fmt::format("{} keyframes show enough contrast on measured surfaces, {} are needed",
                    out.keyframes, fewest);
    return out;
  }
  log().debug("bundle: {} of {} keyframes, readout {:.4f} s", out.keyframes, useful.size(),
              readout_s);
  out.stamped = std::any_of(keyframes.begin(), keyframes.end(),
                            [](const PlacedKeyframe& k) { return k->depth_delay_s != 0; });
  for (const PlacedKeyframe& k : keyframes) {
    out.poses.push_back({k->timestamp_s, k.T_odom_camera, k.T_odom_camera});
  }
  Bundle bundle = make_bundle(keyframes, readout_s, holding(config, held),
                              known != nullptr ? &known->calibration : nullptr);
  out.calibration.camera = bundle.problem().keyframes.front()->gray.level(0).camera;
  out.calibration.grid = bundle.problem().grid;
  if (!solve(bundle, known != nullptr, held, out)) {
    out = {};
    out.why_not = "the adjustment did not converge";
  }
  return out;
}

DepthEstimate calibrate_depth(const std::vector<Keyframe>& keyframes, const history::Path& path,
                              double readout_s, const CalibrationConfig& config,
                              const DepthEstimate* known) {
  return calibrate_depth(useful_keyframes(keyframes, path), readout_s, config, {}, known);
}

}  // namespace sgs::backend
