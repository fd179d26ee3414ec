// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/trajectory_io.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "sgs/core/log.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/text.h"

namespace sgs::io {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kColumns = 8;
constexpr double kMaxQuaternionError = 1e-2;

Result<std::array<double, kColumns>> parse_row(const fs::path& path, const TextLine& line) {
  const auto fields = split_fields(line.text, ",");
  std::array<double, kColumns> row{};
  bool good = fields.size() == kColumns;
  for (std::size_t i = 0; good && i < kColumns; ++i) {
    const auto value = parse_double(fields[i]);
    good = value.has_value();
    if (good) row[i] = *value;
  }
  if (good) return row;
  return fail(
      ErrorCode::kInvalidFormat,
      fmt::format("{}:{}: not a pose: '{}'", path.string(), line.number, line.text.substr(0, 80)),
      "each row must be 'timestamp tx ty tz qx qy qz qw'");
}

bool usable(const std::array<double, kColumns>& row) {
  const bool finite =
      std::all_of(row.begin(), row.end(), [](double v) { return std::isfinite(v); });
  const double norm = std::hypot(std::hypot(row[4], row[5]), std::hypot(row[6], row[7]));
  return finite && std::abs(norm - 1) <= kMaxQuaternionError;
}

std::string warning_text(const fs::path& path, const LoadedTrajectory& loaded) {
  std::string problems;
  const auto add = [&](std::size_t count, const char* what) {
    if (count > 0) problems += fmt::format("{}{} {}", problems.empty() ? "" : ", ", count, what);
  };
  add(loaded.skipped, "rows with NaN or a quaternion that is not of unit length skipped");
  add(loaded.out_of_order, "rows out of time order sorted");
  add(loaded.duplicates, "rows with a repeated time dropped");
  return problems.empty()
             ? ""
             : fmt::format("{}: {} (of {} rows)", path.string(), problems, loaded.rows);
}

}  // namespace

Result<LoadedTrajectory> load_trajectory(const fs::path& path) {
  SGS_ASSIGN_OR_RETURN(const std::string content, read_file(path));
  return trajectory_from_text(content, path);
}

Result<LoadedTrajectory> trajectory_from_text(std::string_view content, const fs::path& path) {
  LoadedTrajectory loaded;
  std::vector<StampedPose> poses;
  double last_time_s = -std::numeric_limits<double>::infinity();
  for (const TextLine& line : content_lines(content)) {
    SGS_ASSIGN_OR_RETURN(const auto row, parse_row(path, line));
    ++loaded.rows;
    if (!usable(row)) {
      ++loaded.skipped;
      continue;
    }
    if (row[0] < last_time_s) ++loaded.out_of_order;
    last_time_s = row[0];
    const Eigen::Quaterniond rotation(row[7], row[4], row[5], row[6]);
    poses.push_back({row[0], SE3(rotation, Eigen::Vector3d(row[1], row[2], row[3]))});
  }
  const std::size_t kept = poses.size();
  loaded.trajectory = Trajectory(std::move(poses));
  loaded.duplicates = kept - loaded.trajectory.size();
  loaded.warning = warning_text(path, loaded);
  if (!loaded.warning.empty()) log().warn("{}", loaded.warning);
  return loaded;
}

std::string trajectory_text(const Trajectory& trajectory) {
  std::string text;
  for (const StampedPose& pose : trajectory.poses()) {
    Eigen::Quaterniond q = pose.T_world_camera.quaternion();
    if (q.w() < 0) q.coeffs() = -q.coeffs();
    const Eigen::Vector3d& t = pose.T_world_camera.t;
    fmt::format_to(std::back_inserter(text),
                   "{:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", pose.timestamp_s,
                   t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
  }
  return text;
}

Status save_trajectory(const fs::path& path, const Trajectory& trajectory) {
  return write_file(path, trajectory_text(trajectory));
}

Status save_kitti(const std::filesystem::path& path, const Trajectory& trajectory) {
  std::string text;
  for (const StampedPose& pose : trajectory.poses()) {
    const SE3& T = pose.T_world_camera;
    for (int row = 0; row < 3; ++row) {
      text += fmt::format("{}{:.9f} {:.9f} {:.9f} {:.9f}", row ? " " : "", T.R(row, 0), T.R(row, 1),
                          T.R(row, 2), T.t(row));
    }
    text += "\n";
  }
  return write_file(path, text);
}

}  // namespace sgs::io
