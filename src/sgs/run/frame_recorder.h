// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "sgs/camera/rgbd_frame.h"
#include "sgs/core/error.h"
#include "sgs/dataset/tum_writer.h"
#include "sgs/run/disk_watch.h"

namespace sgs::run {

/// How a recording fares.
struct RecordingStatus {
  bool on = false;
  std::filesystem::path folder;        ///< of the newest recording; empty: there was none
  std::int64_t frames = 0;             ///< in it
  std::int64_t lost = 0;               ///< that came faster than they could be written
  std::optional<double> seconds_left;  ///< until the disk is full, where it fills
  std::string trouble;                 ///< what is wrong, or why it ended; empty: nothing

  bool operator==(const RecordingStatus&) const = default;
};

/// Keeps frames in a folder (TUM layout, exact times, lossless), on a thread of its own. A disk
/// that fills is told of in time; before it is full the recording ends, and what there is is whole.
/// All functions are thread-safe.
class FrameRecorder {
 public:
  struct Options {
    PinholeCamera camera;
    dataset::TumSequenceWriter::Options writer;
    /// Frames that wait to be written; beyond, offer() waits or the newest is left out.
    std::size_t queue = 60;
    bool wait = true;
    /// Bytes that this user can still write beside a folder; empty: as the system says.
    std::function<std::uintmax_t(const std::filesystem::path&)> free_bytes = {};
    std::uintmax_t reserve_bytes = std::uintmax_t{512} << 20;  ///< of the disk stay free
  };
  explicit FrameRecorder(Options options);
  /// Writes what waits.
  ~FrameRecorder();
  FrameRecorder(const FrameRecorder&) = delete;
  FrameRecorder& operator=(const FrameRecorder&) = delete;

  /// Begins a recording in `folder`, which must be new or empty. While there is one, nothing
  /// happens. Fails where the folder cannot be made or the disk is full.
  Status start(const std::filesystem::path& folder);
  /// Ends it once what waits is written; then start() may begin another one.
  void stop();
  /// Keeps a frame, while there is a recording. May wait (Options::wait).
  void offer(const std::shared_ptr<const RgbdFrame>& frame);
  RecordingStatus status() const;
  /// What ended a recording, other than stop(); ok where nothing did.
  Status failure() const;

 private:
  void loop();
  void write(const RgbdFrame& frame);
  bool look_at_disk();
  void end_with(Error error);

  Options options_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::shared_ptr<const RgbdFrame>> waiting_;
  std::optional<dataset::TumSequenceWriter> writer_;  // of the thread while it writes
  RecordingStatus status_;
  Status failure_;
  bool writing_ = false, quit_ = false;
  DiskWatch disk_;           // of the thread
  double looked_at_s_ = -1;  // likewise
  std::thread thread_;
};

}  // namespace sgs::run
