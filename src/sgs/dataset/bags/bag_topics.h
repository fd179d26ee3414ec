// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sgs/bag/bag.h"
#include "sgs/core/error.h"
#include "sgs/dataset/topic_info.h"

namespace sgs::dataset {

/// What the first message of an image topic says.
struct ImageTopic {
  std::size_t channel = 0;  ///< index into Bag::channels()
  bool compressed = false;  ///< sensor_msgs/CompressedImage
  std::string encoding;     ///< "rgb8", "16UC1", ...; the format of a compressed image
  std::string frame_id;
  int width = 0, height = 0;  ///< 0 for compressed images
  std::int64_t stamp_ns = 0;
  enum class Kind { kColor, kMono, kDepth, kOther } kind = Kind::kOther;
};

/// The topics that make a sequence.
struct BagTopics {
  ImageTopic color, depth;
  std::optional<std::size_t> color_info, depth_info;  ///< channels of sensor_msgs/CameraInfo
};

/// Chooses colour and depth. `option` is "color=/a,depth=/b[,color_info=/c][,depth_info=/d]", each
/// part optional. What it does not name is guessed: the only colour topic (grey ones where there is
/// none), the only depth topic, registered depth before other; raw before packed pictures of one
/// camera. Several or none are an error that lists what there is and names --topics.
Result<BagTopics> choose_topics(const bag::Bag& bag, const std::string& option);

/// All topics for a listing, in order of name.
std::vector<TopicInfo> describe_topics(const bag::Bag& bag);

/// The first message of a channel; empty if there is none.
Result<std::optional<bag::Message>> first_message(const bag::Bag& bag, std::size_t channel);

/// The first message of a channel that is fit to be read, among the first few; empty where none is.
std::optional<bag::Message> first_readable(const bag::Bag& bag, std::size_t channel,
                                           const std::function<bool(const bag::Message&)>& fit);

/// The channel of a topic with one of these types; empty if there is none.
std::optional<std::size_t> find_channel(const bag::Bag& bag, const std::string& topic,
                                        const std::vector<std::string>& types);

/// The channels of camera infos whose first message names a frame; none for an empty name.
std::vector<std::size_t> camera_infos_of(const bag::Bag& bag, const std::string& frame_id);

/// The topics of all camera infos, for messages; "none" where there are none.
std::string camera_info_topics(const bag::Bag& bag);

/// Whether a depth topic's name says that it is registered to colour.
bool named_as_registered(const std::string& topic);

}  // namespace sgs::dataset
