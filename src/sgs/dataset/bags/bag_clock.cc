// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/bags/bag_clock.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "sgs/bag/messages.h"
#include "sgs/dataset/time_unit.h"

namespace sgs::dataset {
namespace {

/// The times of the first images of a topic on both clocks.
struct FirstTimes {
  std::vector<std::int64_t> stamps_ns, received_ns;
};

FirstTimes first_times(const bag::Bag& bag, std::size_t channel) {
  constexpr std::size_t kLooked = 20;
  const auto cursor = bag.read({channel});
  FirstTimes times;
  for (std::size_t i = 0; i < kLooked; ++i) {
    const auto message = cursor->next();
    if (message && !*message) break;
    if (!message) continue;
    const bag::Encoding encoding = bag.channels()[channel].encoding;
    const auto stamp_ns = time_of(**message, encoding, BagClock::kStamp);
    if (!stamp_ns) continue;
    times.stamps_ns.push_back(*stamp_ns);
    times.received_ns.push_back(*time_of(**message, encoding, BagClock::kRecord));
  }
  return times;
}

std::size_t different(const std::vector<std::int64_t>& times) {
  return std::set<std::int64_t>(times.begin(), times.end()).size();
}

double span_s(const std::vector<std::int64_t>& times) {
  const auto [first, last] = std::minmax_element(times.begin(), times.end());
  return 1e-9 * static_cast<double>(*last - *first);
}

/// Whether most images have a time of their own.
bool tells_apart(const std::vector<std::int64_t>& times) {
  return 2 * different(times) > times.size();
}

/// So many images tell whether their times do.
constexpr std::size_t kEnoughTimes = 4;

bool all_zero(const std::vector<std::int64_t>& times) {
  return std::all_of(times.begin(), times.end(), [](std::int64_t t) { return t == 0; });
}

/// What is wrong with the stamps of a topic; empty where nothing is.
std::string useless(const FirstTimes& times, const char* what) {
  if (times.stamps_ns.empty()) return "";
  if (all_zero(times.stamps_ns)) return fmt::format("the {} images have no time stamps", what);
  const bool collapsed = times.stamps_ns.size() >= kEnoughTimes && !tells_apart(times.stamps_ns) &&
                         tells_apart(times.received_ns);
  if (!collapsed) return "";
  return fmt::format("{} of the first {} images share {} time stamps", times.stamps_ns.size(), what,
                     different(times.stamps_ns));
}

void compare_rates(const FirstTimes& times, std::vector<std::string>& warnings) {
  constexpr double kFactor = 5;
  constexpr std::size_t kForRates = 10;
  if (times.stamps_ns.size() < kForRates) return;
  const double stamps_s = span_s(times.stamps_ns), received_s = span_s(times.received_ns);
  if (stamps_s <= 0 || received_s <= 0) return;
  if (stamps_s < kFactor * received_s && received_s < kFactor * stamps_s) return;
  warnings.push_back(fmt::format(
      "the stamps of the first {} colour images go over {:.4g} s, the recorder's clock over {:.4g} "
      "s: the stamps may be in another unit; `--stamps received` takes the recorder's times",
      times.stamps_ns.size(), stamps_s, received_s));
}

}  // namespace

Result<ClockChoice> choose_clock(const bag::Bag& bag, const BagTopics& topics, Stamps option) {
  ClockChoice choice;
  const FirstTimes color = first_times(bag, topics.color.channel);
  const FirstTimes depth = first_times(bag, topics.depth.channel);
  const std::string of_color = useless(color, "colour");
  const std::string problem = of_color.empty() ? useless(depth, "depth") : of_color;
  if (option == Stamps::kReceived) {
    choice.clock = BagClock::kRecord;
    choice.source = "the times of recording, by --stamps received";
  } else if (problem.empty()) {
    choice.source = "the stamps of the images";
    compare_rates(color, choice.warnings);
  } else {
    choice.clock = BagClock::kRecord;
    choice.source = "the times of recording: the stamps tell nothing";
    choice.warnings.push_back(problem + "; the times of recording are taken, which are less exact");
  }
  const bool stamps = choice.clock == BagClock::kStamp;
  const std::vector<std::int64_t>& times = stamps ? color.stamps_ns : color.received_ns;
  if (!stamps && times.size() >= kEnoughTimes && !tells_apart(times)) {
    const bool other_clock = option == Stamps::kReceived && problem.empty();
    return fail(
        ErrorCode::kInvalidFormat,
        fmt::format("{} colour images share {} times of recording, so these do not tell them "
                    "apart{}",
                    times.size(), different(times), other_clock ? "" : "; " + problem),
        other_clock ? "the stamps do: leave out --stamps"
                    : "save the images into two folders, and describe them in an sgs.toml "
                      "with sequence.match = \"order\" and sequence.fps");
  }
  choice.median_step_s = 1e-9 * median_step({times.begin(), times.end()});
  return choice;
}

}  // namespace sgs::dataset
