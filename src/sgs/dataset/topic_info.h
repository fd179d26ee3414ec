// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace sgs::dataset {

/// A topic of a bag, as `sgs info` shows it.
struct TopicInfo {
  std::string topic;
  std::string type;                       ///< "sensor_msgs/Image"
  std::optional<std::uint64_t> messages;  ///< empty where the file has no index
  std::optional<double> rate_hz;
  std::string encoding;  ///< of images
};

}  // namespace sgs::dataset
