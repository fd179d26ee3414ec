// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/dataset/time_unit.h"
#include "sgs/geometry/trajectory.h"
#include "sgs/io/calibration_io.h"

namespace sgs::dataset {

/// The files of one frame, and where a reader of the error should look: "rgb.txt:12".
struct FrameEntry {
  double timestamp_s = 0;
  std::filesystem::path color, depth;
  std::string color_origin, depth_origin;
  std::optional<PinholeCamera> camera = {};  ///< of this colour image, where they differ
  std::filesystem::path confidence = {};     ///< 8-bit image beside the depth; may be empty
  double depth_delay_s = 0;  ///< by how much later than colour its stamp says depth was taken
};

/// What the values of a depth image mean.
enum class DepthCoding {
  kPlain,
  kTurnedBits,  ///< SUN3D: rotated left by three bits
};

/// What a layout itself says about its cameras. Options and calibration files come first.
struct LayoutCalibration {
  Calibration calibration;  ///< image size 0 x 0: that of the images
  std::string source;       ///< for people: the file, or whose published values these are
};

/// What a layout reader finds in a folder, before any image is opened.
struct FrameList {
  std::string layout;
  std::string name;
  std::filesystem::path folder;
  std::vector<FrameEntry> frames;  ///< in order of time
  Trajectory truth;
  std::size_t color_without_depth = 0, depth_without_color = 0;
  const char* paired = "near in time";  ///< what made pairs of the images, for messages
  std::size_t color_images = 0;         ///< that were there, usable or not; 0 = those counted here
  std::string times_source = {};        ///< for people: what the times are
  bool clock_set_back = false;          ///< while it was recorded: times were moved
  std::vector<std::string> warnings;
  std::optional<LayoutCalibration> calibration = {};
  std::optional<PinholeCamera> depth_camera = {};  ///< where it is not simply that of colour
  bool depth_size_differs = false;                 ///< registered depth may have its own size
  DepthCoding depth_coding = DepthCoding::kPlain;
  double max_depth_m = std::numeric_limits<double>::infinity();  ///< farther ones are guesses
  int min_confidence = 0;                ///< of FrameEntry::confidence, for a depth to count
  std::string missing_calibration = {};  ///< remedy where the layout should have one but has not
};

/// One reader per layout. Each returns an error when the folder has the layout but cannot be used.
Result<FrameList> list_tum(const std::filesystem::path& folder, double max_time_difference_s);
Result<FrameList> list_replica(const std::filesystem::path& scene);
Result<FrameList> list_folder(const std::filesystem::path& folder, const io::SequenceToml& toml);

Result<FrameList> list_icl(const std::filesystem::path& folder);
Result<FrameList> list_scannet(const std::filesystem::path& folder);
Result<FrameList> list_seven_scenes(const std::filesystem::path& folder);
Result<FrameList> list_open3d(const std::filesystem::path& folder);
Result<FrameList> list_sun3d(const std::filesystem::path& folder);
Result<FrameList> list_transforms(const std::filesystem::path& folder);
Result<FrameList> list_polycam(const std::filesystem::path& folder);
Result<FrameList> list_arkit_scenes(const std::filesystem::path& folder);
Result<FrameList> list_bare(const std::filesystem::path& folder);

/// Whether a folder has the files that mark a layout.
bool looks_like_tum(const std::filesystem::path& folder);
bool looks_like_replica(const std::filesystem::path& scene);
bool looks_like_icl(const std::filesystem::path& folder);
bool looks_like_scannet(const std::filesystem::path& folder);
bool looks_like_seven_scenes(const std::filesystem::path& folder);
bool looks_like_open3d(const std::filesystem::path& folder);
bool looks_like_sun3d(const std::filesystem::path& folder);
bool looks_like_transforms(const std::filesystem::path& folder);
bool looks_like_polycam(const std::filesystem::path& folder);
bool looks_like_arkit_scenes(const std::filesystem::path& folder);
bool looks_like_bare(const std::filesystem::path& folder);

/// Takes the poses of a file as ground truth. Truth is optional: what cannot be read is a warning.
void take_truth(const std::filesystem::path& file, FrameList& list);
/// The same of a reader's result: an error becomes a warning.
void truth_or_warning(const Status& status, FrameList& list);

/// Reads `associations.txt` ("time colour time depth", either first) into `out.frames`, as
/// read_image_list() does its rows; times that are `frame_numbers` stay what they are. Returns the
/// unit of the times.
Result<TimeUnit> read_associations(const std::filesystem::path& list, bool frame_numbers,
                                   FrameList& out);

/// What is called `name` in a folder ("a/b" below it): as written or, where there is no such thing,
/// in letters of another case. The plain path where there is neither.
std::filesystem::path entry_of(const std::filesystem::path& folder,
                               const std::filesystem::path& name);

/// Whether a file is none of a recording but of the system that copied it: "._NAME" and .DS_Store
/// (macOS), Thumbs.db, desktop.ini (Windows), __MACOSX, and anything hidden.
bool is_left_behind(const std::filesystem::path& file);

/// Files of a folder whose name matches `pattern` (a '*' stands for anything), sorted by
/// name. A missing folder has no files; what is_left_behind() counts as none.
std::vector<std::filesystem::path> files_matching(const std::filesystem::path& folder,
                                                  const std::string& pattern);
/// PNG and JPEG files of a folder, sorted by name.
std::vector<std::filesystem::path> image_files(const std::filesystem::path& folder);

/// Whether name `a` comes before `b` where numbers in them count as numbers: img2 before img10.
bool natural_less(const std::string& a, const std::string& b);

/// The camera that stands for all where each frame has its own: the median of each value, so that
/// most frames need the least resampling. Every frame must have one.
PinholeCamera typical_camera(const std::vector<FrameEntry>& frames);

/// The number a file's name ends with, extension left out ("frame000012.png": 12).
std::optional<long> trailing_number(const std::filesystem::path& file);
/// Files by that number; those without one are left out.
std::map<long, std::filesystem::path> by_number(const std::vector<std::filesystem::path>& files);

/// The last part of a path, also for "." and "a/b/".
std::string folder_name(const std::filesystem::path& folder);

}  // namespace sgs::dataset
