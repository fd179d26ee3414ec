// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sgs/api/export.h"
#include "sgs/api/types.h"

namespace sgs::api {

namespace internal {
struct MapAccess;
}

/// A picture of a map on a black background.
struct Rendering {
  int width = 0, height = 0;
  std::vector<float>
      color;  ///< height x width x 3, red first, in the image's values 0 .. 1, unclamped
  std::vector<float> depth;  ///< height x width, mean depth in metres where alpha > 0.5, else 0
  std::vector<float> alpha;  ///< height x width, opacity 0 .. 1
};

/// The Gaussians at one moment. Immutable, any thread may read; copies share the memory, and the
/// views stay valid as long as one of them lives, whatever became of the session.
class SGS_API Map {
 public:
  Map(const Map&);
  Map& operator=(const Map&);
  ~Map();
  /// A map from a file: a run folder, or a PLY file in the vertex layout of 3DGS.
  static Map load(const std::string& path);

  std::size_t size() const;
  ArrayView positions() const;       ///< size() x 3, world, metres
  ArrayView log_scales() const;      ///< size() x 3, logarithm of standard deviations in metres
  ArrayView rotations() const;       ///< size() x 4, w x y z, not necessarily of unit length
  ArrayView opacity_logits() const;  ///< size() x 1, before the sigmoid
  ArrayView colors() const;          ///< size() x 3, red first, 0 .. 1, unclamped
  /// Refined poses of the mapping keyframes so far; of a map from a file none.
  std::vector<Pose> keyframe_poses() const;
  /// Index of the frame of each of them.
  std::vector<std::int64_t> keyframe_frames() const;

  /// The map seen by `camera` (whose distortion is not applied) at a pose. The same bits for any
  /// number of threads. Throws kInvalidArgument where camera or pose cannot be.
  Rendering render(const Camera& camera, const Pose& T_world_camera, int threads = 2) const;
  /// Writes a file of the format that the name ends in: .spz (version 4), .glb (glTF with
  /// KHR_gaussian_splatting, y up as the first camera stood), .splat; anything else is a PLY file
  /// in the vertex layout of 3DGS.
  void save(const std::string& path) const;

 private:
  friend struct internal::MapAccess;
  struct Impl;
  explicit Map(std::shared_ptr<const Impl> impl);
  std::shared_ptr<const Impl> impl_;
};

}  // namespace sgs::api
