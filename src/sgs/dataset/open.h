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
#include <utility>
#include <vector>

#include "sgs/camera/pinhole.h"
#include "sgs/core/enum_names.h"
#include "sgs/core/error.h"
#include "sgs/dataset/depth_stamps.h"
#include "sgs/dataset/frame_source.h"
#include "sgs/dataset/given_poses.h"
#include "sgs/io/calibration_io.h"

namespace sgs::dataset {

/// Images are delivered no wider than this unless asked for: what time is known for.
inline constexpr int kDefaultMaxWidth_px = 640;

/// Whose times the images of a bag have.
enum class Stamps {
  kCamera,    ///< header.stamp
  kReceived,  ///< when they were recorded; for device clocks that are of no use
};

constexpr auto enum_names(Stamps) {
  using enum Stamps;
  return std::to_array<EnumName<Stamps>>({{kCamera, "camera"}, {kReceived, "received"}});
}

/// How to open a recording.
struct OpenOptions {
  std::optional<io::CameraOption> camera;  ///< intrinsics that replace the folder's own
  std::optional<double> depth_scale;       ///< raw units per metre that replace the folder's own
  std::string depth_scale_source = "--depth-scale";  ///< who says so
  std::int64_t first = 0;  ///< frames [first, last) of the sequence are delivered
  std::int64_t last = std::numeric_limits<std::int64_t>::max();
  double max_time_difference_s = 0.02;  ///< between the colour and depth image of one frame
  // Of bags (bag_source.h); other layouts have no use for them.
  std::string topics;  ///< "color=/a,depth=/b,..."; empty = guessed
  std::string
      extrinsics;  ///< T_color_depth as "tx,ty,tz,qx,qy,qz,qw", or "aligned"; empty = recorded
  std::string
      truth_topic;  ///< of poses, or "world:camera" of tf; empty = one that says it is the truth
  Stamps stamps = Stamps::kCamera;
  std::vector<std::filesystem::path> more_files;  ///< of the same recording, beside the input
  /// Poses to deliver with the frames (given_poses.h): kRecordedPoses, a file, or none (empty).
  std::string poses;
  std::size_t prefetch = 8;             ///< frames decoded ahead on a thread of their own; 0 = none
  int max_width = kDefaultMaxWidth_px;  ///< wider images are reduced; 0 = none is too wide
};

/// What is known about a sequence once it is open, for `sgs info` and the run report.
struct SequenceInfo {
  std::string layout;  ///< "tum", "replica", "scannet", ..., or what kind of bag
  std::string name;
  std::filesystem::path folder;       ///< the folder that holds the images
  std::int64_t frames = 0;            ///< frames in the opened range
  std::int64_t frames_in_folder = 0;  ///< frames in all of the sequence
  double first_time_s = 0;            ///< of the opened range
  double last_time_s = 0;
  Calibration calibration;         ///< of the images as stored, distortion included
  std::string calibration_source;  ///< "sgs.toml", "--camera", "known sequence freiburg1", ...
  /// Who says what a unit of depth is, how depth stands to colour, and what the times are; in
  /// words.
  std::string unit_source, relation_source, times_source;
  std::int64_t color_images = 0;  ///< that the whole recording has, usable or not; 0 = not known
  PinholeCamera delivered;        ///< of the frames as delivered
  bool sparse = false;            ///< single views, too far apart to be tracked
  std::string color_topic, depth_topic;           ///< of a bag
  std::vector<std::filesystem::path> more_files;  ///< of a bag in several files, beside `folder`
  std::optional<DepthDelays> depth_delays;  ///< empty: depth has no stamps of its own, or a bag
  std::size_t truth_rows = 0;               ///< usable ground-truth poses
  std::size_t color_without_depth = 0;      ///< colour images without a depth image near in time
  std::size_t depth_without_color = 0;
  std::size_t missing_images = 0;     ///< frames that name a file that is not there
  std::vector<std::string> warnings;  ///< everything that had to be put right; also in the log
};

/// An open sequence: the frames and what is known about them.
struct Sequence {
  std::unique_ptr<FrameSource> frames;
  SequenceInfo info;
  std::vector<NamedFrame> images;  ///< of the opened range, where images have names
};

/// Opens a recorded sequence, a folder or a file, and finds out its layout by itself
/// (docs/datasets.md has all of them). The calibration comes from the options, `sgs.toml`,
/// `camera.txt`, `cam_params.json`, the layout's own files or a known sequence name, in this order,
/// and is never guessed. The first readable frame is decoded to check the image sizes against it,
/// and whether its depths can be metres. Frames are delivered undistorted, with colour and depth of
/// one size, at most `max_width` wide (dataset/frame_fit.h).
///
/// RgbdFrame::index counts from 0 at the first frame of the opened range. A frame with a missing,
/// damaged or unfitting image is a bad frame; a sequence without any usable frame does not open.
Result<Sequence> open_sequence(const std::filesystem::path& input, const OpenOptions& options = {});

/// Where the recording is that an input means: the input itself, or the only one at most two
/// folders below it.
struct Location {
  std::filesystem::path path;
  bool is_bag = false;  ///< of messages (bag_source.h); else of images
};
Result<Location> locate_recording(const std::filesystem::path& input);

/// Whether a file only lies beside a recording, as a shell's `FOLDER/*` names it: the list of a ROS
/// 2 bag, what SQLite and systems leave behind.
bool lies_beside_recording(const std::filesystem::path& file);

/// Whether a folder has the marks of a layout that open_sequence() reads, by the names of its files
/// alone; what cannot be looked at has none.
bool looks_like_sequence(const std::filesystem::path& folder);

/// The frames [first, last) that the options ask for of `count`; an empty range is an error.
Result<std::pair<std::int64_t, std::int64_t>> frame_range(const OpenOptions& options,
                                                          const std::filesystem::path& input,
                                                          std::int64_t count);

}  // namespace sgs::dataset
