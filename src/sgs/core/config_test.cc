// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/core/config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "sgs/core/text.h"

namespace sgs {
namespace {

using testing::HasSubstr;
using testing::Not;

enum class Way { kStraight, kLeft, kRight };

constexpr auto enum_names(Way) {
  using enum Way;
  return std::to_array<EnumName<Way>>(
      {{kStraight, "straight"}, {kLeft, "left"}, {kRight, "right"}});
}

struct Turn {
  Way way = Way::kStraight;
  double angle_deg = 30;
  std::string name;

  void declare(ParameterList& p) {
    p.add("way", way, "Where to.");
    p.add("angle_deg", angle_deg, "How far.", "deg", {0, 90});
    p.add("name", name, "What it is called.", {});
    p.renamed("direction", "way");
    p.renamed("old_group", "group");
    p.removed("speed", "turns have none");
    p.renamed_word("way", "ahead", "straight");
  }
};

struct Settings {
  int count = 3;
  double rate = 0.1;
  bool fast = false;
  std::string mode = "a";
  std::uint64_t seed = 7;
  int late = 1;
  ParameterList list;
  Settings() {
    const auto outer = list.group("mapper");
    list.add("count", count, "How many.", "px", {1, 9});
    {
      const auto inner = list.group("adam");
      list.add("rate", rate, "How fast.", "", {0, 1});
      list.add("mode", mode, "Which way.", {"a", "b"});
    }
    list.add("fast", fast, "Fast or not.");
    list.add("seed", seed, "The seed.");
    list.add("late", late, "Unbounded.", "", {});
  }
};

TEST(Config, SetsByKeyAndAssignment) {
  Settings s;
  EXPECT_TRUE(s.list.set("mapper.count", "9"));
  EXPECT_TRUE(s.list.set_assignment("mapper.adam.rate=2.5e-1"));
  EXPECT_TRUE(s.list.set_assignment("mapper.adam.mode=\"b\""));
  EXPECT_TRUE(s.list.set_assignment("mapper.fast=true"));
  EXPECT_TRUE(s.list.set_assignment("mapper.seed=18446744073709551615"));
  EXPECT_EQ(s.count, 9);
  EXPECT_EQ(s.rate, 0.25);
  EXPECT_EQ(s.mode, "b");
  EXPECT_TRUE(s.fast);
  EXPECT_EQ(s.seed, 18446744073709551615u);
}

TEST(Config, BadValuesLeaveTheFieldAndNameTheKey) {
  Settings s;
  for (const char* bad :
       {"mapper.count=0", "mapper.count=10", "mapper.count=2.5", "mapper.count=", "mapper.count=3x",
        "mapper.count=nan", "mapper.adam.rate=inf", "mapper.adam.mode=c", "mapper.fast=maybe",
        "mapper.seed=-1", "mapper.late=1e300", "mapper.late=3000000000"}) {
    const auto status = s.list.set_assignment(bad);
    ASSERT_FALSE(status) << bad;
    EXPECT_THAT(status.error().message, HasSubstr("mapper.")) << bad;
  }
  EXPECT_EQ(s.count, 3);
  EXPECT_EQ(s.late, 1);
  EXPECT_FALSE(s.list.set_assignment("no equals sign"));
  EXPECT_FALSE(s.list.set_assignment("=3"));
}

TEST(Config, UnknownKeyNamesTheNearest) {
  Settings s;
  const auto status = s.list.set("mapper.adam.rte", "1");
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().remedy, HasSubstr("'mapper.adam.rate'"));
}

TEST(Config, EachTomlTableAppearsOnce) {
  const Settings s;
  const std::string toml = s.list.to_toml();
  const auto first = toml.find("[mapper]");
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(toml.find("[mapper]", first + 1), std::string::npos) << toml;
  EXPECT_THAT(toml, HasSubstr("rate = 0.1\n"));
  EXPECT_THAT(toml, HasSubstr("mode = \"a\"\n"));
}

TEST(Config, MarkdownEscapesBars) {
  const Settings s;
  EXPECT_THAT(s.list.to_markdown(), HasSubstr("| `mapper.adam.mode` | `\"a\"` |  | a \\| b |"));
}

TEST(Config, ParametersForUsersAndForExpertsAreAllOfThem) {
  Settings s;
  {
    const auto scope = s.list.group("mapper");
    s.list.for_users({"count", "fast"});
    EXPECT_THROW(s.list.for_users({"counter"}), ContractViolation);
  }
  const std::string users = s.list.to_markdown(Audience::kUsers);
  EXPECT_THAT(users, HasSubstr("`mapper.count`"));
  EXPECT_THAT(users, Not(HasSubstr("`mapper.adam.rate`")));
  const std::string experts = s.list.to_toml(Audience::kExperts);
  EXPECT_THAT(experts, HasSubstr("rate = 0.1\n"));
  EXPECT_THAT(experts, Not(HasSubstr("count")));
  EXPECT_THAT(s.list.to_toml(), HasSubstr("count = 3\n"));
}

TEST(Config, DeclaringTwiceIsABug) {
  Settings s;
  const auto scope = s.list.group("mapper");
  EXPECT_THROW(s.list.add("fast", s.fast, "Again."), ContractViolation);
}

TEST(Config, EnumsAreReadAndWrittenAsWords) {
  Turn turn;
  ParameterList list;
  list.add_group("turn", turn);
  EXPECT_THAT(list.to_toml(), HasSubstr("way = \"straight\"\n"));
  EXPECT_THAT(list.to_markdown(), HasSubstr("straight \\| left \\| right"));
  ASSERT_TRUE(list.set_assignment("turn.way=right"));
  EXPECT_EQ(turn.way, Way::kRight);
  ASSERT_TRUE(list.set_assignment("turn.way=\"left\""));
  EXPECT_EQ(turn.way, Way::kLeft);
  const auto status = list.set_assignment("turn.way=rihgt");
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().message, HasSubstr("'turn.way': 'rihgt'"));
  EXPECT_THAT(status.error().remedy, HasSubstr("mean 'right'"));
  EXPECT_THAT(status.error().remedy, HasSubstr("straight | left | right"));
  EXPECT_EQ(turn.way, Way::kLeft);
}

TEST(Config, EnumWordsServeElsewhereToo) {
  EXPECT_EQ(to_string(Way::kLeft), "left");
  EXPECT_EQ(from_string<Way>("way", "straight").value(), Way::kStraight);
  const auto way = from_string<Way>("way", "strait");
  ASSERT_FALSE(way);
  EXPECT_EQ(way.error().message, "unknown way 'strait'");
  EXPECT_THAT(way.error().remedy, HasSubstr("'straight'"));
}

TEST(Config, ChecksWhatWasBuiltInCode) {
  Turn turn;
  EXPECT_TRUE(check(turn));
  turn.angle_deg = 90.5;
  ASSERT_FALSE(check(turn));
  EXPECT_THAT(check(turn).error().text(), HasSubstr("'angle_deg': '90.5' is not within range"));
  EXPECT_THAT(check(turn).error().text(), HasSubstr("0 .. 90 deg"));
  turn.angle_deg = std::numeric_limits<double>::quiet_NaN();
  ASSERT_FALSE(check(turn));
  EXPECT_THAT(check(turn).error().text(), HasSubstr("'nan' is not a number"));
  turn = {};
  turn.way = static_cast<Way>(7);
  ASSERT_FALSE(check(turn));
  EXPECT_THAT(check(turn).error().text(), HasSubstr("'way': '7'"));
  EXPECT_THAT(check(turn).error().text(), HasSubstr("straight | left | right"));
  turn = {};
  turn.name = "\xFF";
  ASSERT_FALSE(check(turn));
  EXPECT_THAT(check(turn).error().message, HasSubstr("UTF-8"));
  Settings settings;
  settings.count = 10;
  ASSERT_FALSE(settings.list.check());
  EXPECT_THAT(settings.list.check().error().text(), HasSubstr("1 .. 9 px"));
  settings.count = 9;
  settings.mode = "c";
  ASSERT_FALSE(settings.list.check());
  EXPECT_THAT(settings.list.check().error().message, HasSubstr("'mapper.adam.mode': 'c'"));
}

TEST(Config, FormerKeysAndWordsAreRefusedByTheirNewNames) {
  Turn turn;
  ParameterList list;
  list.add_group("turn", turn);
  EXPECT_EQ(list.set("turn.direction", "left").error().message,
            "config key 'turn.direction' is now called 'turn.way'");
  EXPECT_EQ(list.set("turn.old_group.x", "1").error().message,
            "config key 'turn.old_group.x' is now called 'turn.group.x'");
  EXPECT_EQ(list.set("turn.speed", "1").error().message,
            "config key 'turn.speed' was removed: turns have none");
  list.read_earlier_versions();
  EXPECT_TRUE(list.set("turn.speed", "1"));
  EXPECT_TRUE(list.set("turn.direction", "left"));
  EXPECT_EQ(turn.way, Way::kLeft);
  EXPECT_EQ(list.set("turn.way", "ahead").error().remedy, "write straight instead");
  EXPECT_THAT(list.set("turn.speeds", "1").error().message, HasSubstr("unknown"));
  EXPECT_EQ(turn.way, Way::kLeft);
}

TEST(Config, LongNonsenseIsRefusedAtOnceAndShortened) {
  const Settings s;
  // The whole distance to every key would take minutes.
  const auto status = s.list.set(std::string(10'000'000, 'x'), "1");
  ASSERT_FALSE(status);
  EXPECT_LT(status.error().text().size(), 300u);
  const auto value = s.list.set("mapper.count", std::string(1'000'000, '1'));
  ASSERT_FALSE(value);
  EXPECT_LT(value.error().text().size(), 300u);
}

TEST(Text, Utf8) {
  for (const char* good : {"", "a", "\xC3\xA4", "\xE2\x82\xAC", "\xF0\x9F\x98\x80"}) {
    EXPECT_TRUE(is_utf8(good)) << good;
  }
  // A lone or missing continuation, two encodings of one character, a surrogate, beyond the last.
  for (const char* bad : {"\x80", "\xC3", "\xC0\xAF", "\xE0\x80\xAF", "\xED\xA0\x80",
                          "\xF0\x80\x80\xAF", "\xF4\x90\x80\x80", "\xFF"}) {
    EXPECT_FALSE(is_utf8(bad));
    EXPECT_EQ(toml_quoted(bad).substr(0, 4), "\"\xEF\xBF\xBD");
  }
  EXPECT_EQ(toml_quoted("a\"\\\n\x7F\xC3\xA4"), "\"a\\\"\\\\\\u000A\\u007F\xC3\xA4\"");
}

}  // namespace
}  // namespace sgs
