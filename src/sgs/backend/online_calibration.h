// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "sgs/backend/calibrate_depth.h"
#include "sgs/backend/keyframe_archive.h"
#include "sgs/camera/past_correction.h"

namespace sgs::backend {

/// A calibration that was learned, and how the past changes with it.
struct LearnedCalibration {
  DepthEstimate estimate;
  PastCorrection correction;  ///< of poses, and of depth as it was corrected before
};

/// Whether a calibration lies where an earlier one, made from a part of the same keyframes, expects
/// it to: within three of the standard deviations that the earlier one gave itself.
bool confirms(const DepthCalibration& later, const DepthCalibration& earlier);

/// Calibrates the depth camera while a recording goes on (docs/calibration.md): whenever there are
/// half as many keyframes again, all are adjusted together, from their raw depth, until the mean is
/// sure, until there are half of config.calibration.keyframes and something was learned, or until
/// there are all of them. Only what two attempts in a row say alike is believed: a recording that
/// the model does not describe (two cameras with a wrong registration, say) is told something else
/// by each stretch of it. What changes nothing that matters is not told. A pure function of what it
/// is given, in order: deterministic, one thread.
///
/// A correction that add() returns is in the tracker's coordinates of that moment. The caller
/// applies it when it suits; until note_applied() says so there is no other.
class OnlineCalibration {
 public:
  explicit OnlineCalibration(const BackendConfig& config);

  /// Takes in the next frame, its depth as measured. `T_world_camera`: as tracked, empty where it
  /// was lost; `readout_s`: readout time of the rolling shutter as known now; `tracked_delay_s`: by
  /// how much later than stamped the tracker takes depth for measured, where it learns that.
  std::optional<LearnedCalibration> add(const std::shared_ptr<const RgbdFrame>& raw,
                                        const std::optional<SE3>& T_world_camera, double readout_s,
                                        std::optional<double> tracked_delay_s = {});
  /// A last attempt when no more frames come, if there are a few new keyframes.
  std::optional<LearnedCalibration> finish();
  /// Poses of frames that come from now on are corrected, by this or by whatever else there is.
  void note_applied(const PastCorrection& correction);

  /// How often a calibration was learned.
  int versions() const { return versions_; }

 private:
  /// How many are adjusted together at most.
  int enough_keyframes() const;
  std::optional<DepthEstimate> attempt();
  bool is_contradiction(const DepthEstimate& estimate, double scale);
  std::optional<LearnedCalibration> learn();

  CalibrationConfig config_;
  KeyframeArchive archive_;
  double readout_s_ = 0;
  std::optional<double> tracked_delay_s_;
  std::size_t next_;                   // keyframes that make the next attempt
  std::optional<DepthEstimate> last_;  // of the last attempt
  DepthCalibration current_;
  bool in_flight_ = false, done_ = false, contradicted_ = false;
  double scale_ = 1;  // of the path, by all corrections together
  int versions_ = 0;
};

}  // namespace sgs::backend
