// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/track_only.h"

#include "sgs/core/log.h"
#include "sgs/tracker/odometry.h"

namespace sgs::run {

Status track_only(dataset::FrameSource& source, const slam::SessionConfig& config,
                  const TrackedFrame& after_frame, const std::stop_token& stop) {
  SGS_ASSIGN_OR_RETURN(auto tracker, tracker::make_tracker(config.tracker, source.camera(), SE3{}));
  tracker::Odometry odometry(std::move(tracker));
  if (odometry.follows_map()) {
    return fail(ErrorCode::kInvalidArgument, "this tracker follows the map and needs one",
                "use --tracker spectral, gicp or orb");
  }
  const std::stop_callback wake(stop, [&] { source.stop(); });
  while (!stop.stop_requested()) {
    auto frame = std::make_shared<RgbdFrame>();
    Error error;
    const auto status = source.next(*frame, error);
    if (status == dataset::FrameRead::kEnd) break;
    if (status == dataset::FrameRead::kEvent) {
      log().warn("{}", error.text());
      continue;
    }
    if (status == dataset::FrameRead::kBadFrame) {
      log().warn("frame {} skipped: {}", frame->index, error.message);
      after_frame(nullptr, nullptr);
      continue;
    }
    const auto result = odometry.track(*frame, nullptr);
    after_frame(frame, &result);
  }
  if (stop.stop_requested()) return fail(ErrorCode::kInterrupted, "interrupted");
  return {};
}

}  // namespace sgs::run
