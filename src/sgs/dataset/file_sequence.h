// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "sgs/dataset/frame_fit.h"
#include "sgs/dataset/frame_list.h"
#include "sgs/dataset/frame_source.h"
#include "sgs/dataset/image_size.h"

namespace sgs::dataset {

/// How the image files of a sequence are stored.
struct StoredFormat {
  Calibration calibration;  ///< of the colour images, or of a typical one where they differ
  /// Of the depth images, registered to colour; without it (fx 0) the same view as colour.
  PinholeCamera depth_camera;
  bool depth_size_differs = false;  ///< depth is known to have a size of its own
  DepthCoding depth_coding = DepthCoding::kPlain;
  double max_depth_m = std::numeric_limits<double>::infinity();  ///< farther ones are guesses
  int min_confidence = 0;  ///< depths of lower confidence are no measurements
};

/// Images of one frame as decoded, and the cameras they were taken with.
struct StoredFrame {
  ColorImage color;
  DepthImage depth;
  StoredCameras cameras;
};

/// Decodes the files of an entry. Errors name the list's line; sizes that cannot belong together
/// are kUnsupported. Where the calibration does not know the images' size (0 x 0), they say it.
Result<StoredFrame> read_stored(const FrameEntry& entry, const StoredFormat& format);

/// Frames from image files, decoded one at a time: what all recorded layouts share.
class FileSequence : public FrameSource {
 public:
  /// `format.calibration` is complete (check_calibration); `delivered` is the camera of the frames.
  FileSequence(std::string name, std::vector<FrameEntry> frames, Trajectory truth,
               const StoredFormat& format, const PinholeCamera& delivered);

  std::string name() const override { return name_; }
  PinholeCamera camera() const override { return fit_.camera(); }
  std::optional<std::int64_t> size() const override {
    return static_cast<std::int64_t>(frames_.size());
  }
  const Trajectory& ground_truth() const override { return truth_; }
  FrameRead next(RgbdFrame& frame, Error& error) override;

 private:
  Status read(const FrameEntry& entry, RgbdFrame& frame) const;
  void note_size(const FrameEntry& entry, ImageSize size) const;

  std::string name_;
  std::vector<FrameEntry> frames_;
  Trajectory truth_;
  StoredFormat format_;
  FrameFit fit_;
  std::size_t position_ = 0;
  mutable std::optional<ImageSize> size_;  ///< of the first colour image
  mutable bool sizes_told_ = false;
};

}  // namespace sgs::dataset
