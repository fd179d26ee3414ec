// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "sgs/camera/depth_calibration.h"
#include "sgs/core/config.h"
#include "sgs/core/error.h"
#include "sgs/dataset/frame_source.h"
#include "sgs/dataset/open.h"
#include "sgs/synthetic/source.h"

namespace sgs::run {

/// Where frames come from, as the command line says it and as a run folder remembers it. All text,
/// so that it can live in config.toml beside the parameters.
struct InputSpec {
  std::string input;   ///< a folder, file or bag with a recording, synth:NAME[:LEVEL], or live:...
  std::string frames;  ///< "a:b", half open, either side may be missing; empty = all
  std::string camera;  ///< fx,fy,cx,cy[,k1,k2,p1,p2,k3[,k4,k5,k6]] or empty
  double depth_scale = 0;                        ///< raw units per metre; 0 = as the folder says
  int max_width = dataset::kDefaultMaxWidth_px;  ///< wider images are reduced; 0 = never
  /// File of `sgs calibrate` that corrects the depths, or empty; run_whole() knows "auto", too.
  std::string calibration;
  std::string topics;  ///< bags: color=/a,depth=/b[,color_info=/c][,depth_info=/d]; empty = guessed
  std::string extrinsics;         ///< bags: tx,ty,tz,qx,qy,qz,qw of T_color_depth, or "aligned"
  std::string truth_topic;        ///< bags: a topic of poses, or world:camera of tf
  std::string stamps = "camera";  ///< bags: whose times the images have, or "received"
  std::string more_files;         ///< bags: further files of the same recording, one a line
  std::string poses;         ///< given ones: "recorded", a TUM file, COLMAP's images.txt; or empty
  std::string map;           ///< of an earlier run, for the camera to be found in; or empty
  bool extends_map = false;  ///< the run goes on with `map`; else nothing of it changes
  std::string trajectory;    ///< synth only: TUM file with the camera's motion
  std::uint64_t synth_seed = 1;
  double wait_s = 30;  ///< live only: how long a sender may be missing or silent; 0 = for ever

  void declare(ParameterList& list);
};

/// An open input and what is known about it.
struct Input {
  std::unique_ptr<dataset::FrameSource> source;
  dataset::SequenceInfo info;
  std::optional<DepthCalibration> calibration;  ///< that the source applies
};

/// What the generator is asked for where `spec` names a synthetic sequence: its scene follows.
Result<synthetic::SynthOptions> synth_options(const InputSpec& spec, int threads);

/// Opens a recorded folder, a synthetic sequence or a stream; `threads` render synthetic frames. A
/// stream is waited for, until a stop is requested.
Result<Input> open_input(const InputSpec& spec, int threads, const std::stop_token& stop = {});

/// Opens the recording of a run once more, for its pictures: poses that were given are not needed.
/// A stream is gone. `learned` is what the run found out about its depth camera on the way
/// (Run::calibration): it is applied unless `spec` names a calibration itself.
Result<Input> reopen_input(InputSpec spec, int threads,
                           const std::optional<DepthCalibration>& learned = std::nullopt);

/// InputSpec::more_files as paths.
std::vector<std::filesystem::path> more_files_of(const InputSpec& spec);

/// Parses "a:b" into [first, last); "" is everything.
struct FrameRange {
  std::int64_t first = 0;
  std::int64_t last = std::numeric_limits<std::int64_t>::max();
};
Result<FrameRange> parse_frame_range(const std::string& text);

}  // namespace sgs::run
