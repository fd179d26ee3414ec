// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <utility>

#include "sgs/dataset/frame_list.h"
#include "sgs/dataset/rigid.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

constexpr double kIclFps = 30;

fs::path icl_truth(const fs::path& folder) {
  const auto files = files_matching(folder, "*.gt.freiburg");
  return files.empty() ? fs::path() : files.front();
}

}  // namespace

bool looks_like_icl(const fs::path& folder) {
  return fs::exists(folder / "associations.txt") && !icl_truth(folder).empty();
}

// ICL-NUIM in its TUM-compatible form (Handa et al., ICRA 2014): what stands for times are frame
// numbers. The renderer's y axis points up, hence the published focal length fy = -480: its poses
// are mirrored into our right-handed world, where the pictures have fy = +480 as they are.
Result<FrameList> list_icl(const fs::path& folder) {
  FrameList out;
  out.layout = "icl-nuim";
  out.name = folder_name(folder);
  out.folder = folder;
  SGS_RETURN_IF_ERROR(read_associations(folder / "associations.txt", true, out));
  out.times_source = fmt::format("frame numbers, {:g} a second", kIclFps);
  for (FrameEntry& frame : out.frames) frame.timestamp_s /= kIclFps;
  out.calibration = {{{640, 480, 481.2, 480, 319.5, 239.5}, {}, 5000},
                     "the values published with ICL-NUIM"};
  take_truth(icl_truth(folder), out);
  const Trajectory counted = std::exchange(out.truth, {});
  for (const StampedPose& pose : counted.poses()) {
    out.truth.push_back({pose.timestamp_s / kIclFps, from_left_handed(pose.T_world_camera)});
  }
  return out;
}

}  // namespace sgs::dataset
