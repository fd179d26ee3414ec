// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "sgs/camera/rgbd_frame.h"
#include "sgs/history/revision.h"

namespace sgs::history {

/// The pictures of a frame as they were delivered, five bytes a pixel; what moves has no depth.
struct Pictures {
  ColorImage color;
  Image<std::uint16_t> depth;  ///< in fractions of a metre (StoredView::units_per_m()), 0: none
};
using PicturesPtr = std::shared_ptr<const Pictures>;

class ViewRoom;  // history/view_store.cc

/// A frame that is remembered. Nothing of it changes; whoever remembers it shares it, and it is
/// gone with the last of them. Thread-safe.
class StoredView {
 public:
  /// One of nobody else, of a frame as it is: its pictures stay in memory. Depth is kept in steps
  /// of a fifth of a millimetre, or as much coarser as `farthest_m` asks for; what is farther is
  /// left out. `calibration`: what has corrected it already.
  explicit StoredView(const RgbdFrame& frame, double farthest_m = 0,
                      CalibrationPtr calibration = nullptr);
  ~StoredView();
  StoredView(const StoredView&) = delete;
  StoredView& operator=(const StoredView&) = delete;

  std::int64_t index() const { return index_; }
  double timestamp_s() const { return timestamp_s_; }
  const PinholeCamera& camera() const { return camera_; }
  /// As RgbdFrame::seen, without what moves; made anew by each call where something does.
  std::shared_ptr<const PixelMask> seen() const;
  float units_per_m() const { return units_per_m_; }
  /// What its pictures take, wherever they lie.
  std::size_t bytes() const {
    return static_cast<std::size_t>(camera_.width) * static_cast<std::size_t>(camera_.height) *
           (sizeof(Rgb8) + sizeof(std::uint16_t));
  }

  /// The pictures, from memory or read from the disk; each call reads them anew there, unless
  /// somebody holds them. Null where the disk has not kept what it was given: the view is gone
  /// then, which is said once.
  PicturesPtr pictures() const;
  /// Their depth in metres, as `now` corrects it.
  DepthImage depth(const Pictures& pictures, const CalibrationPtr& now) const;
  /// The frame again, its depth as `now` corrects it. Empty where the view is gone.
  std::optional<RgbdFrame> frame(const CalibrationPtr& now) const;

 private:
  friend class ViewRoom;

  const std::int64_t index_;
  const double timestamp_s_;
  const PinholeCamera camera_;
  const std::shared_ptr<const PixelMask> seen_;   // shared by the frames of a lens
  const std::vector<std::uint8_t> seen_of_this_;  // its own, a bit a pixel; empty: seen_
  const CalibrationPtr calibration_;
  const float units_per_m_;
  // Of a view in a store, the rest guarded by its room:
  std::shared_ptr<ViewRoom> room_;
  bool changed_ = false;  // not as delivered
  PicturesPtr pictures_;  // null: on the disk, or gone
  mutable std::weak_ptr<const Pictures> lately_;
  std::int64_t at_ = -1;   // where on the disk
  std::size_t print_ = 0;  // of what was written there
  mutable bool gone_ = false;
};
using StoredViewPtr = std::shared_ptr<const StoredView>;

}  // namespace sgs::history
