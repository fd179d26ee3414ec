// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/render/reference/reference_scene.h"

#include <algorithm>
#include <cmath>

#include "sgs/render/reference/scalar_math.h"
#include "sgs/render/view.h"

namespace sgs::render::reference {
namespace {

using View = render::View<double>;

scalar::Splat<double> shape_of(const Parameters& p) {
  return {{p[0], p[1], p[2]}, {p[3], p[4], p[5]}, {p[6], p[7], p[8], p[9]}, p[10]};
}

bool sane(const Parameters& p) {
  for (const double v : p) {
    if (!std::isfinite(v)) return false;
  }
  const double norm2 = p[6] * p[6] + p[7] * p[7] + p[8] * p[8] + p[9] * p[9];
  return std::max({p[3], p[4], p[5]}) < std::log(scalar::kMaxScale_m) && norm2 > 1e-12 &&
         norm2 < 1e12 &&
         std::max({std::abs(p[11]), std::abs(p[12]), std::abs(p[13])}) < scalar::kMaxColor;
}

bool in_view(const View& view, const scalar::CameraPoint<double>& p) {
  const double m = kOutsideMargin;
  return p.z > kNearest_m && p.z < kFarthest_m && p.u > view.u_min - m && p.u < view.u_max + m &&
         p.v > view.v_min - m && p.v < view.v_max + m;
}

double alpha_at(const ImageSplat& s, double px, double py) {
  const double dx = px - s.x, dy = py - s.y;
  const double power = 0.5 * (s.conic_xx * dx * dx + s.conic_yy * dy * dy) + s.conic_xy * dx * dy;
  const double log2_alpha = s.log2_opacity - scalar::kLog2E * power;
  if (log2_alpha < -double{scalar::kLog2Of255}) return 0;
  return std::min(std::exp2(log2_alpha), double{scalar::kMaxAlpha});
}

/// One Gaussian's share of a pixel.
struct Hit {
  std::size_t splat;
  double alpha, transmittance;  ///< transmittance before it
};

/// What a pixel is composed of, front to back.
void collect_hits(std::span<const ImageSplat> splats, int x, int y, double min_transmittance,
                  std::vector<Hit>& hits) {
  hits.clear();
  double T = 1;
  for (std::size_t i = 0; i < splats.size() && T > min_transmittance; ++i) {
    const ImageSplat& s = splats[i];
    if (std::abs(x - s.x) > s.extent_x + 1e-6 || std::abs(y - s.y) > s.extent_y + 1e-6) continue;
    const double alpha = alpha_at(s, x, y);
    if (alpha <= 0) continue;
    hits.push_back({i, alpha, T});
    T *= 1 - alpha;
  }
}

using Sums = scalar::ImageGradient<double>;

/// Adds one pixel's gradients to the sums of the Gaussians that it is made of, back to front.
void backward_pixel(std::span<const ImageSplat> splats, std::span<const Hit> hits, int x, int y,
                    const Pixel& g, double nearest_z, std::vector<Sums>& sums) {
  double behind = 0;  // sum over what lies behind of w (g . value)
  for (auto hit = hits.rbegin(); hit != hits.rend(); ++hit) {
    const ImageSplat& s = splats[hit->splat];
    const double value = g[0] * s.rgb[0] + g[1] * s.rgb[1] + g[2] * s.rgb[2] + g[3] * s.z + g[4];
    const double weight = hit->alpha * hit->transmittance;
    const double d_alpha = hit->transmittance * value - behind / (1 - hit->alpha);
    behind += weight * value;
    if (s.z < nearest_z) continue;
    Sums& sum = sums[hit->splat];
    for (std::size_t c = 0; c < 3; ++c) sum.rgb[c] += weight * g[c];
    sum.z += weight * g[3];
    if (hit->alpha >= double{scalar::kMaxAlpha}) continue;
    const double h = hit->alpha * d_alpha, dx = x - s.x, dy = y - s.y;
    sum.h += h;
    sum.hx += h * dx;
    sum.hy += h * dy;
    sum.hxx += h * dx * dx;
    sum.hxy += h * dx * dy;
    sum.hyy += h * dy * dy;
  }
}

Parameters pack(const scalar::SplatGradient<double>& g, const Sums& sums) {
  return {g.mean[0],       g.mean[1],     g.mean[2],     g.log_scale[0], g.log_scale[1],
          g.log_scale[2],  g.rotation[0], g.rotation[1], g.rotation[2],  g.rotation[3],
          g.opacity_logit, sums.rgb[0],   sums.rgb[1],   sums.rgb[2]};
}

void sum_exposure(const PixelImage& image, const TrainingImage& training, Evaluation& out) {
  for (std::size_t i = 0; i < image.size(); ++i) {
    if (!(image[i][4] > 0.9) || !(training.depth.data()[i] > 0)) continue;
    const Rgbf& c = training.color.data()[i];
    const std::array<double, 3> measured = {c.r, c.g, c.b};
    for (std::size_t k = 0; k < 3; ++k) {
      if (!(measured[k] > 0.02f && measured[k] < 0.97f)) continue;
      out.exposure_measured[k] += measured[k];
      out.exposure_rendered[k] += image[i][k];
    }
  }
}

}  // namespace

Parameters to_parameters(const map::Gaussian& g) {
  Parameters p;
  std::copy_n(g.mean, 3, p.begin());
  std::copy_n(g.log_scale, 3, p.begin() + 3);
  std::copy_n(g.rotation, 4, p.begin() + 6);
  p[10] = g.opacity_logit;
  std::copy_n(g.rgb, 3, p.begin() + 11);
  return p;
}

std::vector<ImageSplat> project_all(std::span<const Parameters> gaussians,
                                    const PinholeCamera& camera, const SE3& T_world_camera,
                                    const map::GaussianSet* candidates) {
  const View view = make_view<double>(camera, T_world_camera);
  std::vector<ImageSplat> out;
  for (std::size_t i = 0; i < gaussians.size(); ++i) {
    const bool known = candidates != nullptr && i < candidates->size();
    if ((known && !candidates->contains(i)) || !sane(gaussians[i])) continue;
    const auto shape = shape_of(gaussians[i]);
    const auto p = scalar::to_camera(view, shape.mean);
    if (!in_view(view, p)) continue;
    const auto o = scalar::project(view, p, shape);
    const double reach2 = 2 * scalar::kLn2 * (o.log2_opacity + scalar::kLog2Of255);
    if (!(reach2 > 0) || !(std::max(o.cov_xx, o.cov_yy) < scalar::kMaxVariance_px2)) continue;
    ImageSplat s{i,
                 o.mean_x,
                 o.mean_y,
                 o.conic_xx,
                 o.conic_xy,
                 o.conic_yy,
                 o.log2_opacity,
                 std::sqrt(reach2 * o.cov_xx),
                 std::sqrt(reach2 * o.cov_yy),
                 p.z,
                 {gaussians[i][11], gaussians[i][12], gaussians[i][13]}};
    if (s.x + s.extent_x < 0 || s.x - s.extent_x > camera.width - 1 || s.y + s.extent_y < 0 ||
        s.y - s.extent_y > camera.height - 1) {
      continue;
    }
    out.push_back(s);
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const ImageSplat& a, const ImageSplat& b) { return a.z < b.z; });
  return out;
}

PixelImage composite(std::span<const ImageSplat> splats, const PinholeCamera& camera,
                     double min_transmittance) {
  PixelImage image;
  image.reserve(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  std::vector<Hit> hits;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      collect_hits(splats, x, y, min_transmittance, hits);
      Pixel pixel{};
      for (const Hit& hit : hits) {
        const ImageSplat& s = splats[hit.splat];
        const double w = hit.alpha * hit.transmittance;
        for (std::size_t c = 0; c < 3; ++c) pixel[c] += w * s.rgb[c];
        pixel[3] += w * s.z;
        pixel[4] += w;
      }
      image.push_back(pixel);
    }
  }
  return image;
}

Evaluation evaluate(std::span<const Parameters> gaussians, const TrainingImage& training,
                    const SE3& T_world_camera, const LossConfig& loss,
                    const EvaluateOptions& options, bool backward) {
  Evaluation out;
  const PinholeCamera& camera = training.camera;
  const auto splats = project_all(gaussians, camera, T_world_camera, options.scope.candidates);
  out.image = composite(splats, camera, options.scope.min_transmittance);
  PixelImage gradient;
  out.loss = image_loss(out.image, training, loss, gradient);
  if (!backward) return out;
  sum_exposure(out.image, training, out);

  std::vector<Sums> sums(splats.size(), Sums{});
  out.reached.assign(gaussians.size(), false);
  std::vector<Hit> hits;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) +
                     static_cast<std::size_t>(x);
      const double depth = training.depth.data()[i];
      const double nearest_z =
          loss.floater_margin_m > 0 && depth > 0 ? depth - double{loss.floater_margin_m} : 0.0;
      collect_hits(splats, x, y, options.scope.min_transmittance, hits);
      for (const Hit& hit : hits) {
        const bool weighs = hit.alpha * hit.transmittance >= double{options.capture.reached_weight};
        if (weighs) out.reached[splats[hit.splat].source] = true;
      }
      backward_pixel(splats, hits, x, y, gradient[i], nearest_z, sums);
    }
  }

  const View view = make_view<double>(camera, T_world_camera);
  out.gradient.assign(gaussians.size(), Parameters{});
  out.visible.assign(gaussians.size(), false);
  for (std::size_t k = 0; k < splats.size(); ++k) {
    const auto shape = shape_of(gaussians[splats[k].source]);
    const auto p = scalar::to_camera(view, shape.mean);
    const auto g = scalar::splat_backward(view, p, scalar::project(view, p, shape), sums[k]);
    out.gradient[splats[k].source] = pack(g, sums[k]);
    out.visible[splats[k].source] = true;
    for (int i = 0; i < 6; ++i) out.camera_twist[i] += g.twist[i];
  }
  return out;
}

}  // namespace sgs::render::reference
