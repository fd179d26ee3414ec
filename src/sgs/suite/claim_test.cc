// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/suite/claim.h"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <thread>
#include <vector>

#include "sgs/io/atomic_file.h"
#include "sgs/io/temporary_folder.h"

namespace sgs::suite {
namespace {

using namespace std::chrono_literals;
using Answer = ClaimBoard::Answer;

/// A lease that does not end during a test.
constexpr auto kLong = 1h;

class Claims : public ::testing::Test {
 protected:
  std::unique_ptr<ClaimBoard> board(ClaimBoard::Duration lease = kLong) const {
    auto opened = ClaimBoard::open(folder_.path() / "claims", lease);
    EXPECT_TRUE(opened);
    return std::move(*opened);
  }
  std::filesystem::path file(const std::string& name) const {
    return folder_.path() / "claims" / name;
  }
  ClaimRecord record(const std::string& name) const {
    return parse_claim(io::read_file(file(name)).value_or(""));
  }
  /// A claim that a process left which is on another machine, or dead.
  void leave(const std::string& name, const std::string& identity) const {
    ClaimRecord left;
    left.worker = "somebody";
    left.identity = identity;
    ASSERT_TRUE(io::write_file(file(name), claim_text(left)));
  }

  io::TemporaryFolder folder_;
};

TEST_F(Claims, AreHeldByOneOfMany) {
  constexpr int kWorkers = 8;
  std::atomic<int> taken{0}, held{0};
  std::vector<std::unique_ptr<Claim>> claims(kWorkers);
  {
    std::vector<std::jthread> workers;
    for (int i = 0; i < kWorkers; ++i) {
      workers.emplace_back([&, i] {
        auto reply = board()->take("work");
        ASSERT_TRUE(reply);
        ++(reply->answer == Answer::kTaken ? taken : held);
        claims[static_cast<std::size_t>(i)] = std::move(reply->claim);
      });
    }
  }
  EXPECT_EQ(taken, 1);
  EXPECT_EQ(held, kWorkers - 1);
}

TEST_F(Claims, ThatAreGivenBackGoToTheNext) {
  const auto here = board(), there = board();
  auto first = here->take("work");
  EXPECT_EQ(there->take("work")->answer, Answer::kHeld);
  first->claim.reset();
  const auto second = there->take("work");
  ASSERT_EQ(second->answer, Answer::kTaken);
  EXPECT_EQ(second->claim->generation(), 1);
}

TEST_F(Claims, OfFailedWorkAreNotTakenWhileItsWorkersGoOn) {
  const auto beside = board();
  ASSERT_TRUE(board()->take("work")->claim->finish(ClaimState::kFailed));
  EXPECT_EQ(beside->take("work")->answer, Answer::kFailed);
  EXPECT_EQ(board()->take("work")->answer, Answer::kTaken);  // started later
}

TEST_F(Claims, OfAKilledProcessOfThisMachineAreTakenOverAtOnce) {
  const pid_t child = ::fork();
  if (child == 0) {
    for (;;) ::pause();
  }
  const std::string identity = process_identity(child);
  leave((board(), "work.0"), identity);
  EXPECT_FALSE(has_ended(identity));
  EXPECT_EQ(board()->take("work")->answer, Answer::kHeld);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_TRUE(has_ended(identity));
  EXPECT_EQ(board()->take("work")->answer, Answer::kTaken);
}

// Nothing can be known of a process elsewhere, but that it is silent.
TEST_F(Claims, OfAnotherMachineAreTakenOverAfterALease) {
  leave((board(), "work.0"), "another-boot pid:[1] 1 1");
  EXPECT_EQ(board()->take("work")->answer, Answer::kHeld);
  const auto patient = board(1ms);
  Result<ClaimBoard::Reply> reply = patient->take("work");
  while (reply->answer == Answer::kHeld) reply = patient->take("work");
  EXPECT_EQ(reply->answer, Answer::kTaken);
}

TEST_F(Claims, OfAnotherMachineAreLeftAloneWhileItGivesSignsOfLife) {
  constexpr auto kLease = 300ms;
  leave((board(), "work.0"), "another-boot pid:[1] 1 1");
  const auto patient = board(kLease);
  ClaimRecord alive = record("work.0");
  // Longer than a lease, in steps that are counted by what was written, not by a clock.
  for (const auto since = std::chrono::steady_clock::now();
       std::chrono::steady_clock::now() - since < 3 * kLease;) {
    ++alive.beat;
    ASSERT_TRUE(io::write_file(file("work.0"), claim_text(alive), io::Durability::kRelaxed));
    ASSERT_EQ(patient->take("work")->answer, Answer::kHeld);
  }
}

TEST_F(Claims, GiveSignsOfLifeAndSeeThatTheyAreLost) {
  const auto mine = board(6ms);
  const auto reply = mine->take("work");
  while (record("work.0").beat < 3) std::this_thread::yield();
  EXPECT_FALSE(reply->claim->lost());
  leave("work.1", "");
  EXPECT_TRUE(reply->claim->lost());
}

TEST_F(Claims, WithoutContentAreThoseOfSomebody) {
  static_cast<void>(board());
  ASSERT_TRUE(io::write_file(file("work.0"), ""));
  EXPECT_EQ(board()->take("work")->answer, Answer::kHeld);
}

TEST_F(Claims, NeedAFolderThatCanBeWritten) {
  ASSERT_TRUE(io::write_file(folder_.path() / "file", ""));
  EXPECT_FALSE(ClaimBoard::open(folder_.path() / "file", kLong));
  const auto mine = board();
  const auto reply = mine->take(std::string(300, 'a'));
  ASSERT_FALSE(reply);
  EXPECT_THAT(reply.error().text(), ::testing::HasSubstr("cannot write"));
}

TEST(ClaimRecordText, IsReadBackAndHasOneLength) {
  ClaimRecord record;
  record.state = ClaimState::kDone;
  record.beat = 12;
  record.worker = "process 1 on here";
  record.identity = process_identity(::getpid());
  EXPECT_EQ(claim_text(record).size(), kClaimRecordBytes);
  EXPECT_EQ(parse_claim(claim_text(record)), record);
  record.worker = std::string(10'000, 'x');
  EXPECT_EQ(claim_text(record).size(), kClaimRecordBytes);
  EXPECT_EQ(parse_claim("state nonsense\nbeat"), ClaimRecord{});
}

TEST(ProcessIdentity, KnowsOnlyWhoCanBeSeenFromHere) {
  EXPECT_FALSE(has_ended(process_identity(::getpid())));
  EXPECT_FALSE(has_ended(""));
  EXPECT_FALSE(has_ended("another-boot pid:[1] 1 1"));
  std::string other_start = process_identity(::getpid());
  other_start.back() = other_start.back() == '1' ? '2' : '1';
  EXPECT_TRUE(has_ended(other_start));  // the number was given to another process
}

}  // namespace
}  // namespace sgs::suite
