// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/features/orb.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "sgs/camera/opencv_threads.h"
#include "sgs/core/error.h"
#include "sgs/features/hamming_row.h"

namespace sgs::features {

namespace {

constexpr int kPatch_px = 31;

/// Pixels around which the camera saw all that describes a feature; empty: all pixels. A corner
/// that the border of the picture makes is none.
cv::Mat patches_seen(const RgbdFrame& frame) {
  if (!frame.seen) return {};
  // cv::Mat has no const view; the source is only read.
  const cv::Mat seen(frame.seen->height(), frame.seen->width(), CV_8U,
                     const_cast<std::uint8_t*>(frame.seen->data()));
  cv::Mat out;
  cv::erode(seen, out, cv::Mat::ones(kPatch_px, kPatch_px, CV_8U), {-1, -1}, 1, cv::BORDER_CONSTANT,
            cv::Scalar(1));
  return 255 * out;
}

}  // namespace

OrbExtractor::OrbExtractor(const OrbConfig& config)
    : config_(config), last_count_(config.clahe_below) {
  keep_opencv_to_one_thread();
}

OrbFrame OrbExtractor::extract(const RgbdFrame& frame) {
  OrbFrame out;
  out.camera = frame.camera;
  cv::Mat gray(frame.color.height(), frame.color.width(), CV_8U);
  for (int y = 0; y < gray.rows; ++y) {
    const Rgb8* in = frame.color.row(y);
    std::uint8_t* row = gray.ptr<std::uint8_t>(y);
    for (int x = 0; x < gray.cols; ++x) row[x] = static_cast<std::uint8_t>(luma(in[x]) + 0.5f);
  }
  out.equalised = last_count_ < config_.clahe_below;
  if (out.equalised) {
    cv::createCLAHE(config_.clahe_clip, {config_.clahe_tiles, config_.clahe_tiles})
        ->apply(gray, gray);
  }
  const auto orb = cv::ORB::create(config_.features, 1.2f, 8, kPatch_px, 0, 2,
                                   cv::ORB::HARRIS_SCORE, kPatch_px, config_.fast_threshold);
  std::vector<cv::KeyPoint> keypoints;
  const cv::Mat whole = patches_seen(frame);
  orb->detectAndCompute(gray, whole, keypoints, out.descriptors);
  out.keypoints.reserve(keypoints.size());
  for (const auto& k : keypoints) {
    const int u = std::clamp(static_cast<int>(k.pt.x + 0.5f), 0, frame.depth.width() - 1);
    const int v = std::clamp(static_cast<int>(k.pt.y + 0.5f), 0, frame.depth.height() - 1);
    out.keypoints.push_back({{k.pt.x, k.pt.y}, k.octave, frame.depth(u, v)});
  }
  last_count_ = static_cast<int>(keypoints.size());
  return out;
}

int hamming(const std::uint8_t* a, const std::uint8_t* b) {
  int distance = 0;
  for (int i = 0; i < 4; ++i) {
    std::uint64_t x, y;
    std::memcpy(&x, a + 8 * i, 8);
    std::memcpy(&y, b + 8 * i, 8);
    distance += std::popcount(x ^ y);
  }
  return distance;
}

std::vector<Match> match_cross_check(const OrbFrame& a, const OrbFrame& b, int max_hamming) {
  const int rows = a.descriptors.rows, columns = b.descriptors.rows;
  std::vector<Match> out;
  if (rows == 0 || columns == 0) return out;
  SGS_CHECK(b.descriptors.isContinuous(), "descriptors lie row after row");
  std::vector<int> distances(static_cast<std::size_t>(columns));
  std::vector<Match> nearest_of_b(static_cast<std::size_t>(columns));
  for (int i = 0; i < rows; ++i) {
    hamming_row(a.descriptors.ptr<std::uint8_t>(i), b.descriptors.ptr<std::uint8_t>(0), columns,
                distances.data());
    Match nearest;
    for (int j = 0; j < columns; ++j) {
      const int d = distances[static_cast<std::size_t>(j)];
      if (d < nearest.distance) nearest = {i, j, d};
      Match& other = nearest_of_b[static_cast<std::size_t>(j)];
      if (d < other.distance) other = {i, j, d};
    }
    if (nearest.b >= 0 && nearest.distance <= max_hamming) out.push_back(nearest);
  }
  std::erase_if(
      out, [&](const Match& m) { return nearest_of_b[static_cast<std::size_t>(m.b)].a != m.a; });
  return out;
}

}  // namespace sgs::features
