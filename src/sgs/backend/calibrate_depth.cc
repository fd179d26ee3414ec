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

#include "sgs/core/error.h"
#include "sgs/core/log.h"

namespace sgs::backend {
namespace {

constexpr int kFewestKeyframes = 8;
constexpr int kFewestPixels = 40;   // per keyframe, below which it is of no use
constexpr double kSameView = 0.45;  // view distance up to which pixels are looked for
constexpr int kOtherPlace = 8;      // keyframes apart that make a view a revisit

/// Which keyframes are adjusted: those with enough contrast, thinned evenly if they are too many.
std::vector<const Keyframe*> choose_keyframes(const std::vector<Keyframe>& all, int most) {
  std::vector<const Keyframe*> useful;
  for (const Keyframe& k : all) {
    if (static_cast<int>(k.pixels.size()) >= kFewestPixels) useful.push_back(&k);
  }
  const auto n = static_cast<int>(useful.size());
  if (n <= most) return useful;
  std::vector<const Keyframe*> out;
  for (int i = 0; i < most; ++i) {
    out.push_back(useful[static_cast<std::size_t>(std::int64_t{i} * n / most)]);
  }
  return out;
}

/// For each keyframe its neighbours in time and the nearest views from other times.
std::vector<std::vector<int>> choose_targets(const std::vector<const Keyframe*>& keyframes,
                                             const CalibrationConfig& config) {
  const auto n = static_cast<int>(keyframes.size());
  std::vector<std::vector<int>> targets(keyframes.size());
  for (int i = 0; i < n; ++i) {
    const Keyframe& host = *keyframes[static_cast<std::size_t>(i)];
    std::vector<std::pair<double, int>> revisits;
    for (int j = 0; j < n; ++j) {
      if (j == i) continue;
      const double distance =
          view_distance(host, keyframes[static_cast<std::size_t>(j)]->T_world_camera);
      if (std::abs(i - j) <= config.neighbours) {
        if (distance < 2 * kSameView) targets[static_cast<std::size_t>(i)].push_back(j);
      } else if (std::abs(i - j) >= kOtherPlace && distance < kSameView) {
        revisits.emplace_back(distance, j);
      }
    }
    std::sort(revisits.begin(), revisits.end());
    for (std::size_t k = 0;
         k < std::min(revisits.size(), static_cast<std::size_t>(config.revisits)); ++k) {
      targets[static_cast<std::size_t>(i)].push_back(revisits[k].second);
    }
    std::sort(targets[static_cast<std::size_t>(i)].begin(),
              targets[static_cast<std::size_t>(i)].end());
  }
  return targets;
}

/// As tracked and measured, corrected by what is known already.
BundleState start_of(const std::vector<const Keyframe*>& keyframes, int grid_size,
                     const DepthEstimate* known) {
  BundleState state;
  state.offsets_per_m.setZero(grid_size);
  const DepthCalibration none;
  const DepthCalibration& calibration = known ? known->calibration : none;
  if (known) {
    state.offsets_per_m = Eigen::Map<const Eigen::VectorXd>(calibration.offset_per_m.data(),
                                                            std::ssize(calibration.offset_per_m));
    state.shift_px = calibration.shift_px;
    state.delay_s = calibration.delay_s;
  }
  SGS_CHECK(state.offsets_per_m.size() == grid_size, "an estimate of another grid");
  for (const Keyframe* k : keyframes) {
    state.T_world_camera.push_back(k->T_world_camera);
    state.exposures.emplace_back();
    state.readout_turns.push_back(Eigen::Vector3d::Zero());
    auto& depths = state.inverse_depths.emplace_back();
    for (const HostPixel& p : k->pixels) {
      const double corrected = p.inverse_depth + calibration.offset_at(p.u, p.v);
      depths.push_back(corrected > 0 ? corrected : p.inverse_depth);
    }
  }
  return state;
}

/// Factors that take the place of what is factored.
using Factors = Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>, Eigen::Upper>;

/// None where the equations have no solution. Their H is lost.
std::optional<Eigen::VectorXd> newton_step(BundleEquations& equations) {
  const Factors factors(equations.H);
  if (factors.info() != Eigen::Success) return {};
  Eigen::VectorXd step = -factors.solve(equations.b);
  if (!step.allFinite()) return {};
  return step;
}

/// Gauss-Newton steps at a level, until the cost falls by no more than a small part of what one
/// unknown's standard deviation is worth; `noise` follows the residuals. False when they lead
/// nowhere.
bool descend(Bundle& bundle, int level, int steps, BundleNoise& noise) {
  constexpr double kConverged = 0.05;
  constexpr BundleNoise kLeast{1, 0.1};
  for (int k = 0; k < steps; ++k) {
    BundleEquations equations = bundle.linearize(level, noise);
    noise.grey = std::max(kLeast.grey, equations.measured.grey);
    noise.depth = std::max(kLeast.depth, equations.measured.depth);
    const auto step = newton_step(equations);
    if (!step) return false;
    bundle.apply(*step);
    log().debug(
        "bundle: level {} step {}: cost {:.1f}, {} + {} residuals, grey {:.2f}, depth {:.2f}, "
        "mean offset {:.5f} /m, shift {:.2f} {:.2f} px, delay {:.4f} s",
        level, k, equations.cost, equations.grey_residuals, equations.depth_residuals, noise.grey,
        noise.depth, bundle.state().offsets_per_m.mean(), bundle.state().shift_px.x(),
        bundle.state().shift_px.y(), bundle.state().delay_s);
    const bool converged = -0.5 * equations.b.dot(*step) < kConverged;
    bundle.reuse(std::move(equations));
    if (converged) break;
  }
  return true;
}

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

/// The priors of the second solution: what the first has not shown is held near nothing. A camera
/// whose offsets vary over the image is likely to have a mean of that size, too.
CalibrationConfig held_where_unknown(CalibrationConfig config, const Bundle& bundle,
                                     const Solution& first) {
  constexpr double kHeldShift_px = 1e-3, kHeldDelay_s = 1e-6;
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
          DepthEstimate& out) {
  const BundleState& state = bundle.state();
  const int n = bundle.grid_size();
  DepthCalibration& c = out.calibration;
  out.shape_rms_per_m = solution.shape_rms;
  out.shape_sigma_per_m = solution.shape_sigma;
  out.shape_known = solution.shape_rms > solution.shape_sigma;
  out.mean_known = solution.mean_sigma < 0.5 * bundle.problem().config.mean_sigma;
  out.shift_known = shift_is_significant(bundle, solution);
  for (int k = 0; k < n; ++k) {
    c.offset_per_m.push_back((out.shape_known ? state.offsets_per_m[k] - solution.mean : 0) +
                             (out.mean_known ? solution.mean : 0));
    c.sigma_per_m.push_back(std::sqrt(std::max(first.covariance(k, k), solution.covariance(k, k))));
  }
  c.mean_sigma_per_m = std::max(first.mean_sigma, solution.mean_sigma);
  const Eigen::Vector3d sigmas = first.covariance.diagonal()
                                     .tail<3>()
                                     .cwiseMax(solution.covariance.diagonal().tail<3>())
                                     .cwiseSqrt();
  if (out.shift_known) c.shift_px = state.shift_px;
  c.shift_sigma_px = sigmas.head<2>();
  out.delay_known = delay_is_significant(bundle, solution);
  if (out.delay_known) c.delay_s = state.delay_s;
  c.delay_sigma_s = sigmas.z();
  out.grey_residuals = solution.equations.grey_residuals;
  out.depth_residuals = solution.equations.depth_residuals;
  out.noise = solution.equations.measured;
  const std::vector<const Keyframe*>& keyframes = bundle.problem().keyframes;
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    out.poses.push_back(
        {keyframes[k]->timestamp_s, keyframes[k]->T_world_camera, state.T_world_camera[k]});
  }
}

Bundle make_bundle(std::vector<const Keyframe*> keyframes, double readout_s,
                   const CalibrationConfig& config, const DepthEstimate* known) {
  BundleProblem problem;
  problem.targets = choose_targets(keyframes, config);
  problem.keyframes = std::move(keyframes);
  problem.readout_s = readout_s;
  problem.grid = {config.columns, config.rows};
  problem.config = config;
  BundleState start = start_of(problem.keyframes, problem.grid.size(), known);
  return Bundle(std::move(problem), std::move(start));
}

/// Coarse to fine; what starts near the solution is there sooner.
std::optional<Solution> solve_freely(Bundle& bundle, bool near, BundleNoise& noise) {
  if (!near && !descend(bundle, 2, 3, noise)) return {};
  if (!descend(bundle, 1, near ? 2 : 3, noise) || !descend(bundle, 0, 5, noise)) return {};
  return solution_of(bundle, noise);
}

/// Both solutions, coarse to fine, then the second from the first. False when they lead nowhere.
bool solve(Bundle& bundle, bool near, DepthEstimate& out) {
  BundleNoise noise;
  const auto first = solve_freely(bundle, near, noise);
  if (!first) return false;
  bundle.set_priors(held_where_unknown(bundle.problem().config, bundle, *first));
  if (!descend(bundle, 0, 3, noise)) return false;
  const auto second = solution_of(bundle, noise);
  if (second) fill(bundle, *first, *second, out);
  return second.has_value();
}

}  // namespace

std::vector<std::string> DepthEstimate::warnings() const {
  std::vector<std::string> out;
  constexpr double kSuspicious_px = 4, kSuspicious_s = 0.015;
  if (calibration.shift_px.norm() > kSuspicious_px) {
    out.push_back(fmt::format(
        "depth lies {:.1f} px off colour: the registration of the two cameras is probably wrong "
        "(their extrinsics, or the image size that the intrinsics are for)",
        calibration.shift_px.norm()));
  }
  if (std::abs(calibration.delay_s) > kSuspicious_s) {
    out.push_back(fmt::format(
        "depth comes {:.0f} ms after colour: the time stamps of one of the two are probably wrong",
        1e3 * calibration.delay_s));
  }
  return out;
}

DepthEstimate calibrate_depth(const std::vector<Keyframe>& all, double readout_s,
                              const CalibrationConfig& config, const DepthEstimate* known) {
  DepthEstimate out;
  auto keyframes = choose_keyframes(all, config.keyframes);
  out.keyframes = static_cast<int>(keyframes.size());
  if (out.keyframes < kFewestKeyframes) {
    out.why_not =
        fmt::format("{} keyframes show enough contrast on measured surfaces, {} are needed",
                    out.keyframes, kFewestKeyframes);
    return out;
  }
  log().debug("bundle: {} of {} keyframes, readout {:.4f} s", out.keyframes, all.size(), readout_s);
  Bundle bundle = make_bundle(std::move(keyframes), readout_s, config, known);
  out.calibration.camera = bundle.problem().keyframes.front()->gray.level(0).camera;
  out.calibration.grid = bundle.problem().grid;
  if (!solve(bundle, known != nullptr, out)) {
    out = {};
    out.why_not = "the adjustment did not converge";
  }
  return out;
}

}  // namespace sgs::backend
