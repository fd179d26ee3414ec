// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sgs/camera/pinhole.h"
#include "sgs/core/error.h"
#include "sgs/dataset/frame_source.h"
#include "sgs/io/calibration_io.h"

namespace sgs::dataset {

/// How to open a sequence folder.
struct OpenOptions {
  std::optional<io::CameraOption> camera;  ///< intrinsics that replace the folder's own
  std::optional<double> depth_scale;       ///< raw units per metre that replace the folder's own
  std::int64_t first = 0;                  ///< frames [first, last) of the sequence are delivered
  std::int64_t last = std::numeric_limits<std::int64_t>::max();
  double max_time_difference_s = 0.02;  ///< between the colour and depth image of one frame
  // Of bags (bag_source.h); other layouts have no use for them.
  std::string topics;  ///< "color=/a,depth=/b,..."; empty = guessed
  std::string
      extrinsics;  ///< T_color_depth as "tx,ty,tz,qx,qy,qz,qw", or "aligned"; empty = recorded
  std::string
      truth_topic;  ///< of poses, or "world:camera" of tf; empty = one that says it is the truth
  std::size_t prefetch = 8;  ///< frames decoded ahead on a thread of their own; 0 = none
};

/// What is known about a sequence once it is open, for `sgs info` and the run report.
struct SequenceInfo {
  std::string layout;  ///< "tum", "replica", "folder", or what kind of bag
  std::string name;
  std::filesystem::path folder;       ///< the folder that holds the images
  std::int64_t frames = 0;            ///< frames in the opened range
  std::int64_t frames_in_folder = 0;  ///< frames in all of the sequence
  double first_time_s = 0;            ///< of the opened range
  double last_time_s = 0;
  Calibration calibration;         ///< of the images as stored, distortion included
  std::string calibration_source;  ///< "sgs.toml", "--camera", "known sequence freiburg1", ...
  std::string color_topic, depth_topic;  ///< of a bag
  std::size_t truth_rows = 0;            ///< usable ground-truth poses
  std::size_t color_without_depth = 0;   ///< colour images without a depth image near in time
  std::size_t depth_without_color = 0;
  std::size_t missing_images = 0;     ///< frames that name a file that is not there
  std::vector<std::string> warnings;  ///< everything that had to be put right; also in the log
};

/// An open sequence: the frames and what is known about them.
struct Sequence {
  std::unique_ptr<FrameSource> frames;
  SequenceInfo info;
};

/// Opens a recorded sequence, guessing its layout:
///   - a bag: ROS 1 .bag, .mcap, .db3, or a folder of rosbag2, see open_bag_sequence();
///   - "folder": `sgs.toml` with sequence.color and sequence.depth;
///   - "tum": `rgb.txt` and `depth.txt`, else `associations.txt`; `groundtruth.txt` optional;
///   - "replica": `results/frame*.jpg` and `results/depth*.png`, or `images/` and `depth_images/`;
///     `traj.txt` optional; `folder` may be the scene or the parent of a single scene.
/// The calibration comes from the options, `sgs.toml`, `camera.txt`, `cam_params.json` or a known
/// TUM sequence name, in this order, and is never guessed. The first readable frame is decoded to
/// check the image sizes against it. Frames are delivered undistorted.
///
/// RgbdFrame::index counts from 0 at the first frame of the opened range. A frame with a missing,
/// damaged or unfitting image is a bad frame; a sequence without any usable frame does not open.
Result<Sequence> open_sequence(const std::filesystem::path& folder,
                               const OpenOptions& options = {});

}  // namespace sgs::dataset
