// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "sgs/viewer/frame_update.h"
#include "sgs/viewer/messages.h"

namespace sgs::viewer {

/// A picture ready to be sent.
struct Picture {
  Pane pane = Pane::kColor;
  std::uint64_t client = 0;  ///< kView only: who asked
  std::shared_ptr<const std::string> message;
};

/// Makes the panes' and the clients' pictures on a thread of its own: low priority, one core,
/// a few pictures a second and never more than half of the time at work. Nothing is made that
/// nobody asked for. Of frames and of each client's requests only the newest waits. Thread-safe.
class PictureService {
 public:
  /// `deliver` is called on the service's thread.
  using Deliver = std::function<void(Picture)>;
  PictureService(const PinholeCamera& camera, Deliver deliver);
  ~PictureService();
  PictureService(const PictureService&) = delete;
  PictureService& operator=(const PictureService&) = delete;

  /// The panes that somebody wants.
  void set_panes(PaneSet panes);
  /// A new frame or map; O(1).
  void offer(FrameUpdatePtr update);
  /// Replaces the client's waiting request.
  void request_view(std::uint64_t client, const ViewRequest& request);
  void forget(std::uint64_t client);

 private:
  struct Worker;
  void loop();
  /// Calls `make`; what it throws costs a picture, nothing else.
  void guarded(const std::function<void()>& make);

  bool failed_ = false;  // the service's thread only: one warning says it
  PinholeCamera camera_;
  Deliver deliver_;
  std::mutex mutex_;
  std::condition_variable changed_;
  // Guarded by mutex_:
  bool stop_ = false;
  PaneSet panes_ = 0, panes_done_ = 0;  // of update_
  FrameUpdatePtr update_;
  std::map<std::uint64_t, ViewRequest> views_;
  std::uint64_t last_client_ = 0;  // clients take turns

  std::thread thread_;
};

}  // namespace sgs::viewer
