// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/bags/bag_order.h"

#include <algorithm>
#include <utility>

#include "sgs/bag/messages.h"

namespace sgs::dataset {
namespace {

/// What lies further back in time than this is of another pass of the clock, not late: the images
/// of one camera come in their order.
constexpr std::int64_t kLatest_ns = 300'000'000;
/// The longest step between two images that follow each other.
constexpr std::int64_t kLongestPause_ns = 1'000'000'000;
/// No recording has a pause of eleven days: what lies alone before or after one has no time.
constexpr std::int64_t kAge_ns = 1'000'000'000'000'000;
/// So many rising times in a row, all of them far back, are a clock that was set back.
constexpr std::size_t kSure = 3;

double seconds(std::int64_t time_ns) { return 1e-9 * static_cast<double>(time_ns); }

Error late(std::int64_t time_ns) {
  return {
      ErrorCode::kInvalidFormat,
      fmt::format("the image at {:.6f} s does not come after the one before it", seconds(time_ns)),
      "recorded twice, it is no loss; where stamps stand still, `--stamps received` takes the "
      "recorder's times"};
}

}  // namespace

Result<std::int64_t> time_of(const bag::Message& message, bag::Encoding encoding, BagClock clock) {
  // What damage makes of a time must leave room to add to it: 2043 is the last year that is exact.
  constexpr std::int64_t kFarthest_ns = std::int64_t{1} << 61;
  if (clock == BagClock::kRecord) {
    return std::clamp(message.record_time_ns, -kFarthest_ns, kFarthest_ns);
  }
  SGS_ASSIGN_OR_RETURN(const bag::Header header, bag::read_header(message, encoding));
  return std::clamp(header.stamp_ns, -kFarthest_ns, kFarthest_ns);
}

MessageOrder::MessageOrder(const bag::Bag& bag, std::size_t channel, BagClock clock)
    : encoding_(bag.channels()[channel].encoding), clock_(clock), cursor_(bag.read({channel})) {}

void MessageOrder::note(Error error) {
  const std::int64_t after_ns = waiting_.empty() ? last_ns_.value_or(0) : waiting_.back().time_ns;
  problems_.push_back({stretch_, after_ns, std::move(error)});
}

/// Messages that turned out to be late ones are left out.
void MessageOrder::give_up_late() {
  for (const Waiting& message : behind_) {
    ++out_of_order_;
    note(late(message.time_ns));
  }
  behind_.clear();
}

/// Whether the message that came last lies far ahead of the one before it, and `time_ns` does not.
bool MessageOrder::last_is_stray(std::int64_t time_ns) const {
  if (waiting_.empty() || time_ns >= waiting_.back().time_ns - kLatest_ns) return false;
  const auto before_ns =
      waiting_.size() > 1 ? std::optional(waiting_[waiting_.size() - 2].time_ns) : last_ns_;
  return before_ns && time_ns > *before_ns && time_ns <= *before_ns + kLongestPause_ns;
}

/// Whether a time is the next of those that are kept behind.
bool MessageOrder::follows_behind(std::int64_t time_ns) const {
  if (behind_.empty()) return false;
  const std::int64_t step_ns = time_ns - behind_.back().time_ns;
  return step_ns > 0 && step_ns <= kLongestPause_ns;
}

/// Keeps what came before something already taken, until it is clear what that means.
void MessageOrder::put_behind(Waiting next) {
  const std::int64_t newest_ns =
      waiting_.empty() ? last_ns_.value_or(next.time_ns) : waiting_.back().time_ns;
  const bool far = next.time_ns < newest_ns - kLatest_ns;
  if (!follows_behind(next.time_ns)) give_up_late();
  // What follows the beginning of a stretch need not be far back itself.
  if (!far && behind_.empty()) {
    ++out_of_order_;
    note(late(next.time_ns));
    return;
  }
  behind_.push_back(std::move(next));
  next_stretch_ = behind_.size() == kSure;
}

void MessageOrder::put(Waiting next) {
  if (last_is_stray(next.time_ns)) {
    const std::int64_t stray_ns = waiting_.back().time_ns;
    waiting_.pop_back();
    ++out_of_order_;
    note({ErrorCode::kInvalidFormat,
          fmt::format("the stamp of an image, {:.6f} s, lies {:.1f} s ahead of its neighbours",
                      seconds(stray_ns), seconds(stray_ns - next.time_ns)),
          ""});
  }
  const bool taken_already = last_ns_ && next.time_ns <= *last_ns_;
  const bool far_back = !waiting_.empty() && next.time_ns < waiting_.back().time_ns - kLatest_ns;
  const bool before_newest = !waiting_.empty() && next.time_ns <= waiting_.back().time_ns;
  if (taken_already || far_back || (before_newest && follows_behind(next.time_ns))) {
    return put_behind(std::move(next));
  }
  give_up_late();
  const auto place = std::lower_bound(
      waiting_.begin(), waiting_.end(), next.time_ns,
      [](const Waiting& waiting, std::int64_t time) { return waiting.time_ns < time; });
  if (place != waiting_.end() && place->time_ns == next.time_ns) {
    ++out_of_order_;
    return note(late(next.time_ns));
  }
  waiting_.insert(place, std::move(next));
}

void MessageOrder::read_one() {
  auto message = cursor_->next();
  if (!message) return note(std::move(message.error()));
  if (!*message) {
    ended_ = true;
    return give_up_late();
  }
  const auto time_ns = time_of(**message, encoding_, clock_);
  if (!time_ns) return note(time_ns.error());
  put({*time_ns, std::move(**message)});
}

void MessageOrder::begin_stretch() {
  ++stretch_;
  next_stretch_ = false;
  last_ns_.reset();
  waiting_.assign(std::make_move_iterator(behind_.begin()), std::make_move_iterator(behind_.end()));
  behind_.clear();
}

void MessageOrder::leave_out(std::size_t place, std::int64_t neighbour_ns) {
  const std::int64_t time_ns = waiting_[place].time_ns;
  waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(place));
  ++out_of_order_;
  note(
      {ErrorCode::kInvalidFormat,
       fmt::format("the stamp of an image, {:.6f} s, has nothing to do with that of its neighbour, "
                   "{:.6f} s",
                   seconds(time_ns), seconds(neighbour_ns)),
       ""});
}

void MessageOrder::leave_out_strays() {
  constexpr std::size_t kMost = 3;
  const auto gap_before = [&](std::size_t i) {
    return waiting_[i].time_ns - waiting_[i - 1].time_ns > kAge_ns;
  };
  if (!begun_ && !waiting_.empty()) {
    begun_ = true;
    for (std::size_t i = std::min(kMost, waiting_.size() - 1); i > 0; --i) {
      if (!gap_before(i) || waiting_.size() - i <= i) continue;
      const std::int64_t first_ns = waiting_[i].time_ns;
      while (i-- > 0) leave_out(0, first_ns);
      break;
    }
  }
  if (!ended_ || waiting_.empty()) return;
  const std::int64_t before_ns = waiting_.size() > 1 ? waiting_[waiting_.size() - 2].time_ns
                                                     : last_ns_.value_or(waiting_.back().time_ns);
  if (waiting_.back().time_ns - before_ns > kAge_ns) leave_out(waiting_.size() - 1, before_ns);
}

void MessageOrder::fill() {
  if (next_stretch_ && waiting_.empty()) begin_stretch();
  while (!ended_ && !next_stretch_ && waiting_.size() < kAhead) {
    read_one();
    if (next_stretch_ && waiting_.empty()) begin_stretch();
  }
  leave_out_strays();
}

MessageOrder::Waiting MessageOrder::take() {
  Waiting front = std::move(waiting_.front());
  waiting_.pop_front();
  last_ns_ = front.time_ns;
  return front;
}

void MessageOrder::drop(std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) take();
}

}  // namespace sgs::dataset
