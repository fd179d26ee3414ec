// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/pose_descent.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "sgs/camera/resample.h"
#include "sgs/render/pose_information.h"

namespace sgs::tracker {
namespace {

/// Of the Gaussians' own gradients nothing is wanted.
class NoRows : public render::GradientSink {
 public:
  void accept(std::span<const std::uint32_t>, const map::Gaussian*) override {}
};

/// Adam's moments of a twist.
class TwistAdam {
 public:
  explicit TwistAdam(const DescentConfig& config) {
    rate_ << Eigen::Vector3d::Constant(config.adam_rotation_rate),
        Eigen::Vector3d::Constant(config.adam_translation_rate);
  }
  Vector6d step(const Vector6d& gradient) {
    constexpr double kBeta1 = 0.9, kBeta2 = 0.999, kEpsilon = 1e-12;
    power1_ *= kBeta1;
    power2_ *= kBeta2;
    mean_ = kBeta1 * mean_ + (1 - kBeta1) * gradient;
    square_ = kBeta2 * square_ + (1 - kBeta2) * gradient.cwiseAbs2();
    const Vector6d size = (square_ / (1 - power2_)).cwiseSqrt().array() + kEpsilon;
    return -rate_.cwiseProduct((mean_ / (1 - power1_)).cwiseQuotient(size));
  }

 private:
  Vector6d rate_, mean_ = Vector6d::Zero(), square_ = Vector6d::Zero();
  double power1_ = 1, power2_ = 1;
};

render::TrainingImage half_size(const RgbdFrame& frame) {
  render::TrainingImage image;
  image.camera = frame.camera.halved(1);
  const ColorImage color = resample_color(frame.color, frame.camera, image.camera);
  image.depth = resample_depth(frame.depth, frame.camera, image.camera);
  image.color = Image<render::Rgbf>(color.width(), color.height());
  std::transform(color.data(), color.data() + color.size(), image.color.data(), [](const Rgb8& c) {
    constexpr float k = 1.0f / 255;
    return render::Rgbf{k * static_cast<float>(c.r), k * static_cast<float>(c.g),
                        k * static_cast<float>(c.b)};
  });
  return image;
}

/// Keeps depth where `alpha` is large enough; whether any is left.
bool keep_explained(const Image<float>& alpha, float min_alpha, DepthImage& depth) {
  bool any = false;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    float& z = depth.data()[i];
    if (alpha.data()[i] < min_alpha) z = 0;
    any = any || z > 0;
  }
  return any;
}

}  // namespace

/// What is descended on: the loss of the map's rendering against a frame, as a function of the
/// pose.
class PoseDescent::Target {
 public:
  Target(render::Rasterizer& rasterizer, std::span<const map::Gaussian> gaussians,
         const render::TrainingImage& image, const render::LossConfig& loss,
         render::Gradients& gradients)
      : rasterizer_(&rasterizer),
        gaussians_(gaussians),
        view_(rasterizer.prepare(image)),
        loss_(loss),
        gradients_(&gradients),
        curvature_(render::pose_information(image, loss)) {
    // Keeps directions that nothing determines where they are.
    curvature_.diagonal().array() += 1e-3 * static_cast<double>(image.depth.size());
  }

  /// False where it is not a number.
  bool look_from(const SE3& T_world_camera) {
    NoRows no_rows;
    rasterizer_->evaluate(gaussians_, *view_, T_world_camera, loss_, *gradients_,
                          {.sink = &no_rows});
    return std::isfinite(loss()) && gradient().allFinite();
  }
  double loss() const { return gradients_->loss; }
  const Vector6d& gradient() const { return gradients_->camera_twist; }
  Vector6d newton_step() const { return -curvature_.ldlt().solve(gradient()); }

 private:
  render::Rasterizer* rasterizer_;
  std::span<const map::Gaussian> gaussians_;
  std::shared_ptr<const render::TrainingView> view_;
  render::LossConfig loss_;
  render::Gradients* gradients_;
  Matrix6d curvature_;
};

SE3 PoseDescent::descend(std::span<const map::Gaussian> gaussians, const RgbdFrame& frame,
                         const SE3& T_world_start) {
  render::TrainingImage image = half_size(frame);
  rasterizer_->render(gaussians, image.camera, T_world_start, rendering_);
  if (!keep_explained(rendering_.alpha, static_cast<float>(config_.min_alpha), image.depth)) {
    return T_world_start;
  }
  const bool by_adam = config_.method == RenderMethod::kAdam;
  render::LossConfig loss;
  loss.color_weight = static_cast<float>(config_.descent.color_weight);
  loss.depth_weight = static_cast<float>(1 - config_.descent.color_weight);
  loss.color_only_where_depth = true;
  if (!by_adam) {
    // Newton's steps need a curvature. Knees well above what depth is off by would take its weight.
    loss.color_knee = 0.05f;
    loss.depth_knee_m = 0.005f;
  }
  Target target(*rasterizer_, gaussians, image, loss, gradients_);
  return by_adam ? adam(target, T_world_start) : newton(target, T_world_start);
}

// The promised curvature is that of ordinary residuals, mostly an upper bound, hence steps that are
// longer than Newton's. Where one does not lead down, it and those after it are halved.
SE3 PoseDescent::newton(Target& target, const SE3& T_world_start) const {
  constexpr double kLongest = 0.05, kShortest = 1e-5;  // rad and m
  double length = 1.8;
  SE3 T = T_world_start, T_best = T_world_start;
  double least = std::numeric_limits<double>::infinity();
  Vector6d step = Vector6d::Zero();
  for (int i = 0; i < config_.descent.newton_steps; ++i) {
    if (target.look_from(T) && target.loss() < least) {
      least = target.loss();
      T_best = T;
      step = length * target.newton_step();
      if (!step.allFinite()) break;
      if (step.norm() > kLongest) step *= kLongest / step.norm();
    } else {
      step *= 0.5;
      length *= 0.5;
    }
    if (step.norm() < kShortest) break;
    T = (T_best * SE3::exp(step)).normalized();
  }
  return T_best;
}

SE3 PoseDescent::adam(Target& target, const SE3& T_world_start) const {
  TwistAdam moments(config_.descent);
  SE3 T = T_world_start, T_best = T_world_start;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < config_.descent.adam_steps && target.look_from(T); ++i) {
    if (target.loss() < least) {
      least = target.loss();
      T_best = T;
    }
    T = (T * SE3::exp(moments.step(target.gradient()))).normalized();
  }
  return T_best;
}

}  // namespace sgs::tracker
