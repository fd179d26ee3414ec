// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "play.h"

#include <algorithm>

#include "interrupt.h"
#include "progress.h"
#include "sgs/core/log.h"
#include "sgs/core/stopwatch.h"
#include "sgs/slam/live_feed.h"

namespace sgs::app {
namespace {

std::string detail_text(const slam::FrameRecord& record) {
  return fmt::format("{:<10} {} Gaussians", tracker::to_string(record.status), record.gaussians);
}

/// Feeds one item; the recorder's failure is returned, a bad frame only noted.
Status feed_item(const slam::FeedItem& item, slam::Session& session, const PlayOptions& options,
                 Progress& progress) {
  if (!item.frame) {
    log().warn("frame {} skipped: {}", item.index, item.bad_reason);
    session.feed_bad(item.index, item.timestamp_s, item.bad_reason);
    progress.step("bad frame");
    return {};
  }
  const auto& record = session.feed(item.frame);
  progress.step(detail_text(record));
  if (options.spectator != nullptr) options.spectator->after_frame(session, item, record);
  return options.recorder ? options.recorder->add(*item.frame) : Status{};
}

}  // namespace

Result<RunClock> play(Input& input, slam::Session& session, const PlayOptions& options) {
  constexpr std::size_t kLiveQueue = 6;  // frames: a fifth of a second
  RunClock clock;
  Progress progress("frames", input.source->size(), options.quiet);
  std::unique_ptr<slam::LiveFeed> live;
  Status status;
  double start_s = -1, held_s = 0;
  if (options.realtime) live = std::make_unique<slam::LiveFeed>(*input.source, kLiveQueue);
  while (!interrupted() && status) {
    const double hold_s = options.spectator != nullptr ? options.spectator->before_frame() : 0;
    if (start_s >= 0) held_s += hold_s;
    const double waiting_since_s = wall_time_s();
    const double busy_before_s = session.mapper_busy_s();
    const auto item = live ? live->next() : slam::read_item(*input.source);
    const double waited_s = wall_time_s() - waiting_since_s;
    if (!item) break;
    ++clock.frames_in;
    if (start_s < 0) {
      start_s = wall_time_s();
    } else {
      // Waiting counts as decoding only while the mapper had nothing to do either.
      clock.starved_s += std::max(0.0, waited_s - (session.mapper_busy_s() - busy_before_s));
    }
    status = feed_item(*item, session, options, progress);
  }
  if (live) {
    live->stop();
    clock.frames_dropped = static_cast<std::int64_t>(live->dropped());
    clock.frames_in += clock.frames_dropped;
    live.reset();
  }
  session.finish();
  if (start_s >= 0) clock.wall_s = wall_time_s() - start_s - held_s;
  progress.finish();
  if (!status) return tl::unexpected(status.error());
  return clock;
}

}  // namespace sgs::app
