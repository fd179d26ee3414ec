// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sgs/camera/pinhole.h"
#include "sgs/core/image.h"
#include "sgs/core/thread_pool.h"
#include "sgs/geometry/se3.h"
#include "sgs/map/gaussian.h"
#include "sgs/map/gaussian_set.h"
#include "sgs/map/mean_bounds.h"
#include "sgs/render/loss_config.h"

namespace sgs::render {

/// Pixel type of the float colour image.
struct Rgbf {
  float r = 0, g = 0, b = 0;
};

/// Composited image of the map on a black background.
/// With weights w_i = alpha_i * prod_{j<i} (1 - alpha_j), front to back:
struct Rendering {
  Image<Rgbf> color;       ///< sum w_i c_i (unclamped)
  Image<float> depth_sum;  ///< D = sum w_i z_i, metres; D / alpha is the mean depth
  Image<float> alpha;      ///< A = sum w_i = 1 - final transmittance
};

/// What a training view is compared with. Prepared once per keyframe and resolution.
struct TrainingImage {
  PinholeCamera camera;  ///< its size is the images' size
  Image<Rgbf> color;     ///< measured colour, 0..1
  DepthImage depth;      ///< measured depth, 0 = none; kUnseen: nor was the colour, nothing counts

  static constexpr float kUnseen = -1;  ///< any negative depth
};

/// A training image in a rasterizer's own layout together with everything about it that stays the
/// same from one evaluation to the next. Immutable, shareable between threads; to be handed only
/// to rasterizers of the kind (Rasterizer::name) that prepared it.
class TrainingView {
 public:
  explicit TrainingView(const PinholeCamera& camera) : camera_(camera) {}
  virtual ~TrainingView() = default;
  TrainingView(const TrainingView&) = delete;
  TrainingView& operator=(const TrainingView&) = delete;
  const PinholeCamera& camera() const { return camera_; }

 private:
  PinholeCamera camera_;
};

/// Gradient rows of the Gaussians that took part in a rendering. Row fields mirror
/// map::Gaussian: d loss / d mean, log_scale, rotation (raw quaternion), opacity_logit, rgb.
struct Gradients {
  std::vector<std::uint32_t> visible;        ///< indices into the rendered span, increasing
  std::vector<map::Gaussian> gradient;       ///< one row per entry of `visible`
  Vector6d camera_twist = Vector6d::Zero();  ///< d loss / d xi of T_world_camera * exp(xi)
  double loss = 0;                           ///< value of the loss (colour + depth + dssim)
  /// Sums over the well-exposed explained pixels (alpha > 0.9, measured depth, 0.02 < y_c < 0.97)
  /// of measured y_c and rendered r_c (without gain): what an exposure gain is estimated from.
  std::array<double, 3> exposure_measured = {0, 0, 0};
  std::array<double, 3> exposure_rendered = {0, 0, 0};
};

/// Takes gradient rows while they are still in the cache, instead of Gradients::gradient.
class GradientSink {
 public:
  virtual ~GradientSink() = default;
  /// `rows[k]` is the gradient of Gaussian `indices[k]`; indices increase. Called from the pool's
  /// threads, at once for disjoint ranges of Gaussians and in no particular order; the Gaussians
  /// of `indices` are not read any more by this evaluation, so that they may be changed.
  virtual void accept(std::span<const std::uint32_t> indices, const map::Gaussian* rows) = 0;
};

/// Compositing stops at this transmittance: nothing behind is seen.
inline constexpr float kMinTransmittance = 1e-4f;

/// What an evaluation looks at.
struct ViewScope {
  /// Bounds of the very Gaussians that are rendered: those out of view are not even looked at. The
  /// result is the same to the bit. Null = all are looked at.
  const map::MeanBounds* bounds = nullptr;
  /// Gaussians that this set is known not to contain are left out. Null = none is.
  const map::GaussianSet* candidates = nullptr;
  /// In (0, 1): where a training view may stop sooner than a picture.
  float min_transmittance = kMinTransmittance;
};

/// What an evaluation notes beside filling Gradients.
struct Capture {
  Rendering* rendering = nullptr;  ///< the forward images
  /// The Gaussians that were composited, not hidden: all that weigh at least reached_weight (alpha
  /// times transmittance, in [0, 1)) in some pixel, and few others. May be the very set of
  /// ViewScope::candidates.
  map::GaussianSet* reached = nullptr;
  float reached_weight = 0;
};

/// How an evaluation goes about it; any of these may be combined.
struct EvaluateOptions {
  ViewScope scope = {};
  Capture capture = {};
  GradientSink* sink = nullptr;  ///< takes the gradient rows; Gradients::gradient stays empty
};

/// A differentiable Gaussian rasterizer: EWA projection with 0.3 px^2 low-pass, alpha clamped to
/// 0.99, contributions below 1/255 dropped, compositing stops at transmittance 1e-4
/// (kMinTransmittance). Gaussians nearer than 0.1 m, far outside the view or with non-finite or
/// absurd parameters are left out. Not thread-safe: one per user. Same input gives the same bits
/// for any number of threads.
class Rasterizer {
 public:
  virtual ~Rasterizer() = default;
  virtual std::string name() const = 0;

  /// Renders `gaussians` seen from T_world_camera into `out` (resized as needed).
  virtual void render(std::span<const map::Gaussian> gaussians, const PinholeCamera& camera,
                      const SE3& T_world_camera, Rendering& out) = 0;

  /// Converts a training image for evaluate(); once per keyframe and resolution.
  virtual std::shared_ptr<const TrainingView> prepare(const TrainingImage& image) const = 0;

  /// One training evaluation: forward, loss against `training`, backward. Reuses `out`'s memory.
  virtual void evaluate(std::span<const map::Gaussian> gaussians, const TrainingView& training,
                        const SE3& T_world_camera, const LossConfig& loss, Gradients& out,
                        const EvaluateOptions& options) = 0;
  void evaluate(std::span<const map::Gaussian> gaussians, const TrainingView& training,
                const SE3& T_world_camera, const LossConfig& loss, Gradients& out,
                Rendering* rendering = nullptr) {
    evaluate(gaussians, training, T_world_camera, loss, out, {.capture = {.rendering = rendering}});
  }

  /// The same with the preparation done here each time.
  void evaluate(std::span<const map::Gaussian> gaussians, const TrainingImage& training,
                const SE3& T_world_camera, const LossConfig& loss, Gradients& out,
                Rendering* rendering = nullptr) {
    evaluate(gaussians, *prepare(training), T_world_camera, loss, out, rendering);
  }
};

/// Scalar double-precision oracle: slow, obviously correct, single-threaded.
std::unique_ptr<Rasterizer> make_reference_rasterizer();
/// SIMD rasterizer dispatched at run time; `pool` may be null (one thread) and must outlive it.
std::unique_ptr<Rasterizer> make_cpu_rasterizer(ThreadPool* pool);

}  // namespace sgs::render
