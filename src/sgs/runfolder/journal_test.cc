// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/runfolder/journal.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "sgs/io/atomic_file.h"
#include "sgs/io/temporary_folder.h"
#include "sgs/runfolder/run_files.h"

namespace sgs::run {
namespace {

namespace fs = std::filesystem;
using ::testing::StartsWith;

slam::FrameRecord frame(std::int64_t index) {
  slam::FrameRecord record;
  record.index = index;
  record.timestamp_s = static_cast<double>(index);
  return record;
}

std::string content(const fs::path& path) { return io::read_file(path).value_or(""); }

auto lines(const fs::path& path) {
  const auto text = content(path);
  return std::count(text.begin(), text.end(), '\n');
}

template <class Condition>
void wait_until(const Condition& condition) {
  while (!condition()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

TEST(Journal, HoldsEachFrameLongBeforeTheEnd) {
  const io::TemporaryFolder scratch;
  auto lock = FolderLock::take(scratch / "run");
  ASSERT_TRUE(lock);
  Journal journal(*lock, {});
  EXPECT_THAT(content(scratch / "run/trajectory.txt"), StartsWith(std::string(kOnlinePoses)));
  journal.add(frame(0));
  auto bad = frame(1);
  bad.bad = true;
  journal.add(bad);
  wait_until([&] { return lines(scratch / "run/frames.csv") == 3; });
  journal.add(frame(2));
  wait_until([&] { return lines(scratch / "run/frames.csv") == 4; });
  wait_until([&] { return lines(scratch / "run/trajectory.txt") == 3; });  // the bad one has none
}

TEST(Journal, AFolderThatWasRemovedComesBackWhole) {
  const io::TemporaryFolder scratch;
  auto lock = FolderLock::take(scratch / "run");
  ASSERT_TRUE(lock);
  {
    Journal journal(
        *lock, {{"config.toml", [](const fs::path& path) { return io::write_file(path, "c"); }}});
    journal.add(frame(0));
    wait_until([&] { return lines(scratch / "run/trajectory.txt") == 2; });
    fs::rename(scratch / "run", scratch / "gone");  // at once: the journal may be writing
    journal.add(frame(1));
  }
  EXPECT_EQ(lines(scratch / "run/frames.csv"), 3);
  EXPECT_EQ(lines(scratch / "run/trajectory.txt"), 3);
  EXPECT_EQ(content(scratch / "run/config.toml"), "c");
  EXPECT_TRUE(FolderLock::is_held(scratch / "run"));
}

TEST(Journal, NothingIsWrittenIntoTheFolderOfAnother) {
  const io::TemporaryFolder scratch;
  auto lock = FolderLock::take(scratch / "run");
  ASSERT_TRUE(lock);
  Result<std::shared_ptr<FolderLock>> other = fail(ErrorCode::kNotFound, "not yet");
  {
    Journal journal(*lock, {});
    fs::rename(scratch / "run", scratch / "moved");
    other = FolderLock::take(scratch / "run");
    ASSERT_TRUE(other);
    journal.add(frame(0));
  }
  EXPECT_FALSE((*lock)->ensure());
  // Its own files are where they were taken to, and there the frame may be.
  EXPECT_FALSE(fs::exists(scratch / "run/frames.csv"));
  EXPECT_TRUE(fs::exists(scratch / "moved/frames.csv"));
}

TEST(FolderLock, KnowsItsFolderAgain) {
  const io::TemporaryFolder scratch;
  EXPECT_FALSE(FolderLock::is_held(scratch / "run"));
  auto lock = FolderLock::take(scratch / "run");
  ASSERT_TRUE(lock);
  EXPECT_TRUE(FolderLock::is_held(scratch / "run"));
  ASSERT_TRUE((*lock)->ensure());
  EXPECT_EQ((*lock)->times_made_again(), 0);
  fs::remove_all(scratch / "run");
  EXPECT_FALSE(FolderLock::is_held(scratch / "run"));
  ASSERT_TRUE((*lock)->ensure());
  EXPECT_EQ((*lock)->times_made_again(), 1);
  EXPECT_TRUE(FolderLock::is_held(scratch / "run"));
  lock = fail(ErrorCode::kInterrupted, "gone");
  EXPECT_FALSE(FolderLock::is_held(scratch / "run"));
}

// What is there is not written twice, a torn line is made good, and nothing is gone in between.
TEST(Journal, GoesOnWithWhatIsThere) {
  const io::TemporaryFolder scratch;
  auto lock = FolderLock::take(scratch / "run");
  ASSERT_TRUE(lock);
  {
    Journal journal(*lock, {});
    for (int i = 0; i < 5; ++i) journal.add(frame(i));
  }
  const auto frames = content(scratch / "run/frames.csv");
  const auto poses = content(scratch / "run/trajectory.txt");
  ASSERT_TRUE(io::append_file(scratch / "run/frames.csv", "5,5.0000"));
  ASSERT_TRUE(io::write_file(scratch / "run/trajectory.txt", poses.substr(0, poses.size() - 7)));
  {
    const auto journal = Journal::resume(*lock, {});
    EXPECT_EQ(content(scratch / "run/frames.csv"), frames);
    for (int i = 0; i < 7; ++i) journal->add(frame(i));
  }
  EXPECT_EQ(content(scratch / "run/frames.csv"),
            frames + slam::frames_csv_line(frame(5)) + slam::frames_csv_line(frame(6)));
  EXPECT_THAT(content(scratch / "run/trajectory.txt"), StartsWith(poses));
  EXPECT_EQ(lines(scratch / "run/trajectory.txt"), 1 + 7);
}

// Of a run that was stopped well, trajectory.txt has the results.
TEST(Journal, GoesOnWithARunThatWasStopped) {
  const io::TemporaryFolder scratch;
  auto lock = FolderLock::take(scratch / "run");
  ASSERT_TRUE(lock);
  ASSERT_TRUE(io::write_file(scratch / "run/trajectory.txt", "0.0 9 9 9 0 0 0 1\n"));
  ASSERT_TRUE(io::write_file(scratch / "run/trajectory_online.txt", "0.0 1 1 1 0 0 0 1\n"));
  {
    const auto journal = Journal::resume(*lock, {});
    journal->add(frame(0));
    journal->add(frame(1));
  }
  EXPECT_THAT(content(scratch / "run/trajectory.txt"),
              StartsWith(std::string(kOnlinePoses) + "0.0 1 1 1 0 0 0 1\n1.0"));
}

}  // namespace
}  // namespace sgs::run
