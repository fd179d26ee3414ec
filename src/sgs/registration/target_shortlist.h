// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "sgs/geometry/se3.h"
#include "sgs/registration/cell_match.h"
#include "sgs/registration/cover_image.h"
#include "sgs/registration/target_blocks.h"

namespace sgs::registration {

/// Points and normals, structure of arrays, that grow at the end.
class GrowingArrays {
 public:
  std::size_t size() const { return arrays_[0].size(); }
  void resize(std::size_t count);
  void push_back(const Eigen::Vector3f& point, const Eigen::Vector3f& normal);
  /// Appends element `i` of `from`.
  void push_back(const GrowingArrays& from, std::size_t i);
  /// Makes it the elements `indices` of `from`.
  void assign(const GrowingArrays& from, std::span<const int> indices);
  PointArrays part(std::size_t begin, std::size_t count) const;
  /// Makes element `i` one that faces nobody.
  void clear_normal(std::size_t i);

 private:
  std::vector<float> arrays_[6];  // point, normal
};

/// Those of a map's targets that can be seen from about here: in view or close to it, facing the
/// camera, and not far behind what covers them. In a long session most targets in the field of view
/// lie behind walls. They are looked through again only once the camera has moved a little, and of
/// them only the blocks in view that the last ones do not cover, so that the cost of a frame hardly
/// depends on the size of the map.
class TargetShortlist {
 public:
  /// `camera` looks onto width x height cells, border included.
  TargetShortlist(const CellCamera& camera, int width, int height);

  /// Takes over what changed in `cloud` and lists anew if needed for a camera at `T_local_camera`.
  void update(const TargetCloud& cloud, const SE3& T_local_camera);

  const GrowingArrays& targets() const { return listed_; }
  /// Index in the cloud of each of targets(), rising.
  const std::vector<int>& indices() const { return indices_; }
  /// How often the targets have been looked through.
  int looks() const { return looks_; }

 private:
  bool follow(const TargetCloud& cloud);
  void look(const SE3& T_local_camera);
  void draw_cover(const Eigen::Matrix3f& R, const Eigen::Vector3f& t);
  void note_nearest(std::span<const int> cells, std::span<const float> depths);
  void spread_depths();
  void list_near(const std::vector<TargetBlocks::Range>& ranges);
  void list(std::size_t i);

  CellCamera camera_;  // onto the widened field of view
  int width_, height_;
  GrowingArrays all_;                     // removed ones have no normal and so face nobody
  std::uint64_t layout_ = 0, moves_ = 0;  // of the cloud they were taken from
  std::size_t removed_ = 0;               // how many of its removals were taken over
  TargetBlocks blocks_;
  ViewPyramid view_;
  CoverImage cover_;
  GrowingArrays listed_;
  std::vector<int> indices_;
  SE3 T_local_look_;
  int looks_ = 0;
  // Of a look: cell and depth of each target in view, and the depth of the nearest in each cell.
  std::vector<int> cells_;
  std::vector<float> depths_, nearest_, spread_;
};

}  // namespace sgs::registration
