// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapjoin/join_files.h"

#include <gmock/gmock.h>

#include <fstream>

#include "sgs/io/temporary_folder.h"
#include "sgs/mapjoin/test_walls.h"

namespace sgs::mapjoin {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

void save(const fs::path& path, const Part& part) {
  ASSERT_TRUE(mapfile::save_map(
      path, {part.sessions, part.gaussians, part.views(), part.view, part.graph}));
}

class JoinFilesTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = new io::TemporaryFolder;
    save(path("a"), walk_along_wall("first", 0, 9, SE3{}));
    save(path("b"), walk_along_wall("second", 1.8, 9, another_world()));
    save(path("c"), walk_along_wall("third", 0.9, 9, another_world().inverse()));
  }
  static void TearDownTestSuite() { delete scratch_; }
  static fs::path path(const std::string& name) { return scratch_->path() / (name + ".sgsmap"); }
  static std::string error_of(const std::vector<fs::path>& inputs, const fs::path& output) {
    const auto done = join_files(inputs, output, 1);
    EXPECT_FALSE(done);
    EXPECT_FALSE(fs::exists(path("out")));
    return done ? "" : done.error().text();
  }

  static inline io::TemporaryFolder* scratch_ = nullptr;
};

// The second sees of the first next to nothing, but the third sees both.
TEST_F(JoinFilesTest, AMapIsLookedForAgainAfterTheOthers) {
  const auto done = join_files({path("a"), path("b"), path("c")}, path("all"), 1);
  ASSERT_TRUE(done) << done.error().text();
  ASSERT_THAT(done->not_joined, ::testing::IsEmpty());
  EXPECT_EQ(done->joined.size(), 2u);
  const auto map = mapfile::MapFile::open(path("all"));
  ASSERT_TRUE(map);
  ASSERT_EQ(map->sessions().size(), 3u);
  EXPECT_EQ(map->sessions()[1].name, "third");
  EXPECT_EQ(map->views(), 27u);
  const auto graph = map->graph();
  ASSERT_TRUE(graph);
  EXPECT_EQ(graph->session.back(), 2);
}

TEST_F(JoinFilesTest, WhatHasNothingInCommonIsNotWritten) {
  save(path("far"), walk_along_wall("elsewhere", 30, 9, another_world()));
  const auto done = join_files({path("a"), path("far")}, path("out"), 1);
  ASSERT_TRUE(done) << done.error().text();
  ASSERT_EQ(done->not_joined.size(), 1u);
  EXPECT_THAT(done->not_joined[0], HasSubstr("far.sgsmap"));
  EXPECT_FALSE(fs::exists(path("out")));
}

TEST_F(JoinFilesTest, InputsAreNeverWritten) {
  EXPECT_THAT(error_of({path("a"), path("c")}, path("c")), HasSubstr("only read"));
  EXPECT_THAT(error_of({path("a"), path("c")}, scratch_->path()), HasSubstr("is a folder"));
}

TEST_F(JoinFilesTest, OneMapTwiceIsRefused) {
  fs::copy_file(path("a"), path("copy"), fs::copy_options::overwrite_existing);
  EXPECT_THAT(error_of({path("a"), path("a")}, path("out")), HasSubstr("both hold the session"));
  EXPECT_THAT(error_of({path("a"), path("copy")}, path("out")), HasSubstr("copy.sgsmap"));
  EXPECT_THAT(error_of({path("a")}, path("out")), HasSubstr("one map alone"));
}

TEST_F(JoinFilesTest, WhatIsNoMapIsRefusedByName) {
  std::ofstream(path("text")) << "this is no map, it is a text of some length\n";
  EXPECT_THAT(error_of({path("a"), path("text")}, path("out")), HasSubstr("text.sgsmap"));
  EXPECT_THAT(error_of({path("a"), path("none")}, path("out")), HasSubstr("none.sgsmap"));
  fs::copy_file(path("c"), path("cut"), fs::copy_options::overwrite_existing);
  fs::resize_file(path("cut"), fs::file_size(path("cut")) / 2);
  EXPECT_THAT(error_of({path("a"), path("cut")}, path("out")), HasSubstr("cut.sgsmap"));
}

}  // namespace
}  // namespace sgs::mapjoin
