// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/given_poses.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <unordered_map>

#include "sgs/core/log.h"
#include "sgs/io/colmap.h"
#include "sgs/io/trajectory_io.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

constexpr const char* kPoseFiles =
    "--poses takes TUM rows (time tx ty tz qx qy qz qw) or images.txt of a COLMAP text model";

/// Something read ahead.
struct ReadAhead {
  FrameRead read = FrameRead::kEnd;
  RgbdFrame frame;
  Error error;
};

class GivenPosesSource final : public FrameSource {
 public:
  GivenPosesSource(std::unique_ptr<FrameSource> source, GivenPoses poses)
      : source_(std::move(source)), poses_(std::move(poses)) {}

  std::string name() const override { return source_->name(); }
  PinholeCamera camera() const override { return source_->camera(); }
  std::optional<std::int64_t> size() const override { return source_->size(); }
  const Trajectory& ground_truth() const override { return source_->ground_truth(); }
  FrameRead next(RgbdFrame& frame, Error& error) override {
    if (!poses_.seen.empty()) find_unit();
    if (ahead_.empty()) return read(frame, error);
    ReadAhead first = std::move(ahead_.front());
    ahead_.pop_front();
    frame = std::move(first.frame);
    error = std::move(first.error);
    if (first.read == FrameRead::kOk) frame.given_T_world_camera->t *= metres_;
    return first.read;
  }
  bool live() const override { return source_->live(); }
  void stop() override { source_->stop(); }

 private:
  FrameRead read(RgbdFrame& frame, Error& error) {
    const FrameRead status = source_->next(frame, error);
    if (status != FrameRead::kOk || frame.given_T_world_camera) return status;
    frame.given_T_world_camera = given_pose_at(poses_.poses, frame.timestamp_s);
    if (frame.given_T_world_camera) {
      frame.given_T_world_camera->t *= metres_;
      return status;
    }
    error = {ErrorCode::kNotFound,
             fmt::format("no pose is given for its time ({:.6f} s)", frame.timestamp_s), ""};
    return FrameRead::kBadFrame;
  }

  /// Looks at the first frames that have a pose, and keeps all of them for next().
  void find_unit() {
    constexpr std::size_t kEnough = 12, kMost = 60;
    std::vector<const RgbdFrame*> posed;
    while (posed.size() < kEnough && ahead_.size() < kMost) {
      ReadAhead& item = ahead_.emplace_back();
      item.read = read(item.frame, item.error);
      if (item.read == FrameRead::kEnd) break;
      if (item.read == FrameRead::kOk) posed.push_back(&item.frame);
    }
    const auto metres = metres_per_unit(posed, poses_.seen);
    poses_.seen.clear();
    if (!metres) {
      log().warn(
          "{}: too few points of the model are seen with depth to tell its unit; it is taken as "
          "the metre",
          name());
    } else if (std::abs(*metres - 1) > kSameUnit) {
      metres_ = *metres;
      log().warn(
          "{}: the unit of the given poses is {:.4g} m, by the measured depths; they are brought "
          "to metres",
          name(), metres_);
    }
  }

  /// A model in metres is not to be bent to the noise of a few frames.
  static constexpr double kSameUnit = 0.02;

  std::unique_ptr<FrameSource> source_;
  GivenPoses poses_;
  std::deque<ReadAhead> ahead_;
  double metres_ = 1;  // a unit of the poses
};

/// The file that holds the poses: `poses`, or the one in that folder.
Result<fs::path> pose_file(const fs::path& poses) {
  std::error_code error;
  if (!fs::is_directory(poses, error)) return poses;
  for (const char* name : {"images.txt", "trajectory.txt"}) {
    if (fs::exists(poses / name, error)) return poses / name;
  }
  if (fs::exists(poses / "images.bin", error)) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{}: a COLMAP model in binary form", poses.string()),
                fmt::format("convert it: `colmap model_converter --input_path {} --output_path OUT "
                            "--output_type TXT`",
                            poses.string()));
  }
  return fail(ErrorCode::kNotFound,
              fmt::format("{}: neither images.txt nor trajectory.txt in it", poses.string()),
              kPoseFiles);
}

/// Whether a picture's name in a model is that of a file: all of it, or all but the extension.
bool names_file(const fs::path& name, const fs::path& file, bool with_extension) {
  auto n = name.end();
  auto f = file.end();
  bool last = true;
  while (n != name.begin()) {
    if (f == file.begin()) return false;
    --n;
    --f;
    const bool equal = last && !with_extension ? n->stem() == f->stem() : *n == *f;
    if (!equal) return false;
    last = false;
  }
  return !last;
}

/// The frame that a picture of a model is; empty where none or several could be.
const NamedFrame* find_frame(const fs::path& name,
                             const std::multimap<std::string, const NamedFrame*>& by_stem) {
  for (const bool with_extension : {true, false}) {
    const NamedFrame* found = nullptr;
    const auto [first, last] = by_stem.equal_range(name.stem().string());
    for (auto it = first; it != last; ++it) {
      if (!names_file(name, it->second->image, with_extension)) continue;
      if (found != nullptr) return nullptr;
      found = it->second;
    }
    if (found != nullptr) return found;
  }
  return nullptr;
}

/// The points beside a list of pictures; none where the file is missing.
Result<std::unordered_map<std::int64_t, Eigen::Vector3d>> points_beside(const fs::path& images) {
  const fs::path path = images.parent_path() / "points3D.txt";
  std::error_code error;
  if (!fs::exists(path, error)) return {};
  return io::load_colmap_points(path);
}

Result<GivenPoses> colmap_poses(const fs::path& path, const PosedFrames& wanted) {
  SGS_ASSIGN_OR_RETURN(const auto images, io::load_colmap_images(path));
  SGS_ASSIGN_OR_RETURN(const auto points, points_beside(path));
  const auto& frames = wanted.frames;
  if (frames.empty()) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{}: poses by file name, but the images of {} have none", path.string(),
                            wanted.sequence),
                "`sgs convert` writes a folder of images; or give TUM rows, which go by time");
  }
  std::multimap<std::string, const NamedFrame*> by_stem;
  for (const NamedFrame& frame : frames) by_stem.emplace(frame.image.stem().string(), &frame);
  std::vector<StampedPose> poses;
  GivenPoses given;
  for (const io::ColmapImage& image : images) {
    const NamedFrame* frame = find_frame(fs::path(image.name).lexically_normal(), by_stem);
    if (frame == nullptr) continue;
    poses.push_back({frame->timestamp_s, image.T_world_camera});
    for (const std::int64_t point : image.points) {
      if (const auto found = points.find(point); found != points.end()) {
        given.seen[frame->timestamp_s].push_back(found->second);
      }
    }
  }
  if (poses.empty()) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: none of its {} pictures ('{}', ...) is one of the {} colour "
                            "images of {} ('{}', ...)",
                            path.string(), images.size(), images.front().name, frames.size(),
                            wanted.sequence, frames.front().image.filename().string()),
                "the model must be of this recording's images, under the same names");
  }
  if (poses.size() < images.size()) {
    given.warnings.push_back(fmt::format("{}: {} of its {} pictures are not in {}", path.string(),
                                         images.size() - poses.size(), images.size(),
                                         wanted.sequence));
  }
  given.poses = Trajectory(std::move(poses));
  return given;
}

/// Whether a file is COLMAP's list of pictures: its rows alone do not tell.
bool is_colmap(const fs::path& path) { return path.filename().string().ends_with("images.txt"); }

Result<GivenPoses> tum_poses(const fs::path& path) {
  auto loaded = io::load_trajectory(path);
  if (!loaded) {
    Error error = loaded.error();
    if (error.code == ErrorCode::kInvalidFormat) error.remedy = kPoseFiles;
    return tl::unexpected<Error>(std::move(error));
  }
  if (!loaded->trajectory.empty()) {
    GivenPoses given{std::move(loaded->trajectory)};
    if (!loaded->warning.empty()) given.warnings.push_back(std::move(loaded->warning));
    return given;
  }
  return fail(
      ErrorCode::kInvalidFormat,
      fmt::format("{}: no usable pose in {} rows{}", path.string(), loaded->rows,
                  loaded->skipped > 0 ? "; their numbers are no rotations or not finite" : ""),
      kPoseFiles);
}

tl::unexpected<Error> other_times(const Trajectory& poses, const PosedFrames& wanted,
                                  const std::string& source) {
  constexpr double kNanoseconds = 1e9;
  const auto& p = poses.poses();
  const double ratio = p.front().timestamp_s / wanted.first_time_s;
  const bool nanoseconds = std::abs(ratio / kNanoseconds - 1) < 0.1;
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("{}: no pose is of the time of any frame: {} poses from {:.3f} to {:.3f} "
                          "s, frames of {} from {:.3f} to {:.3f} s",
                          source, p.size(), p.front().timestamp_s, p.back().timestamp_s,
                          wanted.sequence, wanted.first_time_s, wanted.last_time_s),
              nanoseconds ? "its times are nanoseconds; they must be seconds"
                          : "poses must be on the clock of the recording, in seconds, at most 0.25 "
                            "s apart or at the very times of the frames");
}

/// Poses that are of another time than the frames are useless.
Status check_times(GivenPoses& given, const PosedFrames& wanted, const std::string& source) {
  const auto& p = given.poses.poses();
  if (p.front().timestamp_s > wanted.last_time_s || p.back().timestamp_s < wanted.first_time_s) {
    return other_times(given.poses, wanted, source);
  }
  const auto& frames = wanted.frames;
  const auto without = std::count_if(frames.begin(), frames.end(), [&](const NamedFrame& frame) {
    return !given_pose_at(given.poses, frame.timestamp_s);
  });
  if (without == 0) return {};
  if (static_cast<std::size_t>(without) == frames.size()) {
    return other_times(given.poses, wanted, source);
  }
  given.warnings.push_back(fmt::format("{}: no pose for {} of the {} frames, which are skipped",
                                       source, without, frames.size()));
  return {};
}

/// Gaussians are kept in single precision: at 10 km they would lie on a grid of a millimetre.
Status check_place(const Trajectory& poses, const std::string& source) {
  constexpr double kFarthest_m = 1e4;
  for (const StampedPose& pose : poses.poses()) {
    if (pose.T_world_camera.t.norm() <= kFarthest_m) continue;
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: the camera is {:.3g} m from the origin at {:.3f} s", source,
                            pose.T_world_camera.t.norm(), pose.timestamp_s),
                "poses must be in metres, within 10 km of the origin: subtract that of the first "
                "one");
  }
  return {};
}

}  // namespace

Result<GivenPoses> load_given_poses(const std::string& poses, const Trajectory& recorded,
                                    const PosedFrames& wanted) {
  GivenPoses found{recorded};
  std::string source = wanted.sequence;
  if (poses != kRecordedPoses) {
    SGS_ASSIGN_OR_RETURN(const fs::path path, pose_file(poses));
    source = path.string();
    SGS_ASSIGN_OR_RETURN(found, is_colmap(path) ? colmap_poses(path, wanted) : tum_poses(path));
  } else if (recorded.empty()) {
    return fail(ErrorCode::kNotFound,
                fmt::format("{}: the recording has no poses of its own that are rotation and "
                            "position",
                            wanted.sequence),
                fmt::format("name a file that has them; {}", kPoseFiles));
  }
  SGS_RETURN_IF_ERROR(check_times(found, wanted, source));
  SGS_RETURN_IF_ERROR(check_place(found.poses, source));
  return found;
}

std::optional<SE3> given_pose_at(const Trajectory& poses, double timestamp_s) {
  constexpr double kSameTime_s = 2e-3, kMaxGap_s = 0.25;
  const auto& p = poses.poses();
  auto nearest = std::lower_bound(
      p.begin(), p.end(), timestamp_s,
      [](const StampedPose& pose, double time_s) { return pose.timestamp_s < time_s; });
  const auto distance_s = [&](auto it) { return std::abs(it->timestamp_s - timestamp_s); };
  if (nearest != p.begin() &&
      (nearest == p.end() || distance_s(std::prev(nearest)) < distance_s(nearest))) {
    --nearest;
  }
  // Interpolation comes first: where it can be had it is the better one.
  if (const auto pose = poses.at(timestamp_s, kMaxGap_s)) return pose;
  if (nearest != p.end() && distance_s(nearest) <= kSameTime_s) return nearest->T_world_camera;
  return std::nullopt;
}

std::optional<double> metres_per_unit(const std::vector<const RgbdFrame*>& frames,
                                      const std::map<double, std::vector<Eigen::Vector3d>>& seen) {
  constexpr std::size_t kFewest = 50;
  std::vector<double> ratios;
  for (const RgbdFrame* frame : frames) {
    const auto points = seen.find(frame->timestamp_s);
    if (points == seen.end()) continue;
    const SE3 T_camera_world = frame->given_T_world_camera->inverse();
    const PinholeCamera& c = frame->camera;
    for (const Eigen::Vector3d& point : points->second) {
      // Where a point is seen does not depend on the unit.
      const Eigen::Vector3d p = T_camera_world * point;
      const double u = c.fx * p.x() / p.z() + c.cx, v = c.fy * p.y() / p.z() + c.cy;
      if (!(p.z() > 0 && u > -0.5 && v > -0.5 && u < c.width - 0.5 && v < c.height - 0.5)) continue;
      const float measured =
          frame->depth(static_cast<int>(std::lround(u)), static_cast<int>(std::lround(v)));
      if (measured > 0) ratios.push_back(static_cast<double>(measured) / p.z());
    }
  }
  if (ratios.size() < kFewest) return std::nullopt;
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::nth_element(ratios.begin(), middle, ratios.end());
  return *middle;
}

std::unique_ptr<FrameSource> with_given_poses(std::unique_ptr<FrameSource> source,
                                              GivenPoses poses) {
  return std::make_unique<GivenPosesSource>(std::move(source), std::move(poses));
}

}  // namespace sgs::dataset
