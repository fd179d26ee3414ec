// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/frame_list.h"
#include "sgs/dataset/pairing.h"
#include "sgs/dataset/rigid.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

constexpr double kScanNetFps = 30;
constexpr double kScanNetDepthScale = 1000;

}  // namespace

bool looks_like_scannet(const fs::path& folder) {
  std::error_code error;
  const auto has = [&](const char* name) {
    return fs::is_directory(entry_of(folder, name), error);
  };
  return has("color") && has("depth") && has("intrinsic");
}

// What ScanNet's reader exports from a .sens file: color/N.jpg, depth/N.png, pose/N.txt and
// intrinsic/intrinsic_{color,depth}.txt. Depth is registered, in its own size and intrinsics.
Result<FrameList> list_scannet(const fs::path& folder) {
  FrameList out;
  out.layout = "scannet";
  out.name = folder_name(folder);
  out.folder = folder;
  pair_by_number(by_number(image_files(entry_of(folder, "color"))),
                 by_number(image_files(entry_of(folder, "depth"))), kScanNetFps, out);
  SGS_RETURN_IF_ERROR(require_frames(out, "color/N.jpg with depth/N.png"));
  const fs::path intrinsics = entry_of(folder, "intrinsic/intrinsic_color.txt");
  SGS_ASSIGN_OR_RETURN(const PinholeCamera color, load_intrinsic_matrix(intrinsics));
  out.calibration = {{color, {}, kScanNetDepthScale}, intrinsics.string()};
  SGS_ASSIGN_OR_RETURN(out.depth_camera,
                       load_intrinsic_matrix(entry_of(folder, "intrinsic/intrinsic_depth.txt")));
  std::error_code error;
  if (!fs::is_directory(folder / "pose", error)) return out;
  const Status truth = add_frame_poses(out, [&](std::size_t i) -> Result<std::optional<SE3>> {
    const fs::path pose = folder / "pose" / out.frames[i].color.stem().concat(".txt");
    if (!fs::exists(pose)) return std::optional<SE3>{};
    return load_pose_matrix(pose);
  });
  truth_or_warning(truth, out);
  return out;
}

}  // namespace sgs::dataset
