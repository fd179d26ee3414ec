// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/dataset/open.h"
#include "sgs/dataset/topic_info.h"

namespace sgs::dataset {

/// Opens a bag (see bag/bag.h) as a sequence: topics and calibration are looked for
/// (choose_topics(), find_bag_cameras()), the first usable frame is decoded to check sizes and the
/// depth's unit. Frames are read and decoded one by one, paired by header stamp (bag_clock.h). The
/// input may be several files of one recording (OpenOptions::more_files). Errors beside
/// those of the parts: colour and depth that never come together in time, depth that misses the
/// picture, a median depth outside 0.05 to 20 m (an unknown unit is refused, not guessed).
Result<Sequence> open_bag_sequence(const std::filesystem::path& path, const OpenOptions& options);

/// The topics of a bag, and what had to be put right to read it.
struct BagDescription {
  std::string format;
  std::vector<TopicInfo> topics;
  std::vector<std::string> warnings;
};
Result<BagDescription> describe_bag(const std::filesystem::path& path, const OpenOptions& options);

}  // namespace sgs::dataset
