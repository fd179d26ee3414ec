// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sgs/core/error.h"

namespace sgs::bag {

/// How the fields of a message are packed.
enum class Encoding {
  kRos1,   ///< little-endian, without padding
  kCdr,    ///< OMG CDR with a four-byte header, as ROS 2 writes it
  kOther,  ///< protobuf, JSON, ...: not read
};

/// One topic of a recording. A topic that several publishers or files share is one channel.
struct Channel {
  std::string topic;
  std::string type;  ///< "sensor_msgs/Image"; the "msg" part of ROS 2 names is left out
  Encoding encoding = Encoding::kOther;
  std::optional<std::uint64_t> messages;  ///< as the file's index says; empty without an index
};

/// A recorded message.
struct Message {
  std::size_t channel = 0;          ///< index into Bag::channels()
  std::int64_t record_time_ns = 0;  ///< when it was written; not when the camera saw anything
  std::string data;
};

/// Reads the messages of some channels in the order of the file. Not thread-safe.
class Cursor {
 public:
  virtual ~Cursor() = default;
  /// The next message, or nothing at the end. An error says what is damaged; after it the cursor
  /// goes on behind the damage where that can be found, else it is at its end.
  virtual Result<std::optional<Message>> next() = 0;
};

/// An open recording. Only its index is held in memory; messages are read when a cursor gets to
/// them. All cursors of a bag, and the bag, belong to one thread at a time.
class Bag {
 public:
  virtual ~Bag() = default;

  const std::string& format() const { return format_; }  ///< "ROS 1 bag", "MCAP", ...
  const std::vector<Channel>& channels() const { return channels_; }
  /// What had to be put right: no index, a truncated end, ...
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// Record times of the first and the last message; empty without an index.
  std::optional<std::int64_t> first_time_ns() const { return first_time_ns_; }
  std::optional<std::int64_t> last_time_ns() const { return last_time_ns_; }

  /// A cursor at the first message of `channels` (indices into channels()). The bag must outlive
  /// it.
  virtual std::unique_ptr<Cursor> read(const std::vector<std::size_t>& channels) const = 0;

 protected:
  /// The channel of a topic, added where it is new.
  std::size_t channel_of(const std::string& name, const std::string& type, Encoding encoding);

  std::string format_;
  std::vector<Channel> channels_;
  std::vector<std::string> warnings_;
  std::optional<std::int64_t> first_time_ns_, last_time_ns_;
};

/// Whether a path is a recording that open_bag() is meant for: a file named .bag, .mcap, .db3 or
/// .mkv (in capitals, too, or packed as a whole: .db3.zstd) or of another name that begins as these
/// do, or a folder with the metadata.yaml of rosbag2.
bool looks_like_bag(const std::filesystem::path& path);

/// The recordings in a folder, by name, of .mkv those of cameras only; not those below it.
std::vector<std::filesystem::path> bag_files(const std::filesystem::path& folder);

/// Opens a ROS 1 bag 2.0 (chunks none, bz2, lz4), an MCAP file (none, lz4, zstd), a ROS 2 SQLite
/// file, a rosbag2 folder of either, a recording of an Azure Kinect (.mkv), or a folder of such
/// files, which are one recording (open_bags()). Files without an index, or cut off, are read as
/// far as they go. Errors: kNotFound, kInvalidFormat, kUnsupported (encryption, other versions and
/// compressions).
Result<std::unique_ptr<Bag>> open_bag(const std::filesystem::path& path);

/// Opens the files of one recording, or folders of them, which recorders split by size or time, as
/// one: in order of their times where their indices tell them, else of their names. Refuses files
/// of several kinds and those that cover the same time with the same topics.
Result<std::unique_ptr<Bag>> open_bags(const std::vector<std::filesystem::path>& paths);

}  // namespace sgs::bag
