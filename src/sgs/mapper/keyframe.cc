// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/keyframe.h"

#include <algorithm>
#include <cmath>

#include "sgs/camera/depth_lag.h"

namespace sgs::mapper {
namespace {

render::Rgbf to_float(const Rgb8& c) {
  constexpr float k = 1.0f / 255;
  return {k * static_cast<float>(c.r), k * static_cast<float>(c.g), k * static_cast<float>(c.b)};
}

render::Rgbf mean_color(const Rgb8& a, const Rgb8& b, const Rgb8& c, const Rgb8& d) {
  constexpr float k = 0.25f / 255;
  return {k * static_cast<float>(a.r + b.r + c.r + d.r),
          k * static_cast<float>(a.g + b.g + c.g + d.g),
          k * static_cast<float>(a.b + b.b + c.b + d.b)};
}

/// Mean of the agreeing depths among four; 0 when fewer than two are valid or they disagree.
float merged_depth(const std::array<float, 4>& depths) {
  constexpr float kAgreement = 1.05f;
  float sum = 0, low = 0, high = 0;
  int count = 0;
  for (const float z : depths) {
    if (z <= 0) continue;
    low = count == 0 ? z : std::min(low, z);
    high = std::max(high, z);
    sum += z;
    ++count;
  }
  return count >= 2 && high <= kAgreement * low ? sum / static_cast<float>(count) : 0.0f;
}

}  // namespace

std::optional<KeyframePictures> KeyframeView::pictures() const {
  auto pictures = kept->pictures();
  if (!pictures) return std::nullopt;
  DepthImage depth = kept->depth(*pictures, calibration);
  if (!lag.isZero(0)) depth = depth_with_colour(depth, kept->camera(), lag);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    float& z = depth.data()[i];
    if (z > static_cast<float>(max_depth_m)) z = 0;
  }
  return KeyframePictures{std::move(pictures), std::move(depth), kept->seen()};
}

MapKeyframe::MapKeyframe(const RgbdFrame& frame, const SE3& T, double max_depth_m)
    : MapKeyframe({std::make_shared<const history::StoredView>(frame, max_depth_m), max_depth_m,
                   nullptr, Vector6d::Zero()},
                  T) {}

MapKeyframe::MapKeyframe(KeyframeView view, const SE3& T)
    : T_world_camera(T),
      T_odom_camera(T),
      camera_(view.kept->camera()),
      frame_index_(view.kept->index()),
      view_(std::move(view)) {
  const auto shown = pictures();
  if (!shown) return;
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < shown->depth.size(); ++i) {
    const float z = shown->depth.data()[i];
    sum += static_cast<double>(z);
    count += z > 0;
  }
  if (count > 0) mean_depth_m_ = sum / static_cast<double>(count);
}

void MapKeyframe::cull() {
  culled_ = true;
  view_ = {};
  pose_information.reset();
}

std::size_t half_view_bytes(const PinholeCamera& camera) {
  constexpr std::size_t kChannels = 4;  // colour and depth
  const PinholeCamera half = camera.halved(1);
  return static_cast<std::size_t>(half.width) * static_cast<std::size_t>(half.height) * kChannels *
         sizeof(float);
}

std::optional<render::TrainingImage> MapKeyframe::training_image(int level) const {
  render::TrainingImage image;
  if (!write_training_image(level, image)) return std::nullopt;
  return image;
}

bool MapKeyframe::write_training_image(int level, render::TrainingImage& image) const {
  SGS_CHECK(level == 0 || level == 1, "training images exist at full and half resolution");
  const auto from = pictures();
  if (!from) return false;
  image.camera = camera_.halved(level);
  const int width = image.camera.width, height = image.camera.height;
  if (image.depth.width() != width || image.depth.height() != height) {
    image.color = Image<render::Rgbf>(width, height);
    image.depth = DepthImage(width, height);
  }
  for (int y = 0; y < height; ++y) {
    render::Rgbf* color = image.color.row(y);
    float* depth = image.depth.row(y);
    if (level == 0) {
      const Rgb8* c = from->color().row(y);
      const float* z = from->depth.row(y);
      for (int x = 0; x < width; ++x) {
        color[x] = to_float(c[x]);
        depth[x] = from->sees(x, y) ? z[x] : render::TrainingImage::kUnseen;
      }
      continue;
    }
    const int v = 2 * y;
    const Rgb8 *upper = from->color().row(v), *lower = from->color().row(v + 1);
    const float *z_upper = from->depth.row(v), *z_lower = from->depth.row(v + 1);
    for (int x = 0; x < width; ++x) {
      const int u = 2 * x;
      color[x] = mean_color(upper[u], upper[u + 1], lower[u], lower[u + 1]);
      if (!from->sees(u, v) || !from->sees(u + 1, v) || !from->sees(u, v + 1) ||
          !from->sees(u + 1, v + 1)) {
        depth[x] = render::TrainingImage::kUnseen;
        continue;
      }
      depth[x] = merged_depth({z_upper[u], z_upper[u + 1], z_lower[u], z_lower[u + 1]});
    }
  }
  return true;
}

std::size_t TrainingViewCache::half_bytes(const std::vector<MapKeyframe>& keyframes) const {
  std::size_t bytes = 0;
  for (std::size_t k = first_half_kept_; k < keyframes.size(); ++k) {
    if (!keyframes[k].culled()) bytes += half_view_bytes(keyframes[k].camera());
  }
  return bytes;
}

void TrainingViewCache::drop_halves(std::size_t bytes, const std::vector<MapKeyframe>& keyframes) {
  constexpr std::size_t kKept = 64;
  for (std::size_t dropped = 0; dropped < bytes; ++first_half_kept_) {
    if (first_half_kept_ + kKept >= keyframes.size()) return;
    const MapKeyframe& keyframe = keyframes[first_half_kept_];
    if (!keyframe.culled()) dropped += half_view_bytes(keyframe.camera());
    if (first_half_kept_ < half_.size()) half_[first_half_kept_].reset();
  }
}

void TrainingViewCache::forget(std::size_t index) {
  if (index < half_.size()) half_[index].reset();
  std::erase_if(full_, [&](const auto& entry) { return entry.first == index; });
}

void TrainingViewCache::forget() {
  half_.clear();
  full_.clear();
}

std::shared_ptr<const render::TrainingView> TrainingViewCache::get(const MapKeyframe& keyframe,
                                                                   std::size_t index, int level) {
  const auto made = [&]() -> std::shared_ptr<const render::TrainingView> {
    render::TrainingImage& image = scratch_[static_cast<std::size_t>(level)];
    return keyframe.write_training_image(level, image) ? rasterizer_.prepare(image) : nullptr;
  };
  if (level == 1 && index < first_half_kept_) return made();
  if (level == 1) {
    if (half_.size() <= index) half_.resize(index + 1);
    if (!half_[index]) half_[index] = made();
    return half_[index];
  }
  const auto found = std::find_if(full_.begin(), full_.end(),
                                  [&](const auto& entry) { return entry.first == index; });
  std::pair<std::size_t, std::shared_ptr<const render::TrainingView>> entry;
  if (found != full_.end()) {
    entry = std::move(*found);
    full_.erase(found);
  } else {
    entry = {index, made()};
    if (!entry.second) return nullptr;
    if (full_.size() >= full_kept_) full_.erase(full_.begin());
  }
  full_.push_back(entry);
  return entry.second;
}

}  // namespace sgs::mapper
