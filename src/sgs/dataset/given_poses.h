// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/dataset/frame_source.h"

namespace sgs::dataset {

/// What stands for "those of the recording itself" where a file of poses could be named.
inline constexpr const char* kRecordedPoses = "recorded";

/// The colour image of a frame and its time.
struct NamedFrame {
  double timestamp_s = 0;
  std::filesystem::path image;
};

/// What poses are for.
struct PosedFrames {
  std::string sequence;  ///< what errors call it
  double first_time_s = 0, last_time_s = 0;
  std::vector<NamedFrame> frames;  ///< empty where only the times of the first and last are known
};

/// Poses that were given, and what tells their unit where that is not the metre.
struct GivenPoses {
  Trajectory poses;
  /// By time: points of the model that a frame sees. Pictures alone do not tell how large the world
  /// is, measured depths do. Empty: poses are in metres.
  std::map<double, std::vector<Eigen::Vector3d>> seen = {};
  std::vector<std::string> warnings = {};  ///< what had to be put right
};

/// Poses for the frames of a sequence. `poses` is kRecordedPoses (those of `recorded`), a file of
/// TUM rows, or COLMAP's images.txt, also by the folder that holds it; COLMAP's pictures are found
/// among the frames by name, or where only the extension differs. Errors: no such file, another
/// format, no poses at all, names or times that none of the frames has, positions so far from the
/// origin that a map of single-precision numbers would be coarse.
Result<GivenPoses> load_given_poses(const std::string& poses, const Trajectory& recorded,
                                    const PosedFrames& wanted);

/// The given pose at a time: one within 2 ms as it is, else interpolated over at most a quarter of
/// a second.
std::optional<SE3> given_pose_at(const Trajectory& poses, double timestamp_s);

/// The frames of a source with RgbdFrame::given_T_world_camera. Those without a pose are bad frames
/// that say so. A frame that has a given pose keeps it. Where points are seen, the first frames'
/// depths at these points tell the unit of the poses, which are brought to metres.
std::unique_ptr<FrameSource> with_given_poses(std::unique_ptr<FrameSource> source,
                                              GivenPoses poses);

/// How many metres the unit of a model is: the median of measured depth over that of the points a
/// frame sees; empty where fewer than 50 points tell. `frames` have their given poses.
std::optional<double> metres_per_unit(const std::vector<const RgbdFrame*>& frames,
                                      const std::map<double, std::vector<Eigen::Vector3d>>& seen);

}  // namespace sgs::dataset
