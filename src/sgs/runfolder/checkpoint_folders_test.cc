// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/runfolder/checkpoint_folders.h"

#include <gtest/gtest.h>

#include "sgs/io/atomic_file.h"
#include "sgs/io/temporary_folder.h"
#include "sgs/runfolder/run_files.h"

namespace sgs::run {
namespace {

namespace fs = std::filesystem;

NamedWriter text_file(const char* name, const std::string& text) {
  return {name, [text](const fs::path& path) { return io::write_file(path, text); }};
}

NamedWriter failing_file(const char* name) {
  return {name, [](const fs::path&) -> Status { return fail(ErrorCode::kIo, "full"); }};
}

std::string content(const fs::path& run, const char* name) {
  return io::read_file(newest_checkpoint(run) / name).value_or("");
}

TEST(CheckpointFolders, NameTheNewestAndRemoveTheOneBefore) {
  const io::TemporaryFolder run;
  EXPECT_EQ(newest_checkpoint(run.path()), run.path()) << "none so far";
  CheckpointFolders folders(run.path());
  ASSERT_TRUE(
      folders.write({text_file(files::kMap, "map 1"), text_file(files::kKeyframes, "k 1")}));
  const fs::path first = newest_checkpoint(run.path());
  EXPECT_EQ(content(run.path(), files::kMap), "map 1");
  ASSERT_TRUE(
      folders.write({text_file(files::kMap, "map 2"), text_file(files::kKeyframes, "k 2")}));
  EXPECT_EQ(content(run.path(), files::kMap), "map 2");
  EXPECT_EQ(content(run.path(), files::kKeyframes), "k 2");
  EXPECT_FALSE(fs::exists(first));
  CheckpointFolders later(run.path());
  ASSERT_TRUE(later.write({text_file(files::kMap, "map 3")}));
  EXPECT_EQ(content(run.path(), files::kMap), "map 3");
  for (const fs::path& part : checkpoints_in(run.path())) EXPECT_TRUE(fs::remove(part)) << part;
  EXPECT_TRUE(fs::is_empty(run.path()));
}

// At whatever file it ends: what counts is whole and of one moment.
TEST(CheckpointFolders, AnUnfinishedOneDoesNotCount) {
  const io::TemporaryFolder run;
  CheckpointFolders folders(run.path());
  ASSERT_TRUE(
      folders.write({text_file(files::kMap, "map 1"), text_file(files::kKeyframes, "k 1")}));
  EXPECT_FALSE(folders.write({text_file(files::kMap, "map 2"), failing_file(files::kKeyframes)}));
  EXPECT_EQ(content(run.path(), files::kMap), "map 1");
  EXPECT_EQ(content(run.path(), files::kKeyframes), "k 1");
  // As a kill leaves it.
  ASSERT_TRUE(io::write_file(run.path() / "checkpoint.77" / files::kMap, "map 77"));
  EXPECT_EQ(content(run.path(), files::kMap), "map 1");
  CheckpointFolders later(run.path());
  ASSERT_TRUE(later.write({text_file(files::kMap, "map 78")}));
  EXPECT_EQ(content(run.path(), files::kMap), "map 78");
  EXPECT_FALSE(fs::exists(run.path() / "checkpoint.77"));
}

TEST(CheckpointFolders, NoOtherPlaceCanBeNamed) {
  const io::TemporaryFolder run;
  for (const char* name : {"", "checkpoint.0", "checkpoint.-1", "checkpoint.1/../../x", "..",
                           "/etc", "checkpoint.99999999999999999999", "checkpoint.1x"}) {
    ASSERT_TRUE(io::write_file(run.path() / files::kCheckpoint, name));
    EXPECT_EQ(newest_checkpoint(run.path()), run.path()) << name;
  }
}

TEST(CheckpointFolders, LeaveAloneWhatIsNotTheirs) {
  const io::TemporaryFolder run;
  ASSERT_TRUE(io::write_file(run.path() / "checkpoint.1" / "notes.txt", "mine"));
  CheckpointFolders folders(run.path());
  ASSERT_TRUE(folders.write({text_file(files::kMap, "map")}));
  EXPECT_EQ(io::read_file(run.path() / "checkpoint.1" / "notes.txt"), "mine");
}

}  // namespace
}  // namespace sgs::run
