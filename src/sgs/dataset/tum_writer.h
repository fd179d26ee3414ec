// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "sgs/camera/rgbd_frame.h"
#include "sgs/core/error.h"
#include "sgs/geometry/trajectory.h"

namespace sgs::dataset {

/// Writes a sequence in TUM layout, frame by frame: rgb/ depth/ rgb.txt depth.txt groundtruth.txt
/// camera.txt sgs.toml. Times are exact: they read back as the same numbers. Depth has a stamp of
/// its own, later than colour's by the frame's delay. After each add() the
/// folder is a complete sequence of the frames so far, so an interrupted recording stays readable.
/// Not thread-safe.
class TumSequenceWriter {
 public:
  struct Options {
    std::string name;           ///< goes into sgs.toml; empty = the folder's name
    double depth_scale = 5000;  ///< raw units per metre
    bool jpeg_color = false;    ///< false: PNG, lossless
    int jpeg_quality = 95;
    Distortion distortion = {};  ///< that the frames still have: removed when they are read
  };

  /// Creates the folder, which must not exist or be empty, and writes the calibration.
  static Result<TumSequenceWriter> create(const std::filesystem::path& folder,
                                          const PinholeCamera& camera, Options options);
  static Result<TumSequenceWriter> create(const std::filesystem::path& folder,
                                          const PinholeCamera& camera) {
    return create(folder, camera, Options{});
  }

  /// Writes one frame; its truth pose, where it has one, goes to groundtruth.txt. Frames must have
  /// the camera's size and increasing times (at 1e-6 s).
  Status add(const RgbdFrame& frame);

  /// Replaces groundtruth.txt by a trajectory, e.g. one sampled more densely than the frames.
  Status write_ground_truth(const Trajectory& truth);

  std::size_t frames() const { return frames_; }

 private:
  TumSequenceWriter(std::filesystem::path folder, const PinholeCamera& camera, Options options);

  std::filesystem::path folder_;
  PinholeCamera camera_;
  Options options_;
  std::size_t frames_ = 0;
  double last_time_s_ = 0;
};

}  // namespace sgs::dataset
