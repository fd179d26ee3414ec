// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/robot/news.h"

#include <cstring>

#include "sgs/bag/bytes.h"
#include "sgs/bag/wire_writer.h"

namespace sgs::robot {
namespace {

using bag::Bytes;
using bag::WireWriter;

constexpr char kPose = 'P', kPath = 'T', kCloud = 'C', kGrid = 'G';
constexpr std::size_t kHead_bytes = 1 + sizeof(std::uint32_t);

template <class Matrix>
void put(WireWriter& out, const Matrix& values) {
  for (const double value : values.reshaped()) out.number(value);
}
void put(WireWriter& out, const SE3& T) {
  put(out, T.R);
  put(out, T.t);
}

template <class Matrix>
void get(Bytes& in, Matrix& values) {
  for (auto& value : values.reshaped()) value = in.number<double>();
}
void get(Bytes& in, SE3& T) {
  get(in, T.R);
  get(in, T.t);
}

char pack(const PoseNews& news, WireWriter& out) {
  put(out, news.standing.T_map_odom);
  put(out, news.standing.T_odom_camera);
  out.number<std::uint8_t>(news.standing.velocity ? 1 : 0);
  if (news.standing.velocity) put(out, *news.standing.velocity);
  return kPose;
}

char pack(const PathNews& news, WireWriter& out) {
  for (const StampedPose& pose : news.poses.poses()) {
    out.number(pose.timestamp_s);
    put(out, pose.T_world_camera);
  }
  return kPath;
}

char pack(const CloudNews& news, WireWriter& out) {
  for (const io::ColoredPoint& point : news.points) {
    for (const float value : point.position) out.number(value);
    for (const std::uint8_t value : {point.color.r, point.color.g, point.color.b}) {
      out.number(value);
    }
  }
  return kCloud;
}

char pack(const GridNews& news, WireWriter& out) {
  const occupancy::OccupancyGrid& grid = news.grid;
  out.number(grid.resolution_m).number(grid.origin_m.x()).number(grid.origin_m.y());
  out.number(grid.width).number(grid.height);
  for (const occupancy::Cell cell : grid.cells) out.number(static_cast<std::uint8_t>(cell));
  return kGrid;
}

PoseNews pose_of(Bytes& in) {
  PoseNews news;
  get(in, news.standing.T_map_odom);
  get(in, news.standing.T_odom_camera);
  if (in.number<std::uint8_t>() != 0) get(in, news.standing.velocity.emplace());
  return news;
}

PathNews path_of(Bytes& in) {
  std::vector<StampedPose> poses;
  while (in.ok() && !in.empty()) {
    StampedPose& pose = poses.emplace_back();
    pose.timestamp_s = in.number<double>();
    get(in, pose.T_world_camera);
  }
  return {0, Trajectory(std::move(poses))};
}

CloudNews cloud_of(Bytes& in) {
  CloudNews news;
  while (in.ok() && !in.empty()) {
    io::ColoredPoint& point = news.points.emplace_back();
    for (float& value : point.position) value = in.number<float>();
    for (std::uint8_t* value : {&point.color.r, &point.color.g, &point.color.b}) {
      *value = in.number<std::uint8_t>();
    }
  }
  return news;
}

GridNews grid_of(Bytes& in) {
  GridNews news;
  occupancy::OccupancyGrid& grid = news.grid;
  grid.resolution_m = in.number<double>();
  grid.origin_m.x() = in.number<double>();
  grid.origin_m.y() = in.number<double>();
  grid.width = in.number<int>();
  grid.height = in.number<int>();
  while (in.ok() && !in.empty()) {
    grid.cells.push_back(static_cast<occupancy::Cell>(in.number<std::uint8_t>()));
  }
  return news;
}

tl::unexpected<Error> no_news() {
  return fail(ErrorCode::kInvalidFormat, "what comes is no news of a run",
              "`sgs run --ros2` starts this program, of the same version");
}

bool fits(const occupancy::OccupancyGrid& grid) {
  return grid.width >= 0 && grid.height >= 0 &&
         grid.cells.size() ==
             static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height);
}

Status read_news(char mark, std::string_view body, News& news) {
  Bytes in(body);
  const auto timestamp_s = in.number<double>();
  switch (mark) {
    case kPose:
      news = pose_of(in);
      break;
    case kPath:
      news = path_of(in);
      break;
    case kCloud:
      news = cloud_of(in);
      break;
    case kGrid:
      news = grid_of(in);
      if (!fits(std::get<GridNews>(news).grid)) return no_news();
      break;
    default:
      return no_news();
  }
  if (!in.ok() || !in.empty()) return no_news();
  std::visit([&](auto& one) { one.timestamp_s = timestamp_s; }, news);
  return {};
}

}  // namespace

std::string encode(const News& news) {
  WireWriter body;
  const char mark = std::visit(
      [&](const auto& one) {
        body.number(one.timestamp_s);
        return pack(one, body);
      },
      news);
  WireWriter out;
  out.number(mark).bytes(body.data());
  return out.data();
}

Result<bool> NewsParser::next(News& news) {
  if (buffer_.size() < kHead_bytes) return false;
  std::uint32_t length = 0;
  std::memcpy(&length, buffer_.data() + 1, sizeof length);
  if (buffer_.size() - kHead_bytes < length) return false;
  SGS_RETURN_IF_ERROR(
      read_news(buffer_[0], std::string_view(buffer_).substr(kHead_bytes, length), news));
  buffer_.erase(0, kHead_bytes + length);
  return true;
}

}  // namespace sgs::robot
