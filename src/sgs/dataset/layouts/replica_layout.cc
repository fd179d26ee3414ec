// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include "sgs/dataset/frame_list.h"
#include "sgs/dataset/pairing.h"
#include "sgs/dataset/rigid.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/text.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

constexpr double kFramesPerSecond = 30;  // of the renderings; the layout carries no times

struct ImageFolders {
  std::map<long, fs::path> color, depth;
};

ImageFolders find_images(const fs::path& scene) {
  const fs::path results = entry_of(scene, "results");
  if (fs::is_directory(results)) {
    return {by_number(files_matching(results, "frame*")),
            by_number(files_matching(results, "depth*"))};
  }
  return {by_number(image_files(entry_of(scene, "images"))),
          by_number(image_files(entry_of(scene, "depth_images")))};
}

/// A row of traj.txt; empty for one that holds NaN or no rotation.
Result<std::optional<SE3>> parse_pose(const fs::path& path, const io::TextLine& line) {
  const auto fields = io::split_fields(line.text);
  std::array<double, 16> m{};
  bool good = fields.size() == m.size();
  for (std::size_t i = 0; good && i < m.size(); ++i) {
    const auto value = io::parse_double(fields[i]);
    good = value.has_value();
    m[i] = value.value_or(0);
  }
  if (!good) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}:{}: not a row-major 4x4 matrix", path.string(), line.number),
                "each row must hold 16 numbers");
  }
  return rigid_from_rows(m);
}

Result<std::vector<std::optional<SE3>>> read_poses(const fs::path& path) {
  SGS_ASSIGN_OR_RETURN(const std::string content, io::read_text(path));
  std::vector<std::optional<SE3>> poses;
  for (const io::TextLine& line : io::content_lines(content)) {
    SGS_ASSIGN_OR_RETURN(auto pose, parse_pose(path, line));
    poses.push_back(std::move(pose));
  }
  return poses;
}

Status add_truth(const fs::path& path, const std::vector<long>& numbers, FrameList& out) {
  SGS_ASSIGN_OR_RETURN(const auto poses, read_poses(path));
  // Rows belong to frame numbers in a whole sequence, to positions in a cut-out one.
  const bool by_position = poses.size() == numbers.size();
  std::size_t without = 0, unusable = 0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::size_t row = by_position ? i : static_cast<std::size_t>(numbers[i]);
    if (row >= poses.size()) {
      ++without;
    } else if (!poses[row]) {
      ++unusable;
    } else {
      out.truth.push_back({out.frames[i].timestamp_s, *poses[row]});
    }
  }
  if (without > 0) {
    out.warnings.push_back(fmt::format("{}: {} frames have no row", path.string(), without));
  }
  if (unusable > 0) {
    out.warnings.push_back(fmt::format("{}: {} rows are not rigid transforms and were skipped",
                                       path.string(), unusable));
  }
  return {};
}

}  // namespace

bool looks_like_replica(const fs::path& scene) {
  const fs::path results = entry_of(scene, "results");
  const bool nice_slam = fs::is_directory(results) && !files_matching(results, "frame*").empty();
  return nice_slam || (fs::is_directory(entry_of(scene, "images")) &&
                       fs::is_directory(entry_of(scene, "depth_images")));
}

Result<FrameList> list_replica(const fs::path& scene) {
  FrameList out;
  out.layout = "replica";
  out.name = folder_name(scene);
  out.folder = scene;
  const ImageFolders images = find_images(scene);
  pair_by_number(images.color, images.depth, kFramesPerSecond, out);
  std::vector<long> numbers;
  for (const FrameEntry& frame : out.frames) {
    numbers.push_back(trailing_number(frame.color).value_or(0));
  }
  if (out.frames.empty()) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: {} colour and {} depth images, none with equal numbers",
                            scene.string(), images.color.size(), images.depth.size()),
                "needed: results/frame000000.jpg with results/depth000000.png, or the same in "
                "images/ and depth_images/");
  }
  const fs::path truth = entry_of(scene, "traj.txt");
  if (fs::exists(truth)) truth_or_warning(add_truth(truth, numbers, out), out);
  return out;
}

}  // namespace sgs::dataset
