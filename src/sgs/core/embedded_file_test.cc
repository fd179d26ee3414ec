// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/core/embedded_file.h"

#include <gtest/gtest.h>

#include "sgs/core/error.h"

namespace sgs {
namespace {

constexpr EmbeddedFile kFiles[] = {
    {"a.js", "// SPDX-FileCopyrightText: us\n// SPDX-License-Identifier: L\nlet a;\n"},
    {"folder/b.css", "p{}\n/* SPDX- is named here */\n"},
    {"empty", ""}};

TEST(EmbeddedFile, IsFoundByItsWholePath) {
  EXPECT_EQ(find_embedded(kFiles, "folder/b.css"), &kFiles[1]);
  EXPECT_EQ(find_embedded(kFiles, "b.css"), nullptr);
  EXPECT_EQ(find_embedded({}, "a.js"), nullptr);
}

TEST(EmbeddedFile, TextStartsBehindTheLicence) {
  EXPECT_EQ(embedded_text(kFiles, "a.js"), "\nlet a;\n");
  EXPECT_EQ(embedded_text(kFiles, "folder/b.css"), kFiles[1].bytes);
  EXPECT_EQ(embedded_text(kFiles, "empty"), "");
  EXPECT_THROW(embedded_text(kFiles, "c.js"), ContractViolation);
}

}  // namespace
}  // namespace sgs
