// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// MCAP (mcap.dev/spec); mcap.cc reads it.
#include <zlib.h>

#include <vector>

#include "sgs/bag/bag_writer.h"
#include "sgs/bag/wire_writer.h"

namespace sgs::bag {
namespace {

constexpr std::string_view kWrittenMcapMagic("\x89MCAP0\r\n", 8);

enum WrittenOp : std::uint8_t {
  kHeaderOp = 0x01,
  kFooterOp = 0x02,
  kSchemaOp = 0x03,
  kChannelOp = 0x04,
  kMessageOp = 0x05,
  kChunkOp = 0x06,
  kMessageIndexOp = 0x07,
  kChunkIndexOp = 0x08,
  kStatisticsOp = 0x0B,
  kSummaryOffsetOp = 0x0E,
  kDataEndOp = 0x0F,
};

std::string mcap_record(WrittenOp op, std::string_view content) {
  std::string bytes =
      WireWriter().number(std::uint8_t{op}).number(std::uint64_t{content.size()}).data();
  return bytes.append(content);
}

std::uint32_t sum_of(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      ::crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

class McapWriter final : public BagWriter {
 public:
  Encoding encoding() const override { return Encoding::kCdr; }

  std::size_t add_topic(const std::string& topic, WrittenType type) override {
    const auto id = static_cast<std::uint16_t>(topics_.size());
    Topic added;
    // A schema of its own for each topic, numbered from 1: 0 means none.
    added.schema = mcap_record(kSchemaOp, WireWriter()
                                              .number(static_cast<std::uint16_t>(id + 1))
                                              .string(type_name(type, true))
                                              .string("ros2msg")
                                              .string(message_definition(type, true))
                                              .data());
    added.channel = mcap_record(kChannelOp, WireWriter()
                                                .number(id)
                                                .number(static_cast<std::uint16_t>(id + 1))
                                                .string(topic)
                                                .string("cdr")
                                                .count(0)  // metadata
                                                .data());
    chunk_ += added.schema + added.channel;
    topics_.push_back(std::move(added));
    return id;
  }

  void write(std::size_t topic, std::int64_t time_ns, const std::string& message) override {
    Topic& to = topics_[topic];
    const auto time = static_cast<std::uint64_t>(time_ns);
    to.index.number(time).number(std::uint64_t{chunk_.size()});
    std::string content = WireWriter()
                              .number(static_cast<std::uint16_t>(topic))
                              .number(static_cast<std::uint32_t>(to.messages))
                              .number(time)
                              .number(time)
                              .data();
    chunk_ += mcap_record(kMessageOp, content.append(message));
    if (messages_ == 0) first_ = time;
    last_ = time;
    ++to.messages;
    ++messages_;
  }

  Result<std::string> finish() override {
    std::string file(kWrittenMcapMagic);
    file += mcap_record(kHeaderOp, WireWriter().string("ros2").string("sgs").data());
    const std::uint64_t chunk_at = file.size();
    file += mcap_record(kChunkOp, WireWriter()
                                          .number(first_)
                                          .number(last_)
                                          .number(std::uint64_t{chunk_.size()})
                                          .number(sum_of(chunk_))
                                          .string("")
                                          .number(std::uint64_t{chunk_.size()})
                                          .data() +
                                      chunk_);
    const std::uint64_t chunk_bytes = file.size() - chunk_at;
    WireWriter places, counts;  // by channel: of its index, and of its messages
    const std::uint64_t indices_at = file.size();
    for (std::size_t id = 0; id < topics_.size(); ++id) {
      const auto channel = static_cast<std::uint16_t>(id);
      places.number(channel).number(std::uint64_t{file.size()});
      counts.number(channel).number(topics_[id].messages);
      file += mcap_record(kMessageIndexOp,
                          WireWriter().number(channel).bytes(topics_[id].index.data()).data());
    }
    const std::uint64_t index_bytes = file.size() - indices_at;
    file += mcap_record(kDataEndOp, WireWriter().number(std::uint32_t{0}).data());
    const std::string index = WireWriter()
                                  .number(first_)
                                  .number(last_)
                                  .number(chunk_at)
                                  .number(chunk_bytes)
                                  .bytes(places.data())
                                  .number(index_bytes)
                                  .string("")
                                  .number(std::uint64_t{chunk_.size()})
                                  .number(std::uint64_t{chunk_.size()})
                                  .data();
    append_summary(file, index, counts.data());
    return file.append(kWrittenMcapMagic);
  }

 private:
  struct Topic {
    std::string schema, channel;  // records
    WireWriter index;             // time and place of each message
    std::uint64_t messages = 0;
  };

  /// Everything once more, by kind, and where each kind stands.
  void append_summary(std::string& file, const std::string& chunk_index,
                      const std::string& counts) const {
    const std::uint64_t summary_at = file.size();
    std::string offsets;
    const auto group = [&](WrittenOp op, const std::string& records) {
      offsets += mcap_record(kSummaryOffsetOp, WireWriter()
                                                   .number(std::uint8_t{op})
                                                   .number(std::uint64_t{file.size()})
                                                   .number(std::uint64_t{records.size()})
                                                   .data());
      file += records;
    };
    std::string schemas, channels;
    for (const Topic& topic : topics_) {
      schemas += topic.schema;
      channels += topic.channel;
    }
    group(kSchemaOp, schemas);
    group(kChannelOp, channels);
    group(kStatisticsOp,
          mcap_record(kStatisticsOp, WireWriter()
                                         .number(messages_)
                                         .number(static_cast<std::uint16_t>(topics_.size()))
                                         .number(static_cast<std::uint32_t>(topics_.size()))
                                         .number(std::uint32_t{0})  // attachments
                                         .number(std::uint32_t{0})  // metadata
                                         .number(std::uint32_t{1})  // chunks
                                         .number(first_)
                                         .number(last_)
                                         .bytes(counts)
                                         .data()));
    group(kChunkIndexOp, mcap_record(kChunkIndexOp, chunk_index));
    const std::uint64_t offsets_at = file.size();
    file += offsets;
    file += mcap_record(kFooterOp, WireWriter()
                                       .number(summary_at)
                                       .number(offsets_at)
                                       .number(std::uint32_t{0})  // no sum of the summary
                                       .data());
  }

  std::vector<Topic> topics_;
  std::string chunk_;
  std::uint64_t messages_ = 0, first_ = 0, last_ = 0;
};

}  // namespace

std::unique_ptr<BagWriter> make_mcap_writer() { return std::make_unique<McapWriter>(); }

}  // namespace sgs::bag
