// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/runfolder/resume_file.h"

#include <gmock/gmock.h>

#include "sgs/io/atomic_file.h"
#include "sgs/io/temporary_folder.h"

namespace sgs::run {
namespace {

using ::testing::HasSubstr;

TEST(ResumeFile, GivesBackWhatItWasGiven) {
  const io::TemporaryFolder scratch;
  for (const std::string& state :
       {std::string(), std::string("a\0b", 3), std::string(70000, 'x')}) {
    ASSERT_TRUE(save_resume_file(scratch / "r", state));
    EXPECT_EQ(load_resume_file(scratch / "r"), state);
  }
}

TEST(ResumeFile, RefusesEveryCutAndEveryWrongByte) {
  const io::TemporaryFolder scratch;
  ASSERT_TRUE(save_resume_file(scratch / "r", "the state of a run"));
  const std::string whole = *io::read_file(scratch / "r");
  const auto expect_refused = [&](const std::string& bytes) {
    ASSERT_TRUE(io::write_file(scratch / "r", bytes, io::Durability::kRelaxed));
    const auto loaded = load_resume_file(scratch / "r");
    ASSERT_FALSE(loaded);
    EXPECT_THAT(loaded.error().text(), HasSubstr((scratch / "r").string()));
  };
  for (std::size_t size = 0; size < whole.size(); ++size) expect_refused(whole.substr(0, size));
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    expect_refused(damaged);
  }
  expect_refused(whole + "x");
  expect_refused("x" + whole);
}

}  // namespace
}  // namespace sgs::run
