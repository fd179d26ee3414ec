// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/history/stored_view.h"

#include <algorithm>
#include <utility>

#include "sgs/history/view_room.h"

namespace sgs::history {
namespace {

constexpr double kUnitsPerMetre = 5000, kMostUnits = 65535;

PicturesPtr pictures_of(const RgbdFrame& frame, float units_per_m) {
  auto out = std::make_shared<Pictures>();
  out->color = frame.color;
  out->depth = Image<std::uint16_t>(frame.depth.width(), frame.depth.height());
  for (std::size_t i = 0; i < frame.depth.size(); ++i) {
    const float units = frame.depth.data()[i] * units_per_m + 0.5f;
    if (units < 65536) out->depth.data()[i] = static_cast<std::uint16_t>(units);
  }
  return out;
}

constexpr std::size_t kBits = 8;

std::vector<std::uint8_t> packed(const PixelMask& mask) {
  std::vector<std::uint8_t> out((mask.size() + kBits - 1) / kBits, 0);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (mask.data()[i] != 0) out[i / kBits] |= static_cast<std::uint8_t>(1u << (i % kBits));
  }
  return out;
}

PixelMask unpacked(const std::vector<std::uint8_t>& bits, const PinholeCamera& camera) {
  PixelMask out(camera.width, camera.height);
  for (std::size_t i = 0; i < out.size(); ++i) {
    out.data()[i] = static_cast<std::uint8_t>(bits[i / kBits] >> (i % kBits) & 1u);
  }
  return out;
}

}  // namespace

StoredView::StoredView(const RgbdFrame& frame, double farthest_m, CalibrationPtr calibration)
    : index_(frame.index),
      timestamp_s_(frame.timestamp_s),
      camera_(frame.camera),
      seen_(frame.still ? nullptr : frame.seen),
      seen_of_this_(frame.still && frame.seen ? packed(*frame.seen) : std::vector<std::uint8_t>()),
      calibration_(std::move(calibration)),
      units_per_m_(static_cast<float>(
          farthest_m > 0 ? std::min(kUnitsPerMetre, kMostUnits / farthest_m) : kUnitsPerMetre)),
      pictures_(pictures_of(frame, units_per_m_)) {}

StoredView::~StoredView() {
  if (room_) room_->forget(*this);
}

std::shared_ptr<const PixelMask> StoredView::seen() const {
  if (seen_of_this_.empty()) return seen_;
  return std::make_shared<const PixelMask>(unpacked(seen_of_this_, camera_));
}

PicturesPtr StoredView::pictures() const { return room_ ? room_->pictures(*this) : pictures_; }

DepthImage StoredView::depth(const Pictures& pictures, const CalibrationPtr& now) const {
  DepthImage out(pictures.depth.width(), pictures.depth.height());
  for (std::size_t i = 0; i < out.size(); ++i) {
    out.data()[i] = static_cast<float>(pictures.depth.data()[i]) / units_per_m_;
  }
  const auto change = depth_change(calibration_, now);
  return change ? change->apply(out) : out;
}

std::optional<RgbdFrame> StoredView::frame(const CalibrationPtr& now) const {
  const PicturesPtr kept = pictures();
  if (!kept) return std::nullopt;
  RgbdFrame out;
  out.index = index_;
  out.timestamp_s = timestamp_s_;
  out.camera = camera_;
  out.color = kept->color;
  out.depth = depth(*kept, now);
  out.seen = seen();
  return out;
}

}  // namespace sgs::history
