// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "sgs/dataset/frame_list.h"
#include "sgs/dataset/pairing.h"
#include "sgs/dataset/rigid.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

constexpr double kSevenScenesFps = 30;

/// "frame-000012.color.png" is number 12: what follows the first dot is no part of the stem.
std::map<long, fs::path> seven_scenes_files(const fs::path& folder, const std::string& kind) {
  std::map<long, fs::path> files;
  for (const fs::path& file : files_matching(folder, "frame-*." + kind + ".png")) {
    if (const auto number = trailing_number(file.stem())) files.emplace(*number, file);
  }
  return files;
}

}  // namespace

bool looks_like_seven_scenes(const fs::path& folder) {
  return !files_matching(folder, "frame-*.color.png").empty();
}

// One sequence of 7-Scenes as published (Shotton et al., CVPR 2013): frame-N.{color.png, depth.png,
// pose.txt}, millimetres, 65535 = none, camera to world.
Result<FrameList> list_seven_scenes(const fs::path& folder) {
  FrameList out;
  out.layout = "7-scenes";
  out.name = folder_name(folder);
  out.folder = folder;
  pair_by_number(seven_scenes_files(folder, "color"), seven_scenes_files(folder, "depth"),
                 kSevenScenesFps, out);
  SGS_RETURN_IF_ERROR(require_frames(out, "frame-000000.color.png with frame-000000.depth.png"));
  out.calibration = {{{640, 480, 585, 585, 320, 240}, {}, 1000},
                     "the values published with 7-Scenes"};
  out.warnings.push_back(fmt::format(
      "{}: 7-Scenes does not register depth to colour; they are some pixels apart at their edges "
      "(`sgs calibrate` finds how many)",
      folder.string()));
  const Status truth = add_frame_poses(out, [&](std::size_t i) -> Result<std::optional<SE3>> {
    const fs::path pose = folder / out.frames[i].color.filename().stem().stem().concat(".pose.txt");
    if (!fs::exists(pose)) return std::optional<SE3>{};
    return load_pose_matrix(pose);
  });
  truth_or_warning(truth, out);
  return out;
}

}  // namespace sgs::dataset
