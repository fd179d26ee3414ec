// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/loops/pair_aligner.h"

#include "sgs/loops/drift.h"

namespace sgs::loops {
namespace {

// A reference's points are its own, whatever the tracker registers to; and points of one view share
// all its distortion, where a map's come from many: they count half as much.
alignment::AlignerConfig of_one_view(alignment::AlignerConfig config) {
  constexpr double kOneView = 0.5;
  config.geometry.target.source = alignment::TargetSource::kGrid;
  config.degeneracy.geometry_weight *= kOneView;
  config.geometry.movers.clusters = false;  // told from one frame to the next
  return config;
}

}  // namespace

std::optional<Matrix6d> information_of(const PairAlignment& alignment, double mean_depth_m,
                                       const LoopConfig& config) {
  if (alignment.overlap < config.min_overlap) return std::nullopt;
  const Matrix6d information =
      edge_information(alignment.information, mean_depth_m, config.min_information, config.drift);
  return information.isZero(0) ? std::nullopt : std::optional(information);
}

PairAligner::PairAligner(const alignment::AlignerConfig& config, const RgbdFrame& reference,
                         const registration::FrameMotion& motion)
    : aligner_(of_one_view(config), reference.camera, SE3{}) {
  aligner_.look_at(reference, {}, nullptr);
  alignment::Alignment here;
  here.points_motion = motion;
  aligner_.extend(here, motion.readout);
  reference_.path.append({reference.index, reference.timestamp_s, SE3{}});
}

std::optional<PairAlignment> PairAligner::align(const RgbdFrame& frame,
                                                const registration::FrameMotion& motion,
                                                const SE3& T_start) {
  if (!aligner_.has_map()) return std::nullopt;
  aligner_.look_at(frame, reference_, nullptr);
  const alignment::Alignment a = aligner_.align(T_start, alignment::known_readout(motion));
  if (!a.trusted()) return std::nullopt;
  PairAlignment out;
  out.T_reference_camera = a.T_local_camera.normalized();
  out.information = a.information();
  if (a.picture_holds()) {
    out.used = a.fit.newest_share();
    out.mean_cost = a.picture->mean_cost;
  }
  if (a.geometry) out.overlap = a.geometry->overlap;
  return out;
}

}  // namespace sgs::loops
