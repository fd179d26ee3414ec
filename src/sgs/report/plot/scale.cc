// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/report/plot/scale.h"

#include <fmt/format.h>

#include <algorithm>

namespace sgs::report {
namespace {

std::string tick_text(double value, double step) {
  if (std::abs(value) < 1e-9 * step) value = 0;
  if (std::abs(value) >= 1e6) return fmt::format("{:.3g}M", value / 1e6);
  if (std::abs(value) >= 1e4) return fmt::format("{:g}k", value / 1e3);
  return fmt::format("{:.{}f}", value,
                     std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 6));
}

}  // namespace

void Interval::add(double v) {
  if (!std::isfinite(v)) return;
  min = std::min(min, v);
  max = std::max(max, v);
}

void Interval::pad(double share) {
  const double by = length() > 0 ? share * length() : std::max(1e-3, 0.1 * std::abs(min));
  min -= by;
  max += by;
}

std::vector<Tick> linear_ticks(const Interval& interval, int count) {
  if (interval.empty() || interval.length() <= 0) return {};
  const double raw = interval.length() / std::max(1, count);
  const double power = std::pow(10, std::floor(std::log10(raw))), m = raw / power;
  const double step = power * (m < 1.5 ? 1 : m < 3.5 ? 2 : m < 7.5 ? 5 : 10);
  std::vector<Tick> ticks;
  // Counted in whole steps, so that sums do not drift.
  const auto first = static_cast<long long>(std::ceil(interval.min / step - 1e-9));
  for (long long i = first; static_cast<double>(i) * step <= interval.max + 1e-9 * step; ++i) {
    const double at = static_cast<double>(i) * step;
    ticks.push_back({at, tick_text(at, step)});
  }
  return ticks;
}

std::vector<Tick> log_ticks(const Interval& interval) {
  if (interval.empty()) return {};
  const auto text = [](double value) {
    return value >= 1e-3 && value < 1e5 ? fmt::format("{:g}", value) : fmt::format("{:.0e}", value);
  };
  std::vector<Tick> ticks;
  if (interval.length() < 1.7) {
    for (double decade = std::floor(interval.min); decade <= interval.max; ++decade) {
      for (const double digit : {1.0, 2.0, 5.0}) {
        const double at = decade + std::log10(digit);
        if (at < interval.min - 1e-9 || at > interval.max + 1e-9) continue;
        ticks.push_back({at, text(digit * std::pow(10, decade))});
      }
    }
    return ticks;
  }
  const double step = std::max(1.0, std::ceil(interval.length() / 6));
  for (double t = std::ceil(interval.min / step - 1e-9) * step; t <= interval.max + 1e-9;
       t += step) {
    ticks.push_back({t, text(std::pow(10, t))});
  }
  return ticks;
}

std::string short_number(double value, int digits) {
  if (!std::isfinite(value)) return "n/a";
  if (std::abs(value) >= 1e6) return fmt::format("{:.{}g}M", value / 1e6, digits);
  if (std::abs(value) >= 1e4) return fmt::format("{:.{}g}k", value / 1e3, digits);
  if (std::abs(value) >= std::pow(10, digits)) return fmt::format("{:.0f}", value);
  return fmt::format("{:.{}g}", value, digits);
}

}  // namespace sgs::report
