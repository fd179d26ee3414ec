// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sgs/camera/undistort.h"
#include "sgs/dataset/frame_list.h"
#include "sgs/dataset/frame_source.h"

namespace sgs::dataset {

/// Frames from image files, decoded one at a time: what all recorded layouts share.
class FileSequence : public FrameSource {
 public:
  /// `calibration` is complete (check_calibration) and describes the images as stored.
  FileSequence(std::string name, std::vector<FrameEntry> frames, Trajectory truth,
               const Calibration& calibration);

  std::string name() const override { return name_; }
  PinholeCamera camera() const override { return calibration_.camera; }
  std::optional<std::int64_t> size() const override {
    return static_cast<std::int64_t>(frames_.size());
  }
  const Trajectory& ground_truth() const override { return truth_; }
  FrameRead next(RgbdFrame& frame, Error& error) override;

 private:
  Status read(const FrameEntry& entry, RgbdFrame& frame) const;

  std::string name_;
  std::vector<FrameEntry> frames_;
  Trajectory truth_;
  Calibration calibration_;
  std::optional<Undistorter> undistorter_;
  std::size_t position_ = 0;
};

/// Colour and depth of an entry as stored: decoded and of equal size. Errors name the list's line.
struct ImagePair {
  ColorImage color;
  DepthImage depth;
};
Result<ImagePair> read_pair(const FrameEntry& entry, double depth_scale);

}  // namespace sgs::dataset
