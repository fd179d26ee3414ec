// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "sgs/io/append_file.h"
#include "sgs/runfolder/folder_lock.h"
#include "sgs/runfolder/run_folder.h"
#include "sgs/slam/frame_record.h"

namespace sgs::run {

/// First line of a trajectory.txt that holds poses as the tracker said them, frame by frame. They
/// lie in the tracker's world; keyframes.txt carries them into that of the map
/// (slam/keyframe_pose.h). A finished run's trajectory.txt has no such line.
inline constexpr std::string_view kOnlinePoses =
    "# poses as tracked, before the refinement of keyframes; the run is not finished\n";

/// Keeps frames.csv and trajectory.txt of a run that is going on: what happened to a frame is on
/// the disk half a second later, whatever becomes of the program or the power. It only ever
/// appends. Both files are replaced when the run has finished.
class Journal {
 public:
  /// `opening` are the files that a run begins with: they are written again with the journal where
  /// the folder is removed in the meantime.
  Journal(std::shared_ptr<FolderLock> lock, std::vector<NamedWriter> opening);
  /// Goes on with the journal of a run that was killed or interrupted. Its frames come again, from
  /// the first one on; those that are there already are not written twice, and none of them is gone
  /// at any moment.
  static std::unique_ptr<Journal> resume(std::shared_ptr<FolderLock> lock,
                                         std::vector<NamedWriter> opening);
  /// Writes what is left.
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Notes a frame. Never waits for the disk and never fails: a disk that is full is a warning, and
  /// what did not fit is written when there is room again.
  void add(const slam::FrameRecord& record);

 private:
  /// A file of the journal, and how many of its lines are there from before.
  struct Lines {
    explicit Lines(io::AppendFile appended, std::size_t lines = 0)
        : file(std::move(appended)), known(lines) {}
    void hold(const std::string& line);

    io::AppendFile file;
    std::size_t known;
  };
  Journal(std::shared_ptr<FolderLock> lock, std::vector<NamedWriter> opening, Lines frames,
          Lines poses);
  static Lines new_lines(const std::filesystem::path& path, std::string_view head);
  static Lines lines_of(const std::filesystem::path& path, std::string_view head);

  void loop();
  void write(const std::vector<slam::FrameRecord>& records);
  Status try_write();

  std::shared_ptr<FolderLock> lock_;
  std::vector<NamedWriter> opening_;
  Lines frames_, poses_;
  int times_made_again_ = 0;
  bool failing_ = false;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<slam::FrameRecord> waiting_;  // guarded by mutex_, and so is:
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace sgs::run
