// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sgs/bag/bag.h"
#include "sgs/core/error.h"
#include "sgs/dataset/bags/bag_order.h"
#include "sgs/dataset/bags/bag_topics.h"
#include "sgs/dataset/open.h"

namespace sgs::dataset {

/// The clock whose times are taken, and why, in words.
struct ClockChoice {
  BagClock clock = BagClock::kStamp;
  std::string source;
  std::vector<std::string> warnings;
  double median_step_s = 0;  ///< between the first colour images; 0 = not known
};

/// Chooses the clock of a bag's images. Stamps are the cameras' own and are believed, unless the
/// option says otherwise, or the first images show that they tell nothing: all zero, or nearly all
/// the same. Stamps that go at another rate than the recorder's clock are believed with a warning.
/// Where neither clock tells the images apart, kInvalidFormat.
Result<ClockChoice> choose_clock(const bag::Bag& bag, const BagTopics& topics, Stamps option);

}  // namespace sgs::dataset
