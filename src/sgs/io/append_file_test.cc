// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/append_file.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <csignal>

#include "sgs/io/atomic_file.h"
#include "sgs/io/temporary_folder.h"

namespace sgs::io {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

TEST(AppendFile, Grows) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder / "a/b.txt", "old"));
  AppendFile file(folder / "a/b.txt");
  EXPECT_EQ(read_file(file.path()), "old") << "not before there is something to write";
  ASSERT_TRUE(file.append("one\n"));
  file.hold("two\n");
  EXPECT_EQ(read_file(file.path()), "one\n");
  ASSERT_TRUE(file.append("three\n"));
  EXPECT_EQ(read_file(file.path()), "one\ntwo\nthree\n");
  ASSERT_TRUE(file.sync());
}

TEST(AppendFile, GoesOnBehindWhatIsThere) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder / "b.txt", "one\ntw"));
  AppendFile file(folder / "b.txt", 4);
  ASSERT_TRUE(file.append("2\n"));
  EXPECT_EQ(read_file(file.path()), "one\n2\n");
  AppendFile longer(folder / "b.txt", 1000);
  ASSERT_TRUE(longer.append("3\n"));
  EXPECT_EQ(read_file(file.path()), "one\n2\n3\n") << "no more than there is";
}

TEST(AppendFile, ComesBackWithAllItHeldWhenItWasRemoved) {
  const TemporaryFolder folder;
  AppendFile file(folder / "a/b.txt");
  const std::string large(200'000, 'x');
  ASSERT_TRUE(file.append(large));
  ASSERT_TRUE(file.restore()) << "nothing to do";
  fs::remove_all(folder / "a");
  file.hold("end\n");
  ASSERT_TRUE(file.restore());
  EXPECT_EQ(read_file(file.path()), large + "end\n");
}

TEST(AppendFile, NothingIsMissingInTheMiddleAfterTheDiskWasFull) {
  const TemporaryFolder folder;
  AppendFile file(folder / "a.txt");
  ASSERT_TRUE(file.append("one\n"));
  // A file that may not grow fails as on a full disk: some of it is written, the rest is not.
  const auto before = std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
  const rlimit small{6, limit.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const Status full = file.append("two\n");
  const Status still_full = file.append("three\n");
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  std::signal(SIGXFSZ, before);
  ASSERT_FALSE(full);
  EXPECT_FALSE(still_full);
  EXPECT_THAT(full.error().text(), HasSubstr("a.txt"));
  EXPECT_EQ(read_file(file.path()), "one\ntw");
  ASSERT_TRUE(file.append("four\n"));
  EXPECT_EQ(read_file(file.path()), "one\ntwo\nthree\nfour\n");
}

TEST(AppendFile, AFolderThatCannotBeMadeIsAnError) {
  EXPECT_FALSE(AppendFile("/dev/null/a").append("x"));
}

TEST(WholeLines, LeavesOutWhatWasNotWrittenToItsEnd) {
  using namespace std::string_view_literals;
  EXPECT_EQ(whole_lines(""), "");
  EXPECT_EQ(whole_lines("a\nb\n"), "a\nb\n");
  EXPECT_EQ(whole_lines("a\nb"), "a\n");
  EXPECT_EQ(whole_lines("a"), "");
  EXPECT_EQ(whole_lines("a\nb\0\0\0c\n"sv), "a\n");
}

}  // namespace
}  // namespace sgs::io
