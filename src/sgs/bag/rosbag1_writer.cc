// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// ROS 1 bag format 2.0 (wiki.ros.org/Bags/Format/2.0); rosbag1.cc reads it.
#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "sgs/bag/bag_writer.h"
#include "sgs/bag/wire_writer.h"

namespace sgs::bag {
namespace {

constexpr std::string_view kWrittenMagic = "#ROSBAG V2.0\n";
constexpr std::uint32_t kIndexVersion = 1;

template <class T>
std::string raw(T value) {
  return WireWriter().number(value).data();
}

/// Seconds, then nanoseconds.
std::string ros_time(std::int64_t time_ns) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  return raw(static_cast<std::uint32_t>(time_ns / kSecond)) +
         raw(static_cast<std::uint32_t>(time_ns % kSecond));
}

using Fields = std::vector<std::pair<std::string_view, std::string>>;

/// "length name=value" for each.
std::string fields_text(const Fields& fields) {
  WireWriter out;
  for (const auto& [name, value] : fields) out.string(std::string(name) + "=" + value);
  return out.data();
}

std::string written_record(std::uint8_t op, Fields fields, std::string_view data) {
  fields.emplace_back("op", raw(op));
  return WireWriter().string(fields_text(fields)).string(data).data();
}

class Rosbag1Writer final : public BagWriter {
 public:
  Encoding encoding() const override { return Encoding::kRos1; }

  std::size_t add_topic(const std::string& topic, WrittenType type) override {
    const auto id = static_cast<std::uint32_t>(topics_.size());
    Fields about = {{"topic", topic},
                    {"type", type_name(type, false)},
                    {"md5sum", std::string(message_md5(type))},
                    {"message_definition", message_definition(type, false)}};
    // Of what comes only once, who comes late still gets it.
    const bool once = type == WrittenType::kPath || type == WrittenType::kCloud;
    if (once) about.emplace_back("latching", "1");
    topics_.push_back(
        {written_record(7, {{"conn", raw(id)}, {"topic", topic}}, fields_text(about)), {}, 0});
    chunk_ += topics_.back().connection;
    return id;
  }

  void write(std::size_t topic, std::int64_t time_ns, const std::string& message) override {
    Topic& to = topics_[topic];
    to.index += ros_time(time_ns) + raw(static_cast<std::uint32_t>(chunk_.size()));
    ++to.messages;
    chunk_ += written_record(
        2, {{"conn", raw(static_cast<std::uint32_t>(topic))}, {"time", ros_time(time_ns)}},
        message);
    if (first_ns_ < 0) first_ns_ = time_ns;
    last_ns_ = time_ns;
  }

  Result<std::string> finish() override {
    if (chunk_.size() > std::numeric_limits<std::uint32_t>::max()) {
      return fail(ErrorCode::kUnsupported, "too much for a ROS 1 bag (4 GB)", "write MCAP instead");
    }
    constexpr std::size_t kHeaderRecord = 4096;
    const std::size_t chunk_at = kWrittenMagic.size() + kHeaderRecord;
    std::string body = written_record(
        5, {{"compression", "none"}, {"size", raw(static_cast<std::uint32_t>(chunk_.size()))}},
        chunk_);
    std::string counts, connections;
    for (std::size_t id = 0; id < topics_.size(); ++id) {
      const Topic& topic = topics_[id];
      const std::string number = raw(static_cast<std::uint32_t>(id));
      connections += topic.connection;
      if (topic.messages == 0) continue;
      counts += number + raw(topic.messages);
      body += written_record(
          4, {{"ver", raw(kIndexVersion)}, {"conn", number}, {"count", raw(topic.messages)}},
          topic.index);
    }
    const std::uint64_t index_at = chunk_at + body.size();
    body += connections;
    body += written_record(6,
                           {{"ver", raw(kIndexVersion)},
                            {"chunk_pos", raw(std::uint64_t{chunk_at})},
                            {"start_time", ros_time(std::max<std::int64_t>(first_ns_, 0))},
                            {"end_time", ros_time(last_ns_)},
                            {"count", raw(static_cast<std::uint32_t>(counts.size() / 8))}},
                           counts);
    const Fields header = {{"index_pos", raw(index_at)},
                           {"conn_count", raw(static_cast<std::uint32_t>(topics_.size()))},
                           {"chunk_count", raw(std::uint32_t{1})}};
    // Padded, so that a recorder can write it again when it knows the numbers.
    const std::size_t bare = written_record(3, header, "").size();
    return std::string(kWrittenMagic) +
           written_record(3, header, std::string(kHeaderRecord - bare, ' ')) + body;
  }

 private:
  struct Topic {
    std::string connection;  // record
    std::string index;       // time and place of each message
    std::uint32_t messages = 0;
  };
  std::vector<Topic> topics_;
  std::string chunk_;
  std::int64_t first_ns_ = -1, last_ns_ = 0;
};

}  // namespace

std::unique_ptr<BagWriter> make_rosbag1_writer() { return std::make_unique<Rosbag1Writer>(); }

}  // namespace sgs::bag
