// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "sgs/bag/bag.h"
#include "sgs/bag/message_writer.h"

namespace sgs::bag {

/// Makes a recording in memory: messages of a few topics in order of time, in one chunk that is not
/// packed, with an index. Meant for results, which are small beside the recordings they come from.
class BagWriter {
 public:
  virtual ~BagWriter() = default;
  virtual Encoding encoding() const = 0;
  /// Numbers count from 0.
  virtual std::size_t add_topic(const std::string& topic, WrittenType type) = 0;
  /// `message` is packed as encoding() says; times must not fall.
  virtual void write(std::size_t topic, std::int64_t time_ns, const std::string& message) = 0;
  /// The bytes of the file. Call it once, at the end. Fails where the messages are more than the
  /// format's one chunk can hold (4 GB in a ROS 1 bag).
  virtual Result<std::string> finish() = 0;
};

/// ROS 1 bag 2.0.
std::unique_ptr<BagWriter> make_rosbag1_writer();
/// MCAP with messages of ROS 2.
std::unique_ptr<BagWriter> make_mcap_writer();

}  // namespace sgs::bag
