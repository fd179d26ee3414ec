// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/loops/pair_aligner.h"

namespace sgs::loops {
namespace {

// A reference's points are its own, whatever the tracker registers to.
tracker::SpectralConfig with_own_targets(tracker::SpectralConfig config) {
  config.geometry.target.source = tracker::TargetSource::kGrid;
  return config;
}

// How the camera turned during a readout was found when the frame was tracked, and is not asked
// again.
tracker::ReadoutModel known_readout(const Vector6d& readout) {
  constexpr double kCertain = 1e12;  // 1/rad^2
  const tracker::ReadoutEstimator::Belief belief{readout, kCertain * Eigen::Matrix3d::Identity()};
  return {[belief](const SE3&) { return belief; },
          [readout](const Vector6d&) -> Vector6d { return readout; }};
}

}  // namespace

PairAligner::PairAligner(const tracker::SpectralConfig& config, const RgbdFrame& reference,
                         const Vector6d& readout)
    : aligner_(with_own_targets(config), reference.camera, SE3{}) {
  aligner_.look_at(reference, nullptr);
  tracker::Alignment here;
  here.points_readout = readout;
  aligner_.extend(here, readout);
}

std::optional<PairAlignment> PairAligner::align(const RgbdFrame& frame, const Vector6d& readout,
                                                const SE3& T_start) {
  if (!aligner_.has_map()) return std::nullopt;
  aligner_.look_at(frame, nullptr);
  const tracker::Alignment a = aligner_.align(T_start, known_readout(readout));
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
