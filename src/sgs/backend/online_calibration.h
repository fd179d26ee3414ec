// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "sgs/backend/calibrate_depth.h"
#include "sgs/backend/keyframe_archive.h"
#include "sgs/history/revision.h"

namespace sgs::backend {

/// A calibration that was learned, and how the past changes with it.
struct LearnedCalibration {
  DepthEstimate estimate;
  history::Update update;
};

/// Whether a calibration lies where an earlier one, made from a part of the same keyframes, expects
/// it to: within three of the standard deviations that the earlier one gave itself.
bool confirms(const DepthCalibration& later, const DepthCalibration& earlier);

/// Calibrates the depth camera while a recording goes on (docs/calibration.md): whenever there are
/// half as many keyframes again, all are adjusted together, from their raw depth, until the mean is
/// sure, until there are half of config.calibration.keyframes and something was learned, or until
/// there are all of them. Only what two attempts in a row say alike is believed: a recording that
/// the model does not describe (two cameras with a wrong registration, say) is told something else
/// by each stretch of it. Where no attempt was sure of itself, the whole recording is asked once
/// more at its end (sure_calibration.h). What changes nothing that matters is not told. A pure
/// function of what it is given, in order: deterministic, one thread.
///
/// What add() returns changes the path that it was given. The caller makes a revision of it when
/// it suits; until one comes there is no other.
class OnlineCalibration {
 public:
  explicit OnlineCalibration(const BackendConfig& config);

  /// Takes in the next frame that was tracked, its depth as measured; `revision` has its pose, and
  /// those before it. `readout_s`: readout time of the rolling shutter as known now;
  /// `tracked_delay_s`: by how much later than stamped the tracker takes depth for measured, where
  /// it learns that.
  std::optional<LearnedCalibration> add(const std::shared_ptr<const RgbdFrame>& raw,
                                        const history::Revision& revision, double readout_s,
                                        std::optional<double> tracked_delay_s = {});
  /// A frame was lost.
  void note_gap();
  /// A last attempt when no more frames come, if there are a few new keyframes.
  std::optional<LearnedCalibration> finish(const history::Revision& revision);

  /// How often a calibration was learned.
  int versions() const { return versions_; }

 private:
  /// How many are adjusted together at most.
  int enough_keyframes() const;
  std::optional<DepthEstimate> attempt(const history::Path& path);
  bool is_contradiction(const DepthEstimate& estimate, double scale);
  std::optional<DepthEstimate> by_witnesses(const history::Path& path) const;
  std::optional<LearnedCalibration> learn(std::optional<DepthEstimate> estimate,
                                          const history::Revision& revision);

  CalibrationConfig config_;
  KeyframeArchive archive_;
  double readout_s_ = 0;
  std::optional<double> tracked_delay_s_;
  std::size_t next_;                   // keyframes that make the next attempt
  std::optional<DepthEstimate> last_;  // of the last attempt
  bool done_ = false, contradicted_ = false;
  bool asks_witnesses_ = false;  // there will be no other attempt before the end
  double scale_ = 1;             // of the path, by all corrections together
  int versions_ = 0;
};

}  // namespace sgs::backend
