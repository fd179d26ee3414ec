// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/play.h"

#include <algorithm>
#include <utility>

#include "sgs/core/log.h"
#include "sgs/core/stopwatch.h"
#include "sgs/dataset/source_failure.h"
#include "sgs/slam/live_feed.h"

namespace sgs::run {
namespace {

/// Gives the items of a source one by one, at once or at the sensor's rate.
class Feed {
 public:
  Feed(dataset::FrameSource& source, bool realtime) : source_(source) {
    constexpr std::size_t kLiveQueue = 6;  // frames: a fifth of a second
    if (realtime) live_.emplace(source, kLiveQueue);
  }
  std::optional<dataset::FeedItem> next() {
    return live_ ? live_->next() : dataset::read_item(source_);
  }
  /// Ends a next() that waits for the camera's time. From any thread, until stop().
  void wake() {
    if (live_) live_->stop();
  }
  std::size_t dropped() const { return live_ ? live_->dropped() : 0; }
  /// Ends the playback; returns how many frames were dropped.
  std::int64_t stop() {
    if (!live_) return 0;
    live_->stop();
    const auto dropped = static_cast<std::int64_t>(live_->dropped());
    live_.reset();
    return dropped;
  }

 private:
  dataset::FrameSource& source_;
  std::optional<slam::LiveFeed> live_;
};

/// Feeds one item; the recorder's failure is returned, a bad frame only noted.
Status feed_item(const dataset::FeedItem& item, slam::Session& session, RunObserver& observer,
                 dataset::TumSequenceWriter* recorder = nullptr) {
  if (!item.frame) {
    log().warn("frame {} skipped: {}", item.index, item.bad_reason);
    session.feed_bad(item.index, item.timestamp_s, item.bad_reason);
    observer.on_frame(session, item, session.records().back());
    return {};
  }
  const auto& record = session.feed(item.frame);
  observer.on_frame(session, item, record);
  return recorder != nullptr ? recorder->add(*item.frame) : Status{};
}

/// Tells the log, the time line and whoever watches what happens to the input.
class EventLog {
 public:
  EventLog(RunClock& clock, RunObserver& observer) : clock_(clock), observer_(observer) {}

  void note(const std::string& what) {
    log().warn("input: {}", what);
    clock_.events.push_back({wall_time_s(), what});
    observer_.on_input_event(what);
    open_ = true;
  }
  /// A frame has come; `dropped` so far because they came too fast.
  void frame_came(std::size_t dropped, bool live) {
    if (live && dropped > dropped_) {
      note(fmt::format("{} frames came too fast and were dropped, {} so far", dropped - dropped_,
                       dropped));
    } else if (std::exchange(open_, false)) {
      observer_.on_input_event("");
    }
    dropped_ = dropped;
  }

 private:
  RunClock& clock_;
  RunObserver& observer_;
  std::size_t dropped_ = 0;
  bool open_ = false;  // something was said that is over with the next frame
};

/// Calls `work` and makes an error of what it throws.
template <class Work>
Status guarded(Work&& work) {
  try {
    work();
  } catch (const dataset::SourceFailure& failure) {
    return tl::unexpected(failure.error());
  } catch (...) {
    return tl::unexpected(current_error());
  }
  return {};
}

/// Wall time of a run, from its first item on.
class Timer {
 public:
  explicit Timer(RunClock& clock) : clock_(clock) {}

  void held(double seconds) {
    if (start_s_ >= 0) held_s_ += seconds;
  }
  /// An item came after `waited_s`, of which the mapper was busy for `busy_s`: waiting counts as
  /// decoding only while the mapper had nothing to do either.
  void item_came(double waited_s, double busy_s) {
    ++clock_.frames_in;
    if (start_s_ < 0) {
      start_s_ = wall_time_s();
    } else {
      clock_.starved_s += std::max(0.0, waited_s - busy_s);
    }
  }
  void finished() {
    if (start_s_ >= 0) clock_.wall_s = wall_time_s() - start_s_ - held_s_;
  }

 private:
  RunClock& clock_;
  double start_s_ = -1, held_s_ = 0;
};

}  // namespace

Result<RunClock> play(dataset::FrameSource& source, slam::Session& session,
                      const PlayOptions& options, RunObserver& observer,
                      const std::stop_token& stop) {
  RunClock clock;
  Timer timer(clock);
  Feed feed(source, options.realtime);
  EventLog events(clock, observer);
  Status status;
  const auto play_all = [&] {
    // Neither a file system that does not answer nor a gap in a recording that is played at the
    // camera's rate may keep what is there from being saved.
    const std::stop_callback wake(stop, [&] {
      source.stop();
      feed.wake();
    });
    while (!stop.stop_requested() && status) {
      timer.held(observer.before_frame());
      const double waiting_since_s = wall_time_s();
      const double busy_before_s = session.mapper_busy_s();
      const auto item = feed.next();
      if (!item) break;
      if (item->event) {
        events.note(item->bad_reason);
        continue;
      }
      events.frame_came(feed.dropped(), source.live());
      timer.item_came(wall_time_s() - waiting_since_s, session.mapper_busy_s() - busy_before_s);
      status = feed_item(*item, session, observer, options.recorder);
    }
    if (status) observer.on_last_frame();
  };
  // Whatever ends the frames, what was made of them so far is to be kept.
  if (const Status thrown = guarded(play_all); !thrown) status = thrown;
  clock.frames_dropped = feed.stop();
  clock.frames_in += clock.frames_dropped;
  if (const Status thrown = guarded([&] { session.finish(); }); !thrown && status) status = thrown;
  timer.finished();
  if (!status) return tl::unexpected(status.error());
  return clock;
}

Status replay(dataset::FrameSource& source, slam::Session& session, RunObserver& observer,
              const std::stop_token& stop) {
  Status status;
  const auto replay_all = [&] {
    const std::stop_callback wake(stop, [&] { source.stop(); });
    while (status && session.left_to_replay() > 0 && !stop.stop_requested()) {
      observer.before_frame();
      const auto item = dataset::read_item(source);
      if (!item) break;
      status = feed_item(*item, session, observer);
      if (session.replay_differs_at()) break;
    }
  };
  if (const Status thrown = guarded(replay_all); !thrown) status = thrown;
  if (!status) return status;
  if (stop.stop_requested()) {
    return fail(ErrorCode::kInterrupted, "stopped before the run could go on",
                "nothing has changed: `sgs run --resume` again");
  }
  if (!session.replay_differs_at() && session.left_to_replay() == 0) return {};
  return fail(ErrorCode::kInvalidFormat,
              fmt::format("the run cannot be gone on with: item {} of its input is not what it was",
                          session.records().size()),
              "bring the recording back as it was, or run it again from the beginning");
}

}  // namespace sgs::run
