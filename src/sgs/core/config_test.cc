// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/core/config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sgs {
namespace {

using testing::HasSubstr;

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

TEST(Config, DeclaringTwiceIsABug) {
  Settings s;
  const auto scope = s.list.group("mapper");
  EXPECT_THROW(s.list.add("fast", s.fast, "Again."), ContractViolation);
}

}  // namespace
}  // namespace sgs
