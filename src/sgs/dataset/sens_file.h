// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "sgs/camera/pinhole.h"
#include "sgs/core/error.h"
#include "sgs/core/image.h"
#include "sgs/geometry/se3.h"
#include "sgs/io/image_io.h"

namespace sgs::dataset {

/// ScanNet's recordings (Dai et al., CVPR 2017): one file with all images, poses and intrinsics.
/// Opening it reads the header and walks over the frames' own headers; images are read one by one.
/// No length in the file is believed: what does not fit into the file or its images is an error,
/// and nothing is allocated for it.
class SensFile {
 public:
  struct Frame {
    std::optional<SE3> T_world_camera;  ///< empty where the recording knows none
    std::uint64_t color_time_us = 0, depth_time_us = 0;
    std::uint64_t color_at = 0;  ///< of the colour image in the file; depth follows it
    std::uint64_t color_bytes = 0, depth_bytes = 0;
  };

  static Result<SensFile> open(const std::filesystem::path& path);

  const std::string& sensor() const { return sensor_; }
  const PinholeCamera& color_camera() const { return color_camera_; }
  const PinholeCamera& depth_camera() const { return depth_camera_; }
  double depth_scale() const { return depth_scale_; }  ///< raw units per metre
  const std::vector<Frame>& frames() const { return frames_; }
  std::uint64_t frames_announced() const { return announced_; }  ///< more where the file is cut off
  bool moved_cameras() const {
    return moved_cameras_;
  }  ///< the header has a transform between them

  Result<ColorImage> color(std::size_t frame);
  Result<io::RawDepth> depth(std::size_t frame);

 private:
  explicit SensFile(std::filesystem::path path) : path_(std::move(path)) {}
  Status read_header();
  Status read_cameras();
  void index_frames();
  template <class T>
  bool read(T& value);
  std::optional<std::string> read_bytes(std::uint64_t at, std::uint64_t count);
  tl::unexpected<Error> damaged(const std::string& what) const;
  std::string place(std::size_t frame, const char* what) const;

  std::filesystem::path path_;
  std::ifstream file_;
  std::uint64_t size_ = 0;
  std::string sensor_;
  PinholeCamera color_camera_, depth_camera_;
  std::int32_t color_coding_ = 0, depth_coding_ = 0;
  double depth_scale_ = 0;
  bool moved_cameras_ = false;
  std::uint64_t announced_ = 0;
  std::vector<Frame> frames_;
};

}  // namespace sgs::dataset
