// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "sgs/bag/bag.h"
#include "sgs/core/error.h"
#include "sgs/dataset/bags/bag_cameras.h"
#include "sgs/dataset/bags/bag_clock.h"
#include "sgs/dataset/bags/bag_pairs.h"
#include "sgs/dataset/bags/bag_topics.h"
#include "sgs/dataset/open.h"

namespace sgs::dataset {

/// Everything that was found out about a bag.
struct BagPlan {
  std::string name;
  BagTopics topics;
  BagCameras cameras;
  ClockChoice clock;
  double first_time_s = 0;    ///< of the first pair
  double median_depth_m = 0;  ///< of the first frame that has depth
  double max_difference_s = 0;
  std::int64_t first = 0, last = 0;
};

/// Finds out what is read of a bag, with which cameras, by which clock, and decodes frames until
/// one is fit to be judged. Errors: those of the parts; colour and depth that never come together
/// in time; depth that misses the picture, or whose unit cannot be right.
Result<BagPlan> plan_bag(const bag::Bag& bag, const std::filesystem::path& path,
                         const OpenOptions& options);

/// The pairs of colour and depth that the plan names.
BagPairs pairs_of(const bag::Bag& bag, const BagPlan& plan);

}  // namespace sgs::dataset
