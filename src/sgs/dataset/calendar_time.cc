// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/calendar_time.h"

#include <chrono>
#include <cmath>

namespace sgs::dataset {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Takes numbers of a fixed number of digits off the front of a text.
class Digits {
 public:
  explicit Digits(std::string_view text) : rest_(text) {}

  int take(std::size_t count) {
    int value = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (i >= rest_.size() || !is_digit(rest_[i])) return ok_ = false, 0;
      value = 10 * value + (rest_[i] - '0');
    }
    rest_.remove_prefix(count);
    return value;
  }
  /// One of these characters, where it stands there.
  bool take_one_of(std::string_view characters) {
    const bool there = !rest_.empty() && characters.find(rest_.front()) != std::string_view::npos;
    if (there) rest_.remove_prefix(1);
    return there;
  }
  bool ok() const { return ok_; }
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  bool ok_ = true;
};

/// The fraction of a second behind its point, and at most a time zone behind it; -1 for other
/// things.
double fraction_of(Digits& digits) {
  double fraction = 0, place = 0.1;
  if (digits.take_one_of(".,_-")) {
    if (digits.rest().empty() || !is_digit(digits.rest().front())) return -1;
    while (!digits.rest().empty() && is_digit(digits.rest().front())) {
      fraction += place * digits.take(1);
      place /= 10;
    }
  }
  const std::string_view zone = digits.rest();
  const bool none_or_zone = zone.empty() || zone == "Z" ||
                            ((zone.front() == '+' || zone.front() == '-') &&
                             zone.find_first_not_of("0123456789:", 1) == std::string_view::npos);
  return none_or_zone ? fraction : -1;
}

/// "12:00:00.033", also without what separates the numbers where `compact`.
std::optional<double> seconds_of_day(Digits& digits, bool compact) {
  const std::string_view between = compact ? "" : ":-_.";
  const int hour = digits.take(2);
  if (!compact && !digits.take_one_of(between)) return std::nullopt;
  const int minute = digits.take(2);
  if (!compact && !digits.take_one_of(between)) return std::nullopt;
  const int second = digits.take(2);
  const double fraction = digits.ok() ? fraction_of(digits) : -1;
  if (fraction < 0 || hour > 23 || minute > 59 || second > 60) return std::nullopt;
  return 3600.0 * hour + 60.0 * minute + second + fraction;
}

}  // namespace

std::optional<double> calendar_seconds(std::string_view text) {
  constexpr int kFirstYear = 1970, kLastYear = 2200;
  constexpr double kDay_s = 86400;
  if (text.size() > 2 && text[2] == ':') {
    Digits time(text);
    return seconds_of_day(time, false);
  }
  Digits digits(text);
  const int year = digits.take(4);
  const bool separated = digits.take_one_of("-/_.");
  const int month = digits.take(2);
  if (separated && !digits.take_one_of("-/_.")) return std::nullopt;
  const int day = digits.take(2);
  if (!digits.ok() || year < kFirstYear || year > kLastYear) return std::nullopt;
  const bool gap = digits.take_one_of("T _-");
  if (separated && !gap) return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year(year),
                                         std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  if (!date.ok()) return std::nullopt;
  const bool compact = digits.rest().size() < 3 || is_digit(digits.rest()[2]);
  const auto time_s = seconds_of_day(digits, compact);
  if (!time_s) return std::nullopt;
  const auto days = std::chrono::sys_days(date).time_since_epoch().count();
  return kDay_s * static_cast<double>(days) + *time_s;
}

}  // namespace sgs::dataset
