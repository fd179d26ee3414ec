// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/core/spill_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <string>
#include <system_error>

namespace sgs {
namespace {

std::string read_back(const SpillFile& file, std::int64_t at, std::size_t size) {
  std::string bytes(size, ' ');
  file.read(at, bytes.data(), size);
  return bytes;
}

TEST(SpillFile, GivesBackWhatItTook) {
  auto file = SpillFile::create();
  ASSERT_TRUE(file) << file.error().text();
  const auto first = file->append("first", 5), second = file->append("second", 6);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(read_back(*file, *second, 6), "second");
  EXPECT_EQ(read_back(*file, *first, 5), "first");
  EXPECT_THROW(read_back(*file, *second, 7), std::system_error);
}

TEST(SpillFile, RoomIsUsedAgain) {
  auto file = SpillFile::create();
  ASSERT_TRUE(file);
  const auto first = file->append("first", 5), second = file->append("again", 5);
  ASSERT_TRUE(first && second);
  file->release(*first, 5);
  const auto longer = file->append("longer", 6), third = file->append("third", 5);
  ASSERT_TRUE(longer && third);
  EXPECT_EQ(*third, *first);
  EXPECT_EQ(read_back(*file, 0, 16), "thirdagainlonger");
  const auto last = file->append("sixth", 5);
  ASSERT_TRUE(last);
  EXPECT_EQ(*last, 16);
}

TEST(SpillFile, ADiskThatIsFullTakesNothing) {
  auto file = SpillFile::create();
  ASSERT_TRUE(file);
  ASSERT_TRUE(file->append("one", 3));
  const auto before = std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
  const rlimit small{5, limit.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const auto full = file->append("three", 5);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  std::signal(SIGXFSZ, before);
  EXPECT_FALSE(full);
  const auto later = file->append("four", 4);
  ASSERT_TRUE(later);
  EXPECT_EQ(read_back(*file, 0, 7), "onefour");
}

TEST(SpillFile, AFolderThatIsNotThereIsNamed) {
  const auto file = SpillFile::create("/no/such/folder");
  ASSERT_FALSE(file);
  EXPECT_NE(file.error().text().find("/no/such/folder"), std::string::npos);
}

}  // namespace
}  // namespace sgs
