// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <dds/dds.h>

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sgs/core/error.h"

// ROS 2 without ROS: its topics are topics of DDS, whose names and types follow from its own.
namespace sgs::ros2 {

/// A topic that somebody publishes, in the words of ROS: "/camera/color/image_raw",
/// "sensor_msgs/msg/Image".
struct Offer {
  std::string topic, type;
  bool reliable = false;
  auto operator<=>(const Offer&) const = default;
};

/// The name of a topic of ROS in DDS, and back; empty: none of ROS.
std::string dds_topic(std::string_view ros_topic);
std::string ros_topic(std::string_view dds_topic);
/// The same of a type.
std::string ros_type(std::string_view dds_type);

/// How messages travel.
struct Quality {
  bool reliable = false;
  bool latched = false;  ///< who comes later gets the last ones, too (transient local)
  int depth = 10;        ///< messages that wait; 0: all, and the publisher waits
};

/// A participant in a domain. What it opens lives as long as it does. Thread-safe as DDS is.
class DdsNode {
 public:
  /// `domain`: as ROS_DOMAIN_ID; empty: what that says, else 0.
  static Result<std::unique_ptr<DdsNode>> open(const std::optional<int>& domain);
  ~DdsNode();
  DdsNode(const DdsNode&) = delete;
  DdsNode& operator=(const DdsNode&) = delete;

  int domain() const { return domain_; }
  dds_entity_t participant() const { return participant_; }
  /// What is published by others, by name.
  std::vector<Offer> offers() const;

  Result<dds_entity_t> reader(const dds_topic_descriptor_t& type, const std::string& topic,
                              const Quality& quality) const;
  Result<dds_entity_t> writer(const dds_topic_descriptor_t& type, const std::string& topic,
                              const Quality& quality) const;

 private:
  DdsNode(int domain, dds_entity_t participant, dds_entity_t publications)
      : domain_(domain), participant_(participant), publications_(publications) {}

  int domain_;
  dds_entity_t participant_, publications_;
};

/// Takes the messages of a reader one after the other, `most` at a time: a publisher that is faster
/// than `visit(const Message&)`, which may wait, must not keep the thread.
template <class Message, class Visit>
void take_all(dds_entity_t reader, Visit&& visit, int most = 1000) {
  void* sample = nullptr;
  dds_sample_info_t info{};
  while (most-- > 0 && dds_take(reader, &sample, &info, 1, 1) == 1) {
    if (info.valid_data) visit(*static_cast<const Message*>(sample));
    dds_return_loan(reader, &sample, 1);
    sample = nullptr;
  }
}

}  // namespace sgs::ros2
