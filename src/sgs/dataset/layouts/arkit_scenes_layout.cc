// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "sgs/camera/image_side.h"
#include "sgs/dataset/association.h"
#include "sgs/dataset/frame_list.h"
#include "sgs/dataset/pairing.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/text.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

constexpr double kArkitDepthScale = 1000;
constexpr int kArkitMediumConfidence = 1;  // of 0, 1, 2

/// Files named VIDEO_SECONDS, in order of time.
TimedFiles arkit_files(const fs::path& folder, const std::string& pattern) {
  return files_by_time(files_matching(folder, pattern), [](const std::string& stem) {
    return io::parse_double(std::string_view(stem).substr(stem.rfind('_') + 1));
  });
}

/// The folder with the images: the scene, or the one VIDEO_frames in it.
fs::path arkit_frames(const fs::path& folder) {
  if (fs::is_directory(folder / "lowres_wide")) return folder;
  const fs::path nested = folder / (folder_name(folder) + "_frames");
  return fs::is_directory(nested / "lowres_wide") ? nested : fs::path();
}

/// "width height fx fy cx cy".
Result<PinholeCamera> read_pincam(const fs::path& path) {
  SGS_ASSIGN_OR_RETURN(const std::string content, io::read_text(path));
  const auto n = io::parse_doubles(content);
  if (!n || n->size() != 6 || !((*n)[2] > 0) || !((*n)[3] > 0)) {
    return fail(ErrorCode::kInvalidFormat, fmt::format("{}: not a camera", path.string()),
                "needed: 'width height fx fy cx cy'");
  }
  return PinholeCamera{
      image_side_px((*n)[0]), image_side_px((*n)[1]), (*n)[2], (*n)[3], (*n)[4], (*n)[5]};
}

/// Rows "time rx ry rz tx ty tz", a rotation vector and a position of the world in the camera.
Result<Trajectory> read_arkit_trajectory(const fs::path& path) {
  constexpr std::size_t kColumns = 7;
  SGS_ASSIGN_OR_RETURN(const std::string content, io::read_text(path));
  std::vector<StampedPose> poses;
  for (const io::TextLine& line : io::content_lines(content)) {
    const auto n = io::parse_doubles(line.text);
    if (!n || n->size() != kColumns) {
      return fail(ErrorCode::kInvalidFormat,
                  fmt::format("{}:{}: not a pose", path.string(), line.number),
                  "each row must be 'time rx ry rz tx ty tz'");
    }
    const SE3 T_camera_world(so3_exp({(*n)[1], (*n)[2], (*n)[3]}),
                             Eigen::Vector3d((*n)[4], (*n)[5], (*n)[6]));
    poses.push_back({(*n)[0], T_camera_world.inverse()});
  }
  return Trajectory(std::move(poses));
}

/// Every frame's camera is that of the file nearest in time.
Status add_arkit_cameras(const fs::path& folder, FrameList& out) {
  constexpr double kMaxDifference_s = 0.005;
  const TimedFiles cameras = arkit_files(folder, "*.pincam");
  std::vector<double> times_s;
  for (const FrameEntry& frame : out.frames) times_s.push_back(frame.timestamp_s);
  std::vector<FrameEntry> known;
  for (const auto& [i, j] : associate(times_s, cameras.times_s, kMaxDifference_s)) {
    SGS_ASSIGN_OR_RETURN(out.frames[i].camera, read_pincam(cameras.files[j]));
    known.push_back(std::move(out.frames[i]));
  }
  if (known.empty()) {
    return fail(ErrorCode::kNotFound,
                fmt::format("{}: no VIDEO_TIME.pincam within {} s of an image", folder.string(),
                            kMaxDifference_s),
                "download the asset lowres_wide_intrinsics, too");
  }
  if (known.size() < out.frames.size()) {
    out.warnings.push_back(fmt::format("{}: {} frames without intrinsics were left out",
                                       folder.string(), out.frames.size() - known.size()));
  }
  out.frames = std::move(known);
  return {};
}

/// Poses come ten times a second, a few milliseconds beside their pictures.
Status add_arkit_poses(const fs::path& path, FrameList& out) {
  constexpr double kMaxDifference_s = 0.005, kMaxGap_s = 0.25;
  SGS_ASSIGN_OR_RETURN(const Trajectory poses, read_arkit_trajectory(path));
  return add_frame_poses(out, [&](std::size_t i) -> Result<std::optional<SE3>> {
    const double time_s = out.frames[i].timestamp_s;
    // A frame just before the first pose or after the last one has that pose.
    for (const double offset_s : {0.0, -kMaxDifference_s, kMaxDifference_s}) {
      if (const auto pose = poses.at(time_s + offset_s, kMaxGap_s)) return pose;
    }
    return std::optional<SE3>{};
  });
}

}  // namespace

bool looks_like_arkit_scenes(const fs::path& folder) { return !arkit_frames(folder).empty(); }

// ARKitScenes (Baruch et al., NeurIPS 2021): lowres_wide/, lowres_depth/ (millimetres),
// confidence/, lowres_wide_intrinsics/, lowres_wide.traj; the camera changes from frame to frame.
Result<FrameList> list_arkit_scenes(const fs::path& folder) {
  constexpr double kMaxDifference_s = 0.005;
  const fs::path frames = arkit_frames(folder);
  FrameList out;
  out.layout = "arkitscenes";
  out.name = folder_name(folder);
  out.folder = frames;
  out.depth_size_differs = true;
  out.min_confidence = kArkitMediumConfidence;
  pair_by_time(arkit_files(frames / "lowres_wide", "*.png"),
               arkit_files(frames / "lowres_depth", "*.png"), kMaxDifference_s, out);
  SGS_RETURN_IF_ERROR(require_frames(out, "lowres_wide/ and lowres_depth/ with VIDEO_TIME.png"));
  SGS_RETURN_IF_ERROR(add_arkit_cameras(frames / "lowres_wide_intrinsics", out));
  out.calibration = {{typical_camera(out.frames), {}, kArkitDepthScale},
                     (frames / "lowres_wide_intrinsics").string()};
  add_confidence(frames / "confidence", out);
  fs::path trajectory = frames / "lowres_wide.traj";
  if (!fs::exists(trajectory)) trajectory = folder / "lowres_wide.traj";
  if (fs::exists(trajectory)) SGS_RETURN_IF_ERROR(add_arkit_poses(trajectory, out));
  return out;
}

}  // namespace sgs::dataset
