// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sgs/api/config.h"
#include "sgs/api/export.h"
#include "sgs/api/frame_result.h"
#include "sgs/api/map.h"
#include "sgs/api/recording.h"
#include "sgs/api/types.h"

namespace sgs::api {

/// Order of the bytes of a pixel.
enum class ColorFormat { kRgb, kBgr, kRgba, kBgra };

/// A colour image of the caller's; read during the call only.
struct ColorView {
  const std::uint8_t* data = nullptr;
  int width = 0, height = 0;
  std::ptrdiff_t stride = 0;  ///< bytes from one row to the next; 0 = no gaps
  ColorFormat format = ColorFormat::kRgb;
};

enum class DepthFormat {
  kUint16,   ///< raw units in the machine's byte order; 0 and 65535 = no measurement
  kFloat32,  ///< 0, negative, NaN and infinite = no measurement
};

/// A depth image of the caller's, registered to the colour image; read during the call only.
struct DepthView {
  const void* data = nullptr;
  int width = 0, height = 0;
  std::ptrdiff_t stride = 0;  ///< bytes from one row to the next; 0 = no gaps
  DepthFormat format = DepthFormat::kUint16;
  double scale = 0;  ///< units per metre: 1000 for millimetres, 5000 for TUM; of floats mostly 1
};

/// How a session uses time and threads; never changes an offline result.
struct SessionOptions {
  int threads = 2;    ///< 1 .. 256; 1: everything in feed(), else the mapper has threads of its own
  bool live = false;  ///< map as long as there is time instead of a fixed budget per frame
  Pose T_world_first = kIdentityPose;  ///< pose given to the first frame
};

/// SLAM from frames to trajectory and map.
///
///     sgs::api::Session session({640, 480, 525, 525, 319.5, 239.5, {}});
///     while (camera.grab()) {
///       const auto r = session.feed({rgb, 640, 480},
///                                   {mm, 640, 480, 0, DepthFormat::kUint16, 1000}, seconds);
///     }
///     session.finish();
///     session.save("out");
///
/// feed() and finish() are for one thread at a time: a second one is refused with kBusy. What only
/// reads may be called from any thread, at any time; map() never waits, the others wait for a
/// feed() that is under way.
class SGS_API Session {
 public:
  /// Throws kInvalidArgument where camera, configuration or options cannot be.
  explicit Session(const Camera& camera, const Config& config = Config(),
                   const SessionOptions& options = SessionOptions());
  Session(Session&&) noexcept;
  Session& operator=(Session&&) noexcept;
  ~Session();

  /// Tracks one frame and hands it to the mapper; the images are copied, once. Throws
  /// kInvalidArgument where they are not of the camera's size, where rows overlap, where time does
  /// not rise or the session is finished, and kInvalidFormat where the first depths cannot be
  /// metres (median beyond 0.05 .. 20 m); the session is as it was then.
  FrameResult feed(const ColorView& color, const DepthView& depth, double timestamp_s);
  /// The same with a frame of a recording, which is not copied and keeps its index.
  FrameResult feed(const Frame& frame);
  /// Waits for the mapper to complete what was fed; nothing can be fed after it. Calling it again
  /// changes nothing.
  void finish();
  bool finished() const;

  /// Of the frames as they are tracked: without distortion.
  Camera camera() const;
  /// What became of each frame, with poses as loops have corrected them since.
  std::vector<FrameResult> frames() const;
  /// Poses of all frames, as loops and calibration have corrected them so far.
  Trajectory trajectory() const;
  /// Poses of all frames as they were said when the frames came.
  Trajectory online_trajectory() const;
  /// The newest map; empty before the first keyframe. After finish() the final one.
  std::optional<Map> map() const;

  /// Writes a run folder (docs/formats.md), which `sgs eval`, `sgs view` and `sgs export` read.
  /// `recording`, where given, is noted in it as what was fed, with its ground truth. Throws where
  /// the session is not finished, and what cannot be written.
  void save(const std::string& folder, const Recording* recording = nullptr) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sgs::api
