// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/stream/stream_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "sgs/dataset/frame_fit.h"
#include "sgs/dataset/source_failure.h"
#include "sgs/stream/frame_codec.h"
#include "sgs/stream/inertial_store.h"
#include "sgs/stream/link.h"
#include "sgs/stream/unit_doubts.h"

namespace sgs::stream {
namespace {

using Clock = std::chrono::steady_clock;

Clock::duration seconds(double s) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
}

double seconds_since(Clock::time_point time) {
  return std::chrono::duration<double>(Clock::now() - time).count();
}

bool same_cameras(const Hello& a, const Hello& b) {
  return a.color_camera == b.color_camera && a.depth_camera == b.depth_camera &&
         a.T_color_depth.R == b.T_color_depth.R && a.T_color_depth.t == b.T_color_depth.t;
}

class Receiver final : public StreamSource {
 public:
  Receiver(std::unique_ptr<Entrance> entrance, const Patience& patience,
           const std::optional<Address::Camera>& camera)
      : entrance_(std::move(entrance)),
        patience_(patience),
        is_camera_(camera.has_value()),
        lock_after_s_(camera ? camera->lock_exposure_after_s : 0) {}
  ~Receiver() override { tell_sender("stop"); }

  std::string name() const override { return hello_ ? hello_->name : "stream"; }
  PinholeCamera camera() const override { return hello_->color_camera.camera; }
  std::optional<std::int64_t> size() const override { return std::nullopt; }
  const Trajectory& ground_truth() const override { return no_truth_; }
  const Hello& hello() const override { return *hello_; }
  dataset::ImuRecording imu() const override { return inertial_.recording(entrance_->name()); }
  void watch(StreamWatcher& watcher) override { watcher_ = &watcher; }
  bool live() const override { return true; }
  void stop() override {
    stopped_ = true;
    entrance_->wake();
  }

  /// Waits for the first sender.
  Status wait_for_greeting() {
    asked_ = gone_ = Clock::now();
    while (!hello_) {
      if (stopped_) return fail(ErrorCode::kInterrupted, "interrupted while waiting for a sender");
      if (ended_) return fail(ErrorCode::kInvalidFormat, *ended_);
      if (first_failure_) return tl::unexpected<Error>(*first_failure_);
      if (patience_.first_s > 0 && seconds_since(gone_) > patience_.first_s) {
        return fail(ErrorCode::kNotFound,
                    fmt::format("{}: no sender within {:g} s{}", entrance_->name(),
                                patience_.first_s, last_refusal()),
                    "start one with `sgs send INPUT live:...`, or wait longer: --wait S (0 = for "
                    "ever)");
      }
      handle();
      if (!hello_ && !ended_ && !first_failure_) entrance_->run_until(deadline());
    }
    tell_of_little_seen();
    return {};
  }

  dataset::FrameRead next(RgbdFrame& frame, Error& error) override {
    if (std::exchange(delivered_, false)) asked_ = Clock::now();
    while (true) {
      if (stopped_) return dataset::FrameRead::kEnd;
      if (!events_.empty()) {
        error = {ErrorCode::kIo, std::move(events_.front()), ""};
        events_.pop_front();
        return dataset::FrameRead::kEvent;
      }
      if (packet_) return deliver(frame, error);
      if (done_) return dataset::FrameRead::kEnd;
      if (ended_) throw dataset::SourceFailure({ErrorCode::kIo, *ended_, ""});
      handle();
      if (!something_to_tell()) entrance_->run_until(deadline());
    }
  }

 private:
  void say(std::string what) { events_.push_back(std::move(what)); }

  void tell_of_little_seen() {
    const auto& [camera, lens] = hello_->color_camera;
    const auto seen = dataset::FrameFit(camera, lens).seen(camera);
    if (auto warning = dataset::little_is_seen(seen.get(), "the greeting")) say(*warning);
  }

  std::string last_refusal() const {
    return events_.empty() ? "" : fmt::format("; {}", events_.back());
  }

  dataset::FrameRead deliver(RgbdFrame& frame, Error& error) {
    delivered_ = true;
    frame = RgbdFrame{};
    frame.index = index_++;
    if (watcher_ != nullptr) watcher_->on_packet(*packet_);
    const double sent_s = packet_->timestamp_s;
    if (auto doubt = doubts_.of_time(sent_s)) say(*doubt);
    if (std::exchange(new_clock_, false)) follow_on(sent_s);
    const double time_s = sent_s + moved_s_;
    frame.timestamp_s = time_s;
    frame.camera = camera();
    const auto exposure_s = packet_->exposure_s;
    const Status decoded = decoder_->decode(std::move(*packet_), frame);
    packet_.reset();
    if (!decoded) {
      error = decoded.error();
      // A record without a time would be no record.
      if (!std::isfinite(time_s)) frame.timestamp_s = last_time_s_.value_or(0);
      return dataset::FrameRead::kBadFrame;
    }
    if (last_time_s_ && time_s <= *last_time_s_ && !was_set_back(sent_s)) {
      error = {ErrorCode::kInvalidFormat,
               fmt::format("it came too late: its time is {:.6f} s, that of the frame before "
                           "{:.6f} s",
                           time_s, *last_time_s_),
               ""};
      return dataset::FrameRead::kBadFrame;
    }
    if (is_ahead(sent_s)) {
      error = {ErrorCode::kInvalidFormat,
               fmt::format("its stamp, {:.3f} s, is {:.3f} s in the future", time_s,
                           time_s - expected_s()),
               ""};
      return dataset::FrameRead::kBadFrame;
    }
    frame.timestamp_s = sent_s + moved_s_;
    if (auto doubt = doubts_.of_depth(frame.depth)) say(*doubt);
    if (auto doubt = doubts_.of_mask(frame.still.get())) say(*doubt);
    behind_ = ahead_ = 0;
    in_time_ = true;
    last_time_s_ = frame.timestamp_s;
    last_good_ = Clock::now();
    drop_implausible_delay(frame);
    watch_exposure(frame.timestamp_s, exposure_s);
    return dataset::FrameRead::kOk;
  }

  /// Whether a late frame shows that the sender's clock was set back: the last of several in a row,
  /// all a second or more behind, from a sender that was in time before. Its times are then moved
  /// to follow the others.
  bool was_set_back(double sent_s) {
    constexpr double kSetBack_s = 1, kStep_s = 1.0 / 30;
    constexpr int kSure = 4;
    const bool far = in_time_ && sent_s + moved_s_ < *last_time_s_ - kSetBack_s;
    const bool goes_on = behind_ == 0 || sent_s > last_behind_s_;
    behind_ = !far ? 0 : goes_on ? behind_ + 1 : 1;
    last_behind_s_ = sent_s;
    if (behind_ < kSure) return false;
    const double back_s = *last_time_s_ - (sent_s + moved_s_);
    moved_s_ += back_s + kStep_s;
    say(
        fmt::format("the clock of {} was set back by {:.3f} s; its frames go on, moved to follow "
                    "those before",
                    sender_ ? sender_->who() : std::string("the sender"), back_s));
    return true;
  }

  /// The time of a frame that comes now, by the watch of this side.
  double expected_s() const { return *last_time_s_ + seconds_since(last_good_); }

  /// A camera's clock may stand elsewhere after it was plugged in again.
  void follow_on(double sent_s) {
    constexpr double kSame_s = 1;
    if (!last_time_s_ || !hello_->device_clock || !std::isfinite(sent_s)) return;
    const double off_s = sent_s + moved_s_ - expected_s();
    if (std::abs(off_s) < kSame_s) return;
    moved_s_ -= off_s;
    say(
        fmt::format("the camera's clock stands {:.3f} s off; its frames go on, moved to follow "
                    "those before",
                    off_s));
  }

  /// Whether a frame of a camera's clock is of the future: that is its sender's mistake, unless
  /// several in a row are. Then the clock was set, and the frames are moved to follow the others.
  bool is_ahead(double sent_s) {
    constexpr double kMost_s = 10;
    constexpr int kSure = 4;
    if (!last_time_s_ || !hello_->device_clock) return false;
    const double ahead_s = sent_s + moved_s_ - expected_s();
    if (ahead_s < kMost_s) return false;
    if (++ahead_ < kSure) return true;
    moved_s_ -= ahead_s;
    say(
        fmt::format("the camera's clock was set forward by {:.3f} s; its frames go on, moved to "
                    "follow those before",
                    ahead_s));
    return false;
  }

  void tell_sender(const std::string& line) {
    if (sender_ && hello_->listens) sender_->answer(line);
  }

  /// Asks for a fixed exposure when it is time, and says once that it changes.
  void watch_exposure(double time_s, const std::optional<double>& exposure_s) {
    constexpr double kChange = 1.5, kMs = 1e3;
    if (!sender_since_s_) sender_since_s_ = time_s;
    if (lock_after_s_ > 0 && !locked_ && time_s - *sender_since_s_ >= lock_after_s_) {
      locked_ = true;
      tell_sender("lock_exposure");
    }
    if (!exposure_s || !(*exposure_s > 0) || told_of_exposure_) return;
    if (!first_exposure_s_) first_exposure_s_ = exposure_s;
    const double ratio = *exposure_s / *first_exposure_s_;
    if (lock_after_s_ > 0 || (ratio < kChange && ratio > 1 / kChange)) return;
    told_of_exposure_ = true;
    say(
        fmt::format("exposure went from {:.1f} to {:.1f} ms: the map is better with a fixed one "
                    "(of a camera: `,lock=1` locks it after a second)",
                    kMs * *first_exposure_s_, kMs * *exposure_s));
  }

  /// Depth that is stamped by another clock is taken as of its colour's time.
  void drop_implausible_delay(RgbdFrame& frame) {
    constexpr double kMost_s = 0.1;  // no camera pairs images that are farther apart
    if (std::abs(frame.depth_delay_s) <= kMost_s) return;
    if (!std::exchange(told_of_delay_, true)) {
      say(
          fmt::format("depth is stamped {:.3f} s after its colour: not the same clock, so such "
                      "stamps are not used; send `depth_t` by the clock of `t`, or leave it out",
                      frame.depth_delay_s));
    }
    frame.depth_delay_s = 0;
  }

  /// Makes the most of what has come, and notices what has not.
  void handle() {
    for (std::string& note : entrance_->take_notes()) say(std::move(note));
    take_in_guests();
    listen_to_sender();
    notice_silence();
  }

  bool something_to_tell() const { return !events_.empty() || packet_ || done_ || ended_; }

  Clock::time_point deadline() const {
    constexpr double kLongest_s = 3600;
    auto until = Clock::now() + seconds(kLongest_s);
    for (const auto& guest : entrance_->guests()) {
      until = std::min(until, guest->since() + seconds(patience_.greeting_s));
    }
    const auto quiet = quiet_since();
    if (sender_ && !stalled_) until = std::min(until, quiet + seconds(patience_.stall_s));
    const double over_s = hello_ ? patience_.wait_s : patience_.first_s;
    if (over_s > 0) until = std::min(until, quiet + seconds(over_s));
    return until;
  }

  /// Since when nothing has come although it was asked for.
  Clock::time_point quiet_since() const { return std::max(asked_, sender_ ? last_frame_ : gone_); }

  void take_in_guests() {
    auto& guests = entrance_->guests();
    for (auto it = guests.begin(); it != guests.end();) {
      if (judge(**it)) {
        ++it;
      } else {
        it = guests.erase(it);
      }
    }
  }

  /// Whether a guest may stay one: it has not said who it is yet.
  bool judge(Link& guest) {
    const auto part = guest.parser().next();
    if (!part) return refuse(guest, part.error().text());
    if (*part == StreamParser::Part::kHello) {
      greet(guest);
      return false;
    }
    if (guest.closed()) {
      const auto failure = guest.failure();
      if (failure && !hello_) first_failure_ = failure;
      return refuse(guest, failure ? failure->text() : "it went away without a greeting");
    }
    if (seconds_since(guest.since()) > patience_.greeting_s) {
      return refuse(guest, fmt::format("no greeting within {:g} s", patience_.greeting_s));
    }
    guest.read_on();
    return true;
  }

  bool refuse(Link& link, const std::string& reason) {
    std::string what = fmt::format("{} was refused: {}", link.who(), reason);
    if (is_camera_ && !hello_ && !first_failure_) {
      first_failure_ = Error{ErrorCode::kInvalidFormat, what, ""};
    }
    if (what != std::exchange(last_refused_, what)) say(std::move(what));
    link.answer("refused " + reason);
    link.close();
    if (hello_ && !sender_) entrance_->open_again();
    if (entrance_->ends_with_link()) ended_ = fmt::format("{}: {}", entrance_->name(), reason);
    return false;
  }

  void greet(Link& guest) {
    const Hello& hello = guest.parser().hello();
    if (hello_ && !same_cameras(*hello_, hello)) {
      refuse(guest, "its camera is another one than that of the run");
      return;
    }
    if (sender_ && !stalled_) {
      refuse(guest, "another sender is connected");
      return;
    }
    if (sender_) {
      say(fmt::format("{} takes over from {}, which was silent", guest.who(), sender_->who()));
      sender_->answer("refused another sender took over");
      sender_->close();
    } else if (hello_) {
      say(fmt::format("a sender is there again after {:.1f} s: {}", seconds_since(gone_),
                      guest.who()));
    }
    last_refused_.clear();
    // The coding may differ from sender to sender.
    hello_ = hello;
    decoder_.emplace(hello);
    sender_ = guest.shared_from_this();
    sender_->answer("ok");
    stalled_ = false;
    in_time_ = false;
    behind_ = ahead_ = 0;
    new_clock_ = true;
    gave_frames_ = false;
    locked_ = false;
    sender_since_s_.reset();
    last_frame_ = Clock::now();
  }

  void listen_to_sender() {
    if (!sender_ || packet_) return;
    auto part = sender_->parser().next();
    while (part && *part == StreamParser::Part::kImu) {
      if (watcher_ != nullptr) watcher_->on_samples(sender_->parser().imu());
      inertial_.add(sender_->parser().imu(), moved_s_, *hello_);
      part = sender_->parser().next();
    }
    if (!part) {
      sender_->answer("refused " + part.error().message);
      return lose_sender(
          fmt::format("what {} sent is no stream: {}", sender_->who(), part.error().message));
    }
    if (*part == StreamParser::Part::kFrame) {
      if (stalled_) {
        say(fmt::format("frames come again after {:.1f} s", seconds_since(last_frame_)));
        stalled_ = false;
      }
      last_frame_ = Clock::now();
      gave_frames_ = true;
      packet_ = std::move(sender_->parser().packet());
      return;
    }
    if (*part == StreamParser::Part::kEnd) {
      sender_->answer("done");
      sender_->close();
      sender_.reset();
      done_ = true;
      return;
    }
    if (sender_->closed()) {
      const bool whole = sender_->parser().between_parts();
      if (const auto failure = sender_->failure()) {
        return lose_sender(fmt::format("{}: {}", sender_->who(), failure->message));
      }
      return lose_sender(
          fmt::format("{} went away {}", sender_->who(),
                      whole ? "without saying that it was done" : "in the middle of a frame"));
    }
    sender_->read_on();
  }

  void lose_sender(const std::string& what) {
    sender_->close();
    sender_.reset();
    stalled_ = false;
    // A program that greets again and again and never sends a frame is as good as none.
    if (gave_frames_ || !is_camera_) gone_ = Clock::now();
    if (entrance_->ends_with_link()) {
      ended_ = fmt::format("{}: {}", entrance_->name(), what);
      say(what);
      return;
    }
    say(patience_.wait_s > 0
            ? fmt::format("{}; waiting {:g} s for it to come back", what, patience_.wait_s)
            : fmt::format("{}; waiting for it to come back", what));
    entrance_->open_again();
  }

  void notice_silence() {
    if (!hello_ || packet_ || done_ || ended_) return;
    const double quiet_s = seconds_since(quiet_since());
    if (sender_ && !stalled_ && quiet_s >= patience_.stall_s) {
      stalled_ = true;
      say(fmt::format("no frame for {:.1f} s from {}", quiet_s, sender_->who()));
    }
    if (patience_.wait_s > 0 && quiet_s >= patience_.wait_s) {
      ended_ = fmt::format("{}: {} for {:g} s", entrance_->name(),
                           sender_ ? "no frame" : "no sender", patience_.wait_s);
    }
  }

  std::unique_ptr<Entrance> entrance_;
  Patience patience_;
  bool is_camera_;  // its program is started by this side
  double lock_after_s_;
  Trajectory no_truth_;
  std::atomic<bool> stopped_{false};
  std::optional<Hello> hello_;
  std::optional<FrameDecoder> decoder_;
  std::shared_ptr<Link> sender_;
  std::optional<Packet> packet_;  // taken from the sender, not delivered yet
  std::deque<std::string> events_;
  std::optional<std::string> ended_;  // before its time, and why
  bool done_ = false, stalled_ = false;
  bool delivered_ = true;  // the last call of next() gave a frame
  std::int64_t index_ = 0;
  std::optional<double> last_time_s_;
  double moved_s_ = 0;        // added to the sender's times since its clock was set back
  int behind_ = 0;            // late frames in a row
  double last_behind_s_ = 0;  // the time of the last of them
  bool in_time_ = false;      // the sender that is connected was
  UnitDoubts doubts_;
  bool told_of_delay_ = false;
  bool gave_frames_ = false;  // the sender that is connected, or was
  bool new_clock_ = false;    // no frame of the sender that is connected has come yet
  int ahead_ = 0;             // frames of the future in a row
  std::optional<Error> first_failure_;
  std::string last_refused_;
  InertialStore inertial_;
  StreamWatcher* watcher_ = nullptr;
  bool locked_ = false, told_of_exposure_ = false;
  std::optional<double> sender_since_s_, first_exposure_s_;
  Clock::time_point asked_, last_frame_, gone_, last_good_;
};

}  // namespace

StreamSource::~StreamSource() = default;

Result<std::unique_ptr<StreamSource>> open_stream(
    const Address& address, const Patience& patience,
    const std::function<void(const std::string&)>& announce, const std::stop_token& stop) {
  SGS_ASSIGN_OR_RETURN(auto entrance, Entrance::open(address));
  if (announce) announce(fmt::format("{}: waiting for a sender", entrance->name()));
  auto receiver = std::make_unique<Receiver>(std::move(entrance), patience, address.camera);
  const std::stop_callback wake(stop, [&] { receiver->stop(); });
  SGS_RETURN_IF_ERROR(receiver->wait_for_greeting());
  return receiver;
}

}  // namespace sgs::stream
