// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/occupancy/distance.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace sgs::occupancy {
namespace {

constexpr float kFar = 1e12f;  // squared voxels; sums of it stay finite

/// Squared distances along one line, in voxels: the lower envelope of a parabola over each entry
/// (Felzenszwalb and Huttenlocher, Distance Transforms of Sampled Functions, 2012).
class Line {
 public:
  explicit Line(int length)
      : values_(static_cast<std::size_t>(length)), at_(values_.size()), from_(values_.size() + 1) {}

  void transform(float* first, std::size_t stride) {
    const std::size_t n = values_.size();
    for (std::size_t i = 0; i < n; ++i) values_[i] = first[i * stride];
    std::size_t last = 0;
    at_[0] = 0;
    from_[0] = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < n; ++i) {
      double crossing = crossing_of(at_[last], i);
      while (crossing <= from_[last]) crossing = crossing_of(at_[--last], i);
      at_[++last] = i;
      from_[last] = crossing;
    }
    std::size_t k = 0;
    for (std::size_t i = 0; i < n; ++i) {
      while (k < last && from_[k + 1] < static_cast<double>(i)) ++k;
      const double d = static_cast<double>(i) - static_cast<double>(at_[k]);
      first[i * stride] = std::min(kFar, static_cast<float>(d * d + double{values_[at_[k]]}));
    }
  }

 private:
  /// Where the parabola over `b` comes below that over `a`, which stands before it.
  double crossing_of(std::size_t a, std::size_t b) const {
    const double p = static_cast<double>(a), q = static_cast<double>(b);
    return (double{values_[b]} - double{values_[a]} + q * q - p * p) / (2 * (q - p));
  }

  std::vector<float> values_;
  std::vector<std::size_t> at_;
  std::vector<double> from_;
};

/// Squared distances to the nearest zero, in voxels; x runs fastest.
void transform(std::vector<float>& field, const Eigen::Vector3i& size) {
  const auto nx = static_cast<std::size_t>(size.x()), ny = static_cast<std::size_t>(size.y()),
             nz = static_cast<std::size_t>(size.z());
  Line along_x(size.x()), along_y(size.y()), along_z(size.z());
  for (std::size_t z = 0; z < nz; ++z) {
    for (std::size_t y = 0; y < ny; ++y) along_x.transform(&field[(z * ny + y) * nx], 1);
    for (std::size_t x = 0; x < nx; ++x) along_y.transform(&field[z * ny * nx + x], nx);
  }
  for (std::size_t i = 0; i < nx * ny; ++i) along_z.transform(&field[i], nx * ny);
}

}  // namespace

Status for_each_distance(const OccupancyVolume& volume, double limit_m,
                         const std::function<void(const Eigen::Vector3i&, double)>& visit) {
  // limit: voxels of the box of a distance field that `sgs export esdf` writes (1 GB)
  constexpr std::int64_t kMaxVoxels = std::int64_t{1} << 28;
  Eigen::AlignedBox3i box;
  volume.for_each([&](const Eigen::Vector3i& voxel, Cell) { box.extend(voxel); });
  if (box.isEmpty()) return {};
  const Eigen::Vector3i size = box.sizes() + Eigen::Vector3i::Ones();
  if (std::int64_t{size.x()} * size.y() > kMaxVoxels / size.z()) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("a distance field of {} x {} x {} voxels is too large", size.x(),
                            size.y(), size.z()),
                "a larger --resolution");
  }
  const auto place = [&](const Eigen::Vector3i& voxel) {
    const Eigen::Vector3i at = voxel - box.min();
    return (static_cast<std::size_t>(at.z()) * static_cast<std::size_t>(size.y()) +
            static_cast<std::size_t>(at.y())) *
               static_cast<std::size_t>(size.x()) +
           static_cast<std::size_t>(at.x());
  };
  std::vector<float> field(static_cast<std::size_t>(size.x()) * static_cast<std::size_t>(size.y()) *
                               static_cast<std::size_t>(size.z()),
                           kFar);
  volume.for_each([&](const Eigen::Vector3i& voxel, Cell cell) {
    if (cell == Cell::kOccupied) field[place(voxel)] = 0;
  });
  transform(field, size);
  volume.for_each([&](const Eigen::Vector3i& voxel, Cell) {
    const double metres = volume.voxel_m() * std::sqrt(double{field[place(voxel)]});
    visit(voxel, std::min(metres, limit_m));
  });
  return {};
}

}  // namespace sgs::occupancy
