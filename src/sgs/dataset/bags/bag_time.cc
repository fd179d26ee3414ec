// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/bags/bag_time.h"

#include <fmt/format.h>

#include <charconv>

namespace sgs::dataset {

double seconds_of(std::int64_t nanoseconds) {
  // A product with 1e-9 would be rounded twice and differ from a list of times in its last bit.
  constexpr std::int64_t kPerSecond = 1'000'000'000;
  const bool negative = nanoseconds < 0;
  const auto magnitude = negative ? 0 - static_cast<std::uint64_t>(nanoseconds)
                                  : static_cast<std::uint64_t>(nanoseconds);
  const std::string text = fmt::format("{}{}.{:09}", negative ? "-" : "", magnitude / kPerSecond,
                                       magnitude % kPerSecond);
  double seconds = 0;
  std::from_chars(text.data(), text.data() + text.size(), seconds);
  return seconds;
}

}  // namespace sgs::dataset
