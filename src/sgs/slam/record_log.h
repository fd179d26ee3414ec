// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sgs/core/spill_file.h"
#include "sgs/slam/frame_record.h"

namespace sgs::slam {

/// What the present needs of a frame's record: few of its bytes.
struct FrameBrief {
  std::int64_t index = 0;
  double timestamp_s = 0;
  bool bad = false;
  bool tracked = false;  ///< neither bad nor lost
};

/// The records of a session's frames. A brief of each stays in memory; what else there is of it,
/// but for the newest frames, waits on the disk until somebody asks: a record is a kilobyte, and an
/// hour has a hundred thousand of them.
class RecordLog {
 public:
  /// Frames whose records lie on the disk together.
  static constexpr std::size_t kBlock = 64;

  /// `folder`: where the nameless file is made. Where that fails, all of it stays in memory, and
  /// the log warns once.
  explicit RecordLog(std::filesystem::path folder = SpillFile::default_folder())
      : folder_(std::move(folder)) {}

  /// Indices have to rise. The record stays valid until the next one is added.
  const FrameRecord& add(FrameRecord record);
  std::size_t size() const { return briefs_.size(); }
  bool empty() const { return briefs_.empty(); }
  /// The newest record; there has to be one.
  const FrameRecord& back() const { return newest_.back(); }
  const std::deque<FrameBrief>& briefs() const { return briefs_; }
  /// All records. Throws std::system_error where the disk does not give them back.
  std::vector<FrameRecord> all() const;

 private:
  /// Bytes of kBlock records: in the file, or here where there is none.
  struct Block {
    std::int64_t at = 0;
    std::size_t size = 0;
    std::string bytes;
  };
  void put_away();
  bool spill(Block& block);

  std::filesystem::path folder_;
  std::deque<FrameBrief> briefs_;
  std::vector<Block> blocks_;        // of the oldest frames
  std::vector<FrameRecord> newest_;  // those after them
  std::optional<SpillFile> file_;
  bool failed_ = false;
};

}  // namespace sgs::slam
