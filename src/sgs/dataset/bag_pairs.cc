// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/bag_pairs.h"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <vector>

#include "sgs/bag/messages.h"
#include "sgs/dataset/association.h"

namespace sgs::dataset {
namespace {

/// Messages read ahead of each topic: recorders interleave topics within a fraction of a second.
constexpr std::size_t kAhead = 8;
/// Images further back in time than this are of another pass of the clock, not late.
constexpr std::int64_t kLatest_ns = 1'000'000'000;

}  // namespace

BagPairs::BagPairs(const bag::Bag& bag, std::size_t color, std::size_t depth, BagClock clock,
                   double max_difference_s)
    : clock_(clock), max_difference_s_(max_difference_s) {
  color_.cursor = bag.read({color});
  color_.encoding = bag.channels()[color].encoding;
  depth_.cursor = bag.read({depth});
  depth_.encoding = bag.channels()[depth].encoding;
}

/// Puts a message in its place. What comes before something already taken is an error.
std::optional<Error> BagPairs::take_in(Stream& stream, bag::Message message) {
  std::int64_t time_ns = message.record_time_ns;
  if (clock_ == BagClock::kStamp) {
    const auto header = bag::read_header(message, stream.encoding);
    if (!header) return header.error();
    time_ns = header->stamp_ns;
  }
  const bool taken_already = stream.last_ns && time_ns <= *stream.last_ns;
  const bool far_back =
      !stream.waiting.empty() && time_ns < stream.waiting.back().time_ns - kLatest_ns;
  const auto place = std::lower_bound(
      stream.waiting.begin(), stream.waiting.end(), time_ns,
      [](const Waiting& waiting, std::int64_t time) { return waiting.time_ns < time; });
  const bool twice = place != stream.waiting.end() && place->time_ns == time_ns;
  if (taken_already || far_back || twice) {
    ++stream.backwards;
    return Error{ErrorCode::kInvalidFormat,
                 fmt::format("the image at {:.6f} s does not come after the one before it",
                             1e-9 * static_cast<double>(time_ns)),
                 "the recording repeats time stamps, or its clock was set back"};
  }
  stream.waiting.insert(place, {time_ns, std::move(message)});
  return std::nullopt;
}

/// Reads on until enough messages wait. Damaged depth needs no word of its own: it shows as colour
/// without depth.
void BagPairs::fill(Stream& stream, std::deque<Problem>* problems) {
  const auto note = [&](Error error) {
    const std::int64_t after_ns =
        stream.waiting.empty() ? stream.last_ns.value_or(0) : stream.waiting.back().time_ns;
    if (problems != nullptr) problems->push_back({after_ns, std::move(error)});
  };
  while (!stream.ended && stream.waiting.size() < kAhead) {
    auto message = stream.cursor->next();
    if (!message) {
      note(std::move(message.error()));
    } else if (!*message) {
      stream.ended = true;
    } else if (auto problem = take_in(stream, std::move(**message))) {
      note(std::move(*problem));
    }
  }
}

/// Fills `event` with a problem that was met before `time_ns`.
bool BagPairs::problem_before(std::int64_t time_ns, Event& event) {
  if (problems_.empty() || problems_.front().after_ns >= time_ns) return false;
  event.kind = Event::Kind::kBad;
  event.time_ns = problems_.front().after_ns;
  event.error = std::move(problems_.front().error);
  problems_.pop_front();
  return true;
}

BagPairs::Waiting BagPairs::take(Stream& stream) {
  Waiting front = std::move(stream.waiting.front());
  stream.waiting.pop_front();
  stream.last_ns = front.time_ns;
  return front;
}

void BagPairs::drop(Stream& stream, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) take(stream);
  stream.unpaired += count;
}

void BagPairs::note_distance() {
  for (const Waiting& c : color_.waiting) {
    for (const Waiting& d : depth_.waiting) {
      const std::int64_t distance = std::llabs(c.time_ns - d.time_ns);
      nearest_ns_ = std::min(nearest_ns_.value_or(distance), distance);
    }
  }
}

BagPairs::Event BagPairs::next() {
  Event event;
  for (std::size_t alone = 0; alone < patience_; ++alone) {
    fill(color_, &problems_);
    fill(depth_, nullptr);
    if (color_.waiting.empty() || depth_.waiting.empty()) {
      drop(color_, color_.waiting.size());
      drop(depth_, depth_.waiting.size());
      problem_before(std::numeric_limits<std::int64_t>::max(), event);
      return event;
    }
    if (problem_before(color_.waiting.front().time_ns, event)) return event;
    note_distance();
    // Times relative to the first one: seconds since 1970 have too few digits.
    const std::int64_t origin = color_.waiting.front().time_ns;
    const auto seconds = [&](const std::deque<Waiting>& waiting) {
      std::vector<double> times;
      for (const Waiting& w : waiting) {
        times.push_back(1e-9 * static_cast<double>(w.time_ns - origin));
      }
      return times;
    };
    const auto pairs =
        associate(seconds(color_.waiting), seconds(depth_.waiting), max_difference_s_);
    if (pairs.empty()) {
      drop(color_.waiting.front().time_ns < depth_.waiting.front().time_ns ? color_ : depth_, 1);
      continue;
    }
    drop(color_, pairs.front().first);
    drop(depth_, pairs.front().second);
    Waiting color = take(color_), depth = take(depth_);
    event.kind = Event::Kind::kPair;
    event.time_ns = color.time_ns;
    // Times of recording tell when messages arrived, not when they were measured.
    if (clock_ == BagClock::kStamp) event.depth_delay_ns = depth.time_ns - color.time_ns;
    event.color = std::move(color.message);
    event.depth = std::move(depth.message);
    return event;
  }
  return event;
}

}  // namespace sgs::dataset
