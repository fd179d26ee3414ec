// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/open.h"

#include <algorithm>
#include <array>

#include "sgs/bag/bag.h"
#include "sgs/camera/resample.h"
#include "sgs/core/log.h"
#include "sgs/dataset/bag_source.h"
#include "sgs/dataset/calibration_lookup.h"
#include "sgs/dataset/file_sequence.h"
#include "sgs/dataset/frame_list.h"
#include "sgs/dataset/prefetch.h"
#include "sgs/dataset/reduced_source.h"
#include "sgs/dataset/sens_source.h"
#include "sgs/dataset/sparse_capture.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

/// The only folder below `parent` that holds a Replica scene; empty if there is none or several.
Result<fs::path> single_scene(const fs::path& parent) {
  std::vector<fs::path> scenes;
  std::error_code error;
  for (fs::directory_iterator it(parent, error), end; !error && it != end; it.increment(error)) {
    if (it->is_directory(error) && looks_like_replica(it->path())) scenes.push_back(it->path());
  }
  if (scenes.size() == 1) return scenes.front();
  if (scenes.empty()) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: no known sequence layout; looked for rgb.txt with depth.txt, or "
                            "associations.txt (TUM), results/frame*.jpg with results/depth*.png, "
                            "or images/ with depth_images/ (Replica, NICE-SLAM), sgs.toml with "
                            "sequence.color and sequence.depth, and what marks ScanNet, 7-Scenes, "
                            "Open3D, SUN3D, ICL-NUIM, nerfstudio, Polycam and ARKitScenes",
                            parent.string()),
                "give the folder that holds one of these; an sgs.toml describes any folder of "
                "images");
  }
  std::sort(scenes.begin(), scenes.end());
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("{}: holds {} scenes", parent.string(), scenes.size()),
              fmt::format("give one of them, for example {}", scenes.front().string()));
}

/// How a layout is known and read.
struct Layout {
  bool (*looks_like)(const fs::path& folder);
  Result<FrameList> (*list)(const fs::path& folder);
};

/// In the order in which they are tried: the surest marks first. TUM and Replica need more to be
/// told and come apart.
constexpr std::array kLayouts = {
    Layout{looks_like_icl, list_icl},
    Layout{looks_like_polycam, list_polycam},
    Layout{looks_like_transforms, list_transforms},
    Layout{looks_like_scannet, list_scannet},
    Layout{looks_like_seven_scenes, list_seven_scenes},
    Layout{looks_like_arkit_scenes, list_arkit_scenes},
    Layout{looks_like_sun3d, list_sun3d},
    Layout{looks_like_open3d, list_open3d},
};

Result<FrameList> list_frames(const fs::path& folder, const OpenOptions& options) {
  io::SequenceToml toml;
  if (fs::exists(folder / "sgs.toml")) {
    SGS_ASSIGN_OR_RETURN(toml, io::load_sequence_toml(folder / "sgs.toml"));
  }
  const auto list = [&]() -> Result<FrameList> {
    if (!toml.color.empty()) return list_folder(folder, toml);
    for (const Layout& layout : kLayouts) {
      if (layout.looks_like(folder)) return layout.list(folder);
    }
    if (looks_like_tum(folder)) return list_tum(folder, options.max_time_difference_s);
    if (looks_like_replica(folder)) return list_replica(folder);
    SGS_ASSIGN_OR_RETURN(const fs::path scene, single_scene(folder));
    return list_replica(scene);
  };
  SGS_ASSIGN_OR_RETURN(FrameList frames, list());
  if (!toml.name.empty()) frames.name = toml.name;
  return frames;
}

Status cut_range(FrameList& list, const OpenOptions& options) {
  const auto count = static_cast<std::int64_t>(list.frames.size());
  SGS_ASSIGN_OR_RETURN(const auto range, frame_range(options, list.folder, count));
  list.frames.erase(list.frames.begin() + range.second, list.frames.end());
  list.frames.erase(list.frames.begin(), list.frames.begin() + range.first);
  return {};
}

std::size_t count_missing(const std::vector<FrameEntry>& frames) {
  return static_cast<std::size_t>(
      std::count_if(frames.begin(), frames.end(), [](const FrameEntry& entry) {
        std::error_code error;
        return !fs::exists(entry.color, error) || !fs::exists(entry.depth, error);
      }));
}

/// What was learned from the first frame that can be read.
struct Probe {
  StoredCameras cameras;
  DepthImage depth;
};

/// Decodes frames until one can be read and fits the calibration to its size. Damaged and missing
/// images are passed over; images of the wrong kind are an error of the whole sequence.
Result<Probe> probe(const FrameList& list, const std::string& source, const StoredFormat& format) {
  Error first_error;
  for (const FrameEntry& entry : list.frames) {
    auto stored = read_stored(entry, format);
    if (!stored) {
      if (stored.error().code == ErrorCode::kUnsupported) return tl::unexpected(stored.error());
      if (first_error.message.empty()) first_error = stored.error();
      continue;
    }
    const auto check = [&](const fs::path& file, int width, int height, const PinholeCamera& c) {
      if (c.width == width && c.height == height) return Status{};
      return Status(fail(ErrorCode::kInvalidArgument,
                         fmt::format("{} is {}x{} but the calibration from {} is for {}x{}",
                                     file.string(), width, height, source, c.width, c.height),
                         "give the calibration of images of this size"));
    };
    const auto& [color, depth, cameras] = *stored;
    SGS_RETURN_IF_ERROR(check(entry.color, color.width(), color.height(), cameras.color));
    SGS_RETURN_IF_ERROR(check(entry.depth, depth.width(), depth.height(), cameras.depth));
    return Probe{cameras, std::move(stored->depth)};
  }
  first_error.message = fmt::format("{}: none of {} frames can be read; the first: {}",
                                    list.folder.string(), list.frames.size(), first_error.message);
  return tl::unexpected<Error>(std::move(first_error));
}

Status check_options(const OpenOptions& options) {
  const auto bad = [](std::string what) {
    return fail(ErrorCode::kInvalidArgument, std::move(what));
  };
  if (options.depth_scale && !(*options.depth_scale > 0 && *options.depth_scale < 1e9)) {
    return bad(fmt::format("--depth-scale {} must be positive", *options.depth_scale));
  }
  if (!(options.max_time_difference_s >= 0)) return bad("time difference must not be negative");
  return {};
}

void add_warnings(SequenceInfo& info, const FrameList& list) {
  const auto count = [&](std::size_t n, const char* what) {
    if (n > 0) info.warnings.push_back(fmt::format("{}: {} {}", info.folder.string(), n, what));
  };
  count(info.color_without_depth, "colour images without depth near in time, left out");
  count(info.depth_without_color, "depth images without colour near in time, left out");
  count(info.missing_images, "frames name an image that does not exist; they will be skipped");
  const auto covered = [&](const FrameEntry& e) { return list.truth.at(e.timestamp_s, 0.1); };
  if (!list.truth.empty() && std::none_of(list.frames.begin(), list.frames.end(), covered)) {
    info.warnings.push_back(fmt::format(
        "{}: the ground truth covers {:.6f} .. {:.6f} s, none of the frames", info.folder.string(),
        list.truth.poses().front().timestamp_s, list.truth.poses().back().timestamp_s));
  }
}

/// How the images are stored, and the camera they are delivered with. What the options or a
/// calibration file say replaces all that the layout says of its cameras.
Result<StoredFormat> stored_format(FrameList& list, const FoundCalibration& found) {
  StoredFormat format;
  format.calibration = found.calibration;
  format.depth_size_differs = list.depth_size_differs;
  format.depth_coding = list.depth_coding;
  format.max_depth_m = list.max_depth_m;
  format.min_confidence = list.min_confidence;
  if (found.of_layout) {
    format.depth_camera = list.depth_camera.value_or(PinholeCamera{});
  } else {
    // Two cameras of different size share one view.
    format.depth_size_differs = format.depth_size_differs || list.depth_camera;
    for (FrameEntry& frame : list.frames) frame.camera.reset();
  }
  return format;
}

SequenceInfo describe(const FrameList& list, const FoundCalibration& found) {
  SequenceInfo info;
  info.layout = list.layout;
  info.name = list.name;
  info.folder = list.folder;
  info.frames = static_cast<std::int64_t>(list.frames.size());
  info.first_time_s = list.frames.front().timestamp_s;
  info.last_time_s = list.frames.back().timestamp_s;
  info.calibration_source = found.source;
  info.truth_rows = list.truth.size();
  std::vector<double> delays_s;
  for (const FrameEntry& frame : list.frames) delays_s.push_back(frame.depth_delay_s);
  info.depth_delays = summarize_delays(std::move(delays_s));
  info.color_without_depth = list.color_without_depth;
  info.depth_without_color = list.depth_without_color;
  info.missing_images = count_missing(list.frames);
  info.warnings = list.warnings;
  add_warnings(info, list);
  return info;
}

void warn_of_little_seen(SequenceInfo& info, const PinholeCamera& color) {
  const auto seen = FrameFit(info.delivered, info.calibration.distortion).seen(color);
  if (auto warning = little_is_seen(seen.get(), info.calibration_source)) {
    info.warnings.push_back(fmt::format("{}: {}", info.folder.string(), *warning));
  }
}

std::vector<NamedFrame> names_of_frames(const FrameList& list) {
  std::vector<NamedFrame> names;
  for (const FrameEntry& frame : list.frames) names.push_back({frame.timestamp_s, frame.color});
  return names;
}

std::vector<double> times_of_frames(const FrameList& list) {
  std::vector<double> times_s;
  for (const FrameEntry& frame : list.frames) times_s.push_back(frame.timestamp_s);
  return times_s;
}

Result<Sequence> open_folder(const fs::path& folder, const OpenOptions& options) {
  SGS_ASSIGN_OR_RETURN(FrameList list, list_frames(folder, options));
  std::vector<fs::path> places = {list.folder};
  if (list.layout == "replica") places.push_back(list.folder / "..");
  SGS_ASSIGN_OR_RETURN(const FoundCalibration found, find_calibration(places, list, options));
  const auto frames_in_folder = static_cast<std::int64_t>(list.frames.size());
  SGS_RETURN_IF_ERROR(cut_range(list, options));
  SGS_ASSIGN_OR_RETURN(StoredFormat format, stored_format(list, found));
  SGS_ASSIGN_OR_RETURN(const Probe seen, probe(list, found.source, format));
  if (format.calibration.camera.width == 0) format.calibration.camera = seen.cameras.color;
  if (format.depth_camera.fx > 0) format.depth_camera = seen.cameras.depth;
  SGS_RETURN_IF_ERROR(io::check_calibration(format.calibration, found.source));
  if (!options.depth_scale) {
    SGS_RETURN_IF_ERROR(check_depth_unit(seen.depth, format.calibration.depth_scale, found.source));
  }
  StoredCameras typical = seen.cameras;
  if (list.frames.front().camera) {
    typical.color = format.calibration.camera;
    typical.depth = scaled_to(typical.color, seen.depth.width(), seen.depth.height());
  }
  Sequence sequence;
  sequence.info = describe(list, found);
  sequence.info.frames_in_folder = frames_in_folder;
  sequence.info.calibration = format.calibration;
  sequence.info.delivered = delivered_camera(typical, options.max_width);
  warn_of_little_seen(sequence.info, typical.color);
  sequence.info.sparse = is_sparse(times_of_frames(list), list.truth);
  sequence.images = names_of_frames(list);
  sequence.frames = std::make_unique<FileSequence>(
      list.name, std::move(list.frames), std::move(list.truth), format, sequence.info.delivered);
  return sequence;
}

/// Bags prefetch, log and check by themselves.
Result<Sequence> open_bag(const fs::path& input, const OpenOptions& options) {
  SGS_ASSIGN_OR_RETURN(Sequence sequence, open_bag_sequence(input, options));
  sequence.frames = reduced(std::move(sequence.frames), options.max_width);
  sequence.info.delivered = sequence.frames->camera();
  return sequence;
}

/// What is not a folder: a file that holds a whole recording, or one that marks a folder.
Result<Sequence> open_file(const fs::path& file, const OpenOptions& options) {
  if (file.filename() == "transforms.json") return open_folder(file.parent_path(), options);
  if (is_sens(file)) return open_sens(file, options);
  if (file.extension() == ".r3d") {
    return fail(
        ErrorCode::kUnsupported,
        fmt::format("{}: Record3D compresses depth in a way that this program does not read",
                    file.string()),
        fmt::format("convert it first: `python3 record3d_to_transforms.py {} OUT` (in the "
                    "folder scripts/ of the sources), then `sgs run OUT`",
                    file.string()));
  }
  return fail(ErrorCode::kUnsupported,
              fmt::format("{}: not a folder, and no recording that is known", file.string()),
              "give the folder of an RGB-D sequence, a bag (.bag, .mcap, .db3), or a ScanNet .sens "
              "file");
}

/// What is no bag.
Result<Sequence> open_images(const fs::path& input, const OpenOptions& options) {
  std::error_code error;
  SGS_ASSIGN_OR_RETURN(Sequence sequence, fs::is_directory(input, error)
                                              ? open_folder(input, options)
                                              : open_file(input, options));
  for (const std::string& warning : sequence.info.warnings) log().warn("{}", warning);
  if (options.prefetch > 0) {
    sequence.frames =
        std::make_unique<PrefetchingSource>(std::move(sequence.frames), options.prefetch);
  }
  return sequence;
}

Status add_given_poses(Sequence& sequence, const OpenOptions& options, const fs::path& input) {
  SequenceInfo& info = sequence.info;
  SGS_ASSIGN_OR_RETURN(auto poses, load_given_poses(options.poses, sequence.frames->ground_truth(),
                                                    {input.string(), info.first_time_s,
                                                     info.last_time_s, sequence.images}));
  for (const std::string& warning : poses.warnings) log().warn("{}", warning);
  info.warnings.insert(info.warnings.end(), poses.warnings.begin(), poses.warnings.end());
  sequence.frames = with_given_poses(std::move(sequence.frames), std::move(poses));
  return {};
}

}  // namespace

bool looks_like_sequence(const fs::path& folder) {
  try {
    return fs::exists(folder / "sgs.toml") || looks_like_tum(folder) ||
           looks_like_replica(folder) || bag::looks_like_bag(folder) ||
           std::any_of(kLayouts.begin(), kLayouts.end(),
                       [&](const Layout& layout) { return layout.looks_like(folder); });
  } catch (const fs::filesystem_error&) {
    return false;
  }
}

Result<std::pair<std::int64_t, std::int64_t>> frame_range(const OpenOptions& options,
                                                          const fs::path& input,
                                                          std::int64_t count) {
  const auto first = std::clamp<std::int64_t>(options.first, 0, count);
  const auto last = std::clamp<std::int64_t>(options.last, first, count);
  if (first == last) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("frames {}:{} of {}: the sequence has {}", options.first, options.last,
                            input.string(), count),
                "choose a range inside the sequence");
  }
  return std::pair{first, last};
}

Result<Sequence> open_sequence(const fs::path& input, const OpenOptions& options) {
  SGS_RETURN_IF_ERROR(check_options(options));
  std::error_code error;
  if (!fs::exists(input, error)) {
    return fail(ErrorCode::kNotFound, fmt::format("{}: no such file or folder", input.string()),
                "give the folder of an RGB-D sequence, a bag, or synth:NAME");
  }
  SGS_ASSIGN_OR_RETURN(Sequence sequence, bag::looks_like_bag(input) ? open_bag(input, options)
                                                                     : open_images(input, options));
  if (!options.poses.empty()) SGS_RETURN_IF_ERROR(add_given_poses(sequence, options, input));
  return sequence;
}

}  // namespace sgs::dataset
