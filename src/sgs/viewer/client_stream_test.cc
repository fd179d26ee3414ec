// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/viewer/client_stream.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "sgs/viewer/run_control.h"
#include "sgs/viewer/test_update.h"

namespace sgs::viewer {
namespace {

using nlohmann::json;

class StreamTest : public ::testing::Test {
 protected:
  void post(std::int64_t index, map::SnapshotPtr map = nullptr, bool finished = false) {
    FrameUpdate u = testing::update(index, std::move(map));
    u.finished = finished;
    board.post(std::make_shared<const FrameUpdate>(std::move(u)));
  }
  std::optional<Outgoing> next() { return stream.next(now_s += 1, false); }
  json next_json() {
    const auto out = next();
    return out && out->text ? json::parse(*out->bytes) : json();
  }
  /// Everything there is, as types of text messages and kinds of binary ones.
  std::vector<std::string> all() {
    std::vector<std::string> types;
    while (const auto out = next()) {
      types.push_back(out->text ? json::parse(*out->bytes)["type"].get<std::string>()
                                : "binary " + std::to_string(static_cast<int>((*out->bytes)[0])));
    }
    return types;
  }

  Board board;
  SharedEncoder encoder{board};
  ClientStream stream{encoder, R"({"type":"hello"})"};
  double now_s = 0;
};

using ::testing::ElementsAre;

TEST_F(StreamTest, GreetsFirstAndIsThenSilent) {
  EXPECT_THAT(all(), ElementsAre("hello"));
  EXPECT_TRUE(stream.up_to_date());
}

TEST_F(StreamTest, SlowClientsSkipToTheNewestStateWithoutAGapInThePath) {
  all();
  post(0);
  EXPECT_EQ(next_json()["frame"], 0);
  for (int i = 1; i <= 5; ++i) post(i);
  const json path = next_json();
  EXPECT_EQ(path["type"], "path");
  EXPECT_EQ(path["first"], 1);
  EXPECT_EQ(path["estimate"].size(), 4u);
  EXPECT_EQ(next_json()["frame"], 5);
  EXPECT_FALSE(next());
}

TEST_F(StreamTest, LongHistoriesComeInChunks) {
  for (int i = 0; i <= 5000; ++i) post(i);
  std::vector<std::string> types = all();
  EXPECT_THAT(types, ElementsAre("hello", "path", "path", "path", "state"));
}

TEST_F(StreamTest, FramesThatAreMissingHaveAPlaceInThePath) {
  all();
  post(0);
  all();
  post(3);
  const json path = next_json();
  EXPECT_EQ(path["first"], 1);
  EXPECT_EQ(path["status"], json({3, 3}));
}

TEST_F(StreamTest, NothingIsSentThatNobodyAskedFor) {
  post(0, testing::snapshot(1, {1}));
  stream.offer(Pane::kColor, std::make_shared<const std::string>("\2"));
  EXPECT_THAT(all(), ElementsAre("hello", "state"));
  stream.subscribe({true, bit(Pane::kDepth)});
  stream.offer(Pane::kColor, std::make_shared<const std::string>("\2"));
  stream.offer(Pane::kDepth, std::make_shared<const std::string>("\2"));
  EXPECT_THAT(all(), ElementsAre("binary 2", "binary 1"));
}

TEST_F(StreamTest, OnlyTheNewestPictureOfAPaneWaits) {
  all();
  stream.subscribe({false, bit(Pane::kDepth)});
  stream.offer(Pane::kDepth, std::make_shared<const std::string>("\2old"));
  stream.offer(Pane::kDepth, std::make_shared<const std::string>("\2new"));
  EXPECT_EQ(*next()->bytes, "\2new");
  EXPECT_FALSE(next());
}

TEST_F(StreamTest, MapsAreSkippedToTheNewestAndForgottenOnRequest) {
  all();
  stream.subscribe({true, 0});
  for (std::uint64_t v = 1; v <= 4; ++v) {
    post(static_cast<std::int64_t>(v),
         testing::snapshot(v, {1, static_cast<std::uint32_t>(v + 1)}));
  }
  EXPECT_THAT(all(), ::testing::UnorderedElementsAre("binary 1", "path", "state"));
  EXPECT_TRUE(stream.up_to_date());
  stream.subscribe({false, 0});
  stream.subscribe({true, 0});
  EXPECT_FALSE(stream.up_to_date());
  const auto again = next();
  ASSERT_TRUE(again && !again->text);
  EXPECT_EQ((*again->bytes)[1], 3);  // reset, last
}

TEST_F(StreamTest, MapsAreNotSentMoreOftenThanTheyCanBeSeen) {
  all();
  stream.subscribe({true, 0});
  post(0, testing::snapshot(1, {1}));
  ASSERT_TRUE(stream.next(10, false));
  ASSERT_TRUE(stream.next(10, false));
  post(1, testing::snapshot(2, {1, 2}));
  EXPECT_TRUE(stream.next(10.1, false)->text);
  EXPECT_FALSE(stream.next(10.1, false));
  EXPECT_TRUE(stream.next(10.9, false));
}

TEST_F(StreamTest, TheFinalMapIsExact) {
  all();
  stream.subscribe({true, 0});
  auto map = testing::snapshot(1, {1});
  post(0, map);
  all();
  auto moved = std::make_shared<map::Snapshot>(*map);
  moved->version = 2;
  moved->gaussians[0].mean[0] += 1e-5f;
  post(1, moved);
  all();
  post(1, moved, true);  // the same version, now final
  EXPECT_FALSE(stream.up_to_date());
  bool sent = false;
  while (const auto out = next()) {
    sent = sent || (!out->text && out->bytes->size() == 24 + 48);
  }
  EXPECT_TRUE(sent);
}

TEST_F(StreamTest, StatesPicturesAndMapsTakeTurns) {
  all();
  stream.subscribe({true, bit(Pane::kColor)});
  std::vector<std::string> order;
  for (int i = 0; i < 6; ++i) {  // on every turn there is something new of each kind
    post(i, testing::snapshot(static_cast<std::uint64_t>(i) + 1, {static_cast<std::uint32_t>(i)}));
    stream.offer(Pane::kColor, std::make_shared<const std::string>("\2"));
    const auto out = next();
    order.push_back(out->text ? "text" : std::to_string(static_cast<int>((*out->bytes)[0])));
  }
  EXPECT_THAT(order, ::testing::UnorderedElementsAre("text", "text", "1", "1", "2", "2"));
}

TEST_F(StreamTest, MetricsComeOnce) {
  all();
  eval::Metrics metrics;
  metrics.frames = 3;
  board.set_final_word({metrics});
  EXPECT_FALSE(stream.up_to_date());
  EXPECT_THAT(all(), ElementsAre("metrics"));
  EXPECT_TRUE(stream.up_to_date());
}

TEST_F(StreamTest, ARestartEmptiesThePath) {
  for (int i = 0; i < 3; ++i) post(i);
  all();
  board.restart();
  post(0);
  const json path = next_json();
  EXPECT_EQ(path["type"], "path");
  EXPECT_EQ(path["first"], 0);
  EXPECT_EQ(path["estimate"].size(), 0u);
  EXPECT_EQ(next_json()["frame"], 0);
}

TEST_F(StreamTest, ManyClientsShareTheBytes) {
  ClientStream other(encoder, "{}");
  post(0);
  next();
  other.next(0, false);
  EXPECT_EQ(next()->bytes, other.next(0, false)->bytes);
}

TEST_F(StreamTest, TheSessionIsToldAlsoBeforeTheFirstFrameAndOnlyItsNewestNote) {
  all();
  SessionNote note;
  board.set_session(note);
  note.dropped = 7;
  board.set_session(note);
  EXPECT_FALSE(stream.up_to_date());
  const json told = next_json();
  EXPECT_EQ(told["type"], "session");
  EXPECT_EQ(told["dropped"], 7);
  EXPECT_THAT(all(), ElementsAre());
  EXPECT_TRUE(stream.up_to_date());
}

TEST(RunControl, FinishingEndsAPauseAndTheLastWishCounts) {
  RunControl control;
  control.pause();
  control.pause();
  control.finish(AfterRun::kStartAgain);
  int asked = 0;
  control.wait_turn([&] { return ++asked > 1000; });
  EXPECT_LT(asked, 3);
  EXPECT_TRUE(control.finished().stop_requested());
  control.finish(AfterRun::kRefine);
  control.resume();
  EXPECT_EQ(control.after(), AfterRun::kRefine);
  EXPECT_EQ(control.take_after(), AfterRun::kRefine);
  EXPECT_EQ(control.take_after(), AfterRun::kNothing);
}

TEST(RunControl, WishesAreHeardOnce) {
  RunControl control;
  EXPECT_FALSE(control.take_save());
  control.ask_save();
  control.ask_save();
  EXPECT_TRUE(control.take_save());
  EXPECT_FALSE(control.take_save());
  control.set_recording(true);
  control.set_recording(false);
  EXPECT_EQ(control.take_recording(), false);
  EXPECT_FALSE(control.take_recording());
}

TEST(RunControl, HoldsStepsAndResumes) {
  RunControl control;
  int asked = 0;
  const auto stop = [&] { return ++asked > 1; };
  EXPECT_EQ(control.wait_turn(stop), 0);
  control.pause();
  EXPECT_GT(control.wait_turn(stop), 0);  // until stop() says so
  control.step();
  asked = -1000;
  control.wait_turn(stop);
  EXPECT_LT(asked, -990);
  EXPECT_TRUE(control.paused());
  asked = 0;
  EXPECT_GT(control.wait_turn(stop), 0);  // the step is used up
  control.resume();
  EXPECT_EQ(control.wait_turn(stop), 0);
}

}  // namespace
}  // namespace sgs::viewer
