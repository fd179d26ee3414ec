// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/tum_writer.h"

#include <cmath>

#include "sgs/dataset/frame_list.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/calibration_io.h"
#include "sgs/io/image_io.h"
#include "sgs/io/text.h"
#include "sgs/io/trajectory_io.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

/// A time with as many digits as it takes to read the same number back, six at least.
std::string exact_time(double time_s) {
  constexpr int kUsualDigits = 6, kMostDigits = 17;
  for (int digits = kUsualDigits;; ++digits) {
    std::string text = fmt::format("{:.{}f}", time_s, digits);
    if (digits == kMostDigits || io::parse_double(text) == time_s) return text;
  }
}

}  // namespace

TumSequenceWriter::TumSequenceWriter(fs::path folder, const PinholeCamera& camera, Options options)
    : folder_(std::move(folder)), camera_(camera), options_(std::move(options)) {}

Result<TumSequenceWriter> TumSequenceWriter::create(const fs::path& folder,
                                                    const PinholeCamera& camera, Options options) {
  SGS_CHECK(camera.valid() && options.depth_scale > 0, "incomplete calibration");
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_empty(folder, error)) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: exists and is not empty", folder.string()),
                "give a new or empty folder to write the sequence to");
  }
  SGS_RETURN_IF_ERROR(io::make_folder(folder / "rgb"));
  SGS_RETURN_IF_ERROR(io::make_folder(folder / "depth"));
  const Calibration calibration{camera, options.distortion, options.depth_scale};
  SGS_RETURN_IF_ERROR(io::save_camera_txt(folder / "camera.txt", calibration));
  io::SequenceToml toml;
  toml.calibration = calibration;
  toml.name = options.name.empty() ? folder_name(folder) : options.name;
  SGS_RETURN_IF_ERROR(io::save_sequence_toml(folder / "sgs.toml", toml));
  const char* header = "# timestamp filename\n";
  SGS_RETURN_IF_ERROR(io::write_file(folder / "rgb.txt", header));
  SGS_RETURN_IF_ERROR(io::write_file(folder / "depth.txt", header));
  return TumSequenceWriter(folder, camera, std::move(options));
}

Status TumSequenceWriter::add(const RgbdFrame& frame) {
  constexpr double kTimeStep_s = 1e-6;  // digits of the file names; the lists hold exact times
  SGS_CHECK(frame.color.width() == camera_.width && frame.color.height() == camera_.height &&
                frame.depth.width() == camera_.width && frame.depth.height() == camera_.height,
            "frame size differs from the camera's");
  if (frames_ > 0 && !(frame.timestamp_s >= last_time_s_ + 0.5 * kTimeStep_s)) {
    return fail(
        ErrorCode::kUnsupported,
        fmt::format("frame {} at {:.9f} s cannot be recorded to {}: not a microsecond after "
                    "the one before it",
                    frame.index, frame.timestamp_s, folder_.string()),
        "record without --record, or mend the times of the input");
  }
  const std::string stem = fmt::format("{:.6f}", frame.timestamp_s);
  const std::string color = fmt::format("rgb/{}.{}", stem, options_.jpeg_color ? "jpg" : "png");
  const std::string depth = fmt::format("depth/{}.png", stem);
  SGS_RETURN_IF_ERROR(io::save_color(folder_ / color, frame.color, options_.jpeg_quality));
  SGS_RETURN_IF_ERROR(io::save_depth(folder_ / depth, frame.depth, options_.depth_scale));
  if (frame.truth_T_world_camera) {
    Trajectory row;
    row.push_back({frame.timestamp_s, *frame.truth_T_world_camera});
    SGS_RETURN_IF_ERROR(io::append_file(folder_ / "groundtruth.txt", io::trajectory_text(row)));
  }
  const std::string time = exact_time(frame.timestamp_s);
  const std::string depth_time = exact_time(frame.timestamp_s + frame.depth_delay_s);
  // The lists come last: what they name is there.
  SGS_RETURN_IF_ERROR(
      io::append_file(folder_ / "depth.txt", fmt::format("{} {}\n", depth_time, depth)));
  SGS_RETURN_IF_ERROR(io::append_file(folder_ / "rgb.txt", fmt::format("{} {}\n", time, color)));
  ++frames_;
  last_time_s_ = frame.timestamp_s;
  return {};
}

Status TumSequenceWriter::write_ground_truth(const Trajectory& truth) {
  return io::save_trajectory(folder_ / "groundtruth.txt", truth);
}

}  // namespace sgs::dataset
