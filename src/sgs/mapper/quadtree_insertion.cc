// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "sgs/camera/depth_noise.h"
#include "sgs/mapper/insertion.h"

namespace sgs::mapper {
namespace {

/// Sums over the cells of a quadtree of the grey image, its square and the colours: an integral
/// image over blocks of the smallest cell, since all cells begin and end at their borders.
class CellSums {
 public:
  CellSums(const ColorImage& image, int block)
      : block_(block), columns_(image.width() / block), stride_(columns_ + 1) {
    const int rows = image.height() / block;
    sums_.resize(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(rows + 1));
    std::vector<Sums> line(static_cast<std::size_t>(columns_));
    for (int row = 0; row < rows; ++row) {
      std::fill(line.begin(), line.end(), Sums{});
      for (int y = row * block; y < (row + 1) * block; ++y) add_line(image.row(y), line);
      Sums left{};
      for (int x = 0; x < columns_; ++x) {
        left = left + line[static_cast<std::size_t>(x)];
        at(x + 1, row + 1) = at(x + 1, row) + left;
      }
    }
  }
  double gray_deviation(int x, int y, int size) const {
    const Sums s = cell(x, y, size);
    const double n = static_cast<double>(size) * size, mean = s.gray / n;
    return std::sqrt(std::max(0.0, s.gray2 / n - mean * mean));
  }
  std::array<float, 3> mean_color(int x, int y, int size) const {
    const Sums s = cell(x, y, size);
    const double n = static_cast<double>(size) * size;
    return {static_cast<float>(s.r / n), static_cast<float>(s.g / n), static_cast<float>(s.b / n)};
  }

 private:
  struct Sums {
    double gray = 0, gray2 = 0, r = 0, g = 0, b = 0;
    Sums operator+(const Sums& o) const {
      return {gray + o.gray, gray2 + o.gray2, r + o.r, g + o.g, b + o.b};
    }
    Sums operator-(const Sums& o) const {
      return {gray - o.gray, gray2 - o.gray2, r - o.r, g - o.g, b - o.b};
    }
  };
  void add_line(const Rgb8* pixels, std::vector<Sums>& line) const {
    constexpr float kScale = 1.0f / 255;
    for (Sums& sums : line) {
      int r = 0, g = 0, b = 0;
      float gray = 0, gray2 = 0;
      for (int i = 0; i < block_; ++i, ++pixels) {
        const float value = kScale * luma(*pixels);
        gray += value;
        gray2 += value * value;
        r += pixels->r;
        g += pixels->g;
        b += pixels->b;
      }
      sums = sums + Sums{static_cast<double>(gray), static_cast<double>(gray2), r / 255.0,
                         g / 255.0, b / 255.0};
    }
  }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(stride_) +
           static_cast<std::size_t>(x);
  }
  Sums& at(int x, int y) { return sums_[index(x, y)]; }
  const Sums& at(int x, int y) const { return sums_[index(x, y)]; }
  Sums cell(int x, int y, int size) const {
    const int x0 = x / block_, y0 = y / block_, n = size / block_;
    return at(x0 + n, y0 + n) - at(x0, y0 + n) - at(x0 + n, y0) + at(x0, y0);
  }
  int block_, columns_, stride_;
  std::vector<Sums> sums_;
};

/// Size of the smallest cell: halved while it is even and no less than the smallest leaf.
int smallest_cell(const InsertionConfig& config) {
  int size = config.leaf_max_px;
  while (size % 2 == 0 && size / 2 >= config.leaf_min_px) size /= 2;
  return size;
}

/// One insertion: what its steps share.
class QuadtreeInsertion {
 public:
  QuadtreeInsertion(const MapKeyframe& keyframe, KeyframePictures pictures, int keyframe_index,
                    const render::Rendering* rendering, const InsertionConfig& config,
                    double max_growth, map::GaussianStore& store)
      : keyframe_(keyframe),
        keyframe_index_(keyframe_index),
        rendering_(rendering),
        scale_(rendering != nullptr ? rendering_scale(*rendering, keyframe.camera()) : 1),
        config_(config),
        max_growth_(max_growth),
        store_(store),
        camera_(keyframe.camera()),
        pictures_(std::move(pictures)),
        depth_(fill_depth(pictures_, config.fill_missing_depth)),
        sums_(pictures_.color(), smallest_cell(config)) {}

  void run() {
    for (int y = 0; y < camera_.height; y += config_.leaf_max_px) {
      for (int x = 0; x < camera_.width; x += config_.leaf_max_px) {
        visit(x, y, config_.leaf_max_px);
      }
    }
  }

 private:
  void visit(int x, int y, int size) {
    if (x >= camera_.width || y >= camera_.height) return;
    const bool inside = x + size <= camera_.width && y + size <= camera_.height;
    const bool can_split = size / 2 >= config_.leaf_min_px && size % 2 == 0;
    if (can_split && (!inside || is_structured(x, y, size))) {
      const int half = size / 2;
      visit(x, y, half);
      visit(x + half, y, half);
      visit(x, y + half, half);
      visit(x + half, y + half, half);
    } else if (inside) {
      add_leaf(x, y, size);
    }
  }

  bool is_structured(int x, int y, int size) const {
    if (sums_.gray_deviation(x, y, size) > config_.split_gray) return true;
    const int far = size - 1, middle = size / 2;
    const std::array<float, 5> samples = {depth_.depth(x, y), depth_.depth(x + far, y),
                                          depth_.depth(x, y + far), depth_.depth(x + far, y + far),
                                          depth_.depth(x + middle, y + middle)};
    const auto [low, high] = std::minmax_element(samples.begin(), samples.end());
    if (*high <= 0) return false;
    return *low <= 0 || *high > *low * static_cast<float>(1 + config_.split_depth);
  }

  void add_leaf(int x, int y, int size) {
    const int u = x + size / 2, v = y + size / 2;
    float z = depth_.depth(u, v);
    if (z <= 0 || !is_seen(x, y, size)) return;
    const bool borrowed = depth_.borrowed(u, v) != 0;
    if (rendering_ && !is_unexplained(x, y, size, z, borrowed)) return;
    const Eigen::Vector3f p = back_project(u, v, z);
    const Eigen::Vector3f n =
        borrowed ? Eigen::Vector3f(-p.normalized()) : normal_at(u, v, std::max(4, size / 2), p);
    add_gaussian(p, n, size, sums_.mean_color(x, y, size));
  }

  /// A leaf that reaches over the border of what the camera saw has no colour of its own.
  bool is_seen(int x, int y, int size) const {
    const int far = size - 1;
    return pictures_.sees(x, y) && pictures_.sees(x + far, y) && pictures_.sees(x, y + far) &&
           pictures_.sees(x + far, y + far);
  }

  /// Whether the map leaves this leaf open. A borrowed depth is replaced by the rendered one where
  /// the map is already half opaque: it knows better.
  bool is_unexplained(int x, int y, int size, float& z, bool borrowed) const {
    float alpha = 0, depth_sum = 0, nearest = std::numeric_limits<float>::infinity();
    for (const int dv : {size / 4, size - 1 - size / 4}) {
      for (const int du : {size / 4, size - 1 - size / 4}) {
        const int u = std::min((x + du) / scale_, rendering_->alpha.width() - 1);
        const int v = std::min((y + dv) / scale_, rendering_->alpha.height() - 1);
        alpha += 0.25f * rendering_->alpha(u, v);
        depth_sum += 0.25f * rendering_->depth_sum(u, v);
        nearest = std::min(nearest,
                           rendering_->depth_sum(u, v) / std::max(rendering_->alpha(u, v), 1e-3f));
      }
    }
    constexpr float kTrustRendering = 0.3f;
    const float rendered = depth_sum / std::max(alpha, 1e-3f);
    const bool open = alpha < static_cast<float>(config_.max_alpha);
    if (borrowed) {
      if (open && alpha > kTrustRendering) z = rendered;
      return open;
    }
    // The nearest: a leaf on an edge shows what is behind it, too, and that again and again.
    return open || nearest > z * static_cast<float>(1 + config_.front_ratio) +
                                 static_cast<float>(config_.front_margin_m);
  }

  Eigen::Vector3f back_project(int u, int v, float z) const {
    return camera_.back_project(u, v, z).cast<float>();
  }

  /// A neighbouring surface point, if it is measured and on the same surface.
  std::optional<Eigen::Vector3f> neighbour(int u, int v, float z) const {
    constexpr float kSameSurface = 0.1f;
    if (!depth_.depth.contains(u, v)) return std::nullopt;
    const float other = depth_.depth(u, v);
    if (other <= 0 || std::abs(other - z) > kSameSurface * z) return std::nullopt;
    return back_project(u, v, other);
  }

  Eigen::Vector3f normal_at(int u, int v, int distance, const Eigen::Vector3f& p) const {
    const Eigen::Vector3f facing = -p.normalized();
    const auto left = neighbour(u - distance, v, p.z()), right = neighbour(u + distance, v, p.z());
    const auto up = neighbour(u, v - distance, p.z()), down = neighbour(u, v + distance, p.z());
    if ((!left && !right) || (!up && !down)) return facing;
    const Eigen::Vector3f a = right.value_or(p) - left.value_or(p);
    const Eigen::Vector3f b = down.value_or(p) - up.value_or(p);
    const Eigen::Vector3f n = a.cross(b);
    const float length = n.norm();
    if (!(length > 1e-12f)) return facing;
    return (n.dot(facing) < 0 ? -n : n) / length;
  }

  void add_gaussian(const Eigen::Vector3f& p, const Eigen::Vector3f& n, int size,
                    const std::array<float, 3>& color) {
    // Axes: along the slope of the surface, across it, and its normal.
    const Eigen::Vector3f ray = p.normalized();
    const float cosine = std::max(0.25f, std::abs(ray.dot(n)));
    Eigen::Vector3f slope = ray - n * ray.dot(n);
    slope = slope.norm() < 1e-3f ? n.unitOrthogonal() : Eigen::Vector3f(slope.normalized());
    Eigen::Matrix3f axes;
    axes << slope, n.cross(slope), n;
    const float across = static_cast<float>(config_.sigma_tangential) * static_cast<float>(size) *
                         p.z() / static_cast<float>(camera_.fx);
    const float along = across * std::min(1 / cosine, static_cast<float>(config_.max_slant));
    const float thin = std::max(1e-4f, static_cast<float>(config_.sigma_normal) * across);

    const SE3& T = keyframe_.T_world_camera;
    const Eigen::Vector3f position = (T * p.cast<double>()).cast<float>();
    const Eigen::Quaterniond q(T.R * axes.cast<double>());
    const double opacity = config_.opacity;
    map::Gaussian g{};
    for (int k = 0; k < 3; ++k) {
      g.mean[k] = position[k];
      g.rgb[k] = color[static_cast<std::size_t>(k)] / keyframe_.gain[static_cast<std::size_t>(k)];
    }
    g.log_scale[0] = std::log(along);
    g.log_scale[1] = std::log(across);
    g.log_scale[2] = std::log(thin);
    const double wxyz[4] = {q.w(), q.x(), q.y(), q.z()};
    for (int k = 0; k < 4; ++k) g.rotation[k] = static_cast<float>(wxyz[k]);
    g.opacity_logit = static_cast<float>(std::log(opacity / (1 - opacity)));
    const map::Anchor anchor{position, (T.R * n.cast<double>()).cast<float>(),
                             depth_sigma_m(p.z()) * cosine, keyframe_index_};
    store_.append(g, anchor, longest_log_scale(g.log_scale[0], max_growth_));
  }

  const MapKeyframe& keyframe_;
  int keyframe_index_;
  const render::Rendering* rendering_;
  int scale_;  // pixels of the keyframe per pixel of the rendering
  const InsertionConfig& config_;
  double max_growth_;
  map::GaussianStore& store_;
  PinholeCamera camera_;
  KeyframePictures pictures_;
  FilledDepth depth_;
  CellSums sums_;
};

}  // namespace

std::size_t insert_quadtree(const MapKeyframe& keyframe, int keyframe_index,
                            const render::Rendering* rendering, const InsertionConfig& config,
                            double max_growth, map::GaussianStore& store) {
  auto pictures = keyframe.pictures();
  if (!pictures) return 0;
  const std::size_t before = store.size();
  QuadtreeInsertion(keyframe, std::move(*pictures), keyframe_index, rendering, config, max_growth,
                    store)
      .run();
  return store.size() - before;
}

}  // namespace sgs::mapper
