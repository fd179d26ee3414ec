// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "sgs/io/ply.h"
#include "sgs/map/gaussian.h"
#include "sgs/runfolder/run.h"

namespace sgs::run {

/// Centres of the Gaussians that are more solid than not, as coloured points.
std::vector<io::ColoredPoint> to_points(std::span<const map::Gaussian> gaussians);

/// What was seen from a keyframe.
struct KeyframeView {
  std::int64_t index = 0;  ///< of the frame in the input; of the keyframe where that is gone
  SE3 T_world_camera;      ///< as refined
  ColorImage color;
  DepthImage depth;  ///< metres
};
/// What depth, and without a recording what colour, a keyframe's view has.
enum class ViewSource {
  kMeasured,  ///< the recording's; fails where it is gone
  kMap,       ///< depth from the map, colour from the recording; without one, from the map too
};
/// Hands over the view of each keyframe of a run folder with its camera, in order of time. `map` is
/// what kMap renders.
Status for_each_keyframe(
    const std::filesystem::path& folder, const map::SplatMap& map, ViewSource source, int threads,
    const std::function<Status(const PinholeCamera&, const KeyframeView&)>& visit);

/// COLMAP text model and keyframe pictures: FOLDER/images and FOLDER/sparse/0, the layout that
/// trainers of Gaussian splatting read. Where the recording is gone the pictures are renderings.
/// The model is written in the world `T_out_world` leads to; `map` is in that of the run.
Status export_colmap(const std::filesystem::path& run_folder, const map::SplatMap& map,
                     const SE3& T_out_world, const std::filesystem::path& folder);

}  // namespace sgs::run
