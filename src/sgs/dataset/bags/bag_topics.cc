// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/bags/bag_topics.h"

#include <algorithm>
#include <set>

#include "sgs/bag/messages.h"
#include "sgs/bag/pictures.h"
#include "sgs/dataset/sdk_calibration.h"
#include "sgs/io/text.h"

namespace sgs::dataset {
namespace {

using bag::Bag;
using Kind = ImageTopic::Kind;

constexpr const char* kImageType = "sensor_msgs/Image";
constexpr const char* kCompressedImageType = "sensor_msgs/CompressedImage";
constexpr const char* kCameraInfoType = "sensor_msgs/CameraInfo";

bool has(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

bool is_image(const bag::Channel& channel) {
  return channel.encoding != bag::Encoding::kOther &&
         (channel.type == kImageType || channel.type == kCompressedImageType);
}

/// A topic without what image_transport appends.
std::string base_topic(const std::string& topic) {
  for (const std::string suffix : {"/compressedDepth", "/compressed"}) {
    if (topic.ends_with(suffix)) return topic.substr(0, topic.size() - suffix.size());
  }
  return topic;
}

Kind kind_of(const std::string& topic, const ImageTopic& image) {
  const std::string name = io::lower_case(topic);
  for (const char* other : {"infra", "/ir/", "/ir_", "confidence", "fisheye", "disparity"}) {
    if (has(name, other)) return Kind::kOther;
  }
  const bool named_depth = has(name, "depth");
  if (image.compressed) {
    if (has(image.encoding, "compressedDepth")) return Kind::kDepth;
    // A picture of depth as JPEG is none; as 16-bit PNG it is.
    if (named_depth) return has(image.encoding, "png") ? Kind::kDepth : Kind::kOther;
    return has(image.encoding, "mono8") ? Kind::kMono : Kind::kColor;
  }
  switch (bag::depth_encoding(image.encoding)) {
    case bag::DepthEncoding::kYes:
      return Kind::kDepth;
    case bag::DepthEncoding::kMaybe:
      return named_depth ? Kind::kDepth : Kind::kOther;
    case bag::DepthEncoding::kNo:
      break;
  }
  if (named_depth) return Kind::kOther;
  return image.encoding == "mono8" || image.encoding == "8UC1" ? Kind::kMono : Kind::kColor;
}

/// Empty when the topic has no message that can be read.
std::optional<ImageTopic> look_at(const Bag& bag, std::size_t channel) {
  const bag::Channel& about = bag.channels()[channel];
  const auto message = first_readable(bag, channel, [&](const bag::Message& m) {
    if (about.type == kCompressedImageType) {
      return bag::read_compressed_image(m, about.encoding).has_value();
    }
    const auto image = bag::read_image(m, about.encoding);
    return image && image->width > 0 && image->height > 0;
  });
  if (!message) return std::nullopt;
  ImageTopic image;
  image.channel = channel;
  image.compressed = about.type == kCompressedImageType;
  bag::Header header;
  if (image.compressed) {
    const auto content = bag::read_compressed_image(*message, about.encoding);
    if (!content) return std::nullopt;
    header = content->header;
    image.encoding = content->format;
  } else {
    const auto content = bag::read_image(*message, about.encoding);
    if (!content) return std::nullopt;
    header = content->header;
    image.encoding = content->encoding;
    image.width = static_cast<int>(content->width);
    image.height = static_cast<int>(content->height);
  }
  image.frame_id = header.frame_id;
  image.stamp_ns = header.stamp_ns;
  image.kind = kind_of(about.topic, image);
  return image;
}

std::vector<ImageTopic> image_topics(const Bag& bag) {
  std::vector<ImageTopic> images;
  for (std::size_t i = 0; i < bag.channels().size(); ++i) {
    if (!is_image(bag.channels()[i])) continue;
    if (auto image = look_at(bag, i)) images.push_back(std::move(*image));
  }
  return images;
}

const std::string& name_of(const Bag& bag, const ImageTopic& image) {
  return bag.channels()[image.channel].topic;
}

std::string listed(const Bag& bag, const std::vector<ImageTopic>& images) {
  std::string text;
  for (const ImageTopic& image : images) {
    text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", name_of(bag, image), image.encoding);
  }
  return text.empty() ? "none" : text;
}

std::vector<ImageTopic> of_kind(const std::vector<ImageTopic>& images, Kind kind) {
  std::vector<ImageTopic> result;
  std::copy_if(images.begin(), images.end(), std::back_inserter(result),
               [&](const ImageTopic& image) { return image.kind == kind; });
  return result;
}

/// Leaves out packed pictures of a camera whose raw ones are there, too: they may have lost
/// something.
std::vector<ImageTopic> without_packed_twins(const Bag& bag, std::vector<ImageTopic> images) {
  const auto has_raw_twin = [&](const ImageTopic& packed) {
    return packed.compressed &&
           std::any_of(images.begin(), images.end(), [&](const ImageTopic& raw) {
             return !raw.compressed && base_topic(name_of(bag, packed)) == name_of(bag, raw);
           });
  };
  std::vector<ImageTopic> result;
  std::copy_if(images.begin(), images.end(), std::back_inserter(result),
               [&](const ImageTopic& image) { return !has_raw_twin(image); });
  return result;
}

constexpr const char* kTopicsForm = "--topics color=/TOPIC,depth=/TOPIC";

/// The types of a recording without images: they say what was recorded in their place.
std::string types_of(const Bag& bag) {
  std::set<std::string> types;
  for (const bag::Channel& channel : bag.channels()) types.insert(channel.type);
  return types.empty() ? "nothing" : fmt::format("{}", fmt::join(types, ", "));
}

tl::unexpected<Error> none_of(const Bag& bag, const std::vector<ImageTopic>& all,
                              const char* what) {
  const std::string message =
      fmt::format("no {} topic was recognised; image topics: {}", what, listed(bag, all));
  if (all.empty()) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}; there are messages of {}", message, types_of(bag)),
                "record colour and depth as sensor_msgs/Image or CompressedImage (JPEG, PNG); "
                "videos (H.264, theora) and point clouds are not read");
  }
  std::string named_depth;
  for (const ImageTopic& image : all) {
    if (image.kind == Kind::kOther && has(io::lower_case(name_of(bag, image)), "depth")) {
      named_depth = fmt::format("; {} holds pictures for people ({}), no distances",
                                name_of(bag, image), image.encoding);
    }
  }
  if (what == std::string_view("depth") && !named_depth.empty()) {
    return fail(ErrorCode::kInvalidArgument, message + named_depth,
                "record depth as 16UC1 or 32FC1, as its camera delivers it");
  }
  return fail(ErrorCode::kInvalidArgument, message,
              fmt::format("choose with {}; if none of these is {}, record that topic, too",
                          kTopicsForm, what));
}

Result<ImageTopic> the_only(const Bag& bag, const std::vector<ImageTopic>& candidates,
                            const std::vector<ImageTopic>& all, const char* what) {
  if (candidates.size() == 1) return candidates.front();
  if (candidates.empty()) return none_of(bag, all, what);
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("{} {} topics: {}", candidates.size(), what, listed(bag, candidates)),
              fmt::format("choose one with {}", kTopicsForm));
}

Result<ImageTopic> guess_color(const Bag& bag, const std::vector<ImageTopic>& all) {
  auto candidates = without_packed_twins(bag, of_kind(all, Kind::kColor));
  if (candidates.empty()) candidates = without_packed_twins(bag, of_kind(all, Kind::kMono));
  return the_only(bag, candidates, all, "colour");
}

Result<ImageTopic> guess_depth(const Bag& bag, const std::vector<ImageTopic>& all) {
  const auto candidates = without_packed_twins(bag, of_kind(all, Kind::kDepth));
  std::vector<ImageTopic> registered;
  std::copy_if(candidates.begin(), candidates.end(), std::back_inserter(registered),
               [&](const ImageTopic& image) { return named_as_registered(name_of(bag, image)); });
  if (registered.size() == 1) return registered.front();
  return the_only(bag, candidates, all, "depth");
}

/// What --topics names.
struct TopicsOption {
  std::string color, depth, color_info, depth_info;
};

Result<TopicsOption> parse_topics(const std::string& text) {
  TopicsOption option;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    const std::string part = text.substr(at, end - at);
    const std::size_t equals = part.find('=');
    const std::string key = part.substr(0, equals);
    std::string* value = key == "color"        ? &option.color
                         : key == "depth"      ? &option.depth
                         : key == "color_info" ? &option.color_info
                         : key == "depth_info" ? &option.depth_info
                                               : nullptr;
    if (value == nullptr || equals == std::string::npos || equals + 1 == part.size()) {
      return fail(ErrorCode::kInvalidArgument, fmt::format("--topics '{}': '{}'", text, part),
                  fmt::format("write {}[,color_info=/TOPIC][,depth_info=/TOPIC]", kTopicsForm));
    }
    *value = part.substr(equals + 1);
    at = end + 1;
  }
  return option;
}

Result<ImageTopic> named_image(const Bag& bag, const std::vector<ImageTopic>& all,
                               const std::string& topic) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const ImageTopic& image) {
    return name_of(bag, image) == topic;
  });
  if (found != all.end()) return *found;
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("--topics: '{}' is no image topic with messages; there are {}", topic,
                          listed(bag, all)),
              "name one of these");
}

Result<std::size_t> named_info(const Bag& bag, const std::string& topic) {
  const auto found = find_channel(bag, topic, {kCameraInfoType});
  if (found) return *found;
  const std::string there = camera_info_topics(bag);
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("--topics: there is no {} with the name '{}'; there are: {}",
                          kCameraInfoType, topic, there),
              there == "none" ? "give --camera fx,fy,cx,cy" : "name one of these");
}

/// The camera info beside an image topic, or where an SDK puts it.
std::optional<std::size_t> info_beside(const Bag& bag, const std::string& image_topic) {
  const std::string base = base_topic(image_topic);
  const std::string parent = base.substr(0, base.rfind('/'));
  if (const auto found = find_channel(bag, parent + "/camera_info", {kCameraInfoType})) {
    return found;
  }
  return sdk_info_channel(bag, base);
}

/// The camera info that names the frame of these images, if only one does.
std::optional<std::size_t> only_info_of(const Bag& bag, const std::string& frame_id) {
  const auto all = camera_infos_of(bag, frame_id);
  return all.size() == 1 ? std::optional(all.front()) : std::nullopt;
}

}  // namespace

bool named_as_registered(const std::string& topic) {
  const std::string name = io::lower_case(topic);
  return has(name, "aligned_depth_to_color") || has(name, "registered") ||
         has(name, "depth_to_color") || has(name, "depth_to_rgb");
}

Result<std::optional<bag::Message>> first_message(const Bag& bag, std::size_t channel) {
  return bag.read({channel})->next();
}

std::optional<bag::Message> first_readable(const Bag& bag, std::size_t channel,
                                           const std::function<bool(const bag::Message&)>& fit) {
  constexpr std::size_t kTries = 20;
  const auto cursor = bag.read({channel});
  for (std::size_t i = 0; i < kTries; ++i) {
    auto message = cursor->next();
    if (message && !*message) break;
    if (message && fit(**message)) return std::move(**message);
  }
  return std::nullopt;
}

std::vector<std::size_t> camera_infos_of(const Bag& bag, const std::string& frame_id) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < bag.channels().size() && !frame_id.empty(); ++i) {
    const bag::Channel& channel = bag.channels()[i];
    if (channel.type != kCameraInfoType) continue;
    const auto message = first_message(bag, i);
    if (!message || !*message) continue;
    const auto header = bag::read_header(**message, channel.encoding);
    if (header && header->frame_id == frame_id) found.push_back(i);
  }
  return found;
}

std::string camera_info_topics(const Bag& bag) {
  std::string there;
  for (const bag::Channel& channel : bag.channels()) {
    if (channel.type == kCameraInfoType) there += (there.empty() ? "" : ", ") + channel.topic;
  }
  return there.empty() ? "none" : there;
}

std::optional<std::size_t> find_channel(const Bag& bag, const std::string& topic,
                                        const std::vector<std::string>& types) {
  for (std::size_t i = 0; i < bag.channels().size(); ++i) {
    const bag::Channel& channel = bag.channels()[i];
    if (channel.topic == topic &&
        std::find(types.begin(), types.end(), channel.type) != types.end()) {
      return i;
    }
  }
  return std::nullopt;
}

Result<BagTopics> choose_topics(const Bag& bag, const std::string& option) {
  SGS_ASSIGN_OR_RETURN(const TopicsOption named, parse_topics(option));
  const auto all = image_topics(bag);
  BagTopics topics;
  SGS_ASSIGN_OR_RETURN(topics.color, named.color.empty() ? guess_color(bag, all)
                                                         : named_image(bag, all, named.color));
  SGS_ASSIGN_OR_RETURN(topics.depth, named.depth.empty() ? guess_depth(bag, all)
                                                         : named_image(bag, all, named.depth));
  topics.color_info = info_beside(bag, name_of(bag, topics.color));
  topics.depth_info = info_beside(bag, name_of(bag, topics.depth));
  if (!topics.color_info && !topics.depth_info) {
    topics.color_info = only_info_of(bag, topics.color.frame_id);
    if (topics.depth.frame_id != topics.color.frame_id) {
      topics.depth_info = only_info_of(bag, topics.depth.frame_id);
    }
  }
  if (!named.color_info.empty()) {
    SGS_ASSIGN_OR_RETURN(topics.color_info, named_info(bag, named.color_info));
  }
  if (!named.depth_info.empty()) {
    SGS_ASSIGN_OR_RETURN(topics.depth_info, named_info(bag, named.depth_info));
  }
  return topics;
}

std::vector<TopicInfo> describe_topics(const Bag& bag) {
  double duration_s = 0;
  if (bag.first_time_ns() && bag.last_time_ns()) {
    duration_s = 1e-9 * static_cast<double>(*bag.last_time_ns() - *bag.first_time_ns());
  }
  std::vector<TopicInfo> topics;
  for (std::size_t i = 0; i < bag.channels().size(); ++i) {
    const bag::Channel& channel = bag.channels()[i];
    TopicInfo topic{channel.topic, channel.type, channel.messages, {}, ""};
    if (channel.messages && *channel.messages > 1 && duration_s > 0) {
      topic.rate_hz = static_cast<double>(*channel.messages - 1) / duration_s;
    }
    if (is_image(channel)) {
      if (const auto image = look_at(bag, i)) topic.encoding = image->encoding;
    }
    topics.push_back(std::move(topic));
  }
  std::sort(topics.begin(), topics.end(),
            [](const TopicInfo& a, const TopicInfo& b) { return a.topic < b.topic; });
  return topics;
}

}  // namespace sgs::dataset
