// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/metre_check.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <utility>

namespace sgs::slam {
namespace {

constexpr int kStep_px = 16, kEnough = 100;
constexpr double kNear_m = 0.3, kFar_m = 5;  // beyond, noise is what differs
constexpr double kSameSurface = 0.15;        // share of the depth, before the frame is fitted
constexpr double kFits = 0.03;               // and after
constexpr double kLeastLever_m = 0.05;       // by which the scale moves points as no pose does
constexpr double kLeastCosine = 0.75;        // between viewing directions

using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;

/// A point of the map against the plane of the frame that lies there: what scale, turn and shift
/// would do to their distance `r`.
struct Row {
  Vector7d J;
  double r, depth_m;
};

/// Point of the frame at a pixel; not finite where none was measured.
Eigen::Vector3d point_at(const RgbdFrame& frame, int u, int v) {
  const double z = frame.depth(u, v);
  if (z > 0) return frame.camera.back_project(u, v, z);
  return Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
}

/// The rows of those points of a view that the frame sees.
std::vector<Row> rows_of(const std::vector<Eigen::Vector3d>& points, const SE3& T_camera_view,
                         const RgbdFrame& frame) {
  constexpr int kReach_px = 3;
  constexpr double kMostSlope = 0.2;  // a jump of depth is no plane
  std::vector<Row> rows;
  for (const Eigen::Vector3d& point : points) {
    const Eigen::Vector3d p = T_camera_view * point;
    if (!(p.z() > kNear_m && p.z() < kFar_m)) continue;
    const double u = frame.camera.fx * p.x() / p.z() + frame.camera.cx;
    const double v = frame.camera.fy * p.y() / p.z() + frame.camera.cy;
    if (!(u >= kReach_px && v >= kReach_px && u < frame.camera.width - kReach_px - 1 &&
          v < frame.camera.height - kReach_px - 1)) {
      continue;
    }
    const int x = static_cast<int>(std::lround(u)), y = static_cast<int>(std::lround(v));
    const Eigen::Vector3d q = point_at(frame, x, y);
    const Eigen::Vector3d along =
        point_at(frame, x + kReach_px, y) - point_at(frame, x - kReach_px, y);
    const Eigen::Vector3d down =
        point_at(frame, x, y + kReach_px) - point_at(frame, x, y - kReach_px);
    const bool plane = along.norm() < kMostSlope * p.z() && down.norm() < kMostSlope * p.z();
    if (!plane || !(std::abs(q.z() - p.z()) < kSameSurface * p.z())) continue;
    const Eigen::Vector3d n = along.cross(down).normalized();
    Row row{Vector7d::Zero(), n.dot(p - q), p.z()};
    row.J << n.dot(p), p.cross(n), n;
    rows.push_back(row);
  }
  return rows;
}

struct Normal {
  Matrix7d H = Matrix7d::Zero();
  Vector7d b = Vector7d::Zero();

  explicit Normal(const std::vector<Row>& rows) {
    for (const Row& row : rows) {
      H += row.J * row.J.transpose();
      b -= row.J * row.r;
    }
    H.diagonal().array() += 1e-6 * H.trace();  // what cannot be told stays as it is
  }
};

}  // namespace

void MetreCheck::know(std::int64_t index, const RgbdFrame& view) {
  View& known = views_.emplace_back(View{index, {}});
  for (int v = kStep_px / 2; v < view.camera.height; v += kStep_px) {
    for (int u = kStep_px / 2; u < view.camera.width; u += kStep_px) {
      const double z = view.depth(u, v);
      if (z > kNear_m && z < kFar_m) known.points.push_back(view.camera.back_project(u, v, z));
    }
  }
}

bool MetreCheck::add(const RgbdFrame& frame, const SE3& T_world_camera, const history::Path& path) {
  if (views_.empty() || frames_ >= needed_) return false;
  std::vector<Row> most;
  for (const View& view : views_) {
    const SE3 T_camera_view = T_world_camera.inverse() * path.at(view.index);
    if (T_camera_view.R(2, 2) < kLeastCosine) continue;
    std::vector<Row> rows = rows_of(view.points, T_camera_view, frame);
    if (rows.size() > most.size()) most = std::move(rows);
  }
  if (most.size() < kEnough) return false;
  const Normal all(most);
  const Vector7d first = all.H.ldlt().solve(all.b);
  std::erase_if(most, [&](const Row& row) {
    return std::abs(row.r + row.J.dot(first)) > kFits * row.depth_m;
  });
  if (most.size() < kEnough) return false;
  // What is left of the scale when the pose is free.
  const Normal normal(most);
  const Matrix6d pose = normal.H.bottomRightCorner<6, 6>();
  const Vector6d coupling = normal.H.bottomLeftCorner<6, 1>();
  const Vector6d share = pose.ldlt().solve(coupling);
  H_ += normal.H(0, 0) - coupling.dot(share);
  b_ += normal.b[0] - share.dot(normal.b.tail<6>());
  count_ += static_cast<int>(most.size());
  return ++frames_ == needed_;
}

std::optional<double> MetreCheck::ratio() const {
  if (frames_ < needed_ || H_ < kLeastLever_m * kLeastLever_m * count_) return std::nullopt;
  return 1 + b_ / H_;
}

}  // namespace sgs::slam
