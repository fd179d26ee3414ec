// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/open.h"

#include <algorithm>

#include "sgs/bag/bag.h"
#include "sgs/core/log.h"
#include "sgs/dataset/bag_source.h"
#include "sgs/dataset/calibration_lookup.h"
#include "sgs/dataset/file_sequence.h"
#include "sgs/dataset/frame_list.h"
#include "sgs/dataset/prefetch.h"

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
                            "or images/ with depth_images/ (Replica, NICE-SLAM), and sgs.toml with "
                            "sequence.color and sequence.depth",
                            parent.string()),
                "give the folder that holds one of these; an sgs.toml describes any folder of "
                "images");
  }
  std::sort(scenes.begin(), scenes.end());
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("{}: holds {} scenes", parent.string(), scenes.size()),
              fmt::format("give one of them, for example {}", scenes.front().string()));
}

Result<FrameList> list_frames(const fs::path& folder, const OpenOptions& options) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    return fail(ErrorCode::kNotFound,
                fmt::format("{}: {}", folder.string(),
                            fs::exists(folder, error) ? "not a folder" : "no such folder"),
                "give the folder of an RGB-D sequence");
  }
  io::SequenceToml toml;
  if (fs::exists(folder / "sgs.toml")) {
    SGS_ASSIGN_OR_RETURN(toml, io::load_sequence_toml(folder / "sgs.toml"));
  }
  const auto list = [&]() -> Result<FrameList> {
    if (!toml.color.empty()) return list_folder(folder, toml);
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
  const auto first = std::clamp<std::int64_t>(options.first, 0, count);
  const auto last = std::clamp<std::int64_t>(options.last, first, count);
  if (first == last) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("frames {}:{} of {}: the sequence has {}", options.first, options.last,
                            list.folder.string(), count),
                "choose a range inside the sequence");
  }
  list.frames.erase(list.frames.begin() + last, list.frames.end());
  list.frames.erase(list.frames.begin(), list.frames.begin() + first);
  return {};
}

std::size_t count_missing(const std::vector<FrameEntry>& frames) {
  return static_cast<std::size_t>(
      std::count_if(frames.begin(), frames.end(), [](const FrameEntry& entry) {
        std::error_code error;
        return !fs::exists(entry.color, error) || !fs::exists(entry.depth, error);
      }));
}

/// Decodes frames until one can be read and fits the calibration to its size. Damaged and missing
/// images are passed over; images of the wrong kind are an error of the whole sequence.
Status probe(const FrameList& list, FoundCalibration& found) {
  PinholeCamera& camera = found.calibration.camera;
  Error first_error;
  for (const FrameEntry& entry : list.frames) {
    const auto images = read_pair(entry, found.calibration.depth_scale);
    if (!images) {
      if (images.error().code == ErrorCode::kUnsupported) return tl::unexpected(images.error());
      if (first_error.message.empty()) first_error = images.error();
      continue;
    }
    const int width = images->color.width(), height = images->color.height();
    if (camera.width == 0) {
      camera.width = width;
      camera.height = height;
    }
    if (camera.width == width && camera.height == height) return {};
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("{} is {}x{} but the calibration from {} is for {}x{}", entry.color.string(),
                    width, height, found.source, camera.width, camera.height),
        "give the calibration of images of this size");
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

}  // namespace

Result<Sequence> open_sequence(const fs::path& folder, const OpenOptions& options) {
  SGS_RETURN_IF_ERROR(check_options(options));
  if (bag::looks_like_bag(folder)) return open_bag_sequence(folder, options);
  SGS_ASSIGN_OR_RETURN(FrameList list, list_frames(folder, options));
  std::vector<fs::path> places = {list.folder};
  if (list.layout == "replica") places.push_back(list.folder / "..");
  SGS_ASSIGN_OR_RETURN(FoundCalibration found,
                       find_calibration(places, folder_name(list.folder), options));
  Sequence sequence;
  SequenceInfo& info = sequence.info;
  info.frames_in_folder = static_cast<std::int64_t>(list.frames.size());
  SGS_RETURN_IF_ERROR(cut_range(list, options));
  SGS_RETURN_IF_ERROR(probe(list, found));
  SGS_RETURN_IF_ERROR(io::check_calibration(found.calibration, found.source));
  info.layout = list.layout;
  info.name = list.name;
  info.folder = list.folder;
  info.frames = static_cast<std::int64_t>(list.frames.size());
  info.first_time_s = list.frames.front().timestamp_s;
  info.last_time_s = list.frames.back().timestamp_s;
  info.calibration = found.calibration;
  info.calibration_source = found.source;
  info.truth_rows = list.truth.size();
  info.color_without_depth = list.color_without_depth;
  info.depth_without_color = list.depth_without_color;
  info.missing_images = count_missing(list.frames);
  info.warnings = list.warnings;
  add_warnings(info, list);
  for (const std::string& warning : info.warnings) log().warn("{}", warning);
  sequence.frames = std::make_unique<FileSequence>(list.name, std::move(list.frames),
                                                   std::move(list.truth), found.calibration);
  if (options.prefetch > 0) {
    sequence.frames =
        std::make_unique<PrefetchingSource>(std::move(sequence.frames), options.prefetch);
  }
  return sequence;
}

}  // namespace sgs::dataset
