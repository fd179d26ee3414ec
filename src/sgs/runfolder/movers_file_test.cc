// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/runfolder/movers_file.h"

#include <gmock/gmock.h>

#include "sgs/io/atomic_file.h"
#include "sgs/io/temporary_folder.h"

namespace sgs::run {
namespace {

std::vector<slam::FrameRecord> records_of(int count) {
  std::vector<slam::FrameRecord> frames(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) frames[static_cast<std::size_t>(k)].index = 2 * k;
  return frames;
}

TEST(MoversFile, ComesBackToTheFramesThatAreThere) {
  auto frames = records_of(5);
  frames[1].movers = std::string("\x00\xf1", 2);
  frames[4].movers = "\x7f";
  const io::TemporaryFolder folder;
  const auto path = folder.path() / "movers.txt";
  ASSERT_TRUE(io::write_file(path, movers_text(frames)));
  auto read = records_of(4);  // the last one is not there
  ASSERT_TRUE(load_movers(path, read));
  EXPECT_EQ(read[0].movers, "");
  EXPECT_EQ(read[1].movers, frames[1].movers);
  EXPECT_EQ(read[3].movers, "");
}

TEST(MoversFile, IsEmptyWhereNothingMoved) { EXPECT_EQ(movers_text(records_of(3)), ""); }

TEST(MoversFile, NamesALineThatIsNone) {
  const io::TemporaryFolder folder;
  const auto path = folder.path() / "movers.txt";
  for (const char* wrong : {"2 0g\n", "2 012\n", "2\n", "2 \n", " 00\n", "x 00\n", "-\n"}) {
    ASSERT_TRUE(io::write_file(path, std::string("# head\n0 ff\n") + wrong));
    auto frames = records_of(3);
    const Status read = load_movers(path, frames);
    ASSERT_FALSE(read) << wrong;
    EXPECT_THAT(read.error().message, testing::HasSubstr("movers.txt, line 3")) << wrong;
  }
}

}  // namespace
}  // namespace sgs::run
