// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "sgs/runfolder/named_writer.h"

namespace sgs::run {

/// Writes the checkpoints of a run that is going on. Each has a folder of its own, checkpoint.N,
/// and counts from the moment when checkpoint.txt names it: whatever happens, the files of a
/// checkpoint belong together. The one before is removed after that.
class CheckpointFolders {
 public:
  explicit CheckpointFolders(std::filesystem::path run_folder);

  /// Writes `written` as the next checkpoint. Where that fails the last one stays.
  Status write(const std::vector<NamedWriter>& written);

 private:
  std::filesystem::path run_folder_;
  int number_;  // of the last one that was begun
};

/// Folder of the newest checkpoint of an unfinished run; the run's folder itself where there is
/// none: runs of older versions kept their only one there.
std::filesystem::path newest_checkpoint(const std::filesystem::path& run_folder);

/// Files and folders of checkpoints, finished or not, in an order in which they can be removed.
std::vector<std::filesystem::path> checkpoints_in(const std::filesystem::path& run_folder);

}  // namespace sgs::run
