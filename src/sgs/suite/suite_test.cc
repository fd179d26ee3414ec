// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/suite/suite.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "sgs/io/atomic_file.h"
#include "sgs/io/temporary_folder.h"
#include "sgs/slam/session_config.h"

namespace sgs::suite {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// The error that a text gives.
std::string error_of(const std::string& text) {
  Suite suite;
  const Status status = read_suite(text, "mine.toml", suite);
  return status ? "no error" : status.error().text();
}

TEST(Suite, BuiltInSuiteHasSequencesVariantsAliasesAndPublications) {
  const auto suite = load_suite("tum-synth");
  ASSERT_TRUE(suite) << suite.error().text();
  EXPECT_EQ(suite->sequences.size(), 10u);
  EXPECT_EQ(suite->sequences[1].scene, "nostructure_texture_far");
  EXPECT_EQ(suite->aliases.at("tau_deg"), "tracker.degeneracy.condition_threshold");
  ASSERT_TRUE(suite->variant("gicp"));
  EXPECT_THAT(suite->variant("gicp")->arguments, ElementsAre("--tracker", "gicp"));
  ASSERT_EQ(suite->publications.size(), 2u);
  const Publication::Row& lost = suite->publications[0].results[2];
  EXPECT_EQ(lost.system, "Photo-SLAM");
  EXPECT_FALSE(lost.ate_cm.at("notex_near"));
  EXPECT_DOUBLE_EQ(*lost.ate_cm.at("nostruct_far"), 5.36);
}

TEST(Suite, BuiltInBenchmarksHaveThePapersSequencesAndSystems) {
  const auto tum = load_suite("tum");
  ASSERT_TRUE(tum) << tum.error().text();
  EXPECT_EQ(tum->sequences.size(), 12u);
  ASSERT_TRUE(tum->benchmark);
  EXPECT_DOUBLE_EQ(*tum->publications[0].results[4].ate_cm.at("notex_near_val"), 1.09);
  const auto replica = load_suite("replica");
  ASSERT_TRUE(replica) << replica.error().text();
  EXPECT_EQ(replica->sequences.size(), 8u);
  EXPECT_DOUBLE_EQ(*replica->publications[0].results[1].ate_cm.at("average"), 0.24);
  for (const auto* suite : {&*tum, &*replica}) {
    for (const char* system : {"Point-SLAM", "GS-SLAM", "SplaTAM", "MonoGS", "Photo-SLAM",
                               "GS-ICP SLAM", "Spectral GS-SLAM (paper)"}) {
      EXPECT_TRUE(std::any_of(suite->publications.begin(), suite->publications.end(),
                              [&](const Publication& publication) {
                                return std::any_of(
                                    publication.results.begin(), publication.results.end(),
                                    [&](const auto& row) { return row.system == system; });
                              }))
          << suite->name << " has nothing of " << system;
    }
  }
}

TEST(Suite, BuiltInVariantsAndAliasesNameParametersThatExist) {
  const auto suite = load_suite("tum-synth");
  ASSERT_TRUE(suite) << suite.error().text();
  slam::SessionConfig config;
  ParameterList list;
  config.declare(list);
  const auto set = [&](const std::string& option, const std::string& value) {
    if (option == "--set") return list.set_assignment(value);
    return list.set(option == "--preset" ? "slam.preset" : "tracker.type", value);
  };
  for (const Variant& variant : suite->variants) {
    for (std::size_t i = 0; i + 1 < variant.arguments.size(); i += 2) {
      const Status status = set(variant.arguments[i], variant.arguments[i + 1]);
      EXPECT_TRUE(status) << variant.name << ": " << status.error().text();
    }
  }
  for (const auto& [alias, key] : suite->aliases) EXPECT_NE(list.find(key), nullptr) << alias;
}

TEST(Suite, UnknownNamesListWhatThereIs) {
  const auto suite = load_suite("tom");
  ASSERT_FALSE(suite);
  EXPECT_EQ(suite.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(suite.error().text(), HasSubstr("Allowed: replica | tum-synth | tum; the name of a "
                                              "file ends in"));
  const auto variant = load_suite("tum-synth")->variant("magic");
  ASSERT_FALSE(variant);
  EXPECT_THAT(variant.error().text(), HasSubstr("Allowed: spectral | gicp | orb"));
}

TEST(Suite, FileOfOnesOwnAddsToTheBuiltInVariants) {
  const io::TemporaryFolder folder;
  const auto path = folder.path() / "mine.toml";
  ASSERT_TRUE(io::write_file(path, R"(
[[sequence]]
name = "desk"
input = "tum/desk"
[[variant]]
name = "gicp"
arguments = ["--tracker", "gicp", "--threads", "1"]
[aliases]
steps = "mapper.iterations_per_frame"
)"));
  const auto suite = load_suite(path.string());
  ASSERT_TRUE(suite) << suite.error().text();
  EXPECT_EQ(suite->name, "mine");
  ASSERT_EQ(suite->sequences.size(), 1u);
  EXPECT_EQ(suite->sequences[0].input, (folder.path() / "tum/desk").string());
  EXPECT_TRUE(suite->variant("orb"));
  EXPECT_EQ(suite->variant("gicp")->arguments.back(), "1");
  EXPECT_EQ(suite->aliases.size(), 4u);
  EXPECT_EQ(load_suite((folder.path() / "none.toml").string()).error().code, ErrorCode::kNotFound);
  ASSERT_TRUE(io::write_file(path, "[aliases]\n"));
  EXPECT_THAT(load_suite(path.string()).error().text(), HasSubstr("needs a [[sequence]]"));
}

TEST(Suite, ErrorsNameFileAndLine) {
  const auto sequence = [](const std::string& keys) { return "\n[[sequence]]\n" + keys; };
  EXPECT_THAT(error_of("[[sequence"), HasSubstr("mine.toml:1: "));
  EXPECT_EQ(
      error_of("variants = 1"),
      "mine.toml:1: unknown key 'variants' (did you mean 'variant'? Allowed: sequence | variant "
      "| aliases | publication | benchmark)");
  EXPECT_THAT(error_of(sequence("name = 'a'\nlevel = 'x'")),
              HasSubstr("mine.toml:4: unknown key 'level' (did you mean"));
  EXPECT_THAT(error_of(sequence("name = 3")), HasSubstr("mine.toml:3: this must be a text"));
  EXPECT_THAT(error_of("sequence = 3"), HasSubstr("mine.toml:1: this must be a list"));
  EXPECT_THAT(error_of("sequence = ['a']"), HasSubstr("mine.toml:1: this must be a table"));
  EXPECT_THAT(error_of("aliases = 'a'"), HasSubstr("this must be a table"));
  EXPECT_THAT(error_of(sequence("scene = 'fold'")), HasSubstr("mine.toml:2: the name ''"));
  EXPECT_THAT(error_of(sequence("name = '../a'\nscene = 'fold'")), HasSubstr("'../a'"));
  EXPECT_THAT(error_of(sequence("name = 'a'")), HasSubstr("needs 'scene' or 'input' or 'folders'"));
  EXPECT_THAT(error_of(sequence("name = 'average'\nscene = 'fold'")), HasSubstr("no sequence can"));
  EXPECT_THAT(error_of(sequence("name = 'a'\nfolders = ['b']")),
              HasSubstr("'a' is looked for by name, but of which benchmark?"));
  EXPECT_THAT(error_of(sequence("name = 'a'\nscene = 'fold'\ninput = 'a'")),
              HasSubstr("needs 'scene' or 'input'"));
  EXPECT_THAT(error_of(sequence("name = 'a'\nscene = 'folt'")), HasSubstr("nearest first: fold"));
  const std::string twice = sequence("name = 'a'\nscene = 'fold'");
  EXPECT_THAT(error_of(twice + twice), HasSubstr("mine.toml: 'a' is there twice"));
}

TEST(Suite, PublishedValuesNeedSourceAndSequence) {
  const auto publication = [](const std::string& ate, const std::string& source) {
    return "[[sequence]]\nname = 'a'\nscene = 'fold'\n[[publication]]\n" + source +
           "results = [{system = 'X', ate_cm = {" + ate + "}}]";
  };
  const std::string source = "source = 'a paper, table 2'\n";
  EXPECT_EQ(error_of(publication("a = 1.5", source)), "no error");
  EXPECT_THAT(error_of(publication("a = 1.5", "")), HasSubstr("mine.toml:4: 'source' is missing"));
  EXPECT_THAT(error_of(publication("b = 1.5", source)), HasSubstr("'X' reports of 'b'"));
  for (const char* value : {"-1", "nan", "inf", "'gone'", "true"}) {
    EXPECT_THAT(error_of(publication(std::string("a = ") + value, source)),
                HasSubstr("mine.toml:6: this must be an error in cm or \"lost\""))
        << value;
  }
  EXPECT_THAT(error_of("[[publication]]\nsource = 'p'\nresults = [{ate_cm = {}}]"),
              HasSubstr("'system' is missing"));
}

}  // namespace
}  // namespace sgs::suite
