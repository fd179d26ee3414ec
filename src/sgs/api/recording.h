// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sgs/api/export.h"
#include "sgs/api/types.h"

namespace sgs::api {

namespace internal {
struct RecordingAccess;
struct FrameAccess;
}  // namespace internal

/// One frame as a recording delivers it: rectified, colour and depth of the same camera. Immutable;
/// copies share the images.
class SGS_API Frame {
 public:
  Frame(const Frame&);
  Frame& operator=(const Frame&);
  ~Frame();

  std::int64_t index() const;  ///< position in the recording, bad frames counted
  double timestamp_s() const;
  Camera camera() const;
  int width() const;
  int height() const;
  /// height x width x 3 bytes, red first, rows without gaps. Valid as long as any copy lives.
  const std::uint8_t* color() const;
  /// height x width, metres along the optical axis, 0 = no measurement, rows without gaps.
  const float* depth() const;
  /// Ground truth where the recording knows it.
  std::optional<Pose> truth() const;

 private:
  friend struct internal::FrameAccess;
  struct Impl;
  explicit Frame(std::shared_ptr<const Impl> impl);
  std::shared_ptr<const Impl> impl_;
};

/// A frame that could not be read.
struct BadFrame {
  std::int64_t index = 0;
  double timestamp_s = 0;
  std::string reason;
};

/// A recording that is open: a folder, a bag, a file or a rendered sequence, whatever `sgs run`
/// reads (docs/datasets.md). Frames come in order of time. For one thread at a time: a second one
/// is refused with kBusy; stop() may come from any.
class SGS_API Recording {
 public:
  /// Opens `input`: a path, or "synth:NAME[:LEVEL]". `options` are the keys of docs/parameters.md
  /// below `input`, without that prefix: frames, camera, depth_scale, max_width, topics, ... Throws
  /// what `sgs info` would say: kNotFound, kInvalidFormat, kUnknownKey, ...
  static Recording open(const std::string& input, const Settings& options = {});
  Recording(Recording&&) noexcept;
  Recording& operator=(Recording&&) noexcept;
  ~Recording();

  /// The next frame that can be read; empty at the end. Frames that cannot be are noted in
  /// bad_frames().
  std::optional<Frame> next();
  /// Makes a next() that waits, and all later ones, return empty soon.
  void stop();
  /// Frames that could not be read so far.
  std::vector<BadFrame> bad_frames() const;

  std::string name() const;
  /// "tum", "scannet", ..., or what kind of bag.
  std::string layout() const;
  /// Where the calibration came from.
  std::string calibration_source() const;
  /// Of the frames as delivered.
  Camera camera() const;
  /// Frames in all, bad ones included; empty where that is not known before the end.
  std::optional<std::int64_t> size() const;
  /// In a time base and a world of its own; empty where there is none.
  Trajectory ground_truth() const;
  /// What had to be put right to open it.
  std::vector<std::string> warnings() const;

 private:
  friend struct internal::RecordingAccess;
  struct Impl;
  explicit Recording(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace sgs::api
