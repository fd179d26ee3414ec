// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sgs/bag/bag.h"
#include "sgs/bag/byte_file.h"

namespace sgs::bag {

/// Consecutive records: a part of a file, or the content of an unpacked chunk.
class RecordRange {
 public:
  RecordRange() = default;
  RecordRange(ByteFile* file, std::uint64_t begin, std::uint64_t size)
      : file_(file), begin_(begin), size_(size) {}
  explicit RecordRange(std::shared_ptr<const std::string> bytes)
      : bytes_(std::move(bytes)), size_(bytes_->size()) {}

  std::uint64_t size() const { return size_; }
  /// Bytes [at, at + bytes) of the range; valid until the next call.
  Result<std::string_view> view(std::uint64_t at, std::uint64_t bytes) const;
  /// Whether these bytes lie in the range, without reading them.
  Status check(std::uint64_t at, std::uint64_t bytes) const;
  /// For messages: "FILE: byte N".
  std::string place(std::uint64_t at) const;

 private:
  ByteFile* file_ = nullptr;
  std::shared_ptr<const std::string> bytes_;
  std::uint64_t begin_ = 0, size_ = 0;
};

/// What ROS 1 bags and MCAP files have in common: records, many of them in packed chunks, and an
/// index at the end that may be missing. A format says how its records look.
class ChunkedBag : public Bag {
 public:
  std::unique_ptr<Cursor> read(const std::vector<std::size_t>& channels) const override;

  /// A record as far as it concerns every format.
  struct Record {
    enum class Kind { kMessage, kChannel, kChunk, kOther } kind = Kind::kOther;
    std::uint32_t id = 0;      ///< of the message's channel, as the file numbers it
    std::int64_t time_ns = 0;  ///< of a message
    std::uint64_t data_at = 0, data_bytes = 0;  ///< the message, or the packed chunk, in its range
    std::uint64_t next = 0;                     ///< where the following record begins
    std::string compression;                    ///< of a chunk
    std::uint64_t unpacked_bytes = 0;
    std::uint32_t crc = 0;  ///< of the unpacked chunk; 0 = not given
  };

 protected:
  /// A chunk, or records that lie in no chunk.
  struct Segment {
    std::uint64_t at = 0;    ///< of the chunk's record, or of the first loose record
    std::uint64_t end = 0;   ///< of loose records; 0 = this is a chunk
    bool ids_known = false;  ///< `ids` are all channels in it
    std::vector<std::uint32_t> ids;
  };

  explicit ChunkedBag(ByteFile file) : file_(std::move(file)) {}

  /// Understands the record at `at` of a range; its data need not be read for that.
  virtual Result<Record> parse(const RecordRange& range, std::uint64_t at) const = 0;
  /// Takes note of the channel that a record declares.
  virtual Status declare(const RecordRange& range, std::uint64_t at) = 0;

  /// Reads a file without its index: forgets what that said, lists the segments from `begin` to
  /// where the file can be understood, and looks for channels in the first of them. Adds warnings,
  /// `why` first.
  Status scan(std::uint64_t begin, const char* why);
  /// The error of a record that makes no sense.
  static tl::unexpected<Error> broken(const RecordRange& range, std::uint64_t at,
                                      const std::string& what);

  mutable ByteFile file_;
  std::vector<Segment> segments_;
  std::map<std::uint32_t, std::size_t> channel_of_id_;

 private:
  friend class ChunkCursor;
  Result<RecordRange> open_segment(const Segment& segment) const;
  Result<RecordRange> open_chunk(const Record& chunk) const;
  Status find_channels();

  /// Cursors of one frame's topics are mostly in the same chunk.
  mutable std::deque<std::pair<std::uint64_t, std::shared_ptr<const std::string>>> recent_chunks_;
};

Result<std::unique_ptr<Bag>> open_rosbag1(const std::filesystem::path& path);
Result<std::unique_ptr<Bag>> open_mcap(const std::filesystem::path& path);
Result<std::unique_ptr<Bag>> open_db3(const std::filesystem::path& path);
/// A recording of an Azure Kinect. Its tracks are topics: /color/image, /depth/image, /imu; its
/// calibration is their camera infos and /tf_static. What is wrong with that is the error of their
/// messages, so that who gives another one needs it not.
Result<std::unique_ptr<Bag>> open_kinect(const std::filesystem::path& path);
/// Whether a file begins as one: Matroska, with the tracks of that camera.
bool is_kinect_recording(const std::filesystem::path& path);
/// Several files as one recording, in the given order (not empty). `warnings` come before those of
/// the files.
std::unique_ptr<Bag> join_bags(std::vector<std::unique_ptr<Bag>> parts,
                               std::vector<std::string> warnings = {});

}  // namespace sgs::bag
