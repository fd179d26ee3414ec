// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/render/instruction_set.h"

#include <gtest/gtest.h>

namespace sgs::render {
namespace {

TEST(InstructionSet, OnlyOffersWhatItCanUse) {
  const auto names = instruction_sets();
  ASSERT_FALSE(names.empty());
  for (const auto& name : names) EXPECT_TRUE(use_instruction_set(name)) << name;
  // While one is in use, the others can still be chosen.
  ASSERT_TRUE(use_instruction_set(names.back()));
  EXPECT_TRUE(use_instruction_set(names.front()));
  EXPECT_TRUE(use_instruction_set("best"));
  EXPECT_EQ(instruction_sets(), names);
}

TEST(InstructionSet, RefusesOthersAndNamesTheChoices) {
  const auto status = use_instruction_set("mmx");
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().text().find(instruction_sets().front()), std::string::npos);
}

}  // namespace
}  // namespace sgs::render
