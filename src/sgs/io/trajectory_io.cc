// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/trajectory_io.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "sgs/core/log.h"
#include "sgs/core/text.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/text.h"

namespace sgs::io {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kColumns = 8;
constexpr double kMaxQuaternionError = 1e-2;
constexpr const char* kExpected =
    "expected are rows of eight numbers: time in seconds, position in metres, quaternion: "
    "'time tx ty tz qx qy qz qw'; a first line that names its columns so may say another order";

using PoseRow = std::array<double, kColumns>;

/// Which fields of a row are the columns of a pose, and how many fields there are.
struct PoseColumns {
  std::array<std::size_t, kColumns> at = {0, 1, 2, 3, 4, 5, 6, 7};
  std::size_t count = kColumns;
};

/// Names under which programs write the columns, in our order.
constexpr std::array<std::array<std::string_view, 7>, kColumns> kColumnNames = {{
    {"t", "time", "timestamp", "timestamp_s", "stamp", "sec", "time_s"},
    {"tx", "x", "px", "p_x", "pos_x", "position_x", "t_x"},
    {"ty", "y", "py", "p_y", "pos_y", "position_y", "t_y"},
    {"tz", "z", "pz", "p_z", "pos_z", "position_z", "t_z"},
    {"qx", "q_x", "rot_x", "quat_x", "orientation_x", "rx", "r_x"},
    {"qy", "q_y", "rot_y", "quat_y", "orientation_y", "ry", "r_y"},
    {"qz", "q_z", "rot_z", "quat_z", "orientation_z", "rz", "r_z"},
    {"qw", "q_w", "rot_w", "quat_w", "orientation_w", "rw", "r_w"},
}};

tl::unexpected<Error> no_pose(const fs::path& path, const TextLine& line, const char* what) {
  constexpr std::size_t kLongest = 240;
  const std::string_view shown = line.text.substr(0, kLongest);
  return fail(ErrorCode::kInvalidFormat,
              fmt::format("{}:{}: {}: '{}'{}", path.string(), line.number, what, printable(shown),
                          shown.size() < line.text.size() ? " and so on" : ""),
              kExpected);
}

/// The columns as a heading names them; an error where it does not name all of a pose.
Result<PoseColumns> columns_of(const fs::path& path, const TextLine& heading) {
  const auto names = split_fields(heading.text, ",;");
  PoseColumns columns;
  columns.count = names.size();
  for (std::size_t i = 0; i < kColumns; ++i) {
    const auto is_column = [&](std::string_view name) {
      const auto& known = kColumnNames[i];
      return std::find(known.begin(), known.end(), lower_case(std::string(name))) != known.end();
    };
    const auto found = std::find_if(names.begin(), names.end(), is_column);
    if (found == names.end())
      return no_pose(path, heading, "neither a pose nor names of its columns");
    columns.at[i] = static_cast<std::size_t>(found - names.begin());
  }
  return columns;
}

bool is_heading(const TextLine& line) {
  const auto fields = split_fields(line.text, ",;");
  return !fields.empty() && !parse_decimal(fields[0]);
}

Result<PoseRow> parse_row(const fs::path& path, const TextLine& line, const PoseColumns& columns) {
  const auto fields = split_row(line.text, columns.count);
  PoseRow row{};
  bool good = fields.size() == columns.count;
  for (std::size_t i = 0; good && i < kColumns; ++i) {
    const auto value = parse_decimal(fields[columns.at[i]]);
    good = value.has_value();
    if (good) row[i] = *value;
  }
  if (good) return row;
  return no_pose(path, line, "not a pose");
}

bool usable(const PoseRow& row) {
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
  SGS_ASSIGN_OR_RETURN(const std::string content, read_text(path));
  return trajectory_from_text(content, path);
}

Result<LoadedTrajectory> trajectory_from_text(std::string_view content, const fs::path& path) {
  LoadedTrajectory loaded;
  std::vector<StampedPose> poses;
  double last_time_s = -std::numeric_limits<double>::infinity();
  auto lines = content_lines(content);
  PoseColumns columns;
  if (lines.size() > 1 && is_heading(lines.front())) {
    SGS_ASSIGN_OR_RETURN(columns, columns_of(path, lines.front()));
    lines.erase(lines.begin());
  }
  for (const TextLine& line : lines) {
    SGS_ASSIGN_OR_RETURN(const auto row, parse_row(path, line, columns));
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
