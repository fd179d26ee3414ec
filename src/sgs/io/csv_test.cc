// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/csv.h"

#include <gmock/gmock.h>

namespace sgs::io {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Csv, RowsByColumnName) {
  const auto table = CsvTable::parse("a,b,c\n1,2,3\n\r\n4\r\n", "t.csv");
  ASSERT_TRUE(table);
  ASSERT_EQ(table->rows(), 2u);
  EXPECT_EQ(table->column("c"), 2u);
  EXPECT_EQ(table->column("d"), std::nullopt);
  EXPECT_THAT(table->row(0), ElementsAre("1", "2", "3"));
  EXPECT_THAT(table->row(1), ElementsAre("4", "", ""));
}

TEST(Csv, ErrorsNameFileLineAndColumn) {
  const auto wide = CsvTable::parse("a\n1\n1,2\n", "t.csv");
  ASSERT_FALSE(wide);
  EXPECT_THAT(wide.error().message, HasSubstr("t.csv: line 3"));
  const auto table = CsvTable::parse("a\n\nx\n", "t.csv");
  const Error error = table->bad_cell(0, "a", "x", "a number").value();
  EXPECT_THAT(error.message, HasSubstr("t.csv: line 3: 'x' in column 'a' is not a number"));
}

TEST(Csv, AnEmptyTextIsAnEmptyTable) {
  const auto table = CsvTable::parse("", "t.csv");
  ASSERT_TRUE(table);
  EXPECT_EQ(table->rows(), 0u);
  EXPECT_EQ(table->column("a"), std::nullopt);
}

}  // namespace
}  // namespace sgs::io
