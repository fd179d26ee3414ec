// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/file_sequence.h"

#include "sgs/io/image_io.h"

namespace sgs::dataset {
namespace {

/// Ground truth is interpolated over at most this; motion capture drops out now and then.
constexpr double kMaxTruthGap_s = 0.1;

tl::unexpected<Error> from_list(Error error, const std::string& origin) {
  error.message = fmt::format("{} (named in {})", error.message, origin);
  return tl::unexpected<Error>(std::move(error));
}

}  // namespace

Result<ImagePair> read_pair(const FrameEntry& entry, double depth_scale) {
  auto color = io::load_color(entry.color);
  if (!color) return from_list(color.error(), entry.color_origin);
  auto depth = io::load_depth(entry.depth, depth_scale);
  if (!depth) return from_list(depth.error(), entry.depth_origin);
  if (color->width() != depth->width() || color->height() != depth->height()) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{} is {}x{} but {} is {}x{}", entry.color.string(), color->width(),
                            color->height(), entry.depth.string(), depth->width(), depth->height()),
                "depth must be registered to colour and of the same size");
  }
  return ImagePair{std::move(*color), std::move(*depth)};
}

FileSequence::FileSequence(std::string name, std::vector<FrameEntry> frames, Trajectory truth,
                           const Calibration& calibration)
    : name_(std::move(name)),
      frames_(std::move(frames)),
      truth_(std::move(truth)),
      calibration_(calibration) {
  SGS_CHECK(calibration.camera.valid() && calibration.depth_scale > 0, "incomplete calibration");
  if (!calibration.distortion.is_zero()) {
    undistorter_.emplace(calibration.camera, calibration.distortion);
  }
}

Status FileSequence::read(const FrameEntry& entry, RgbdFrame& frame) const {
  SGS_ASSIGN_OR_RETURN(ImagePair images, read_pair(entry, calibration_.depth_scale));
  const PinholeCamera& camera = calibration_.camera;
  if (images.color.width() != camera.width || images.color.height() != camera.height) {
    return fail(
        ErrorCode::kUnsupported,
        fmt::format("{} is {}x{} but the calibration is for {}x{}", entry.color.string(),
                    images.color.width(), images.color.height(), camera.width, camera.height));
  }
  frame.color = undistorter_ ? undistorter_->color(images.color) : std::move(images.color);
  frame.depth = undistorter_ ? undistorter_->depth(images.depth) : std::move(images.depth);
  return {};
}

FrameRead FileSequence::next(RgbdFrame& frame, Error& error) {
  if (position_ == frames_.size()) return FrameRead::kEnd;
  const FrameEntry& entry = frames_[position_];
  frame = RgbdFrame{};
  frame.index = static_cast<std::int64_t>(position_++);
  frame.timestamp_s = entry.timestamp_s;
  frame.camera = calibration_.camera;
  frame.truth_T_world_camera = truth_.at(entry.timestamp_s, kMaxTruthGap_s);
  if (auto status = read(entry, frame); !status) {
    error = std::move(status.error());
    return FrameRead::kBadFrame;
  }
  return FrameRead::kOk;
}

}  // namespace sgs::dataset
