// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/journal.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "sgs/io/atomic_file.h"
#include "sgs/io/temporary_folder.h"
#include "sgs/run/run_files.h"

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

}  // namespace
}  // namespace sgs::run
