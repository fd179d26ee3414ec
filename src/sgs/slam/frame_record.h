// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/geometry/se3.h"
#include "sgs/tracker/track_result.h"

namespace sgs::slam {

/// What happened to one input frame: one line of frames.csv.
struct FrameRecord {
  std::int64_t index = 0;
  double timestamp_s = 0;
  bool bad = false;  ///< the frame could not be read; everything below is empty
  std::string bad_reason;
  /// The tracker's pose as it was said when the frame came; not in frames.csv. As it is known now:
  /// Session::revision().
  SE3 T_online_camera;
  tracker::TrackingStatus status = tracker::TrackingStatus::kLost;
  alignment::LostReason lost_reason = alignment::LostReason::kNone;
  bool tracking_keyframe = false;
  bool mapping_keyframe = false;
  bool heldout = false;
  tracker::Diagnostics diagnostics;
  double track_ms = 0;
  std::int64_t gaussians = 0;
  std::int64_t iterations = 0;
  int loops = 0;                 ///< closed so far
  int calibrations = 0;          ///< of depth, learned so far
  double correction_m = 0;       ///< by how much the past was moved just before this frame
  std::int64_t fingerprint = 0;  ///< of the frame (camera/fingerprint.h); 0 = not known
  /// Where something moved by itself (mover_blocks() of camera/movers.h), not in frames.csv; empty:
  /// nowhere.
  std::string movers;
  /// Exposure over the map's colour per channel, as `sgs refine` learned it; NaN = not known. Of a
  /// held-out frame: as the frames around it in time tell.
  std::array<double, 3> gain = {kUnknownGain, kUnknownGain, kUnknownGain};
  static constexpr double kUnknownGain = std::numeric_limits<double>::quiet_NaN();
};

/// A per-frame value: its key in frames.csv and in the viewer's messages, its unit ("" = none) and
/// what it means. Six values stand under `key`_0 to `key`_5.
struct FrameColumn {
  std::string_view key, unit, meaning;
  std::string_view format = "{:.6g}";  ///< of a real number in the file
};

/// The status column: the tracker's, or "bad". `Record` is FrameRecord or const FrameRecord.
template <class Record>
struct StatusCell {
  Record& record;
};

/// The columns of frames.csv, declared once: calls `visit(FrameColumn, field)` for each in the
/// order of the file. Writing, reading, the viewer's messages, the report and docs/formats.md
/// follow from this list. Fields are numbers, bools, named enums, std::array<double, 6> (not
/// measured: NaN), std::optional<Matrix6d> or a StatusCell. New columns go to the end.
template <class Record, class Visitor>
void visit_columns(Record& r, Visitor&& visit) {
  using C = FrameColumn;
  auto& d = r.diagnostics;
  visit(C{"index", "", "Position in the input, counted from 0, bad frames included."}, r.index);
  visit(C{"timestamp_s", "s", "Time stamp of the colour image.", "{:.9f}"}, r.timestamp_s);
  visit(C{"status", "",
          "`ok`; `degenerate`: tracked, but geometry did not observe every direction; `lost`; "
          "`bad`: the frame could not be read, the rest of its line is missing."},
        StatusCell<Record>{r});
  visit(C{"tracking_keyframe", "", "1: the tracker extended its own target map with this frame."},
        r.tracking_keyframe);
  visit(C{"mapping_keyframe", "", "1: the frame became a keyframe of the mapper."},
        r.mapping_keyframe);
  visit(C{"heldout", "", "1: the mapper never sees this frame; it is kept for evaluation."},
        r.heldout);
  visit(C{"track_ms", "ms", "CPU time of tracking, reading excluded."}, r.track_ms);
  visit(C{"gaussians", "", "Gaussians in the map that this frame was tracked against."},
        r.gaussians);
  visit(C{"mapping_iterations", "", "Mapping steps done when that map was made."}, r.iterations);
  visit(C{"source_points", "", "Points sampled from the frame."}, d.source_points);
  visit(C{"inliers", "", "Points matched to the map at the final pose."}, d.inliers);
  visit(C{"visual_inliers", "", "Pixels or features that vision used."}, d.visual_inliers);
  visit(C{"overlap", "", "Share of the sampled points that the map explains."}, d.overlap);
  visit(C{"cost", "", "Cost of the registration at the final pose."}, d.cost);
  visit(C{"visual_cost", "", "Mean photometric cost per pixel; 1: as its noise model expects."},
        d.visual_cost);
  visit(C{"readout_s", "s", "Readout time of the rolling shutter, as learned so far."},
        d.readout_s);
  visit(C{"tracking_iterations", "", "Gauss-Newton steps over all levels."}, d.iterations);
  visit(
      C{"condition_number", "", "Largest over smallest eigenvalue of the registration's Hessian."},
      d.condition_number);
  visit(C{"planarity", "", "Planarity of the observed normals: 0 none, 1 one plane."}, d.planarity);
  visit(C{"prior_source", "", "What knew about the pose beside the registration of depth."},
        d.prior_source);
  visit(C{"prior_active", "", "1: it filled directions that geometry did not observe."},
        d.prior_active);
  visit(C{"degenerate_mask", "", "Bit k is set where weight_k exceeds 0.5."}, d.degenerate_mask);
  visit(C{"eigenvalue", "", "Eigenvalues of the registration's Hessian, rising."}, d.eigenvalues);
  visit(C{"snr", "", "Information about each principal axis over what noise alone would show."},
        d.snr);
  visit(C{"weight", "", "Weight of vision along each axis: 0 seen by geometry, 1 unseen."},
        d.weights);
  visit(C{"ms_points", "ms", "CPU time of sampling points."}, d.ms_points);
  visit(C{"ms_index", "ms", "CPU time of the index of targets."}, d.ms_index);
  visit(C{"ms_geometry", "ms", "CPU time of the geometric term."}, d.ms_geometry);
  visit(C{"ms_visual", "ms", "CPU time of the visual term."}, d.ms_visual);
  visit(C{"ms_update", "ms", "CPU time of extending targets and visual keyframes."}, d.ms_update);
  visit(C{"axis", "",
          "Entry m of principal axis k under axis_k_m: unit twists of the camera, rotation first.",
          "{:.4g}"},
        d.axes);
  visit(C{"lost_reason", "", "Why a lost frame has no pose that can be trusted; else `none`."},
        r.lost_reason);
  visit(C{"targets", "", "Points of the map among which the registration searched."}, d.targets);
  visit(C{"loops", "", "Loops closed so far."}, r.loops);
  visit(C{"correction_m", "m", "By how much the past was moved just before this frame."},
        r.correction_m);
  visit(C{"calibrations", "", "Calibrations of depth learned so far."}, r.calibrations);
  visit(
      C{"fingerprint", "",
        "A number from the frame's pixels: `sgs refine` sees by it whether the recording is still "
        "the same. 0: not known."},
      r.fingerprint);
  visit(C{"gain_red", "",
          "Exposure of the frame over the map's colour, red, as `sgs refine` learned it; of a "
          "held-out frame as the frames around it tell."},
        r.gain[0]);
  visit(C{"gain_green", "", "The same, green."}, r.gain[1]);
  visit(C{"gain_blue", "", "The same, blue."}, r.gain[2]);
  visit(C{"depth_delay_s", "s",
          "By how much later than its stamp says depth is measured, as learned so far."},
        d.depth_delay_s);
  visit(C{"movers", "",
          "Share of the sampled points that move by themselves, or stand in space that was seen to "
          "be free. They do not count in overlap."},
        d.movers);
}

/// The first line of frames.csv, with its line feed.
std::string frames_csv_header();
/// One line of frames.csv with its line feed; empty cells where nothing was measured.
std::string frames_csv_line(const FrameRecord& record);
/// frames.csv: the header and a line per record.
std::string frames_csv(std::span<const FrameRecord> records);
/// Reads frames.csv back. Missing columns (of older files) stay at their defaults, unknown ones are
/// ignored; cells that do not fit, indices that do not rise or are beyond any recording are errors
/// that name line and column. `source` stands for the file's name in messages.
Result<std::vector<FrameRecord>> frames_from_csv(std::string_view text, std::string_view source);

/// The columns as a Markdown table, for docs/formats.md.
std::string frame_columns_markdown();

}  // namespace sgs::slam
