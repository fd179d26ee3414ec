// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/association.h"
#include "sgs/dataset/frame_list.h"
#include "sgs/dataset/image_list.h"
#include "sgs/dataset/pairing.h"
#include "sgs/io/text.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

/// The list of pairs, under the names that programs give it.
fs::path associations_of(const fs::path& folder) {
  for (const char* name :
       {"associations.txt", "association.txt", "associate.txt", "associated.txt", "assoc.txt"}) {
    const fs::path list = entry_of(folder, name);
    if (fs::exists(list)) return list;
  }
  return {};
}

std::vector<double> times_of(const ImageList& list) {
  std::vector<double> times;
  for (const ListedImage& image : list.images) times.push_back(image.timestamp_s);
  return times;
}

/// What the frames' times were in the list.
struct ListedTimes {
  TimeUnit unit;
  double first = 0, last = 0;
};

Result<ListedTimes> pair_lists(const fs::path& folder, double max_difference_s, FrameList& out) {
  SGS_ASSIGN_OR_RETURN(const auto color,
                       read_image_list(entry_of(folder, "rgb.txt"), out.warnings));
  SGS_ASSIGN_OR_RETURN(const auto depth,
                       read_image_list(entry_of(folder, "depth.txt"), out.warnings, color.moved_s));
  const auto pairs = associate(times_of(color), times_of(depth), max_difference_s);
  if (pairs.empty()) {
    return fail(
        ErrorCode::kInvalidFormat,
        fmt::format("{}: no colour image has a depth image within {} s: colour covers "
                    "{:.6f} .. {:.6f} s, depth {:.6f} .. {:.6f} s",
                    folder.string(), max_difference_s, color.images.front().timestamp_s,
                    color.images.back().timestamp_s, depth.images.front().timestamp_s,
                    depth.images.back().timestamp_s),
        "rgb.txt and depth.txt must use the same clock; images that belong together in their order "
        "can be paired by an sgs.toml with [sequence] color = \"rgb\", depth = \"depth\", match = "
        "\"order\" (the folders' names)");
  }
  for (const auto& [i, j] : pairs) {
    const ListedImage &c = color.images[i], &d = depth.images[j];
    FrameEntry& frame =
        out.frames.emplace_back(FrameEntry{c.timestamp_s, c.path, d.path, c.origin, d.origin});
    frame.depth_delay_s = d.timestamp_s - c.timestamp_s;
  }
  out.color_without_depth = color.images.size() - pairs.size();
  out.depth_without_color = depth.images.size() - pairs.size();
  out.color_images = color.rows;
  out.clock_set_back = !color.moved_s.empty();
  return ListedTimes{color.unit, color.first, color.last};
}

Result<ListedTimes> read_pairs(const fs::path& folder, FrameList& out) {
  SGS_ASSIGN_OR_RETURN(const TimeUnit unit, read_associations(associations_of(folder), false, out));
  return ListedTimes{unit, out.frames.front().timestamp_s * unit.per_second,
                     out.frames.back().timestamp_s * unit.per_second};
}

/// Brings poses to the seconds of the frames, where they are in the unit of the list or, by their
/// size, in another one.
void bring_truth_to_seconds(const ListedTimes& listed, FrameList& out) {
  if (out.truth.empty()) return;
  std::vector<double> times;
  for (const StampedPose& pose : out.truth.poses()) times.push_back(pose.timestamp_s);
  const bool beside_list = times.front() <= listed.last && times.back() >= listed.first;
  const TimeUnit unit = beside_list ? listed.unit : unit_of_times(times, false);
  if (unit.per_second == 1) return;
  std::vector<StampedPose> poses = out.truth.poses();
  for (StampedPose& pose : poses) pose.timestamp_s /= unit.per_second;
  out.truth = Trajectory(std::move(poses));
  out.warnings.push_back(
      fmt::format("{}: the times of the ground truth are {}; they are brought "
                  "to seconds",
                  out.folder.string(), unit.name));
}

/// The calibration that ETH3D's SLAM benchmark puts into each folder: "fx fy cx cy" of images
/// without distortion, depth in 1/5000 m.
Result<std::optional<LayoutCalibration>> eth3d_calibration(const fs::path& path) {
  constexpr double kDepthScale = 5000;
  std::error_code error;
  if (!fs::exists(path, error)) return std::optional<LayoutCalibration>{};
  SGS_ASSIGN_OR_RETURN(const std::string content, io::read_text(path));
  const auto numbers = io::parse_doubles(content);
  if (!numbers || numbers->size() != 4) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: not the calibration of an ETH3D recording", path.string()),
                "it must hold four numbers: fx fy cx cy; or write a camera.txt");
  }
  const auto& n = *numbers;
  return std::optional(
      LayoutCalibration{{{0, 0, n[0], n[1], n[2], n[3]}, {}, kDepthScale}, path.string()});
}

}  // namespace

bool looks_like_tum(const fs::path& folder) {
  const auto has = [&](const char* name) { return fs::exists(entry_of(folder, name)); };
  return (has("rgb.txt") && has("depth.txt")) || !associations_of(folder).empty();
}

Result<FrameList> list_tum(const fs::path& folder, double max_time_difference_s) {
  FrameList out;
  out.layout = "tum";
  out.name = folder_name(folder);
  out.folder = folder;
  const auto there = [&](const char* name) { return fs::exists(entry_of(folder, name)); };
  const bool lists = there("rgb.txt") && there("depth.txt");
  SGS_ASSIGN_OR_RETURN(
      const ListedTimes listed,
      lists ? pair_lists(folder, max_time_difference_s, out) : read_pairs(folder, out));
  drop_implausible_delays(out);
  out.times_source = fmt::format(
      "{}, {}", lists ? "rgb.txt and depth.txt" : associations_of(folder).filename().string(),
      listed.unit.name.empty() ? "seconds" : listed.unit.name);
  SGS_ASSIGN_OR_RETURN(out.calibration, eth3d_calibration(entry_of(folder, "calibration.txt")));
  const fs::path truth = entry_of(folder, "groundtruth.txt");
  if (fs::exists(truth)) {
    take_truth(truth, out);
    bring_truth_to_seconds(listed, out);
    if (out.clock_set_back) {
      out.truth = {};
      out.warnings.push_back(fmt::format(
          "{}: left out: its times are of the clock that was set back", truth.string()));
    }
  }
  return out;
}

}  // namespace sgs::dataset
