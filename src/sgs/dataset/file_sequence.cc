// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/file_sequence.h"

#include <utility>

#include "sgs/camera/resample.h"
#include "sgs/core/log.h"
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

/// A camera that does not know its size takes that of the image; one that is for another size of
/// the same view is scaled.
template <class T>
PinholeCamera sized(PinholeCamera camera, const Image<T>& image) {
  if (camera.width == 0) {
    camera.width = image.width();
    camera.height = image.height();
    return camera;
  }
  const ImageSize own{camera.width, camera.height}, size{image.width(), image.height()};
  return own != size && same_shape(own, size) ? scaled_to(camera, size.width, size.height) : camera;
}

}  // namespace

Result<StoredFrame> read_stored(const FrameEntry& entry, const StoredFormat& format) {
  auto color = io::load_color(entry.color);
  if (!color) return from_list(color.error(), entry.color_origin);
  auto depth = read_depth(entry, format);
  if (!depth) return from_list(depth.error(), entry.depth_origin);
  const bool equal = color->width() == depth->width() && color->height() == depth->height();
  const bool own_camera = format.depth_camera.fx > 0;
  const bool same_view =
      same_shape({color->width(), color->height()}, {depth->width(), depth->height()});
  if (!own_camera && !same_view) {
    return fail(
        ErrorCode::kUnsupported,
        fmt::format("{} is {}x{} but {} is {}x{}, which is another shape and so another "
                    "view",
                    entry.color.string(), color->width(), color->height(), entry.depth.string(),
                    depth->width(), depth->height()),
        io::viewer_orientation(entry.color) != 1
            ? "the pictures are stored turned, and say so (Exif): turn them all with "
              "`mogrify -auto-orient FOLDER/*.jpg`"
            : "depth must be registered to colour: export it again as aligned to colour, or "
              "give the original recording (a bag knows both cameras)");
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
  note_size(entry, {stored.color.width(), stored.color.height()});
  return fit_.fit(std::move(stored.color), std::move(stored.depth), stored.cameras,
                  entry.color.string(), entry.depth.string(), frame);
}

/// Says once that images come in several sizes.
void FileSequence::note_size(const FrameEntry& entry, ImageSize size) const {
  if (!size_) size_ = size;
  if (size == *size_ || std::exchange(sizes_told_, true)) return;
  log().warn(
      "{} is {}x{}, images before it {}x{}: the images have several sizes; all are brought "
      "to {}x{}",
      entry.color.string(), size.width, size.height, size_->width, size_->height,
      fit_.camera().width, fit_.camera().height);
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
