// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/sens_source.h"

#include <algorithm>

#include "sgs/camera/resample.h"
#include "sgs/dataset/depth_stamps.h"
#include "sgs/dataset/frame_fit.h"
#include "sgs/dataset/sens_file.h"
#include "sgs/dataset/sparse_capture.h"
#include "sgs/io/text.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

constexpr double kSensFps = 30;  // where the file has no times

/// What the header says, or the options instead.
struct SensCalibration {
  Calibration color;
  StoredCameras cameras;
  std::string source;
};

/// When the images of each frame were taken.
struct SensTimes {
  std::vector<double> color_s, depth_delay_s;
};

class SensSource final : public FrameSource {
 public:
  SensSource(std::string name, SensFile file, SensCalibration calibration,
             const PinholeCamera& delivered, SensTimes times, std::int64_t first, std::int64_t last)
      : name_(std::move(name)),
        file_(std::move(file)),
        calibration_(std::move(calibration)),
        fit_(delivered, calibration_.color.distortion),
        times_(std::move(times)),
        first_(first),
        last_(last),
        position_(first) {
    for (std::size_t i = 0; i < times_.color_s.size(); ++i) {
      if (const auto& pose = file_.frames()[i].T_world_camera)
        truth_.push_back({times_.color_s[i], *pose});
    }
  }

  std::string name() const override { return name_; }
  PinholeCamera camera() const override { return fit_.camera(); }
  std::optional<std::int64_t> size() const override { return last_ - first_; }
  const Trajectory& ground_truth() const override { return truth_; }

  FrameRead next(RgbdFrame& frame, Error& error) override {
    if (position_ == last_) return FrameRead::kEnd;
    const auto i = static_cast<std::size_t>(position_);
    frame = RgbdFrame{};
    frame.index = position_++ - first_;
    frame.timestamp_s = times_.color_s[i];
    frame.depth_delay_s = times_.depth_delay_s[i];
    frame.camera = fit_.camera();
    frame.truth_T_world_camera = file_.frames()[i].T_world_camera;
    if (auto status = read(i, frame); !status) {
      error = std::move(status.error());
      return FrameRead::kBadFrame;
    }
    return FrameRead::kOk;
  }

 private:
  Status read(std::size_t i, RgbdFrame& frame) {
    SGS_ASSIGN_OR_RETURN(ColorImage color, file_.color(i));
    SGS_ASSIGN_OR_RETURN(const io::RawDepth raw, file_.depth(i));
    return fit_.fit(std::move(color), io::depth_in_metres(raw, calibration_.color.depth_scale),
                    calibration_.cameras, fmt::format("colour of frame {}", i),
                    fmt::format("depth of frame {}", i), frame);
  }

  std::string name_;
  SensFile file_;
  SensCalibration calibration_;
  FrameFit fit_;
  SensTimes times_;
  std::int64_t first_, last_, position_;
  Trajectory truth_;
};

/// Times of the images; by number where those of colour do not rise from frame to frame.
SensTimes frame_times(const SensFile& file, std::vector<std::string>& warnings,
                      const fs::path& path) {
  constexpr double kMicrosecond_s = 1e-6;
  const auto& frames = file.frames();
  const auto fall = std::adjacent_find(
      frames.begin(), frames.end(),
      [](const auto& a, const auto& b) { return a.color_time_us >= b.color_time_us; });
  const bool rising = fall == frames.end();
  if (!rising) {
    warnings.push_back(
        fmt::format("{}: times are missing or do not rise; taken as {:.0f} frames a "
                    "second",
                    path.string(), kSensFps));
  }
  SensTimes out;
  std::vector<double> depth_s;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const SensFile::Frame& frame = frames[i];
    const double color_s = static_cast<double>(frame.color_time_us) * kMicrosecond_s;
    out.color_s.push_back(rising ? color_s : static_cast<double>(i) / kSensFps);
    depth_s.push_back(static_cast<double>(frame.depth_time_us) * kMicrosecond_s);
    out.depth_delay_s.push_back(rising && frame.depth_time_us > 0 ? depth_s.back() - color_s : 0);
  }
  if (const auto why = implausible_delays(out.depth_delay_s, depth_s)) {
    warnings.push_back(fmt::format("{}: {}", path.string(), *why));
    out.depth_delay_s.assign(frames.size(), 0);
  }
  return out;
}

Result<SensCalibration> calibrate(const SensFile& file, const fs::path& path,
                                  const OpenOptions& options) {
  SensCalibration out;
  out.cameras = {file.color_camera(), file.depth_camera()};
  out.source = path.filename().string();
  if (options.camera) {
    PinholeCamera& color = out.cameras.color;
    color = {color.width,        color.height,       options.camera->fx,
             options.camera->fy, options.camera->cx, options.camera->cy};
    out.cameras.depth = scaled_to(color, out.cameras.depth.width, out.cameras.depth.height);
    out.color.distortion = options.camera->distortion;
    out.source = fmt::format("--camera, depth scale from {}", out.source);
  }
  out.color.camera = out.cameras.color;
  out.color.depth_scale = options.depth_scale.value_or(file.depth_scale());
  if (options.depth_scale) out.source += " and " + options.depth_scale_source;
  SGS_RETURN_IF_ERROR(io::check_calibration(out.color, out.source));
  // The depth camera has to be as usable.
  Calibration depth = out.color;
  depth.camera = out.cameras.depth;
  SGS_RETURN_IF_ERROR(io::check_calibration(depth, out.source + " (depth)"));
  return out;
}

/// The depths of the first readable frame must be metres.
Status check_sens_unit(SensFile& file, const SensCalibration& calibration) {
  for (std::size_t i = 0; i < file.frames().size(); ++i) {
    const auto raw = file.depth(i);
    if (!raw) continue;
    const double scale = calibration.color.depth_scale;
    return check_depth_unit(io::depth_in_metres(*raw, scale), scale, calibration.source);
  }
  return {};
}

void add_sens_warnings(const SensFile& file, const fs::path& path, SequenceInfo& info) {
  if (file.frames().size() < file.frames_announced()) {
    info.warnings.push_back(fmt::format("{}: cut off; {} of {} frames are whole", path.string(),
                                        file.frames().size(), file.frames_announced()));
  }
  if (file.moved_cameras()) {
    info.warnings.push_back(
        fmt::format("{}: has a transform between its cameras; depth is taken as registered to "
                    "colour, as ScanNet's is",
                    path.string()));
  }
}

}  // namespace

bool is_sens(const fs::path& file) { return io::lower_case(file.extension().string()) == ".sens"; }

Result<Sequence> open_sens(const fs::path& path, const OpenOptions& options) {
  SGS_ASSIGN_OR_RETURN(SensFile file, SensFile::open(path));
  SGS_ASSIGN_OR_RETURN(const SensCalibration calibration, calibrate(file, path, options));
  if (!options.depth_scale) SGS_RETURN_IF_ERROR(check_sens_unit(file, calibration));
  const auto count = static_cast<std::int64_t>(file.frames().size());
  SGS_ASSIGN_OR_RETURN(const auto range, frame_range(options, path, count));
  Sequence sequence;
  SequenceInfo& info = sequence.info;
  auto times = frame_times(file, info.warnings, path);
  const std::vector<double> times_s = times.color_s;
  info.depth_delays = summarize_delays(times.depth_delay_s);
  info.layout = "scannet .sens";
  info.name = path.stem().string();
  info.folder = path.parent_path();
  info.frames = range.second - range.first;
  info.frames_in_folder = count;
  info.first_time_s = times_s[static_cast<std::size_t>(range.first)];
  info.last_time_s = times_s[static_cast<std::size_t>(range.second - 1)];
  info.calibration = calibration.color;
  info.calibration_source = calibration.source;
  info.unit_source = options.depth_scale ? options.depth_scale_source : path.string();
  info.relation_source = "depth is registered, as ScanNet records it";
  info.times_source = "the times of the colour images in the file";
  info.delivered = delivered_camera(calibration.cameras, options.max_width);
  add_sens_warnings(file, path, info);
  const FrameFit fit(info.delivered, info.calibration.distortion);
  if (auto warning =
          little_is_seen(fit.seen(calibration.cameras.color).get(), calibration.source)) {
    info.warnings.push_back(fmt::format("{}: {}", path.string(), *warning));
  }
  auto source =
      std::make_unique<SensSource>(info.name, std::move(file), calibration, info.delivered,
                                   std::move(times), range.first, range.second);
  info.truth_rows = source->ground_truth().size();
  info.sparse = is_sparse(times_s, source->ground_truth());
  // The names that ScanNet's own exporter gives the pictures.
  for (std::int64_t i = range.first; i < range.second; ++i) {
    sequence.images.push_back(
        {times_s[static_cast<std::size_t>(i)], fmt::format("color/{}.jpg", i)});
  }
  sequence.frames = std::move(source);
  return sequence;
}

}  // namespace sgs::dataset
