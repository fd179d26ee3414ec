// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "sgs/alignment/known_view.h"
#include "sgs/core/image.h"
#include "sgs/core/thread_pool.h"

namespace sgs::slam {

/// Views of a finished map from where no camera took one: back along a corridor, from the other
/// side of a table. Places that cameras have been to or seen through are asked all around, and
/// where the map's views together show enough, what they show is drawn as from there.
///
/// Drawn from the pixels of views with depth, not from Gaussians: those have only learned to look
/// right from where they were seen (docs/decisions/0086-views-nobody-took.md).
class DrawnViews {
 public:
  /// Of a map of so many views, at most `most` for a camera that comes.
  DrawnViews(const PinholeCamera& camera, std::size_t views, std::size_t most);

  /// Takes in the next view of the map, before draw(): who is near it is found without a drawing.
  void know(const alignment::KnownView& view);

  /// Draws the views, those first that show most. Pictures (grey) and depths are of
  /// the camera that comes; where nothing is shown nothing is seen. Their ferns answer the
  /// questions of the last view; their times are not numbers. They are drawn in `pool` and visited
  /// here, in order; they are the same for any number of threads.
  void draw(ThreadPool& pool, const std::function<void(const alignment::KnownView&)>& visit) const;

 private:
  struct Taken {
    SE3 T_world_camera;
    double mean_depth_m;
  };
  /// A pixel of a source, as a patch of surface; world.
  struct Patch {
    Eigen::Vector3f point, normal;
    float seen_from_m;  // depth in the source
    std::uint32_t source;
  };
  /// Where a surface faces, in 1/127; zero: there is none.
  using Facing = Eigen::Matrix<std::int8_t, 3, 1>;
  /// A view that others are drawn from, in grey; without depth where nothing was seen.
  struct Source {
    SE3 T_world_camera;
    PinholeCamera camera;
    Image<std::uint8_t> gray;
    DepthImage depth;
    Image<Facing> facing;  // towards the camera
  };
  struct Candidate {
    SE3 T_world_camera;
    double shown = 0;                    // share of the picture
    std::vector<std::uint32_t> sources;  // that show it, the best first
  };
  static Source source_of(const alignment::KnownView& view);
  std::vector<Eigen::Vector3d> places() const;
  std::vector<Eigen::Matrix3d> ways_to_look() const;
  bool is_taken(const SE3& T_world_camera) const;
  Eigen::Vector3d up() const;
  Candidate glance(const SE3& T_world_camera) const;
  alignment::KnownView compose(const Candidate& candidate) const;

  PinholeCamera camera_;
  std::size_t most_;
  std::size_t every_;  // so many views one is a source
  std::size_t known_ = 0;
  std::uint64_t fern_seed_ = 0;
  std::vector<Taken> taken_;
  std::vector<Source> sources_;
  std::vector<Patch> patches_;                 // a few hundred of each source
  std::vector<Eigen::Vector3d> seen_through_;  // world
};

}  // namespace sgs::slam
