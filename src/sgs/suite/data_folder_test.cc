// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/suite/data_folder.h"

#include <gmock/gmock.h>

#include <set>

#include "sgs/io/atomic_file.h"
#include "sgs/io/temporary_folder.h"

namespace sgs::suite {
namespace {

namespace fs = std::filesystem;

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class DataFolder : public ::testing::Test {
 protected:
  DataFolder() {
    suite_.name = "mine";
    suite_.benchmark = Benchmark{"the Somewhere benchmark", {"Whole"}};
    suite_.sequences = {{"desk", "", "", "", {"set_desk", "desk"}},
                        {"wall", "", "", "", {"set_wall", "wall"}, "groundtruth.txt"}};
  }
  fs::path add_file(const fs::path& path) {
    EXPECT_TRUE(io::make_folder((folder_.path() / path).parent_path()));
    EXPECT_TRUE(io::write_file(folder_.path() / path, ""));
    return folder_.path() / path;
  }
  /// A folder with the marks of TUM's layout.
  fs::path add_recording(const fs::path& path) {
    add_file(path / "rgb.txt");
    add_file(path / "depth.txt");
    add_file(path / "rgb" / "1.png");
    return folder_.path() / path;
  }
  Result<Findings> find(const fs::path& below = "") {
    return find_recordings(folder_.path() / below, suite_);
  }

  io::TemporaryFolder folder_;
  Suite suite_;
};

TEST_F(DataFolder, GivesInputsToWhatLiesThereAndNamesWhatDoesNot) {
  const fs::path desk = add_recording("Set-Desk");
  const auto found = find();
  ASSERT_TRUE(found) << found.error().text();
  EXPECT_THAT(found->found, ElementsAre("desk: " + desk.string()));
  EXPECT_THAT(found->missing,
              ElementsAre("wall: not there; the Somewhere benchmark publishes it as set_wall"));
  ASSERT_EQ(suite_.sequences.size(), 1u);
  EXPECT_EQ(suite_.sequences[0].input, desk.string());
}

TEST_F(DataFolder, LooksOneLevelDeeperAndTakesWhatLiesHigher) {
  add_recording("unpacked/desk");
  const fs::path wall = add_recording("b/set_wall");
  add_file("b/set_wall/groundtruth.txt");
  const fs::path higher = add_recording("desk");
  const auto found = find();
  ASSERT_TRUE(found) << found.error().text();
  EXPECT_THAT(found->found, ElementsAre("desk: " + higher.string(), "wall: " + wall.string()));
  EXPECT_THAT(found->missing, IsEmpty());
}

TEST_F(DataFolder, MayBeTheRecordingItself) {
  add_recording("desk");
  const auto found = find("desk/");
  ASSERT_TRUE(found) << found.error().text();
  EXPECT_EQ(suite_.sequences[0].input, (folder_.path() / "desk/").string());
}

TEST_F(DataFolder, NamesArchivesWithTheCommandThatUnpacksThem) {
  add_recording("desk");
  const fs::path archive = add_file("loaded here/set_wall.tar.gz");
  auto found = find();
  ASSERT_TRUE(found) << found.error().text();
  EXPECT_THAT(found->missing, ElementsAre("wall: it is packed: tar -xf '" + archive.string() +
                                          "' -C '" + archive.parent_path().string() + "'"));
}

TEST_F(DataFolder, NamesAnArchiveThatHoldsSeveral) {
  add_recording("desk");
  add_file("Whole.zip");
  const auto found = find();
  ASSERT_TRUE(found) << found.error().text();
  EXPECT_THAT(found->missing,
              Contains(AllOf(HasSubstr("wall: it is packed: unzip "), HasSubstr("Whole.zip -d "))));
}

TEST_F(DataFolder, LeavesOutWhatIsNoRecordingOrLacksWhatItNeeds) {
  add_recording("wall");
  add_file("desk/readme.txt");
  const auto found = find();
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(
      found.error().message,
      AllOf(HasSubstr("nothing of the Somewhere benchmark lies there"),
            HasSubstr("desk: " + (folder_.path() / "desk").string() + " holds no recording"),
            HasSubstr("wall has no groundtruth.txt")));
}

TEST_F(DataFolder, PassesOverListsWithoutPictures) {
  fs::remove_all(add_recording("desk") / "rgb");
  EXPECT_THAT(find().error().message, HasSubstr("desk has no pictures"));
  add_recording("whole/desk");
  const auto found = find();
  ASSERT_TRUE(found) << found.error().text();
  EXPECT_THAT(found->found, ElementsAre(HasSubstr("whole/desk")));
}

TEST_F(DataFolder, BelongsToABenchmarkAndABenchmarkNeedsOne) {
  EXPECT_THAT(find_recordings("", suite_).error().text(), HasSubstr("say with --data DIR"));
  EXPECT_THAT(find_recordings(folder_.path() / "none", suite_).error().text(),
              HasSubstr("no such folder"));
  Suite plain;
  EXPECT_TRUE(find_recordings("", plain));
  EXPECT_THAT(find_recordings(folder_.path(), plain).error().text(),
              HasSubstr("looks for nothing in --data"));
}

/// Every sequence of a built-in benchmark by each of its names.
TEST_F(DataFolder, HoldsTheBuiltInBenchmarksUnderAllTheirNames) {
  for (const char* name : {"tum", "replica"}) {
    const auto whole = load_suite(name);
    ASSERT_TRUE(whole) << whole.error().text();
    std::set<std::string> seen;
    for (const Sequence& sequence : whole->sequences) {
      for (const std::string& folder : sequence.folders) {
        EXPECT_TRUE(seen.insert(folder).second) << folder << " names two sequences";
        const fs::path place = fs::path(name) / sequence.name / folder;
        add_recording(place);
        add_file(place / "groundtruth.txt");
        Suite suite = *whole;
        const auto found = find_recordings(folder_.path() / name / sequence.name, suite);
        ASSERT_TRUE(found) << folder << ": " << found.error().text();
        fs::remove_all(folder_.path() / place);
      }
    }
  }
}

}  // namespace
}  // namespace sgs::suite
