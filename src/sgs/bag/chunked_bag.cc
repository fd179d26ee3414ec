// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/bag/chunked_bag.h"

#include <zlib.h>

#include <algorithm>

#include "sgs/bag/unpack.h"

namespace sgs::bag {
namespace {

constexpr std::size_t kChunksKept = 4;
/// Without an index, channels are looked for in this much of the recording.
constexpr std::uint64_t kLookedThrough_bytes = std::uint64_t{64} << 20;

std::uint32_t crc_of(std::string_view bytes) {
  uLong crc = ::crc32(0, nullptr, 0);
  while (!bytes.empty()) {
    const auto piece = bytes.substr(0, 1u << 30);
    crc =
        ::crc32(crc, reinterpret_cast<const Bytef*>(piece.data()), static_cast<uInt>(piece.size()));
    bytes.remove_prefix(piece.size());
  }
  return static_cast<std::uint32_t>(crc);
}

}  // namespace

Status RecordRange::check(std::uint64_t at, std::uint64_t bytes) const {
  if (at > size_ || bytes > size_ - at) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: a record of {} bytes goes beyond its end", place(at), bytes),
                "the file is damaged or was cut off; copy or record it again");
  }
  return {};
}

Result<std::string_view> RecordRange::view(std::uint64_t at, std::uint64_t bytes) const {
  SGS_RETURN_IF_ERROR(check(at, bytes));
  if (file_ != nullptr) return file_->view(begin_ + at, bytes);
  return std::string_view(*bytes_).substr(at, bytes);
}

std::string RecordRange::place(std::uint64_t at) const {
  if (file_ == nullptr) return fmt::format("byte {} of an unpacked chunk", at);
  return fmt::format("{}: byte {}", file_->path().string(), begin_ + at);
}

/// Goes through the segments that hold wanted channels.
class ChunkCursor : public Cursor {
 public:
  ChunkCursor(const ChunkedBag& bag, const std::vector<std::size_t>& channels)
      : bag_(bag), wanted_(bag.channels().size(), false) {
    for (const std::size_t channel : channels) wanted_.at(channel) = true;
  }

  Result<std::optional<Message>> next() override {
    while (true) {
      if (!open_) {
        while (segment_ < bag_.segments_.size() && !concerns(bag_.segments_[segment_])) ++segment_;
        if (segment_ == bag_.segments_.size()) return std::nullopt;
        SGS_ASSIGN_OR_RETURN(range_, bag_.open_segment(bag_.segments_[segment_++]));
        open_ = true;
        at_ = 0;
      }
      if (at_ >= range_.size()) {
        open_ = false;
        continue;
      }
      auto message = step();
      if (!message) {
        open_ = false;  // records behind a damaged one cannot be found; the next chunk can
        return tl::unexpected(message.error());
      }
      if (*message) return message;
    }
  }

 private:
  bool concerns(const ChunkedBag::Segment& segment) const {
    return !segment.ids_known || std::any_of(segment.ids.begin(), segment.ids.end(),
                                             [&](auto id) { return channel_of(id).has_value(); });
  }
  std::optional<std::size_t> channel_of(std::uint32_t id) const {
    const auto found = bag_.channel_of_id_.find(id);
    if (found == bag_.channel_of_id_.end() || !wanted_[found->second]) return std::nullopt;
    return found->second;
  }
  Result<std::optional<Message>> step() {
    SGS_ASSIGN_OR_RETURN(const ChunkedBag::Record record, bag_.parse(range_, at_));
    at_ = record.next;
    if (record.kind != ChunkedBag::Record::Kind::kMessage) return std::nullopt;
    const auto channel = channel_of(record.id);
    if (!channel) return std::nullopt;
    SGS_ASSIGN_OR_RETURN(const auto data, range_.view(record.data_at, record.data_bytes));
    SGS_ASSIGN_OR_RETURN(auto content, message_content(data, bag_.channels()[*channel].encoding));
    return Message{*channel, record.time_ns, std::move(content)};
  }

  const ChunkedBag& bag_;
  std::vector<bool> wanted_;
  std::size_t segment_ = 0;
  bool open_ = false;
  RecordRange range_;
  std::uint64_t at_ = 0;
};

std::unique_ptr<Cursor> ChunkedBag::read(const std::vector<std::size_t>& channels) const {
  return std::make_unique<ChunkCursor>(*this, channels);
}

Result<RecordRange> ChunkedBag::open_segment(const Segment& segment) const {
  if (segment.end != 0) return RecordRange(&file_, segment.at, segment.end - segment.at);
  SGS_ASSIGN_OR_RETURN(const Record chunk, parse(RecordRange(&file_, 0, file_.size()), segment.at));
  if (chunk.kind != Record::Kind::kChunk) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: the index names byte {}, where no chunk is", file_.path().string(),
                            segment.at),
                "the file is damaged; copy or record it again");
  }
  return open_chunk(chunk);
}

Result<RecordRange> ChunkedBag::open_chunk(const Record& chunk) const {
  // Plain chunks can be as large as the file: they are read where they lie.
  if (chunk.compression.empty() || chunk.compression == "none") {
    return RecordRange(&file_, chunk.data_at, chunk.data_bytes);
  }
  for (const auto& [at, bytes] : recent_chunks_) {
    if (at == chunk.data_at) return RecordRange(bytes);
  }
  SGS_ASSIGN_OR_RETURN(const auto packed, file_.view(chunk.data_at, chunk.data_bytes));
  auto unpacked = unpack(chunk.compression, packed, chunk.unpacked_bytes);
  if (unpacked && chunk.crc != 0 && crc_of(*unpacked) != chunk.crc) {
    unpacked = fail(ErrorCode::kInvalidFormat, "a chunk's checksum is wrong",
                    "copy or record the file again");
  }
  if (!unpacked) {
    Error error = std::move(unpacked.error());
    error.message =
        fmt::format("{}: byte {}: {}", file_.path().string(), chunk.data_at, error.message);
    return tl::unexpected<Error>(std::move(error));
  }
  auto bytes = std::make_shared<const std::string>(std::move(*unpacked));
  recent_chunks_.emplace_front(chunk.data_at, bytes);
  if (recent_chunks_.size() > kChunksKept) recent_chunks_.pop_back();
  return RecordRange(std::move(bytes));
}

tl::unexpected<Error> ChunkedBag::broken(const RecordRange& range, std::uint64_t at,
                                         const std::string& what) {
  return fail(ErrorCode::kInvalidFormat, fmt::format("{}: {}", range.place(at), what),
              "the file is damaged; copy or record it again");
}

Status ChunkedBag::scan(std::uint64_t begin, const char* why) {
  segments_.clear();
  channels_.clear();
  channel_of_id_.clear();
  first_time_ns_ = last_time_ns_ = std::nullopt;
  warnings_.push_back(fmt::format("{}: {}", file_.path().string(), why));
  const RecordRange all(&file_, 0, file_.size());
  std::uint64_t at = begin;
  while (at < file_.size()) {
    const auto record = parse(all, at);
    if (!record) {
      warnings_.push_back(
          fmt::format("{}: cut off or damaged at byte {} of {}; what lies before it is "
                      "read",
                      file_.path().string(), at, file_.size()));
      break;
    }
    using Kind = Record::Kind;
    if (record->kind == Kind::kChunk) {
      segments_.push_back({at, 0, false, {}});
    } else if (record->kind == Kind::kMessage || record->kind == Kind::kChannel) {
      const bool goes_on = !segments_.empty() && segments_.back().end == at;
      if (!goes_on) segments_.push_back({at, at, false, {}});
      segments_.back().end = record->next;
    }
    at = record->next;
  }
  return find_channels();
}

Status ChunkedBag::find_channels() {
  std::uint64_t looked = 0;
  for (const Segment& segment : segments_) {
    if (looked > kLookedThrough_bytes) break;
    const auto range = open_segment(segment);
    if (!range) {
      if (range.error().code == ErrorCode::kUnsupported) return tl::unexpected(range.error());
      continue;  // the cursor will say it
    }
    for (std::uint64_t at = 0; at < range->size() && at <= kLookedThrough_bytes;) {
      const auto record = parse(*range, at);
      if (!record) break;
      if (record->kind == Record::Kind::kChannel) SGS_RETURN_IF_ERROR(declare(*range, at));
      at = record->next;
    }
    looked += range->size();
  }
  return {};
}

}  // namespace sgs::bag
