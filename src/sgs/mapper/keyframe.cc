// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/keyframe.h"

#include <algorithm>
#include <cmath>

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

std::uint16_t to_units(float z, float unit_m) {
  const float units = z / unit_m + 0.5f;
  return units < 65536 ? static_cast<std::uint16_t>(units) : std::uint16_t{0};
}

/// The depth of pictures as it is known now; what moves beyond the range that is kept is dropped.
void change_depth_of(KeyframePictures& pictures, const DepthChange& change) {
  DepthImage depth(pictures.depth.width(), pictures.depth.height());
  for (std::size_t i = 0; i < depth.size(); ++i) {
    depth.data()[i] = pictures.depth_unit_m * static_cast<float>(pictures.depth.data()[i]);
  }
  depth = change.apply(depth);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    pictures.depth.data()[i] = to_units(depth.data()[i], pictures.depth_unit_m);
  }
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

MapKeyframe::MapKeyframe(const RgbdFrame& frame, const SE3& T, double max_depth_m)
    : T_world_camera(T), T_odom_camera(T), camera_(frame.camera), frame_index_(frame.index) {
  take_pictures(frame, max_depth_m);
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < pictures_->depth.size(); ++i) {
    const std::uint16_t z = pictures_->depth.data()[i];
    sum += z;
    count += z > 0;
  }
  if (count > 0) mean_depth_m_ = sum / static_cast<double>(count) * pictures_->depth_unit_m;
}

void MapKeyframe::take_pictures(const RgbdFrame& frame, double max_depth_m) {
  depth_unit_m_ = static_cast<float>(max_depth_m / 65535);
  const auto pictures = std::make_shared<KeyframePictures>();
  pictures->color = frame.color;
  pictures->seen = seen_ = frame.seen;
  pictures->depth = Image<std::uint16_t>(frame.depth.width(), frame.depth.height());
  pictures->depth_unit_m = depth_unit_m_;
  for (std::size_t i = 0; i < frame.depth.size(); ++i) {
    const float z = frame.depth.data()[i];
    if (z > 0 && z <= static_cast<float>(max_depth_m)) {
      pictures->depth.data()[i] = to_units(z, depth_unit_m_);
    }
  }
  pictures_ = pictures;
}

std::shared_ptr<const KeyframePictures> MapKeyframe::pictures() const {
  if (pictures_) return pictures_;
  auto pictures = std::make_shared<KeyframePictures>();
  read_parked(*pictures);
  return pictures;
}

void MapKeyframe::read_parked(KeyframePictures& pictures) const {
  if (pictures.color.width() != camera_.width || pictures.color.height() != camera_.height) {
    pictures.color = ColorImage(camera_.width, camera_.height);
    pictures.depth = Image<std::uint16_t>(camera_.width, camera_.height);
  }
  pictures.depth_unit_m = depth_unit_m_;
  pictures.seen = seen_;
  const std::size_t color_bytes = pictures.color.size() * sizeof(Rgb8);
  file_->read(color_at_, pictures.color.data(), color_bytes);
  file_->read(depth_at_, pictures.depth.data(), pictures.depth.size() * sizeof(std::uint16_t));
  for (const auto& change : changes_) change_depth_of(pictures, *change);
}

void MapKeyframe::change_depth(const std::shared_ptr<const DepthChange>& change) {
  pose_information.reset();
  change_pictures(change);
}

void MapKeyframe::change_pictures(const std::shared_ptr<const DepthChange>& change) {
  if (culled_) return;
  if (!pictures_) {
    changes_.push_back(change);
    return;
  }
  // In place where nobody else looks at them: copies of all keyframes would tear holes into memory.
  if (pictures_.use_count() > 1) pictures_ = std::make_shared<KeyframePictures>(*pictures_);
  change_depth_of(*pictures_, *change);
}

Status MapKeyframe::park(SpillFile& file) {
  if (!pictures_) return {};
  const auto& color = pictures_->color;
  const auto& depth = pictures_->depth;
  const std::size_t color_bytes = color.size() * sizeof(Rgb8);
  SGS_ASSIGN_OR_RETURN(color_at_, file.append(color.data(), color_bytes));
  const auto depth_at = file.append(depth.data(), depth.size() * sizeof(std::uint16_t));
  if (!depth_at) {
    file.release(color_at_, color_bytes);
    return tl::unexpected(depth_at.error());
  }
  depth_at_ = *depth_at;
  file_ = &file;
  pictures_.reset();
  return {};
}

void MapKeyframe::cull(SpillFile* file) {
  SGS_CHECK(!file_ || file_ == file, "pictures go where they were parked");
  culled_ = true;
  pictures_.reset();
  changes_.clear();
  pose_information.reset();
  const std::size_t pixels =
      static_cast<std::size_t>(camera_.width) * static_cast<std::size_t>(camera_.height);
  if (file_) {
    file->release(color_at_, pixels * sizeof(Rgb8));
    file->release(depth_at_, pixels * sizeof(std::uint16_t));
  }
  file_ = nullptr;
}

std::size_t MapKeyframe::picture_bytes() const {
  return static_cast<std::size_t>(camera_.width) * static_cast<std::size_t>(camera_.height) *
         (sizeof(Rgb8) + sizeof(std::uint16_t));
}

std::size_t half_view_bytes(const PinholeCamera& camera) {
  constexpr std::size_t kChannels = 4;  // colour and depth
  const PinholeCamera half = camera.halved(1);
  return static_cast<std::size_t>(half.width) * static_cast<std::size_t>(half.height) * kChannels *
         sizeof(float);
}

render::TrainingImage MapKeyframe::training_image(int level) const {
  render::TrainingImage image;
  KeyframePictures room;
  write_training_image(level, image, room);
  return image;
}

void MapKeyframe::write_training_image(int level, render::TrainingImage& image,
                                       KeyframePictures& room) const {
  SGS_CHECK(level == 0 || level == 1, "training images exist at full and half resolution");
  image.camera = camera_.halved(level);
  const int width = image.camera.width, height = image.camera.height;
  if (!pictures_) read_parked(room);
  const KeyframePictures& from = pictures_ ? *pictures_ : room;
  if (image.depth.width() != width || image.depth.height() != height) {
    image.color = Image<render::Rgbf>(width, height);
    image.depth = DepthImage(width, height);
  }
  for (int y = 0; y < height; ++y) {
    render::Rgbf* color = image.color.row(y);
    float* depth = image.depth.row(y);
    if (level == 0) {
      const Rgb8* c = from.color.row(y);
      const std::uint16_t* z = from.depth.row(y);
      for (int x = 0; x < width; ++x) {
        color[x] = to_float(c[x]);
        depth[x] = from.sees(x, y) ? from.depth_unit_m * static_cast<float>(z[x])
                                   : render::TrainingImage::kUnseen;
      }
      continue;
    }
    const int v = 2 * y;
    const Rgb8 *upper = from.color.row(v), *lower = from.color.row(v + 1);
    for (int x = 0; x < width; ++x) {
      const int u = 2 * x;
      color[x] = mean_color(upper[u], upper[u + 1], lower[u], lower[u + 1]);
      if (!from.sees(u, v) || !from.sees(u + 1, v) || !from.sees(u, v + 1) ||
          !from.sees(u + 1, v + 1)) {
        depth[x] = render::TrainingImage::kUnseen;
        continue;
      }
      depth[x] = merged_depth({from.depth_m(u, v), from.depth_m(u + 1, v), from.depth_m(u, v + 1),
                               from.depth_m(u + 1, v + 1)});
    }
  }
}

void TrainingViewCache::drop_half(std::size_t index) {
  SGS_CHECK(index == first_half_kept_, "views are dropped from the oldest on");
  if (index < half_.size()) half_[index].reset();
  ++first_half_kept_;
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
  if (level == 1 && index < first_half_kept_) {
    keyframe.write_training_image(1, scratch_[1], room_);
    return rasterizer_.prepare(scratch_[1]);
  }
  if (level == 1) {
    if (half_.size() <= index) half_.resize(index + 1);
    if (!half_[index]) {
      keyframe.write_training_image(1, scratch_[1], room_);
      half_[index] = rasterizer_.prepare(scratch_[1]);
    }
    return half_[index];
  }
  const auto found = std::find_if(full_.begin(), full_.end(),
                                  [&](const auto& entry) { return entry.first == index; });
  std::pair<std::size_t, std::shared_ptr<const render::TrainingView>> entry;
  if (found != full_.end()) {
    entry = *found;
  } else {
    keyframe.write_training_image(0, scratch_[0], room_);
    entry = {index, rasterizer_.prepare(scratch_[0])};
  }
  if (found != full_.end()) {
    full_.erase(found);
  } else if (full_.size() >= full_kept_) {
    full_.erase(full_.begin());
  }
  full_.push_back(entry);
  return entry.second;
}

}  // namespace sgs::mapper
