// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/file_sequence.h"

#include <cmath>

#include "sgs/camera/resample.h"
#include "sgs/io/image_io.h"

namespace sgs::dataset {
namespace {

/// Ground truth is interpolated over at most this; motion capture drops out now and then.
constexpr double kMaxTruthGap_s = 0.1;

tl::unexpected<Error> from_list(Error error, const std::string& origin) {
  error.message = fmt::format("{} (named in {})", error.message, origin);
  return tl::unexpected<Error>(std::move(error));
}

/// SUN3D turns the bits of each value so that viewers show something: the low three come last.
void unturn_bits(io::RawDepth& raw) {
  for (std::size_t i = 0; i < raw.size(); ++i) {
    const unsigned value = raw.data()[i];
    raw.data()[i] = static_cast<std::uint16_t>(value >> 3 | value << 13);
  }
}

void drop_beyond(DepthImage& depth, double max_depth_m) {
  if (std::isinf(max_depth_m)) return;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (static_cast<double>(depth.data()[i]) > max_depth_m) depth.data()[i] = 0;
  }
}

Status drop_unsure(DepthImage& depth, const std::filesystem::path& path, int min_confidence) {
  if (path.empty() || min_confidence <= 0) return {};
  SGS_ASSIGN_OR_RETURN(const GrayImage confidence, io::load_gray(path));
  if (confidence.width() != depth.width() || confidence.height() != depth.height()) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{} is {}x{} but its depth is {}x{}", path.string(), confidence.width(),
                            confidence.height(), depth.width(), depth.height()));
  }
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (confidence.data()[i] < min_confidence) depth.data()[i] = 0;
  }
  return {};
}

Result<DepthImage> read_depth(const FrameEntry& entry, const StoredFormat& format) {
  SGS_ASSIGN_OR_RETURN(io::RawDepth raw, io::load_raw_depth(entry.depth));
  if (format.depth_coding == DepthCoding::kTurnedBits) unturn_bits(raw);
  DepthImage depth = io::depth_in_metres(raw, format.calibration.depth_scale);
  drop_beyond(depth, format.max_depth_m);
  SGS_RETURN_IF_ERROR(drop_unsure(depth, entry.confidence, format.min_confidence));
  return depth;
}

/// The same view in two sizes: equal shapes, up to a pixel of rounding.
bool same_shape(const ColorImage& color, const DepthImage& depth) {
  const double height = static_cast<double>(color.height()) * depth.width() / color.width();
  return std::abs(height - depth.height()) <= 1;
}

/// A camera that does not know its size takes that of the image.
template <class T>
PinholeCamera sized(PinholeCamera camera, const Image<T>& image) {
  if (camera.width != 0) return camera;
  camera.width = image.width();
  camera.height = image.height();
  return camera;
}

}  // namespace

Result<StoredFrame> read_stored(const FrameEntry& entry, const StoredFormat& format) {
  auto color = io::load_color(entry.color);
  if (!color) return from_list(color.error(), entry.color_origin);
  auto depth = read_depth(entry, format);
  if (!depth) return from_list(depth.error(), entry.depth_origin);
  const bool equal = color->width() == depth->width() && color->height() == depth->height();
  const bool own_camera = format.depth_camera.fx > 0;
  if (!equal && !own_camera && !(format.depth_size_differs && same_shape(*color, *depth))) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{} is {}x{} but {} is {}x{}", entry.color.string(), color->width(),
                            color->height(), entry.depth.string(), depth->width(), depth->height()),
                format.depth_size_differs
                    ? "depth must show the same view as colour"
                    : "depth must be registered to colour and of the same size");
  }
  StoredCameras cameras;
  cameras.color = sized(entry.camera.value_or(format.calibration.camera), *color);
  cameras.depth = own_camera ? sized(format.depth_camera, *depth)
                  : equal    ? cameras.color
                             : scaled_to(cameras.color, depth->width(), depth->height());
  return StoredFrame{std::move(*color), std::move(*depth), cameras};
}

FileSequence::FileSequence(std::string name, std::vector<FrameEntry> frames, Trajectory truth,
                           const StoredFormat& format, const PinholeCamera& delivered)
    : name_(std::move(name)),
      frames_(std::move(frames)),
      truth_(std::move(truth)),
      format_(format),
      fit_(delivered, format.calibration.distortion) {
  SGS_CHECK(format.calibration.camera.valid() && format.calibration.depth_scale > 0,
            "incomplete calibration");
}

Status FileSequence::read(const FrameEntry& entry, RgbdFrame& frame) const {
  SGS_ASSIGN_OR_RETURN(StoredFrame stored, read_stored(entry, format_));
  return fit_.fit(std::move(stored.color), std::move(stored.depth), stored.cameras,
                  entry.color.string(), entry.depth.string(), frame);
}

FrameRead FileSequence::next(RgbdFrame& frame, Error& error) {
  if (position_ == frames_.size()) return FrameRead::kEnd;
  const FrameEntry& entry = frames_[position_];
  frame = RgbdFrame{};
  frame.index = static_cast<std::int64_t>(position_++);
  frame.timestamp_s = entry.timestamp_s;
  frame.depth_delay_s = entry.depth_delay_s;
  frame.camera = fit_.camera();
  frame.truth_T_world_camera = truth_.at(entry.timestamp_s, kMaxTruthGap_s);
  if (auto status = read(entry, frame); !status) {
    error = std::move(status.error());
    return FrameRead::kBadFrame;
  }
  return FrameRead::kOk;
}

}  // namespace sgs::dataset
