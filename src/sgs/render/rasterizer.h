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
  DepthImage depth;      ///< measured depth, 0 = none
};

/// A training image in a rasterizer's own layout together with everything about it that stays the
/// same from one evaluation to the next. Immutable, shareable between threads; to be handed only
/// to rasterizers of the kind (Rasterizer::name) that prepared it.
class PreparedTarget {
 public:
  explicit PreparedTarget(const PinholeCamera& camera) : camera_(camera) {}
  virtual ~PreparedTarget() = default;
  PreparedTarget(const PreparedTarget&) = delete;
  PreparedTarget& operator=(const PreparedTarget&) = delete;
  const PinholeCamera& camera() const { return camera_; }

 private:
  PinholeCamera camera_;
};

/// The loss of docs/mapping.md, section 3, summed over pixels (not averaged):
///   color_weight / 3 * sum_c |gain_c r_c - y_c|   over all pixels (or those with depth, see below)
/// + depth_weight * |D - A z| / max(z, 0.3 m)       over pixels with measured depth z (kAlpha), or
///   depth_weight * |D - z|                         (kAbsolute: the paper's form)
/// + dssim_weight * (1 - SSIM) averaged over channels, over all pixels (0 = off), SSIM between
///   gain_c r_c and y_c in an 11x11 Gaussian window (sigma 1.5) on zero-padded images.
/// Where |e| is below a knee k it is replaced by its Huber form, e^2 / 2k (and |e| - k/2 above): an
/// L1 slope that does not shrink with the residual keeps Adam's steps from settling.
struct LossConfig {
  enum class Depth { kAlphaRelative, kAbsolute };
  float color_weight = 0.8f;
  float color_knee = 0.0f;  ///< 0 = L1
  float depth_weight = 0.2f;
  float depth_knee_m = 0.0f;
  float dssim_weight = 0.0f;
  Depth depth_form = Depth::kAlphaRelative;
  bool color_only_where_depth = false;  ///< paper: pixels without depth count nothing
  /// Gaussians more than this far in front of the measured depth get no gradient (paper's
  /// "floaters"); 0 = off.
  float floater_margin_m = 0.0f;
  std::array<float, 3> gain = {1, 1, 1};  ///< exposure gain of this view per channel
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

/// Side of the tiles of EvaluateOptions::tiles, pixels.
inline constexpr int kMaskTile = 32;

/// Compositing stops at this transmittance: nothing behind is seen.
inline constexpr float kMinTransmittance = 1e-4f;

/// What an evaluation may do beside filling Gradients, and what it may leave out.
struct EvaluateOptions {
  Rendering* rendering = nullptr;  ///< where to store the forward images
  GradientSink* sink = nullptr;    ///< takes the gradient rows; Gradients::gradient stays empty
  /// Bounds of the very Gaussians that are rendered: those out of view are not even looked at. The
  /// result is the same to the bit.
  const map::MeanBounds* bounds = nullptr;
  /// One byte per Gaussian, not zero where it is frozen: drawn as ever, but neither among
  /// Gradients::visible nor in camera_twist. Empty = none is.
  std::span<const std::uint8_t> frozen = {};
  /// One byte per tile of kMaskTile pixels, row by row, zero where the loss does not count (nor the
  /// exposure sums). Gaussians that reach no other tile are left out. Empty = all count. Goes
  /// neither with `rendering` nor with D-SSIM.
  std::span<const std::uint8_t> tiles = {};
  std::vector<float>* tile_loss = nullptr;  ///< loss per tile like `tiles`, without D-SSIM
  /// Gaussians that it is known not to contain are left out. Null = all are looked at.
  const map::GaussianSet* candidates = nullptr;
  /// Gets the Gaussians that were composited, not hidden: all that weigh at least reached_weight
  /// (alpha times transmittance, in [0, 1)) in some pixel that counts, and few others. Goes not
  /// with `frozen`. May be the very set of `candidates`.
  map::GaussianSet* reached = nullptr;
  float reached_weight = 0;
  /// In (0, 1): where a training view may stop sooner than a picture.
  float min_transmittance = kMinTransmittance;
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
  virtual std::shared_ptr<const PreparedTarget> prepare(const TrainingImage& image) const = 0;

  /// One training evaluation: forward, loss against `target`, backward. Reuses `out`'s memory.
  virtual void evaluate(std::span<const map::Gaussian> gaussians, const PreparedTarget& target,
                        const SE3& T_world_camera, const LossConfig& loss, Gradients& out,
                        const EvaluateOptions& options) = 0;
  void evaluate(std::span<const map::Gaussian> gaussians, const PreparedTarget& target,
                const SE3& T_world_camera, const LossConfig& loss, Gradients& out,
                Rendering* rendering = nullptr) {
    EvaluateOptions options;
    options.rendering = rendering;
    evaluate(gaussians, target, T_world_camera, loss, out, options);
  }

  /// The same with the preparation done here each time.
  void evaluate(std::span<const map::Gaussian> gaussians, const TrainingImage& target,
                const SE3& T_world_camera, const LossConfig& loss, Gradients& out,
                Rendering* rendering = nullptr) {
    evaluate(gaussians, *prepare(target), T_world_camera, loss, out, rendering);
  }
};

/// Scalar double-precision oracle: slow, obviously correct, single-threaded.
std::unique_ptr<Rasterizer> make_reference_rasterizer();
/// SIMD rasterizer dispatched at run time; `pool` may be null (one thread) and must outlive it.
std::unique_ptr<Rasterizer> make_cpu_rasterizer(ThreadPool* pool);

}  // namespace sgs::render
