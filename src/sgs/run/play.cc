// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/play.h"

#include <algorithm>
#include <utility>

#include "sgs/core/log.h"
#include "sgs/core/stopwatch.h"
#include "sgs/dataset/source_failure.h"
#include "sgs/run/status_teller.h"
#include "sgs/slam/live_feed.h"

namespace sgs::run {
namespace {

/// Gives the items of a source one by one, at once or at the sensor's rate, and to the recorder.
class Feed {
 public:
  Feed(dataset::FrameSource& source, const PlayOptions& options)
      : source_(source), recorder_(options.recorder) {
    constexpr std::size_t kLiveQueue = 6;  // frames: a fifth of a second
    if (!options.realtime) return;
    live_.emplace(source, kLiveQueue, [this](const dataset::FeedItem& item) { record(item); });
  }
  std::optional<dataset::FeedItem> next() {
    if (live_) return live_->next();
    auto item = dataset::read_item(source_);
    if (!item) return item;
    record(*item);
    delivered_ += item->event ? 0 : 1;
    return item;
  }
  /// Ends a next() that waits for the camera's time. From any thread, until stop().
  void wake() {
    if (live_) live_->stop();
  }
  /// Nobody wants frames now, until release(), which returns how many were left out. A source that
  /// waits for its reader waits.
  void hold() {
    if (live_) live_->hold();
  }
  std::size_t release() { return live_ ? live_->release() : 0; }
  std::size_t left_out() const { return live_ ? live_->left_out() : 0; }
  std::size_t dropped() const { return live_ ? live_->dropped() : 0; }
  std::size_t delivered() const { return live_ ? live_->delivered() : delivered_; }
  /// Ends the playback; returns how many frames were dropped.
  std::int64_t stop() {
    if (!live_) return 0;
    live_->stop();
    const auto dropped = static_cast<std::int64_t>(live_->dropped());
    live_.reset();
    return dropped;
  }

 private:
  void record(const dataset::FeedItem& item) {
    if (recorder_ != nullptr && item.frame) recorder_->offer(item.frame);
  }

  dataset::FrameSource& source_;
  FrameRecorder* recorder_;
  std::size_t delivered_ = 0;
  std::optional<slam::LiveFeed> live_;  // last: its thread calls record()
};

/// Feeds one item; a bad frame is only noted.
void feed_item(const dataset::FeedItem& item, slam::Session& session, RunObserver& observer) {
  if (!item.frame) {
    log().warn("frame {} skipped: {}", item.index, item.bad_reason);
    session.feed_bad(item.index, item.timestamp_s, item.bad_reason);
    observer.on_frame(session, item, session.records().back());
    return;
  }
  observer.on_frame(session, item, session.feed(item.frame));
}

/// Tells the log, the time line and whoever watches what happens to the input.
class EventLog {
 public:
  EventLog(RunClock& clock, RunObserver& observer) : clock_(clock), observer_(observer) {}

  void note(const std::string& what) {
    log().warn("input: {}", what);
    clock_.events.push_back({wall_time_s(), what});
    observer_.on_input_event(what);
    open_ = what;
  }
  /// Somebody wanted it so.
  void note_pause(double held_s, std::size_t left_out) {
    const std::string what =
        left_out > 0
            ? fmt::format("paused for {:.1f} s; {} frames that came meanwhile are left out", held_s,
                          left_out)
            : fmt::format("paused for {:.1f} s", held_s);
    log().info("input: {}", what);
    clock_.events.push_back({wall_time_s(), what});
  }
  /// A frame has come; `dropped` so far because they came too fast.
  void frame_came(std::size_t dropped, bool live) {
    if (live && dropped > dropped_) {
      note(fmt::format("{} frames came too fast and were dropped, {} so far", dropped - dropped_,
                       dropped));
    } else if (!open_.empty()) {
      open_.clear();
      observer_.on_input_event("");
    }
    dropped_ = dropped;
  }
  /// What the input suffers from; is over with the next frame.
  const std::string& trouble() const { return open_; }

 private:
  RunClock& clock_;
  RunObserver& observer_;
  std::size_t dropped_ = 0;
  std::string open_;
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
  Feed feed(source, options);
  EventLog events(clock, observer);
  StatusTeller teller(observer, source.camera(), options.realtime,
                      options.realtime || source.live(), options.recorder);
  const auto counts = [&] {
    return FeedCounts{feed.delivered(), feed.dropped(),
                      static_cast<std::size_t>(clock.frames_left_out) + feed.left_out()};
  };
  const auto held = [&] {
    feed.hold();
    teller.moment(counts(), events.trouble());
  };
  const auto go_on = [&](double held_s) {
    timer.held(held_s);
    const std::size_t left_out = feed.release();
    if (!(held_s > 0)) return;
    clock.frames_left_out += static_cast<std::int64_t>(left_out);
    events.note_pause(held_s, left_out);
    teller.gap();
  };
  Status status;
  const auto play_all = [&] {
    // Neither a file system that does not answer nor a gap in a recording that is played at the
    // camera's rate may keep what is there from being saved.
    const auto end = [&] {
      source.stop();
      feed.wake();
    };
    const std::stop_callback when_stopped(stop, end), when_enough(options.enough, end);
    const auto over = [&] { return stop.stop_requested() || options.enough.stop_requested(); };
    while (!over()) {
      go_on(observer.before_frame(held));
      if (over()) break;
      const double waiting_since_s = wall_time_s();
      const double busy_before_s = session.mapper_busy_s();
      const auto item = feed.next();
      if (!item) break;
      if (item->event) {
        events.note(item->bad_reason);
        teller.moment(counts(), events.trouble());
        continue;
      }
      events.frame_came(feed.dropped(), source.live());
      timer.item_came(wall_time_s() - waiting_since_s, session.mapper_busy_s() - busy_before_s);
      feed_item(*item, session, observer);
      teller.frame(*item, session.records().back(), counts(), events.trouble());
    }
    observer.on_last_frame();
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
    while (session.left_to_replay() > 0 && !stop.stop_requested()) {
      observer.before_frame([] {});
      const auto item = dataset::read_item(source);
      if (!item) break;
      feed_item(*item, session, observer);
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
