// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sgs/camera/depth_calibration.h"
#include "sgs/core/config.h"
#include "sgs/core/error.h"
#include "sgs/dataset/frame_source.h"
#include "sgs/dataset/open.h"

namespace sgs::run {

/// Where frames come from, as the command line says it and as a run folder remembers it. All text,
/// so that it can live in config.toml beside the parameters.
struct InputSpec {
  std::string input;       ///< a folder, file or bag with a recording, or synth:NAME[:LEVEL]
  std::string frames;      ///< "a:b", half open, either side may be missing; empty = all
  std::string camera;      ///< fx,fy,cx,cy[,k1,k2,p1,p2,k3[,k4,k5,k6]] or empty
  double depth_scale = 0;  ///< raw units per metre; 0 = as the folder says
  int max_width = dataset::kDefaultMaxWidth_px;  ///< wider images are reduced; 0 = never
  std::string calibration;  ///< file of `sgs calibrate` that corrects the depths, or empty
  std::string topics;  ///< bags: color=/a,depth=/b[,color_info=/c][,depth_info=/d]; empty = guessed
  std::string extrinsics;   ///< bags: tx,ty,tz,qx,qy,qz,qw of T_color_depth, or "aligned"
  std::string truth_topic;  ///< bags: a topic of poses, or world:camera of tf
  std::string trajectory;   ///< synth only: TUM file with the camera's motion
  std::uint64_t synth_seed = 1;

  void declare(ParameterList& list);
};

/// An open input and what is known about it.
struct Input {
  std::unique_ptr<dataset::FrameSource> source;
  dataset::SequenceInfo info;
  std::optional<DepthCalibration> calibration;  ///< that the source applies
};

/// Opens a recorded folder or a synthetic sequence; `threads` render synthetic frames.
Result<Input> open_input(const InputSpec& spec, int threads);

/// Parses "a:b" into [first, last); "" is everything.
struct FrameRange {
  std::int64_t first = 0;
  std::int64_t last = std::numeric_limits<std::int64_t>::max();
};
Result<FrameRange> parse_frame_range(const std::string& text);

}  // namespace sgs::run
