// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "sgs/core/error.h"
#include "sgs/core/image.h"

namespace sgs::video {

/// Writes pictures of one size as a video. The ending of the file chooses the format: .mp4 (H.264,
/// or MPEG-4 where no H.264 encoder is installed), .webm (VP9) or .avi (Motion JPEG).
class VideoFile {
 public:
  /// Another ending, a size that is not positive and an encoder that this machine does not have are
  /// errors. `fps` > 0. Odd sizes lose their last row or column: the encoders want even ones.
  static Result<VideoFile> create(const std::filesystem::path& path, int width, int height,
                                  double fps);
  VideoFile(VideoFile&&) noexcept;
  VideoFile& operator=(VideoFile&&) noexcept;
  ~VideoFile();

  /// Appends a picture; it must have the size given.
  void add(const ColorImage& picture);
  /// Ends the video and puts it in its place; until then nothing stands there. A full disk is an
  /// error that leaves nothing behind.
  Status finish();

 private:
  struct State;
  explicit VideoFile(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace sgs::video
