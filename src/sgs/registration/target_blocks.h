// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "sgs/geometry/se3.h"
#include "sgs/registration/clouds.h"
#include "sgs/registration/view_pyramid.h"

namespace sgs::registration {

/// Where the targets of a map lie, block by block: consecutive ones come from neighbouring pixels
/// of one keyframe, so that a sphere around each block is small. What a camera cannot see is left
/// out without a look at its points, and the cost of a view hardly grows with the map.
class TargetBlocks {
 public:
  static constexpr std::size_t kBlock = 64;  ///< targets

  /// Positions [begin, end) of the cloud's points.
  struct Range {
    std::size_t begin = 0, end = 0;
  };

  /// Takes over what was added to `cloud` or moved.
  void follow(const TargetCloud& cloud);
  /// Around the points of a block; a negative radius where there are none.
  struct Sphere {
    Eigen::Vector3f centre;
    float radius;
  };

  /// Ranges, rising and apart from each other, outside of which a camera at `T_local_camera` sees
  /// nothing in `view`; valid until the next call. Blocks that are `hidden` (camera coordinates)
  /// are left out, too.
  const std::vector<Range>& in_view(const ViewPyramid& view, const SE3& T_local_camera,
                                    const std::function<bool(const Sphere&)>& hidden = {});

 private:
  Sphere around(const TargetCloud& cloud, std::size_t begin, std::size_t end) const;

  std::vector<Sphere> spheres_;  // the last one may be of a block that is not full yet
  std::size_t points_ = 0;
  std::uint64_t layout_ = 0, moves_ = 0;  // of the cloud they were taken from
  std::vector<Range> in_view_;
};

}  // namespace sgs::registration
