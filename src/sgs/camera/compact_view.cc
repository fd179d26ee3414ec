// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/compact_view.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sgs/camera/pyramid.h"
#include "sgs/core/error.h"

namespace sgs {
namespace {

constexpr float kUnitsPerMetre = 5000;

}  // namespace

CompactView::CompactView(const RgbdFrame& frame, int level)
    : level_(level),
      all_seen_(frame.seen == nullptr),
      camera_(frame.camera.halved(level)),
      index_(frame.index),
      timestamp_s_(frame.timestamp_s),
      gray_(camera_.width, camera_.height),
      depth_(camera_.width, camera_.height) {
  GrayPyramid pyramid;
  pyramid.build(frame.color, frame.camera, level + 1, frame.seen.get());
  SGS_CHECK(pyramid.levels() == level + 1, "the image cannot be halved so often");
  const Image<float>& gray = pyramid.level(level).gray;
  for (std::size_t i = 0; i < gray_.size(); ++i) {
    const float value = gray.data()[i];
    if (std::isnan(value)) continue;
    gray_.data()[i] =
        static_cast<std::uint8_t>(std::lround(all_seen_ ? value : std::max(1.0f, value)));
  }
  for (int v = 0; v < depth_.height(); ++v) {
    const float* row = frame.depth.row(v << level);
    for (int u = 0; u < depth_.width(); ++u) {
      const float units = std::round(row[u << level] * kUnitsPerMetre);
      depth_(u, v) = units < 65535 ? static_cast<std::uint16_t>(units) : std::uint16_t{0};
    }
  }
}

CompactView::CompactView(Parts parts)
    : all_seen_(parts.all_seen),
      camera_(parts.camera),
      index_(parts.index),
      timestamp_s_(parts.timestamp_s),
      gray_(std::move(parts.gray)),
      depth_(std::move(parts.depth)) {
  const auto fits = [&](const auto& image) {
    return image.width() == camera_.width && image.height() == camera_.height;
  };
  SGS_CHECK(fits(gray_) && fits(depth_), "a view's images have the size of its camera");
}

CompactView::Parts CompactView::parts() const {
  SGS_CHECK(level_ == 0, "a view that was halved is not the whole one");
  return {camera_, index_, timestamp_s_, all_seen_, gray_, depth_};
}

RgbdFrame CompactView::frame() const {
  RgbdFrame out;
  out.index = index_;
  out.timestamp_s = timestamp_s_;
  out.camera = camera_;
  out.color = ColorImage(gray_.width(), gray_.height());
  out.depth = DepthImage(depth_.width(), depth_.height());
  for (std::size_t i = 0; i < gray_.size(); ++i) {
    const std::uint8_t g = gray_.data()[i];
    out.color.data()[i] = {g, g, g};
    out.depth.data()[i] = static_cast<float>(depth_.data()[i]) / kUnitsPerMetre;
  }
  if (all_seen_) return out;
  auto seen = std::make_shared<PixelMask>(gray_.width(), gray_.height());
  std::transform(gray_.data(), gray_.data() + gray_.size(), seen->data(),
                 [](std::uint8_t g) { return std::uint8_t{g > 0}; });
  out.seen = std::move(seen);
  return out;
}

}  // namespace sgs
