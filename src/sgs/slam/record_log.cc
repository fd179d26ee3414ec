// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/record_log.h"

#include <utility>

#include "sgs/core/archive.h"
#include "sgs/core/log.h"
#include "sgs/geometry/archive_se3.h"

namespace sgs::slam {
namespace {

template <class Archive>
struct ArchiveColumn {
  Archive& archive;

  template <class T>
  void operator()(const FrameColumn&, T& field) const {
    archive(field);
  }
  void operator()(const FrameColumn&, StatusCell<FrameRecord> cell) const {
    archive(cell.record.status, cell.record.bad);
  }
};

/// All columns, and what is none.
template <class Archive>
void archive_record(Archive& a, FrameRecord& r) {
  visit_columns(r, ArchiveColumn<Archive>{a});
  a(r.bad_reason, r.T_online_camera, r.movers);
}

FrameBrief brief_of(const FrameRecord& r) {
  return {r.index, r.timestamp_s, r.bad, !r.bad && r.status != tracker::TrackingStatus::kLost};
}

}  // namespace

const FrameRecord& RecordLog::add(FrameRecord record) {
  if (newest_.size() == kBlock) put_away();
  newest_.reserve(kBlock);
  briefs_.push_back(brief_of(record));
  newest_.push_back(std::move(record));
  return newest_.back();
}

std::vector<FrameRecord> RecordLog::all() const {
  std::vector<FrameRecord> records;
  records.reserve(size());
  std::string read;
  for (const Block& block : blocks_) {
    if (block.bytes.empty()) {
      read.resize(block.size);
      file_->read(block.at, read.data(), block.size);
    }
    ArchiveReader archive(block.bytes.empty() ? read : block.bytes);
    for (std::size_t i = 0; i < kBlock; ++i) archive_record(archive, records.emplace_back());
    SGS_CHECK(archive.complete(), "records came back otherwise than they were put away");
  }
  records.insert(records.end(), newest_.begin(), newest_.end());
  for (std::size_t i = 0; i < records.size(); ++i) {
    records[i].index = briefs_[i].index;
    records[i].timestamp_s = briefs_[i].timestamp_s;
    records[i].bad = briefs_[i].bad;
  }
  return records;
}

void RecordLog::put_away() {
  ArchiveWriter archive;
  for (FrameRecord& record : newest_) archive_record(archive, record);
  Block block;
  block.bytes = archive.take();
  block.size = block.bytes.size();
  if (spill(block)) std::string().swap(block.bytes);  // assigning would keep its memory
  blocks_.push_back(
      std::move(block));  // the last thing that may fail: nothing is lost or twice there
  newest_.clear();
}

bool RecordLog::spill(Block& block) {
  if (failed_) return false;
  const auto write = [&]() -> Status {
    if (!file_) {
      SGS_ASSIGN_OR_RETURN(file_, SpillFile::create(folder_));
    }
    SGS_ASSIGN_OR_RETURN(block.at, file_->append(block.bytes.data(), block.size));
    return {};
  };
  const Status status = write();
  failed_ = !status;
  if (failed_) log().warn("records of frames stay in memory: {}", status.error().text());
  return status.has_value();
}

}  // namespace sgs::slam
