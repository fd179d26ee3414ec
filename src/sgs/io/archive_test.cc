// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/archive.h"

#include <gtest/gtest.h>

namespace sgs::io {
namespace {

TEST(Archive, TheCommandFollowsFromTheName) {
  EXPECT_EQ(unpacking_of("a/desk.zip")->command, "unzip a/desk.zip -d a/desk");
  EXPECT_EQ(unpacking_of("a/desk.zip")->unpacked, "a/desk");
  EXPECT_EQ(unpacking_of("desk.TGZ")->command, "mkdir -p desk && tar -xf desk.TGZ -C desk");
  EXPECT_EQ(unpacking_of("walk.mcap.zstd")->command, "zstd -d walk.mcap.zstd -o walk.mcap");
  EXPECT_EQ(unpacking_of("walk.tar.gz")->unpacked, "walk");
  EXPECT_FALSE(unpacking_of("walk.mcap"));
  EXPECT_FALSE(unpacking_of(".zip"));
  EXPECT_FALSE(unpacking_of("zip"));
}

TEST(Archive, PathsAreQuotedWhereAShellNeedsIt) {
  EXPECT_EQ(shell_quoted("a/b-1_2.bag"), "a/b-1_2.bag");
  EXPECT_EQ(shell_quoted("my walk.bag"), "'my walk.bag'");
  EXPECT_EQ(shell_quoted("it's"), "'it'\\''s'");
  EXPECT_EQ(unpacking_of("my walk.zip")->command, "unzip 'my walk.zip' -d 'my walk'");
}

}  // namespace
}  // namespace sgs::io
