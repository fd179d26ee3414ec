// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/backend/bundle.h"

#include <algorithm>
#include <array>
#include <cmath>

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

}  // namespace

/// What the points add up to.
struct Bundle::Sums {
  BundleEquations equations;
  std::vector<double> grey, depth;  // magnitudes; depth in units of the sensor's noise
};

Bundle::Bundle(BundleProblem problem, BundleState start)
    : problem_(std::move(problem)), state_(std::move(start)) {
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
std::vector<BundleRow> Bundle::rows_of(int host, std::size_t pixel, int level) const {
  const BundleRows residuals(problem_, state_);
  const auto point = residuals.point(host, pixel, level);
  if (!point) return {};
  std::vector<BundleRow> rows;
  BundleRow own;
  if (residuals.depth(*point, host, own)) rows.push_back(own);
  const std::size_t of_host = rows.size();
  for (const int target : problem_.targets[static_cast<std::size_t>(host)]) {
    BundleRow depth, grey;
    if (!residuals.depth(*point, target, depth)) continue;  // hidden, or not known to be visible
    if (!residuals.grey(*point, target, level, grey)) continue;
    rows.push_back(depth);
    rows.push_back(grey);
  }
  if (rows.size() == of_host) rows.clear();
  return rows;
}

// Which unknowns the rows of a pixel touch: those of its keyframe, of the targets that see it, and
// the nodes of the grid under them.
void Bundle::start_elimination(int host, const std::vector<BundleRow>& rows, Elimination& e) const {
  e.H = e.b = 0;
  e.keyframes.assign(1, host);
  e.globals.clear();
  for (const BundleRow& r : rows) {
    if (!r.is_depth) continue;
    if (r.target != host) e.keyframes.push_back(r.target);
    e.globals.insert(e.globals.end(), r.grid.node.begin(), r.grid.node.end());
  }
  std::sort(e.keyframes.begin() + 1, e.keyframes.end());
  std::sort(e.globals.begin(), e.globals.end());
  e.globals.erase(std::unique(e.globals.begin(), e.globals.end()), e.globals.end());
  for (int n = 0; n < 3; ++n) e.globals.push_back(grid_size() + n);
  e.coupling.setZero(kKeyframeUnknowns * static_cast<Eigen::Index>(e.keyframes.size()) +
                     static_cast<Eigen::Index>(e.globals.size()));
}

void Bundle::add_row(int host, const BundleRow& r, const BundleNoise& noise, Elimination& e,
                     Sums& sums) const {
  BundleEquations& out = sums.equations;
  const double share = problem_.config.information;
  const double sigma = r.sigma * (r.is_depth ? noise.depth : noise.grey);
  (r.is_depth ? sums.depth : sums.grey).push_back(std::abs(r.residual) / r.sigma);
  ++(r.is_depth ? out.depth_residuals : out.grey_residuals);
  const double weight = share * t_weight(r.residual, sigma);
  out.cost += share * t_cost(r.residual, sigma);
  e.H += weight * r.by_inverse_depth * r.by_inverse_depth;
  e.b += weight * r.by_inverse_depth * r.residual;
  if (r.target != host) add_keyframes(host, r, weight, e, out);
  if (r.is_depth) add_calibration(host, r, weight, e, out);
}

void Bundle::add_keyframes(int host, const BundleRow& r, double weight, Elimination& e,
                           BundleEquations& out) const {
  constexpr int kBlock = kKeyframeUnknowns;
  const int a = kBlock * host, b = kBlock * r.target;
  out.H.block<kBlock, kBlock>(a, a) += weight * r.by_host * r.by_host.transpose();
  out.H.block<kBlock, kBlock>(b, b) += weight * r.by_target * r.by_target.transpose();
  if (a < b) {
    out.H.block<kBlock, kBlock>(a, b) += weight * r.by_host * r.by_target.transpose();
  } else {
    out.H.block<kBlock, kBlock>(b, a) += weight * r.by_target * r.by_host.transpose();
  }
  out.b.segment<kBlock>(a) += weight * r.residual * r.by_host;
  out.b.segment<kBlock>(b) += weight * r.residual * r.by_target;
  const double coupling = weight * r.by_inverse_depth;
  e.coupling.segment<kBlock>(0) += coupling * r.by_host;
  const auto place = std::lower_bound(e.keyframes.begin() + 1, e.keyframes.end(), r.target);
  e.coupling.segment<kBlock>(kBlock * (place - e.keyframes.begin())) += coupling * r.by_target;
}

void Bundle::add_calibration(int host, const BundleRow& r, double weight, Elimination& e,
                             BundleEquations& out) const {
  constexpr int kBlock = kKeyframeUnknowns;
  constexpr std::size_t kTouched = 7;  // four nodes, shift, delay
  std::array<int, kTouched> where;
  std::array<double, kTouched> by;
  for (std::size_t n = 0; n < kTouched; ++n) {
    where[n] = n < 4 ? r.grid.node[n] : grid_size() + static_cast<int>(n) - 4;
    by[n] = n < 4 ? r.grid.weight[n] : r.by_shift_and_delay[static_cast<int>(n) - 4];
  }
  const Eigen::Index first_coupling = kBlock * static_cast<Eigen::Index>(e.keyframes.size());
  for (std::size_t n = 0; n < kTouched; ++n) {
    const int g = first_global() + where[n];
    if (r.target != host) {
      out.H.block<kBlock, 1>(kBlock * host, g) += weight * by[n] * r.by_host;
      out.H.block<kBlock, 1>(kBlock * r.target, g) += weight * by[n] * r.by_target;
    }
    for (std::size_t m = 0; m < kTouched; ++m) {
      const int h = first_global() + where[m];
      if (h >= g) out.H(g, h) += weight * by[n] * by[m];
    }
    out.b[g] += weight * r.residual * by[n];
    const auto place = std::lower_bound(e.globals.begin(), e.globals.end(), where[n]);
    e.coupling[first_coupling + (place - e.globals.begin())] += weight * r.by_inverse_depth * by[n];
  }
}

// Schur complement of an inverse depth.
void Bundle::subtract_eliminated(const Elimination& e, BundleEquations& out) const {
  const double inverse = 1 / e.H;
  const Eigen::VectorXd& w = e.coupling;
  const auto blocks = static_cast<Eigen::Index>(e.keyframes.size());
  const auto globals = static_cast<Eigen::Index>(e.globals.size());
  const auto place = [&](Eigen::Index k) {
    return kKeyframeUnknowns * e.keyframes[static_cast<std::size_t>(k)];
  };
  const auto global = [&](Eigen::Index k) {
    return first_global() + e.globals[static_cast<std::size_t>(k)];
  };
  const auto tail = w.tail(globals);
  for (Eigen::Index x = 0; x < blocks; ++x) {
    const KeyframeVector wx = inverse * w.segment<kKeyframeUnknowns>(kKeyframeUnknowns * x);
    for (Eigen::Index y = 0; y < blocks; ++y) {
      if (place(y) < place(x)) continue;
      out.H.block<kKeyframeUnknowns, kKeyframeUnknowns>(place(x), place(y)) -=
          wx * w.segment<kKeyframeUnknowns>(kKeyframeUnknowns * y).transpose();
    }
    for (Eigen::Index y = 0; y < globals; ++y) {
      out.H.block<kKeyframeUnknowns, 1>(place(x), global(y)) -= tail[y] * wx;
    }
    out.b.segment<kKeyframeUnknowns>(place(x)) -= e.b * wx;
  }
  for (Eigen::Index y = 0; y < globals; ++y) {
    for (Eigen::Index x = 0; x <= y; ++x) {
      out.H(global(x), global(y)) -= inverse * tail[x] * tail[y];
    }
    out.b[global(y)] -= inverse * e.b * tail[y];
  }
}

void Bundle::add_priors(BundleEquations& out) const {
  const CalibrationConfig& c = problem_.config;
  const auto keyframes = static_cast<int>(problem_.keyframes.size());
  const auto pull = [&](int unknown, double value, double sigma) {
    out.H(unknown, unknown) += 1 / (sigma * sigma);
    out.b[unknown] += value / (sigma * sigma);
    out.cost += 0.5 * value * value / (sigma * sigma);
  };
  for (int k = 0; k < keyframes; ++k) {
    const Exposure& e = state_.exposures[static_cast<std::size_t>(k)];
    pull(kKeyframeUnknowns * k + 6, e.log_gain, kLogGainSigma);
    pull(kKeyframeUnknowns * k + 7, e.offset, kBrightnessSigma);
    for (int n = 0; n < 3; ++n) {
      pull(kKeyframeUnknowns * k + 8 + n, state_.readout_turns[static_cast<std::size_t>(k)][n],
           c.readout_sigma_rad);
    }
  }
  add_offset_priors(out);
  const int after_grid = first_global() + grid_size();
  pull(after_grid, state_.shift_px.x(), c.shift_sigma_px);
  pull(after_grid + 1, state_.shift_px.y(), c.shift_sigma_px);
  pull(after_grid + 2, state_.delay_s, c.delay_sigma_s);
  // The first camera stands where it stands.
  constexpr double kHeld = 1e-9;
  for (int k = 0; k < 6; ++k) pull(k, 0, kHeld);
}

void Bundle::add_offset_priors(BundleEquations& out) const {
  const CalibrationConfig& c = problem_.config;
  const int first = first_global(), n = grid_size();
  const Eigen::VectorXd& D = state_.offsets_per_m;
  // The mean: a prior on a sum.
  const double mean_weight = 1 / (c.mean_sigma * c.mean_sigma);
  const std::vector<double> areas = problem_.grid.area();
  const Eigen::Map<const Eigen::VectorXd> area(areas.data(), n);
  out.H.block(first, first, n, n) += mean_weight * area * area.transpose();
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
  Sums sums;
  sums.equations.H.setZero(unknowns(), unknowns());
  sums.equations.b.setZero(unknowns());
  for (std::size_t i = 0; i < problem_.keyframes.size(); ++i) {
    eliminated_[i].resize(problem_.keyframes[i]->pixels.size());
    for (std::size_t p = 0; p < problem_.keyframes[i]->pixels.size(); ++p) {
      Elimination& e = eliminated_[i][p];
      const auto rows = rows_of(static_cast<int>(i), p, level);
      start_elimination(static_cast<int>(i), rows, e);
      for (const BundleRow& row : rows) add_row(static_cast<int>(i), row, noise, e, sums);
      if (e.H > 0) subtract_eliminated(e, sums.equations);
    }
  }
  add_priors(sums.equations);
  sums.equations.measured = {robust_sigma(sums.grey), robust_sigma(sums.depth)};
  return std::move(sums.equations);
}

void Bundle::apply(const Eigen::VectorXd& step) {
  SGS_CHECK(step.size() == unknowns(), "a step has one entry per unknown");
  for (std::size_t i = 0; i < eliminated_.size(); ++i) {
    for (std::size_t p = 0; p < eliminated_[i].size(); ++p) {
      const Elimination& e = eliminated_[i][p];
      if (e.H <= 0) continue;
      double rhs = e.b;
      Eigen::Index at = 0;
      for (const int k : e.keyframes) {
        rhs += e.coupling.segment<kKeyframeUnknowns>(at).dot(
            step.segment<kKeyframeUnknowns>(kKeyframeUnknowns * k));
        at += kKeyframeUnknowns;
      }
      for (const int g : e.globals) rhs += e.coupling[at++] * step[first_global() + g];
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
