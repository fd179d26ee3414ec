// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/bags/bag_pairs.h"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <utility>
#include <vector>

#include "sgs/dataset/association.h"

namespace sgs::dataset {
namespace {

/// Images a second are at least so many: a longer step between two of them is a gap.
constexpr std::int64_t kLongestStep_ns = 1'000'000'000;

/// Times relative to the first one: seconds since 1970 have too few digits.
std::vector<double> seconds_after(const std::deque<MessageOrder::Waiting>& waiting,
                                  std::int64_t origin) {
  std::vector<double> times;
  for (const auto& w : waiting) times.push_back(1e-9 * static_cast<double>(w.time_ns - origin));
  return times;
}

}  // namespace

BagPairs::BagPairs(const bag::Bag& bag, std::size_t color, std::size_t depth, BagClock clock,
                   double max_difference_s)
    : color_(bag, color, clock),
      depth_(bag, depth, clock),
      clock_(clock),
      max_difference_s_(max_difference_s) {}

/// The first problem of colour that was met before a time. Damaged depth needs no word of its own:
/// it shows as colour without depth.
std::optional<BagPairs::Event> BagPairs::problem_before(int stretch, std::int64_t time_ns) {
  auto& problems = color_.problems();
  if (problems.empty()) return std::nullopt;
  MessageOrder::Problem& problem = problems.front();
  const bool later =
      problem.stretch > stretch || (problem.stretch == stretch && problem.after_ns >= time_ns);
  if (later) return std::nullopt;
  Event event;
  event.kind = Event::Kind::kBad;
  event.stamp_ns = problem.after_ns;
  event.time_ns = problem.after_ns + moved_ns_;
  event.moved = moved_ns_ != 0;
  event.error = std::move(problem.error);
  problems.pop_front();
  return event;
}

/// Lets the times of a new stretch of colour follow those of the old one.
std::optional<BagPairs::Event> BagPairs::begin_stretch() {
  if (color_.stretch() == stretch_) return std::nullopt;
  stretch_ = color_.stretch();
  const std::int64_t front_ns = color_.waiting().front().time_ns;
  const std::int64_t before_ns = last_ns_.value_or(front_ns) - moved_ns_;
  moved_ns_ = last_ns_.value_or(front_ns) + step_ns_ - front_ns;
  Event event;
  event.kind = Event::Kind::kBack;
  event.time_ns = front_ns + moved_ns_;
  event.stamp_ns = front_ns;
  event.moved = true;
  event.error = {ErrorCode::kInvalidFormat,
                 fmt::format("the clock of the recording was set back by {:.3f} s at {:.3f} s; the "
                             "images go on as a new stretch, moved to follow the one before",
                             1e-9 * static_cast<double>(before_ns + step_ns_ - front_ns),
                             1e-9 * static_cast<double>(before_ns)),
                 ""};
  return event;
}

void BagPairs::drop_color(std::size_t count) {
  if (count > 0) last_ns_ = color_.waiting()[count - 1].time_ns + moved_ns_;
  color_.drop(count);
  color_unpaired_ += count;
}

void BagPairs::drop_depth(std::size_t count) {
  depth_.drop(count);
  depth_unpaired_ += count;
}

/// Images of two passes of the clock do not belong together, whatever their times.
void BagPairs::drop_earlier_stretch() {
  if (color_.stretch() < depth_.stretch()) {
    drop_color(color_.waiting().size());
  } else {
    drop_depth(depth_.waiting().size());
  }
}

void BagPairs::note_distance() {
  for (const auto& c : color_.waiting()) {
    for (const auto& d : depth_.waiting()) {
      const std::int64_t distance = std::llabs(c.time_ns - d.time_ns);
      nearest_ns_ = std::min(nearest_ns_.value_or(distance), distance);
    }
  }
}

BagPairs::Event BagPairs::next() {
  constexpr auto kWhenever = std::numeric_limits<std::int64_t>::max();
  for (std::size_t alone = 0; alone < patience_; ++alone) {
    color_.fill();
    depth_.fill();
    if (color_.waiting().empty() || depth_.waiting().empty()) {
      drop_color(color_.waiting().size());
      drop_depth(depth_.waiting().size());
      return problem_before(std::numeric_limits<int>::max(), kWhenever).value_or(Event{});
    }
    if (auto problem = problem_before(stretch_, color_.waiting().front().time_ns)) return *problem;
    if (auto back = begin_stretch()) return *back;
    if (color_.stretch() != depth_.stretch()) {
      drop_earlier_stretch();
      continue;
    }
    note_distance();
    const std::int64_t origin = color_.waiting().front().time_ns;
    const auto pairs = associate(seconds_after(color_.waiting(), origin),
                                 seconds_after(depth_.waiting(), origin), max_difference_s_);
    if (pairs.empty()) {
      if (origin < depth_.waiting().front().time_ns) {
        drop_color(1);
      } else {
        drop_depth(1);
      }
      continue;
    }
    drop_color(pairs.front().first);
    drop_depth(pairs.front().second);
    auto color = color_.take(), depth = depth_.take();
    Event event;
    event.kind = Event::Kind::kPair;
    event.stamp_ns = color.time_ns;
    event.time_ns = color.time_ns + moved_ns_;
    event.moved = stretch_ > 0;
    // Times of recording tell when messages arrived, not when they were measured.
    if (clock_ == BagClock::kStamp) event.depth_delay_ns = depth.time_ns - color.time_ns;
    event.color = std::move(color.message);
    event.depth = std::move(depth.message);
    const std::int64_t step_ns = event.time_ns - last_ns_.value_or(event.time_ns);
    if (step_ns > 0 && step_ns < kLongestStep_ns) step_ns_ = step_ns;
    last_ns_ = event.time_ns;
    return event;
  }
  return {};
}

}  // namespace sgs::dataset
