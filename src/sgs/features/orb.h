// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "sgs/camera/rgbd_frame.h"
#include "sgs/features/features_config.h"

namespace sgs::features {

/// One ORB keypoint with its measured depth.
struct Keypoint {
  Eigen::Vector2f uv;  ///< full-image pixels
  int octave = 0;
  float depth_m = 0;  ///< 0 = none measured
};

/// ORB features of one frame; descriptor row i (32 bytes) belongs to keypoint i.
struct OrbFrame {
  PinholeCamera camera;
  std::vector<Keypoint> keypoints;
  cv::Mat descriptors;
  bool equalised = false;  ///< CLAHE was applied

  /// Point of keypoint i in camera coordinates; its depth must be known.
  Eigen::Vector3d point(int i) const {
    const Keypoint& k = keypoints[static_cast<std::size_t>(i)];
    return camera.back_project(static_cast<double>(k.uv.x()), static_cast<double>(k.uv.y()),
                               static_cast<double>(k.depth_m));
  }
};

/// Extracts ORB features (Rublee et al., ICCV 2011) with OpenCV, which is set to one thread for
/// the whole process. Remembers whether the last frame was poor in features. Not thread-safe.
class OrbExtractor {
 public:
  explicit OrbExtractor(const OrbConfig& config);
  OrbFrame extract(const RgbdFrame& frame);

 private:
  OrbConfig config_;
  int last_count_;
};

/// Index pair of a match.
struct Match {
  int a = -1, b = -1;
  int distance = 256;  ///< Hamming
};

/// Mutual nearest neighbours by Hamming distance, at most `max_hamming`, in order of a.
std::vector<Match> match_cross_check(const OrbFrame& a, const OrbFrame& b, int max_hamming = 256);

/// Hamming distance of two 32-byte descriptors.
int hamming(const std::uint8_t* a, const std::uint8_t* b);

}  // namespace sgs::features
