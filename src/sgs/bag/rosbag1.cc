// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// ROS 1 bag format 2.0 (wiki.ros.org/Bags/Format/2.0): records "header length, header fields, data
// length, data"; the field "op" says what a record is.
#include <algorithm>
#include <optional>

#include "sgs/bag/bytes.h"
#include "sgs/bag/chunked_bag.h"
#include "sgs/core/text.h"

namespace sgs::bag {
namespace {

constexpr std::string_view kRosbagMagic = "#ROSBAG V2.0\n";
enum RosbagOp : std::uint8_t {
  kOpMessage = 2,
  kOpBagHeader = 3,
  kOpIndex = 4,
  kOpChunk = 5,
  kOpChunkInfo = 6,
  kOpConnection = 7,
};

/// A record's header: "length, name=value" for each field.
class RosbagHeader {
 public:
  explicit RosbagHeader(std::string_view bytes) : bytes_(bytes) {}

  /// Value of a field; empty if it is missing.
  std::string_view text(std::string_view name) const {
    Bytes in(bytes_);
    while (!in.empty()) {
      const std::string_view field = in.string();
      if (!in.ok()) break;
      if (field.size() > name.size() && field.starts_with(name) && field[name.size()] == '=') {
        return field.substr(name.size() + 1);
      }
    }
    return {};
  }
  template <class T>
  std::optional<T> number(std::string_view name) const {
    const std::string_view value = text(name);
    if (value.size() != sizeof(T)) return std::nullopt;
    return Bytes(value).number<T>();
  }
  /// Seconds and nanoseconds.
  std::optional<std::int64_t> time_ns(std::string_view name) const {
    const auto both = number<std::uint64_t>(name);
    if (!both) return both;
    return static_cast<std::int64_t>(*both & 0xffffffffu) * 1'000'000'000 +
           static_cast<std::int64_t>(*both >> 32);
  }
  std::uint8_t op() const { return number<std::uint8_t>("op").value_or(0); }

 private:
  std::string_view bytes_;
};

/// Where the parts of a record lie.
struct RosbagRecord {
  std::string header;
  std::uint64_t data_at = 0, data_bytes = 0;
  std::uint64_t next() const { return data_at + data_bytes; }
};

Result<RosbagRecord> read_rosbag_record(const RecordRange& range, std::uint64_t at) {
  constexpr std::uint64_t kLength = sizeof(std::uint32_t);
  RosbagRecord record;
  SGS_ASSIGN_OR_RETURN(const auto length_bytes, range.view(at, kLength));
  const std::uint64_t header_bytes = Bytes(length_bytes).number<std::uint32_t>();
  SGS_ASSIGN_OR_RETURN(const auto header, range.view(at + kLength, header_bytes + kLength));
  record.header = header.substr(0, header_bytes);
  record.data_at = at + 2 * kLength + header_bytes;
  record.data_bytes = Bytes(header.substr(header_bytes)).number<std::uint32_t>();
  SGS_RETURN_IF_ERROR(range.check(record.data_at, record.data_bytes));
  return record;
}

class Rosbag1 : public ChunkedBag {
 public:
  explicit Rosbag1(ByteFile file) : ChunkedBag(std::move(file)) { format_ = "ROS 1 bag"; }

  Status open() {
    const RecordRange all(&file_, 0, file_.size());
    const auto first = read_rosbag_record(all, kRosbagMagic.size());
    if (!first || RosbagHeader(first->header).op() != kOpBagHeader) {
      return fail(ErrorCode::kInvalidFormat,
                  fmt::format("{}: no bag header", file_.path().string()),
                  "the file is damaged or was cut off; copy or record it again");
    }
    const RosbagHeader header(first->header);
    if (const auto encryptor = header.text("encryptor"); !encryptor.empty()) {
      return fail(ErrorCode::kUnsupported,
                  fmt::format("{}: encrypted with {}", file_.path().string(),
                              printable(shortened(encryptor))),
                  "decrypt it first: rosbag decrypt FILE");
    }
    const auto index_at = header.number<std::uint64_t>("index_pos").value_or(0);
    const auto chunks = header.number<std::uint32_t>("chunk_count").value_or(0);
    if (index_at != 0 && read_index(index_at, chunks)) return {};
    return scan(first->next(),
                "no index (the recorder did not finish); read from the beginning. `rosbag reindex` "
                "writes one");
  }

 protected:
  Result<Record> parse(const RecordRange& range, std::uint64_t at) const override {
    SGS_ASSIGN_OR_RETURN(const RosbagRecord raw, read_rosbag_record(range, at));
    const RosbagHeader header(raw.header);
    Record record;
    record.data_at = raw.data_at;
    record.data_bytes = raw.data_bytes;
    record.next = raw.next();
    const std::uint8_t op = header.op();
    if (op == kOpMessage) {
      const auto id = header.number<std::uint32_t>("conn");
      const auto time = header.time_ns("time");
      if (!id || !time) return broken(range, at, "a message without connection or time");
      record.kind = Record::Kind::kMessage;
      record.id = *id;
      record.time_ns = *time;
    } else if (op == kOpConnection) {
      record.kind = Record::Kind::kChannel;
    } else if (op == kOpChunk) {
      record.kind = Record::Kind::kChunk;
      record.compression = header.text("compression");
      record.unpacked_bytes = header.number<std::uint32_t>("size").value_or(0);
    } else if (op < kOpMessage || op > kOpConnection) {
      return broken(range, at, fmt::format("unknown record {}", op));
    }
    return record;
  }

  Status declare(const RecordRange& range, std::uint64_t at) override {
    SGS_ASSIGN_OR_RETURN(const RosbagRecord raw, read_rosbag_record(range, at));
    const RosbagHeader header(raw.header);
    const auto id = header.number<std::uint32_t>("conn");
    const std::string topic(header.text("topic"));
    SGS_ASSIGN_OR_RETURN(const auto data, range.view(raw.data_at, raw.data_bytes));
    const std::string type(RosbagHeader(data).text("type"));
    if (!id || topic.empty()) {
      return broken(range, at, "a connection without number or topic");
    }
    channel_of_id_[*id] = channel_of(topic, type, Encoding::kRos1);
    return {};
  }

 private:
  /// Whether the index at the end could be read.
  bool read_index(std::uint64_t index_at, std::uint64_t chunks) {
    const RecordRange all(&file_, 0, file_.size());
    for (std::uint64_t at = index_at; at < file_.size();) {
      const auto record = read_rosbag_record(all, at);
      if (!record) return false;
      const std::uint8_t op = RosbagHeader(record->header).op();
      if (op == kOpConnection && !declare(all, at)) return false;
      if (op == kOpChunkInfo && !add_chunk(all, *record)) return false;
      if (op != kOpConnection && op != kOpChunkInfo) return false;
      at = record->next();
    }
    std::sort(segments_.begin(), segments_.end(),
              [](const Segment& a, const Segment& b) { return a.at < b.at; });
    return segments_.size() == chunks;
  }

  bool add_chunk(const RecordRange& all, const RosbagRecord& record) {
    const RosbagHeader header(record.header);
    const auto at = header.number<std::uint64_t>("chunk_pos");
    const auto first = header.time_ns("start_time"), last = header.time_ns("end_time");
    const auto data = all.view(record.data_at, record.data_bytes);
    if (!at || *at >= file_.size() || !first || !last || !data) return false;
    Segment segment{*at, 0, true, {}};
    Bytes counts(*data);
    while (!counts.empty()) {
      const auto id = counts.number<std::uint32_t>();
      const auto count = counts.number<std::uint32_t>();
      const auto channel = channel_of_id_.find(id);
      if (!counts.ok() || channel == channel_of_id_.end()) return false;
      segment.ids.push_back(id);
      Channel& to = channels_[channel->second];
      to.messages = to.messages.value_or(0) + count;
    }
    first_time_ns_ = std::min(first_time_ns_.value_or(*first), *first);
    last_time_ns_ = std::max(last_time_ns_.value_or(*last), *last);
    segments_.push_back(std::move(segment));
    return true;
  }
};

}  // namespace

Result<std::unique_ptr<Bag>> open_rosbag1(const std::filesystem::path& path) {
  SGS_ASSIGN_OR_RETURN(ByteFile file, ByteFile::open(path));
  const auto magic = file.view(0, std::min<std::uint64_t>(file.size(), kRosbagMagic.size()));
  if (!magic) return tl::unexpected(magic.error());
  if (*magic != kRosbagMagic) {
    const bool other = magic->starts_with("#ROSBAG") || magic->starts_with("#ROSRECORD");
    if (!other) return not_of_its_name(file, "a ROS 1 bag");
    return fail(ErrorCode::kUnsupported,
                fmt::format("{}: a bag of another version than 2.0", path.string()),
                fmt::format("convert it: rosbag fix {} NEW.bag", path.string()));
  }
  auto bag = std::make_unique<Rosbag1>(std::move(file));
  SGS_RETURN_IF_ERROR(bag->open());
  return bag;
}

}  // namespace sgs::bag
