// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/input/input.h"

#include <algorithm>
#include <charconv>
#include <filesystem>

#include "sgs/core/log.h"
#include "sgs/dataset/calibrated_source.h"
#include "sgs/dataset/given_poses.h"
#include "sgs/dataset/prefetch.h"
#include "sgs/dataset/reduced_source.h"
#include "sgs/input/inertial.h"
#include "sgs/io/camera_file.h"
#include "sgs/io/depth_calibration_io.h"
#include "sgs/io/trajectory_io.h"
#include "sgs/stream/stream_source.h"
#include "sgs/synthetic/source.h"

namespace sgs::run {
namespace {

/// Delivers only the frames [first, last) of another source.
class RangeSource : public dataset::FrameSource {
 public:
  RangeSource(std::unique_ptr<FrameSource> source, FrameRange range)
      : source_(std::move(source)), range_(range) {}
  std::string name() const override { return source_->name(); }
  PinholeCamera camera() const override { return source_->camera(); }
  std::optional<std::int64_t> size() const override {
    const auto all = source_->size();
    if (!all) return all;
    return std::max<std::int64_t>(0, std::min(*all, range_.last) - range_.first);
  }
  const Trajectory& ground_truth() const override { return source_->ground_truth(); }
  dataset::FrameRead next(RgbdFrame& frame, Error& error) override {
    for (; position_ < range_.last; ++position_) {
      const auto status = source_->next(frame, error);
      if (status == dataset::FrameRead::kEnd) return status;
      if (position_ < range_.first) continue;
      frame.index -= range_.first;
      ++position_;
      return status;
    }
    return dataset::FrameRead::kEnd;
  }

 private:
  std::unique_ptr<FrameSource> source_;
  FrameRange range_;
  std::int64_t position_ = 0;
};

Result<Input> open_synthetic(const InputSpec& spec, const FrameRange& range, int threads) {
  SGS_ASSIGN_OR_RETURN(const auto options, synth_options(spec, threads));
  if (!spec.camera.empty()) {
    return fail(ErrorCode::kInvalidArgument, "--camera does not apply to a synthetic sequence",
                "leave it out");
  }
  SGS_ASSIGN_OR_RETURN(auto source, synthetic::make_synthetic_source(options));
  Input input;
  input.info.layout = "synthetic";
  input.info.name = source->name();
  input.info.calibration = {source->camera(), {}, 5000};
  input.info.delivered = source->camera();
  input.info.calibration_source = "generator";
  input.info.frames_in_folder = source->size().value_or(0);
  input.info.truth_rows = source->ground_truth().size();
  if (range.first > 0 || range.last < std::numeric_limits<std::int64_t>::max()) {
    source = std::make_unique<RangeSource>(std::move(source), range);
  }
  input.info.frames = source->size().value_or(0);
  if (input.info.frames == 0) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("--frames {} selects none of the {} frames", spec.frames,
                            input.info.frames_in_folder),
                "choose a range within the sequence");
  }
  if (!source->ground_truth().empty()) {
    input.info.first_time_s = source->ground_truth().poses().front().timestamp_s;
    input.info.last_time_s = source->ground_truth().poses().back().timestamp_s;
  }
  if (!spec.poses.empty()) {
    const auto& info = input.info;
    SGS_ASSIGN_OR_RETURN(auto poses, dataset::load_given_poses(
                                         spec.poses, source->ground_truth(),
                                         {info.name, info.first_time_s, info.last_time_s, {}}));
    input.info.warnings = poses.warnings;
    source = dataset::with_given_poses(std::move(source), std::move(poses));
  }
  constexpr std::size_t kFramesAhead = 4;
  input.source = std::make_unique<dataset::PrefetchingSource>(std::move(source), kFramesAhead);
  return input;
}

Result<Input> open_recorded(const InputSpec& spec, const FrameRange& range) {
  dataset::OpenOptions options;
  if (!spec.camera.empty()) {
    SGS_ASSIGN_OR_RETURN(options.camera, io::read_camera_option(spec.camera));
  }
  if (options.camera && options.camera->depth_scale > 0) {
    options.depth_scale = options.camera->depth_scale;
    options.depth_scale_source = spec.camera;
  }
  if (spec.depth_scale > 0) {
    options.depth_scale = spec.depth_scale;
    options.depth_scale_source = dataset::OpenOptions().depth_scale_source;
  }
  options.topics = spec.topics;
  options.extrinsics = spec.extrinsics;
  options.truth_topic = spec.truth_topic;
  SGS_ASSIGN_OR_RETURN(options.stamps, from_string<dataset::Stamps>("--stamps", spec.stamps));
  options.more_files = more_files_of(spec);
  options.max_width = spec.max_width;
  options.poses = spec.poses;
  options.first = range.first;
  options.last = range.last;
  SGS_ASSIGN_OR_RETURN(auto sequence, dataset::open_sequence(spec.input, options));
  return Input{std::move(sequence.frames), std::move(sequence.info), {}};
}

Status check_stream_options(const InputSpec& spec) {
  const auto set = [](const char* name, bool is_set) { return is_set ? name : nullptr; };
  for (const char* option :
       {set("--frames", !spec.frames.empty()), set("--camera", !spec.camera.empty()),
        set("--depth-scale", spec.depth_scale > 0), set("--topics", !spec.topics.empty()),
        set("--extrinsics", !spec.extrinsics.empty()),
        set("--truth-topic", !spec.truth_topic.empty()),
        set("--stamps", spec.stamps != InputSpec{}.stamps)}) {
    if (option == nullptr) continue;
    return fail(ErrorCode::kInvalidArgument, fmt::format("{} does not apply to a stream", option),
                stream::is_camera(spec.input) ? "a camera says it itself"
                                              : "give it to the sender: `sgs send` takes it");
  }
  return {};
}

/// Poses of a stream come with its frames, or from a file.
Status add_poses_to_stream(const InputSpec& spec, Input& input) {
  if (spec.poses.empty()) return {};
  dataset::GivenPoses poses;
  if (spec.poses != dataset::kRecordedPoses) {
    constexpr double kAny = std::numeric_limits<double>::infinity();
    SGS_ASSIGN_OR_RETURN(
        poses, dataset::load_given_poses(spec.poses, {}, {input.info.name, -kAny, kAny, {}}));
  }
  input.info.warnings = poses.warnings;
  input.source = dataset::with_given_poses(std::move(input.source), std::move(poses));
  return {};
}

Status calibrate(const InputSpec& spec, Input& input) {
  if (spec.calibration.empty()) return {};
  SGS_ASSIGN_OR_RETURN(auto calibration, io::load_depth_calibration(spec.calibration));
  SGS_ASSIGN_OR_RETURN(input.source,
                       dataset::calibrated(std::move(input.source), calibration, spec.calibration));
  input.calibration = std::move(calibration);
  return {};
}

Result<Input> open_live(const InputSpec& spec, const std::stop_token& stop) {
  SGS_RETURN_IF_ERROR(check_stream_options(spec));
  SGS_ASSIGN_OR_RETURN(const auto address, stream::parse_address(spec.input));
  stream::Patience patience;
  patience.first_s = patience.wait_s = spec.wait_s;
  const auto announce = [](const std::string& what) { log().warn("{}", what); };
  if (address.camera) {
    constexpr double kStart_s = 30;  // SDKs take their time until there are frames
    patience.greeting_s = kStart_s;
  }
  SGS_ASSIGN_OR_RETURN(auto source, stream::open_stream(address, patience, announce, stop));
  Input input;
  const stream::Hello& hello = source->hello();
  const stream::StreamSource* stream = source.get();
  const bool has_imu = hello.T_color_imu.has_value();
  input.info.layout = "stream";
  input.info.name = source->name();
  input.info.calibration = {hello.color_camera.camera, hello.color_camera.distortion,
                            hello.depth_scale};
  input.info.calibration_source = "the stream's greeting";
  input.info.unit_source = input.info.calibration_source;
  input.info.times_source = hello.device_clock ? "the camera's clock" : "the sender";
  input.info.relation_source = hello.depth_camera ? "depth is registered with color_from_depth"
                                                  : "depth is registered, says the sender";
  input.source = dataset::reduced(std::move(source), spec.max_width);
  input.info.delivered = input.source->camera();
  SGS_RETURN_IF_ERROR(add_poses_to_stream(spec, input));
  SGS_RETURN_IF_ERROR(calibrate(spec, input));
  if (has_imu) {
    input.source = with_imu(std::move(input.source), [stream] { return stream->imu(); });
  }
  return input;
}

Result<Input> open_uncalibrated(const InputSpec& spec, int threads, const std::stop_token& stop) {
  SGS_ASSIGN_OR_RETURN(const auto range, parse_frame_range(spec.frames));
  const bool recorded = !stream::is_stream(spec.input) && !synthetic::is_synth_spec(spec.input);
  if (!recorded && !spec.more_files.empty()) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{} is no recording that more files could belong to", spec.input),
                "give one input at a time");
  }
  if (stream::is_stream(spec.input)) return open_live(spec, stop);
  if (synthetic::is_synth_spec(spec.input)) return open_synthetic(spec, range, threads);
  if (!spec.trajectory.empty()) {
    return fail(ErrorCode::kInvalidArgument, "--trajectory applies to synthetic sequences only",
                "leave it out");
  }
  return open_recorded(spec, range);
}

}  // namespace

void InputSpec::declare(ParameterList& list) {
  const auto group = list.group("input");
  list.add("source", input,
           "Folder of the sequence, bag, synth:NAME[:LEVEL], live:... or camera:...", {});
  list.add("frames", frames, "Frames a:b (half open) of the sequence; empty = all.", {});
  list.add("camera", camera,
           "fx,fy,cx,cy[,k1,k2,p1,p2,k3[,k4,k5,k6]] instead of the folder's calibration.", {});
  list.add("depth_scale", depth_scale,
           "Raw depth units per metre instead of the folder's; 0 = as the folder says.", "1/m",
           {0, 1e9});
  list.add("max_width", max_width,
           "Wider images of a recording are reduced to this width; 0 = never.", "px", {0, 16384});
  list.add("calibration", calibration, "File of `sgs calibrate` that corrects the depths.", {});
  list.add("topics", topics,
           "Bags: color=/a,depth=/b[,color_info=/c][,depth_info=/d]; what is left out is guessed.",
           {});
  list.add("extrinsics", extrinsics,
           "Bags: depth camera to colour camera as tx,ty,tz,qx,qy,qz,qw, or aligned; empty = as "
           "recorded.",
           {});
  list.add("truth_topic", truth_topic,
           "Bags: ground truth from a topic of poses, or WORLD:CAMERA of tf.", {});
  list.add("stamps", stamps,
           "Bags: the images have the times of the camera, or received: when they were recorded.",
           {});
  list.add("more_files", more_files, "Bags: further files of the same recording, one a line.", {});
  list.add("poses", poses,
           "Poses for the tracker `given`: a TUM file, images.txt of a COLMAP model or its folder, "
           "or recorded: those of the recording.",
           {});
  list.add("map", map, "Map of an earlier run for the camera to find itself in; empty = a new one.",
           {});
  list.add("extends_map", extends_map,
           "The run goes on with that map and leaves one of all sessions; else the map stays as it "
           "is, and the camera is only tracked there.");
  list.add("trajectory", trajectory, "TUM trajectory that a synthetic camera flies along.", {});
  list.add("wait_s", wait_s,
           "Streams: end the run when nobody has sent a frame for so long; 0 = never.", "s",
           {0, 1e9});
  list.add("synth_seed", synth_seed, "Seed of a synthetic scene, its motion and its noise.");
}

std::vector<std::filesystem::path> more_files_of(const InputSpec& spec) {
  std::vector<std::filesystem::path> files;
  std::string_view rest = spec.more_files;
  while (!rest.empty()) {
    const auto end = std::min(rest.find('\n'), rest.size());
    if (end > 0) files.emplace_back(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return files;
}

Result<FrameRange> parse_frame_range(const std::string& text) {
  FrameRange range;
  const auto colon = text.find(':');
  const auto number = [&](std::string_view part, std::int64_t& value) {
    if (part.empty()) return true;
    const auto result = std::from_chars(part.data(), part.data() + part.size(), value);
    return result.ec == std::errc{} && result.ptr == part.data() + part.size() && value >= 0;
  };
  if (text.empty()) return range;
  if (colon == std::string::npos || !number(std::string_view(text).substr(0, colon), range.first) ||
      !number(std::string_view(text).substr(colon + 1), range.last) || range.first >= range.last) {
    return fail(ErrorCode::kInvalidArgument, fmt::format("--frames '{}' is not a range", text),
                "write a:b with a < b, for example 0:100, 50: or :200");
  }
  return range;
}

Result<synthetic::SynthOptions> synth_options(const InputSpec& spec, int threads) {
  SGS_ASSIGN_OR_RETURN(auto options, synthetic::parse_synth_spec(spec.input));
  SGS_ASSIGN_OR_RETURN(const auto range, parse_frame_range(spec.frames));
  options.seed = spec.synth_seed;
  options.threads = threads;
  if (!spec.trajectory.empty()) {
    SGS_ASSIGN_OR_RETURN(auto loaded, io::load_trajectory(spec.trajectory));
    options.trajectory = std::move(loaded.trajectory);
  }
  if (range.last < std::numeric_limits<int>::max()) options.frames = static_cast<int>(range.last);
  return options;
}

Result<Input> open_input(const InputSpec& spec, int threads, const std::stop_token& stop) {
  if (!spec.calibration.empty()) {
    // A file that is none is told before anything is waited for.
    SGS_RETURN_IF_ERROR(io::load_depth_calibration(spec.calibration));
  }
  SGS_ASSIGN_OR_RETURN(auto input, open_uncalibrated(spec, threads, stop));
  if (!stream::is_stream(spec.input)) SGS_RETURN_IF_ERROR(calibrate(spec, input));
  return input;
}

Result<Input> reopen_input(InputSpec spec, int threads,
                           const std::optional<DepthCalibration>& learned) {
  spec.poses.clear();
  if (stream::is_stream(spec.input)) {
    return fail(ErrorCode::kNotFound, fmt::format("the input was a stream ({})", spec.input),
                "what is to be looked at again must be kept: `sgs run live:... --record FOLDER`");
  }
  SGS_ASSIGN_OR_RETURN(auto input, open_input(spec, threads));
  if (learned && !input.calibration) {
    SGS_ASSIGN_OR_RETURN(input.source, dataset::calibrated(std::move(input.source), *learned,
                                                           "what the run learned"));
    input.calibration = learned;
  }
  return input;
}

}  // namespace sgs::run
