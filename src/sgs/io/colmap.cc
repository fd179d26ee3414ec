// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/colmap.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "sgs/io/atomic_file.h"
#include "sgs/io/text.h"

namespace sgs::io {
namespace {

constexpr std::size_t kPoseColumns = 9;  // IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID, then NAME

/// What stands behind the first `fields` fields of a line, without the white space around it.
std::string_view after_fields(std::string_view line, std::size_t fields) {
  constexpr std::string_view kBlank = " \t\r";
  std::size_t at = 0;
  for (std::size_t i = 0; i < fields && at != std::string_view::npos; ++i) {
    at = line.find_first_of(kBlank, line.find_first_not_of(kBlank, at));
  }
  at = line.find_first_not_of(kBlank, at);
  if (at == std::string_view::npos) return {};
  return line.substr(at, line.find_last_not_of(kBlank) - at + 1);
}

Result<ColmapImage> colmap_image(std::string_view line, const std::string& place) {
  constexpr double kMaxQuaternionError = 1e-2;
  const auto fields = split_fields(line);
  std::array<double, kPoseColumns> n{};
  bool numbers = fields.size() > kPoseColumns;
  for (std::size_t i = 0; numbers && i < n.size(); ++i) {
    const auto value = parse_double(fields[i]);
    numbers = value && std::isfinite(*value);
    if (numbers) n[i] = *value;
  }
  if (!numbers) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: not a picture of a COLMAP model: '{}'", place, line.substr(0, 80)),
                "every second row must be 'IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME', the rows "
                "between hold points or nothing");
  }
  const Eigen::Quaterniond q(n[1], n[2], n[3], n[4]);
  if (std::abs(q.norm() - 1) > kMaxQuaternionError) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: the quaternion's length is {:.3g}, so it is no rotation", place,
                            q.norm()));
  }
  const SE3 T_camera_world(q, {n[5], n[6], n[7]});
  return ColmapImage{std::string(after_fields(line, kPoseColumns)), T_camera_world.inverse()};
}

/// Numbers of the points in a row "x y POINT3D_ID ..."; -1 stands for a feature without one.
Result<std::vector<std::int64_t>> points_of(std::string_view line, const std::string& place) {
  const auto fields = split_fields(line);
  std::vector<std::int64_t> points;
  for (std::size_t i = 2; i < fields.size(); i += 3) {
    std::int64_t point = 0;
    const char* last = fields[i].data() + fields[i].size();
    const auto parsed = std::from_chars(fields[i].data(), last, point);
    if (parsed.ec != std::errc{} || parsed.ptr != last) {
      return fail(ErrorCode::kInvalidFormat,
                  fmt::format("{}: '{}' is no number of a point", place, fields[i].substr(0, 40)),
                  "rows between the pictures hold 'X Y POINT3D_ID' again and again");
    }
    if (point >= 0) points.push_back(point);
  }
  return points;
}

}  // namespace

// Rows come in pairs, and the second one may be empty: blank lines count.
Result<std::vector<ColmapImage>> load_colmap_images(const std::filesystem::path& path) {
  SGS_ASSIGN_OR_RETURN(const std::string content, read_text(path));
  std::vector<ColmapImage> images;
  bool points = false;
  int number = 0;
  for (std::string_view rest = content; !rest.empty();) {
    const auto end = rest.find('\n');
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    ++number;
    const std::string place = fmt::format("{}:{}", path.string(), number);
    if (line.starts_with('#')) continue;
    if (std::exchange(points, false)) {
      SGS_ASSIGN_OR_RETURN(images.back().points, points_of(line, place));
      continue;
    }
    if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    SGS_ASSIGN_OR_RETURN(auto image, colmap_image(line, place));
    images.push_back(std::move(image));
    points = true;
  }
  if (images.empty()) {
    return fail(ErrorCode::kInvalidFormat, fmt::format("{}: holds no pictures", path.string()),
                "give images.txt of a COLMAP text model");
  }
  return images;
}

Result<std::unordered_map<std::int64_t, Eigen::Vector3d>> load_colmap_points(
    const std::filesystem::path& path) {
  constexpr std::size_t kPointColumns = 4;  // POINT3D_ID X Y Z; colour, error and track follow
  constexpr double kLargestNumber = 1e15;
  SGS_ASSIGN_OR_RETURN(const std::string content, read_text(path));
  std::unordered_map<std::int64_t, Eigen::Vector3d> points;
  for (const TextLine& line : content_lines(content)) {
    const auto fields = split_fields(line.text);
    std::array<double, kPointColumns> n{};
    bool numbers = fields.size() >= n.size();
    for (std::size_t i = 0; numbers && i < n.size(); ++i) {
      const auto value = parse_double(fields[i]);
      numbers = value && std::abs(*value) < kLargestNumber;
      if (numbers) n[i] = *value;
    }
    if (!numbers) {
      return fail(ErrorCode::kInvalidFormat,
                  fmt::format("{}:{}: not a point of a COLMAP model", path.string(), line.number),
                  "each row must begin with 'POINT3D_ID X Y Z'");
    }
    points.emplace(static_cast<std::int64_t>(n[0]), Eigen::Vector3d(n[1], n[2], n[3]));
  }
  return points;
}

Status save_colmap_model(const std::filesystem::path& folder, const PinholeCamera& camera,
                         std::span<const ColmapImage> images,
                         std::span<const ColoredPoint> points) {
  constexpr double kHalfPixel = 0.5;
  std::string text = fmt::format(
      "# Camera list: CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[fx fy cx cy]\n1 PINHOLE {} {} {:.9g} "
      "{:.9g} {:.9g} {:.9g}\n",
      camera.width, camera.height, camera.fx, camera.fy, camera.cx + kHalfPixel,
      camera.cy + kHalfPixel);
  SGS_RETURN_IF_ERROR(write_file(folder / "cameras.txt", text));

  text =
      "# Two lines per image: IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME; then its\n"
      "# points (none).\n";
  int id = 0;
  for (const ColmapImage& image : images) {
    if (image.name.find_first_of(" \t\n") != std::string::npos) {
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("COLMAP image names cannot hold spaces: '{}'", image.name));
    }
    const SE3 T_camera_world = image.T_world_camera.inverse();
    const Eigen::Quaterniond q = T_camera_world.quaternion();
    const Eigen::Vector3d& t = T_camera_world.t;
    text += fmt::format("{} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} 1 {}\n\n", ++id, q.w(),
                        q.x(), q.y(), q.z(), t.x(), t.y(), t.z(), image.name);
  }
  SGS_RETURN_IF_ERROR(write_file(folder / "images.txt", text));

  text = "# POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] (none)\n";
  id = 0;
  for (const ColoredPoint& p : points) {
    text += fmt::format("{} {:.6f} {:.6f} {:.6f} {} {} {} 0\n", ++id, p.position.x(),
                        p.position.y(), p.position.z(), p.color.r, p.color.g, p.color.b);
  }
  return write_file(folder / "points3D.txt", text);
}

}  // namespace sgs::io
