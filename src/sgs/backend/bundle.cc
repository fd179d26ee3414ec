// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/backend/bundle.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "sgs/core/error.h"

namespace sgs::backend {
namespace {

constexpr double kDegreesOfFreedom = 5;  // of the t distribution of all residuals
// Weak priors that keep exposures regular and fix what is common to all of them.
constexpr double kLogGainSigma = 0.3, kBrightnessSigma = 30;

double t_weight(double r, double sigma) {
  const double e2 = r * r / (sigma * sigma);
  return (kDegreesOfFreedom + 1) / (kDegreesOfFreedom + e2) / (sigma * sigma);
}

double t_cost(double r, double sigma) {
  return 0.5 * (kDegreesOfFreedom + 1) * std::log1p(r * r / (sigma * sigma) / kDegreesOfFreedom);
}

/// Standard deviation of the bulk of some residuals.
double robust_sigma(std::vector<double>& magnitudes) {
  if (magnitudes.empty()) return 0;
  const auto middle = magnitudes.begin() + static_cast<std::ptrdiff_t>(magnitudes.size() / 2);
  std::nth_element(magnitudes.begin(), middle, magnitudes.end());
  return 1.4826 * *middle;
}

/// A prior of one unknown: near nothing.
void pull(BundleEquations& out, int unknown, double value, double sigma) {
  out.H(unknown, unknown) += 1 / (sigma * sigma);
  out.b[unknown] += value / (sigma * sigma);
  out.cost += 0.5 * value * value / (sigma * sigma);
}

}  // namespace

/// Magnitudes of the residuals: grey, and depth in units of the sensor's noise.
struct Bundle::Measured {
  std::vector<double> grey, depth;

  void add(const BundleRow& r) {
    (r.is_depth ? depth : grey).push_back(std::abs(r.residual) / r.sigma);
  }
};

Bundle::Bundle(BundleProblem problem, BundleState start)
    : problem_(std::move(problem)),
      state_(std::move(start)),
      sums_(static_cast<std::size_t>(calibration_size())) {
  SGS_CHECK(state_.T_world_camera.size() == problem_.keyframes.size() &&
                state_.exposures.size() == problem_.keyframes.size() &&
                state_.readout_turns.size() == problem_.keyframes.size() &&
                state_.inverse_depths.size() == problem_.keyframes.size() &&
                state_.offsets_per_m.size() == grid_size(),
            "the state does not fit the problem");
  eliminated_.resize(problem_.keyframes.size());
}

int Bundle::first_global() const {
  return kKeyframeUnknowns * static_cast<int>(problem_.keyframes.size());
}

// A pixel that is seen nowhere but in its own keyframe says nothing: no rows.
void Bundle::collect_rows(const BundleRows& residuals, int host, std::size_t pixel, int level,
                          std::vector<BundleRow>& rows) const {
  rows.clear();
  const auto point = residuals.point(host, pixel, level);
  if (!point) return;
  BundleRow depth, grey;
  if (residuals.depth(*point, host, depth)) rows.push_back(depth);
  const std::size_t of_host = rows.size();
  for (const int target : problem_.targets[static_cast<std::size_t>(host)]) {
    if (!residuals.depth(*point, target, depth)) continue;  // hidden, or not known to be visible
    if (!residuals.grey(*point, target, level, grey)) continue;
    rows.push_back(depth);
    rows.push_back(grey);
  }
  if (rows.size() == of_host) rows.clear();
}

std::size_t Bundle::block_of(int host, int target) const {
  if (target == host) return 0;
  const auto& targets = problem_.targets[static_cast<std::size_t>(host)];
  const auto place = std::find(targets.begin(), targets.end(), target);
  return 1 + static_cast<std::size_t>(place - targets.begin());
}

WeightedRow Bundle::weighted(int host, const BundleRow& r, const BundleNoise& noise) const {
  WeightedRow out;
  out.block = block_of(host, r.target);
  const double sigma = r.sigma * (r.is_depth ? noise.depth : noise.grey);
  out.weight = problem_.config.information * t_weight(r.residual, sigma);
  out.residual = r.residual;
  out.by_inverse_depth = r.by_inverse_depth;
  std::copy(r.by_host.begin(), r.by_host.end(), out.by_host.begin());
  std::copy(r.by_target.begin(), r.by_target.end(), out.by_target.begin());
  out.is_depth = r.is_depth;
  for (std::size_t n = 0; r.is_depth && n < kTouchedCalibration; ++n) {
    const auto after_grid = static_cast<Eigen::Index>(n) - 4;
    out.calibration[n] = static_cast<std::size_t>(n < 4 ? Eigen::Index{r.grid.node[n]}
                                                        : Eigen::Index{grid_size()} + after_grid);
    out.by_calibration[n] = n < 4 ? r.grid.weight[n] : r.by_shift_and_delay[after_grid];
  }
  return out;
}

// From the corner of a keyframe and its targets to the place of each in the whole.
void Bundle::add_host(int host, const BundleSums& sums, BundleEquations& out) const {
  constexpr int kBlock = kKeyframeUnknowns;
  std::vector<int> keyframes{host};
  const auto& targets = problem_.targets[static_cast<std::size_t>(host)];
  keyframes.insert(keyframes.end(), targets.begin(), targets.end());
  for (std::size_t a = 0; a < keyframes.size(); ++a) {
    const int at_a = kBlock * keyframes[a];
    for (std::size_t b = a; b < keyframes.size(); ++b) {
      const int at_b = kBlock * keyframes[b];
      if (at_a <= at_b) {
        out.H.block<kBlock, kBlock>(at_a, at_b) += sums.H(a, b);
      } else {
        out.H.block<kBlock, kBlock>(at_b, at_a) += sums.H(a, b).transpose();
      }
    }
    for (int g = 0; g < calibration_size(); ++g) {
      out.H.block<kBlock, 1>(at_a, first_global() + g) +=
          sums.cross(a, static_cast<std::size_t>(g));
    }
    out.b.segment<kBlock>(at_a) += sums.b(a);
  }
}

void Bundle::add_priors(BundleEquations& out) const {
  const CalibrationConfig& c = problem_.config;
  const auto keyframes = static_cast<int>(problem_.keyframes.size());
  for (int k = 0; k < keyframes; ++k) {
    const Exposure& e = state_.exposures[static_cast<std::size_t>(k)];
    pull(out, kKeyframeUnknowns * k + 6, e.log_gain, kLogGainSigma);
    pull(out, kKeyframeUnknowns * k + 7, e.offset, kBrightnessSigma);
    for (int n = 0; n < 3; ++n) {
      pull(out, kKeyframeUnknowns * k + 8 + n, state_.readout_turns[static_cast<std::size_t>(k)][n],
           c.readout_sigma_rad);
    }
  }
  // The first camera stands where it stands.
  constexpr double kHeld = 1e-9;
  for (int k = 0; k < 6; ++k) pull(out, k, 0, kHeld);
}

void Bundle::add_calibration_priors(BundleEquations& out) const {
  const CalibrationConfig& c = problem_.config;
  add_offset_priors(out);
  const int after_grid = first_global() + grid_size();
  pull(out, after_grid, state_.shift_px.x(), c.shift_sigma_px);
  pull(out, after_grid + 1, state_.shift_px.y(), c.shift_sigma_px);
  pull(out, after_grid + 2, state_.delay_s, c.delay_sigma_s);
}

// Equations that say: no step.
void Bundle::hold_calibration(BundleEquations& out) const {
  const int first = first_global(), n = calibration_size();
  out.H.topRightCorner(first, n).setZero();
  out.H.bottomRightCorner(n, n).setIdentity();
  out.b.tail(n).setZero();
}

void Bundle::hold(const DepthCalibration& calibration) {
  SGS_CHECK(calibration.grid == problem_.grid, "a calibration over another grid");
  state_.offsets_per_m = Eigen::Map<const Eigen::VectorXd>(calibration.offset_per_m.data(),
                                                           std::ssize(calibration.offset_per_m));
  state_.shift_px = calibration.shift_px;
  state_.delay_s = calibration.delay_s;
  problem_.calibration_held = true;
}

void Bundle::add_offset_priors(BundleEquations& out) const {
  const CalibrationConfig& c = problem_.config;
  const int first = first_global(), n = grid_size();
  const Eigen::VectorXd& D = state_.offsets_per_m;
  // The mean: a prior on a sum.
  const double mean_weight = 1 / (c.mean_sigma * c.mean_sigma);
  const std::vector<double> areas = problem_.grid.area();
  const Eigen::Map<const Eigen::VectorXd> area(areas.data(), n);
  out.H.block(first, first, n, n).noalias() += mean_weight * area * area.transpose();
  out.b.segment(first, n) += mean_weight * area.dot(D) * area;
  const double smooth_weight = 1 / (c.smooth_sigma * c.smooth_sigma);
  const auto join = [&](int a, int b) {
    const double d = D[a] - D[b];
    out.H(first + a, first + a) += smooth_weight;
    out.H(first + b, first + b) += smooth_weight;
    out.H(first + std::min(a, b), first + std::max(a, b)) -= smooth_weight;
    out.b[first + a] += smooth_weight * d;
    out.b[first + b] -= smooth_weight * d;
  };
  const ImageGrid& grid = problem_.grid;
  for (int y = 0; y < grid.rows; ++y) {
    for (int x = 0; x < grid.columns; ++x) {
      const int k = y * grid.columns + x;
      if (x + 1 < grid.columns) join(k, k + 1);
      if (y + 1 < grid.rows) join(k, k + grid.columns);
    }
  }
}

BundleEquations Bundle::linearize(int level, const BundleNoise& noise) {
  BundleEquations out;
  out.H = std::move(H_);
  out.H.setZero(unknowns(), unknowns());
  out.b.setZero(unknowns());
  Measured measured;
  const BundleRows residuals(problem_, state_);
  sums_.begin();
  std::vector<BundleRow> rows;
  std::vector<WeightedRow> summed;
  for (int host = 0; host < std::ssize(problem_.keyframes); ++host) {
    const auto i = static_cast<std::size_t>(host);
    sums_.begin_host(1 + problem_.targets[i].size());
    eliminated_[i].resize(problem_.keyframes[i]->pixels.size());
    for (std::size_t p = 0; p < eliminated_[i].size(); ++p) {
      collect_rows(residuals, host, p, level, rows);
      summed.clear();
      for (const BundleRow& r : rows) {
        measured.add(r);
        const double sigma = r.sigma * (r.is_depth ? noise.depth : noise.grey);
        const double cost = t_cost(r.residual, sigma);
        (r.is_depth ? out.depth_cost : out.grey_cost) += cost;
        out.cost += problem_.config.information * cost;
        summed.push_back(weighted(host, r, noise));
      }
      sums_.add_pixel(summed, eliminated_[i][p]);
    }
    add_host(host, sums_, out);
  }
  out.H.bottomRightCorner(calibration_size(), calibration_size()) += sums_.calibration_H();
  out.b.tail(calibration_size()) += sums_.calibration_b();
  add_priors(out);
  if (problem_.calibration_held) {
    hold_calibration(out);
  } else {
    add_calibration_priors(out);
  }
  out.grey_residuals = static_cast<int>(measured.grey.size());
  out.depth_residuals = static_cast<int>(measured.depth.size());
  out.measured = {robust_sigma(measured.grey), robust_sigma(measured.depth)};
  return out;
}

void Bundle::apply(const Eigen::VectorXd& step) {
  SGS_CHECK(step.size() == unknowns(), "a step has one entry per unknown");
  for (std::size_t i = 0; i < eliminated_.size(); ++i) {
    for (std::size_t p = 0; p < eliminated_[i].size(); ++p) {
      const Elimination& e = eliminated_[i][p];
      if (e.H <= 0) continue;
      double rhs = e.b;
      const double* coupling = e.coupling.data();
      for (const std::size_t block : e.blocks) {
        const int k = block == 0 ? static_cast<int>(i) : problem_.targets[i][block - 1];
        rhs += Eigen::Map<const KeyframeVector>(coupling).dot(
            step.segment<kKeyframeUnknowns>(kKeyframeUnknowns * k));
        coupling += kBlockStride;
      }
      for (const std::size_t unknown : e.calibration) {
        rhs += *coupling++ * step[first_global() + static_cast<Eigen::Index>(unknown)];
      }
      double& q = state_.inverse_depths[i][p];
      q = std::clamp(q - rhs / e.H, 0.5 * q, 2 * q);
    }
  }
  for (std::size_t k = 0; k < problem_.keyframes.size(); ++k) {
    const auto block = step.segment<kKeyframeUnknowns>(kKeyframeUnknowns * static_cast<int>(k));
    SE3& T = state_.T_world_camera[k];
    T = (T * SE3::exp(block.head<6>())).normalized();
    state_.exposures[k].log_gain += block[6];
    state_.exposures[k].offset += block[7];
    state_.readout_turns[k] += block.tail<3>();
  }
  state_.offsets_per_m += step.segment(first_global(), grid_size());
  state_.shift_px += step.segment<2>(first_global() + grid_size());
  state_.delay_s += step[unknowns() - 1];
}

}  // namespace sgs::backend
