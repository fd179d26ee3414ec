// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/video/video_file.h"

#include <fmt/format.h>

#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <vector>

#include "sgs/io/atomic_file.h"

namespace sgs::video {
namespace {

namespace fs = std::filesystem;

/// Encoders for an ending, the best first; none for one that is not known.
std::vector<int> codecs_for(const std::string& ending) {
  using cv::VideoWriter;
  if (ending == ".mp4") {
    return {VideoWriter::fourcc('a', 'v', 'c', '1'), VideoWriter::fourcc('m', 'p', '4', 'v')};
  }
  if (ending == ".webm") return {VideoWriter::fourcc('V', 'P', '9', '0')};
  if (ending == ".avi") return {VideoWriter::fourcc('M', 'J', 'P', 'G')};
  return {};
}

/// Written beside the file, under a name with the same ending: that is what chooses the container.
fs::path unfinished(const fs::path& path) {
  return path.parent_path() /
         fmt::format(".{}-unfinished{}", path.stem().string(), path.extension().string());
}

}  // namespace

struct VideoFile::State {
  fs::path path, temporary;
  int width = 0, height = 0;
  std::int64_t pictures = 0;
  cv::VideoWriter writer;

  ~State() {
    if (!writer.isOpened()) return;
    writer.release();
    std::error_code ignored;
    fs::remove(temporary, ignored);
  }
};

VideoFile::VideoFile(std::unique_ptr<State> state) : state_(std::move(state)) {}
VideoFile::VideoFile(VideoFile&&) noexcept = default;
VideoFile& VideoFile::operator=(VideoFile&&) noexcept = default;
VideoFile::~VideoFile() = default;

Result<VideoFile> VideoFile::create(const fs::path& path, int width, int height, double fps) {
  auto state = std::make_unique<State>();
  state->path = path;
  state->temporary = unfinished(path);
  state->width = width / 2 * 2;
  state->height = height / 2 * 2;
  const auto codecs = codecs_for(path.extension().string());
  if (codecs.empty()) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: '{}' is no video format that can be written", path.string(),
                            path.extension().string()),
                "end the name in .mp4, .webm or .avi");
  }
  if (state->width <= 0 || state->height <= 0 || !(fps > 0)) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: a video of {}x{} pixels cannot be", path.string(), width, height));
  }
  if (!path.parent_path().empty()) SGS_RETURN_IF_ERROR(io::make_folder(path.parent_path()));
  for (const int codec : codecs) {
    if (state->writer.open(state->temporary.string(), codec, fps,
                           cv::Size(state->width, state->height))) {
      return VideoFile(std::move(state));
    }
  }
  return fail(ErrorCode::kUnsupported,
              fmt::format("{} cannot be written: no encoder for {}, or no right to write there",
                          path.string(), path.extension().string()),
              "try .avi, which needs no library beside OpenCV");
}

void VideoFile::add(const ColorImage& picture) {
  SGS_CHECK(picture.width() / 2 * 2 == state_->width && picture.height() / 2 * 2 == state_->height,
            "all pictures of a video have one size");
  ColorImage copy = picture;
  const cv::Mat rgb(picture.height(), picture.width(), CV_8UC3, copy.data());
  cv::Mat bgr;
  cv::cvtColor(rgb(cv::Rect(0, 0, state_->width, state_->height)), bgr, cv::COLOR_RGB2BGR);
  state_->writer.write(bgr);
  ++state_->pictures;
}

Status VideoFile::finish() {
  state_->writer.release();
  std::error_code error;
  const auto bytes = fs::file_size(state_->temporary, error);
  // The encoder does not say that the disk was full: an empty file does, or one that is missing.
  if (error || bytes == 0 || state_->pictures == 0) {
    std::error_code ignored;
    fs::remove(state_->temporary, ignored);
    return fail(ErrorCode::kIo, fmt::format("{} could not be written", state_->path.string()),
                "is there space on the disk?");
  }
  fs::rename(state_->temporary, state_->path, error);
  if (!error) return {};
  return fail(ErrorCode::kIo,
              fmt::format("{} could not be written: {}", state_->path.string(), error.message()));
}

}  // namespace sgs::video
