// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// MCAP (mcap.dev/spec): records "opcode, 64-bit length, content"; messages lie in chunks, or
// between them.
#include <algorithm>

#include "sgs/bag/bytes.h"
#include "sgs/bag/chunked_bag.h"

namespace sgs::bag {
namespace {

constexpr std::string_view kMcapMagic("\x89MCAP0\r\n", 8);
constexpr std::uint64_t kMcapRecordHead = 9;  // opcode and length
enum McapOp : std::uint8_t {
  kMcapFooter = 0x02,
  kMcapSchema = 0x03,
  kMcapChannel = 0x04,
  kMcapMessage = 0x05,
  kMcapChunk = 0x06,
  kMcapChunkIndex = 0x08,
  kMcapStatistics = 0x0B,
  kMcapDataEnd = 0x0F,
};

Encoding encoding_of(std::string_view name) {
  if (name == "ros1") return Encoding::kRos1;
  return name == "cdr" ? Encoding::kCdr : Encoding::kOther;
}

class Mcap : public ChunkedBag {
 public:
  explicit Mcap(ByteFile file) : ChunkedBag(std::move(file)) { format_ = "MCAP"; }

  Status open() {
    if (read_summary()) return {};
    schemas_.clear();
    return scan(kMcapMagic.size(),
                "no index (the recorder did not finish, or left it out); read from the beginning. "
                "`mcap recover` writes one");
  }

 protected:
  Result<Record> parse(const RecordRange& range, std::uint64_t at) const override {
    // The magic at the end of the file is no record.
    if (range.size() - at == kMcapMagic.size() && is_magic(range, at)) {
      Record end;
      end.next = range.size();
      return end;
    }
    SGS_ASSIGN_OR_RETURN(const auto head, range.view(at, kMcapRecordHead));
    Bytes in(head);
    const auto op = in.number<std::uint8_t>();
    const auto bytes = in.number<std::uint64_t>();
    const std::uint64_t content = at + kMcapRecordHead;
    SGS_RETURN_IF_ERROR(range.check(content, bytes));
    Record record;
    record.data_at = content;
    record.data_bytes = bytes;
    record.next = content + bytes;
    if (op == kMcapSchema || op == kMcapChannel) record.kind = Record::Kind::kChannel;
    if (op == kMcapMessage) return parse_message(range, record);
    if (op == kMcapChunk) return parse_chunk(range, record);
    if (op == 0) return broken(range, at, "a record of kind 0");
    return record;
  }

  Status declare(const RecordRange& range, std::uint64_t at) override {
    SGS_ASSIGN_OR_RETURN(const Record record, parse(range, at));
    SGS_ASSIGN_OR_RETURN(const auto head, range.view(at, 1));
    const bool is_schema = head[0] == kMcapSchema;
    SGS_ASSIGN_OR_RETURN(const auto content, range.view(record.data_at, record.data_bytes));
    Bytes in(content);
    const auto id = in.number<std::uint16_t>();
    if (is_schema) {
      schemas_[id] = in.string();
    } else {
      const auto schema = in.number<std::uint16_t>();
      const std::string topic(in.string());
      const Encoding encoding = encoding_of(in.string());
      if (in.ok()) channel_of_id_[id] = channel_of(topic, schemas_[schema], encoding);
    }
    return in.ok() ? Status{} : broken(range, at, "a channel or schema that is too short");
  }

 private:
  static bool is_magic(const RecordRange& range, std::uint64_t at) {
    const auto bytes = range.view(at, kMcapMagic.size());
    return bytes && *bytes == kMcapMagic;
  }

  static Result<Record> parse_message(const RecordRange& range, Record record) {
    constexpr std::uint64_t kHead = 2 + 4 + 8 + 8;  // channel, sequence, log and publish time
    if (record.data_bytes < kHead) return broken(range, record.data_at, "a message too short");
    SGS_ASSIGN_OR_RETURN(const auto head, range.view(record.data_at, kHead));
    Bytes in(head);
    record.kind = Record::Kind::kMessage;
    record.id = in.number<std::uint16_t>();
    in.number<std::uint32_t>();
    record.time_ns = static_cast<std::int64_t>(in.number<std::uint64_t>());
    record.data_at += kHead;
    record.data_bytes -= kHead;
    return record;
  }

  static Result<Record> parse_chunk(const RecordRange& range, Record record) {
    constexpr std::uint64_t kHead =
        8 + 8 + 8 + 4 + 4;  // up to the length of the compression's name
    constexpr std::uint64_t kLongestName = 64;
    SGS_ASSIGN_OR_RETURN(
        const auto head,
        range.view(record.data_at, std::min(record.data_bytes, kHead + kLongestName + 8)));
    Bytes in(head);
    in.piece(16);
    record.kind = Record::Kind::kChunk;
    record.unpacked_bytes = in.number<std::uint64_t>();
    record.crc = in.number<std::uint32_t>();
    record.compression = in.string();
    const auto packed = in.number<std::uint64_t>();
    if (!in.ok() || packed > record.data_bytes - in.position()) {
      return broken(range, record.data_at, "a chunk that does not fit its record");
    }
    record.data_at += in.position();
    record.data_bytes = packed;
    return record;
  }

  /// Whether the summary at the end could be read and lists all chunks.
  bool read_summary() {
    constexpr std::uint64_t kFooterBytes = 8 + 8 + 4;
    const std::uint64_t tail = kMcapRecordHead + kFooterBytes + kMcapMagic.size();
    if (file_.size() < tail + kMcapMagic.size()) return false;
    const std::uint64_t footer_at = file_.size() - tail;
    const RecordRange all(&file_, 0, file_.size());
    if (!is_magic(all, file_.size() - kMcapMagic.size())) return false;
    const auto footer = all.view(footer_at, kMcapRecordHead + kFooterBytes);
    if (!footer || (*footer)[0] != kMcapFooter) return false;
    const auto begin = Bytes(footer->substr(kMcapRecordHead)).number<std::uint64_t>();
    if (begin == 0 || begin >= footer_at) return false;
    for (std::uint64_t at = begin; at < footer_at;) {
      const auto record = parse(all, at);
      if (!record || record->next > footer_at || !add_summary(all, at, *record)) return false;
      at = record->next;
    }
    // The channels may stand behind the statistics.
    for (Channel& channel : channels_) channel.messages = 0;
    for (const auto& [id, count] : counts_) {
      const auto channel = channel_of_id_.find(id);
      if (channel != channel_of_id_.end()) *channels_[channel->second].messages += count;
    }
    const std::uint64_t listed = segments_.size();
    if (!statistics_ || chunk_count_ != listed) return false;
    // Messages outside chunks are in no index.
    if (listed == 0) segments_.push_back({kMcapMagic.size(), begin, false, {}});
    std::sort(segments_.begin(), segments_.end(),
              [](const Segment& a, const Segment& b) { return a.at < b.at; });
    return true;
  }

  bool add_summary(const RecordRange& all, std::uint64_t at, const Record& record) {
    const auto op = static_cast<std::uint8_t>(all.view(at, 1).value_or("\0")[0]);
    if (record.kind == Record::Kind::kChannel) return declare(all, at).has_value();
    const auto content = all.view(record.data_at, record.data_bytes);
    if (!content) return false;
    if (op == kMcapChunkIndex) return add_chunk(*content);
    if (op == kMcapStatistics) return add_statistics(*content);
    return true;
  }

  bool add_chunk(std::string_view content) {
    Bytes in(content);
    in.piece(16);  // times
    Segment segment{in.number<std::uint64_t>(), 0, false, {}};
    in.number<std::uint64_t>();
    Bytes offsets(in.string());
    while (!offsets.empty()) {
      segment.ids.push_back(offsets.number<std::uint16_t>());
      offsets.number<std::uint64_t>();
      if (!offsets.ok()) return false;
    }
    segment.ids_known = !segment.ids.empty();
    segments_.push_back(std::move(segment));
    return in.ok();
  }

  bool add_statistics(std::string_view content) {
    Bytes in(content);
    const auto messages = in.number<std::uint64_t>();
    in.piece(2 + 4 + 4 + 4);  // schemas, channels, attachments, metadata
    chunk_count_ = in.number<std::uint32_t>();
    const auto first = in.number<std::uint64_t>(), last = in.number<std::uint64_t>();
    if (messages > 0) {
      first_time_ns_ = static_cast<std::int64_t>(first);
      last_time_ns_ = static_cast<std::int64_t>(last);
    }
    Bytes counts(in.string());
    while (!counts.empty() && counts.ok()) {
      const auto id = counts.number<std::uint16_t>();
      counts_[id] = counts.number<std::uint64_t>();
    }
    if (!counts.ok()) return false;
    statistics_ = in.ok();
    return statistics_;
  }

  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, std::uint64_t> counts_;
  bool statistics_ = false;
  std::uint64_t chunk_count_ = 0;
};

}  // namespace

Result<std::unique_ptr<Bag>> open_mcap(const std::filesystem::path& path) {
  SGS_ASSIGN_OR_RETURN(ByteFile file, ByteFile::open(path));
  const auto magic = file.view(0, std::min<std::uint64_t>(file.size(), kMcapMagic.size()));
  if (!magic) return tl::unexpected(magic.error());
  if (*magic != kMcapMagic) {
    return not_of_its_name(file, "an MCAP file");
  }
  auto bag = std::make_unique<Mcap>(std::move(file));
  SGS_RETURN_IF_ERROR(bag->open());
  return bag;
}

}  // namespace sgs::bag
