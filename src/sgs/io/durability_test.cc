// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <string>
#include <vector>

#include "sgs/io/append_file.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/temporary_folder.h"

namespace {

/// What the calls below saw while somebody watched, and whether they are to fail.
struct Disk {
  bool watched = false;
  int error = 0;  ///< errno of every sync; 0 = they work
  std::vector<std::string> calls;
  std::string renamed;  ///< the last file that got another name
} disk;

int sync_call(int fd, long number) {
  if (disk.watched) {
    struct stat info {};
    ::fstat(fd, &info);
    disk.calls.emplace_back(S_ISDIR(info.st_mode) ? "sync folder" : "sync file");
  }
  if (disk.error != 0) {
    errno = disk.error;
    return -1;
  }
  return static_cast<int>(::syscall(number, fd));
}

}  // namespace

// Those of the program come before those of the C library.
extern "C" int fsync(int fd) { return sync_call(fd, SYS_fsync); }
extern "C" int fdatasync(int fd) { return sync_call(fd, SYS_fdatasync); }
extern "C" int rename(const char* from, const char* to) noexcept {
  if (disk.watched) {
    disk.calls.emplace_back("rename");
    disk.renamed = from;
  }
  return static_cast<int>(::syscall(SYS_renameat, AT_FDCWD, from, AT_FDCWD, to));
}

namespace sgs::io {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class DurabilityTest : public testing::Test {
 protected:
  void SetUp() override { disk = {true, 0, {}, {}}; }
  void TearDown() override { disk = {}; }
  const TemporaryFolder folder_;
};

// A file that is renamed before its content is on the disk is empty after a power cut, and a rename
// that is not on the disk has not happened.
TEST_F(DurabilityTest, AFileIsOnTheDiskBeforeItsNameIsAndThenTheNameIs) {
  ASSERT_TRUE(write_file(folder_ / "a", "x"));
  EXPECT_THAT(disk.calls, ElementsAre("sync file", "rename", "sync folder"));
}

TEST_F(DurabilityTest, WhoDoesNotWantToWaitDoesNot) {
  ASSERT_TRUE(write_file(folder_ / "a", "x", Durability::kRelaxed));
  EXPECT_THAT(disk.calls, ElementsAre("rename"));
}

TEST_F(DurabilityTest, ADiskThatFailsLeavesTheOldFile) {
  ASSERT_TRUE(write_file(folder_ / "a", "old"));
  disk.error = EIO;
  EXPECT_FALSE(write_file(folder_ / "a", "new"));
  EXPECT_EQ(read_file(folder_ / "a"), "old");
  disk.error = EINVAL;  // a file system that knows no such thing
  EXPECT_TRUE(write_file(folder_ / "a", "new"));
}

TEST_F(DurabilityTest, WhatGrowsIsSyncedWhenItGrew) {
  AppendFile file(folder_ / "a");
  ASSERT_TRUE(file.append("x"));
  EXPECT_THAT(disk.calls, IsEmpty());
  ASSERT_TRUE(file.sync());
  ASSERT_TRUE(file.sync());
  EXPECT_THAT(disk.calls, ElementsAre("sync file"));
  disk.error = EIO;
  ASSERT_TRUE(file.append("y"));
  EXPECT_FALSE(file.sync());
  disk.error = 0;
  EXPECT_TRUE(file.sync());
  EXPECT_EQ(read_file(folder_ / "a"), "xy");
}

TEST_F(DurabilityTest, TemporaryFilesAreKnownByTheirNames) {
  ASSERT_TRUE(write_file(folder_ / "map.ply", "x"));
  const std::string temporary = std::filesystem::path(disk.renamed).filename();
  EXPECT_TRUE(is_temporary_of(temporary, "map.ply")) << temporary;
  EXPECT_FALSE(is_temporary_of(temporary, "map")) << temporary;
  EXPECT_TRUE(is_temporary_of("map.ply.7.tmp", "map.ply"));
  for (const char* name : {"map.ply", "map.ply.tmp", "map.ply..tmp", "map.ply.mine.tmp",
                           "map.ply.7.tmp.png", "map.ply7.tmp", "map.ply.7 .tmp", ".7.tmp"}) {
    EXPECT_FALSE(is_temporary_of(name, "map.ply")) << name;
  }
}

}  // namespace
}  // namespace sgs::io
