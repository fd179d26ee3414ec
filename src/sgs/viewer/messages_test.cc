// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/viewer/messages.h"

#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "sgs/viewer/test_update.h"

namespace sgs::viewer {
namespace {

using nlohmann::json;

TEST(Messages, HelloSaysWhatTheRunIs) {
  RunInfo info{
      "1.2", "my \"desk\"\xff", "spectral", "default", true, false, {640, 480, 500, 501, 320, 240},
      40};
  const json hello = json::parse(hello_message(info));
  EXPECT_EQ(hello["type"], "hello");
  EXPECT_EQ(hello["protocol"], 2);
  EXPECT_EQ(hello["frames_total"], 40);
  EXPECT_EQ(hello["camera"]["fy"], 501);
  EXPECT_EQ(hello["refines"], false);
  EXPECT_TRUE(hello["up"].is_null());
  info.up = -Eigen::Vector3d::UnitY();
  EXPECT_EQ(json::parse(hello_message(info))["up"], json({0.0, -1.0, 0.0}));
  EXPECT_EQ(hello["input"].get<std::string>().substr(0, 9), "my \"desk\"");
  info.frames_total.reset();
  EXPECT_TRUE(json::parse(hello_message(info))["frames_total"].is_null());
}

TEST(Messages, RefinementSaysHowItFares) {
  const json note = json::parse(refinement_message({true, 0.25, "30.1 dB"}));
  EXPECT_EQ(note["type"], "refinement");
  EXPECT_EQ(note["running"], true);
  EXPECT_EQ(note["share"], 0.25);
  EXPECT_EQ(note["text"], "30.1 dB");
}

TEST(Messages, StateCarriesWhatTheTrackerSaid) {
  FrameUpdate u = testing::update(7, testing::snapshot(3, {0, 1}));
  u.record.status = tracker::TrackingStatus::kDegenerate;
  u.record.diagnostics.weights = {0, 0, 1, 0.25, 0, 0};
  u.record.diagnostics.degenerate_mask = 4;
  u.record.diagnostics.snr = {1, 2, 3, 4, 5, INFINITY};
  u.record.diagnostics.prior_source = tracker::PriorSource::kPhotometric;
  u.truth = SE3();
  const json state = json::parse(state_message(u, true));
  EXPECT_EQ(state["type"], "state");
  EXPECT_EQ(state["frame"], 7);
  EXPECT_EQ(state["status"], "degenerate");
  EXPECT_TRUE(state["lost"].is_null());
  const json& values = state["values"];
  EXPECT_EQ(values["index"], 7);
  EXPECT_EQ(values["status"], "degenerate");
  EXPECT_EQ(values["prior_source"], "photometric");
  EXPECT_EQ(values["lost_reason"], "none");
  EXPECT_EQ(values["weight"][3], 0.25);
  EXPECT_EQ(values["degenerate_mask"], 4);
  EXPECT_EQ(values["snr"][4], 5);
  EXPECT_TRUE(values["snr"][5].is_null());
  EXPECT_TRUE(values["eigenvalue"].is_null());
  EXPECT_TRUE(values["axis"].is_null());
  EXPECT_EQ(state["pose"], json({7, 0, 0, 0, 0, 0, 1}));
  EXPECT_EQ(state["truth"], json({0, 0, 0, 0, 0, 0, 1}));
  EXPECT_EQ(state["map_version"], 3);
  EXPECT_EQ(state["gaussians"], 2);
  EXPECT_TRUE(state["fps"].is_null());
  EXPECT_EQ(state["paused"], true);
  EXPECT_EQ(state["finished"], false);
  u.record.diagnostics.axes = Matrix6d::Identity();
  EXPECT_EQ(json::parse(state_message(u, false))["values"]["axis"][1], json({0, 1, 0, 0, 0, 0}));
}

// Every column that hello announces is in every state, so that a page can show what it never heard
// of.
TEST(Messages, StateHasEveryAnnouncedColumn) {
  const json hello = json::parse(hello_message({}));
  const json state = json::parse(state_message(testing::update(1), false));
  ASSERT_GT(hello["columns"].size(), 20u);
  for (const json& column : hello["columns"]) {
    EXPECT_TRUE(state["values"].contains(column["key"].get<std::string>())) << column;
    EXPECT_FALSE(column["meaning"].get<std::string>().empty()) << column;
  }
  EXPECT_EQ(state["values"].size(), hello["columns"].size());
}

TEST(Messages, ALostFrameSaysWhy) {
  FrameUpdate u = testing::update(1);
  u.record.status = tracker::TrackingStatus::kLost;
  u.record.lost_reason = alignment::LostReason::kTooFewMatches;
  const json state = json::parse(state_message(u, false));
  EXPECT_EQ(state["lost"], alignment::explain(alignment::LostReason::kTooFewMatches));
  EXPECT_EQ(state["values"]["lost_reason"], "too_few_matches");
}

TEST(Messages, ASessionTellsHowItFares) {
  SessionNote note;
  note.dropped = 3;
  note.warnings = {{"dark", "it is dark"}};
  note.recording = true;
  note.downloads = {"map.ply"};
  const json session = json::parse(session_message(note));
  EXPECT_EQ(session["type"], "session");
  EXPECT_EQ(session["dropped"], 3);
  EXPECT_TRUE(session["camera_fps"].is_null());
  EXPECT_EQ(session["warnings"], json::parse(R"([{"key":"dark","text":"it is dark"}])"));
  EXPECT_EQ(session["recording"], true);
  EXPECT_EQ(session["ended"], false);
  EXPECT_EQ(session["downloads"], json({"map.ply"}));
  const json hello = json::parse(hello_message({}));
  EXPECT_EQ(hello["session"], false) << "a replay has none";
}

TEST(Messages, ABrokenPoseIsNullAndStillJson) {
  FrameUpdate u = testing::update(1);
  u.T_world_camera.t.x() = NAN;
  EXPECT_TRUE(json::parse(state_message(u, false))["pose"].is_null());
}

TEST(Messages, PathKeepsOrderAndGaps) {
  std::vector<PathPoint> points(2);
  points[0].estimate = {1, 2, 3, 0, 0, 0, 1};
  points[0].status = PathPoint::kOk;
  points[0].has_truth = true;
  const json path = json::parse(path_message(5, points));
  EXPECT_EQ(path["first"], 5);
  EXPECT_EQ(path["estimate"][0], json({1, 2, 3, 0, 0, 0, 1}));
  EXPECT_EQ(path["truth"].size(), 2u);
  EXPECT_TRUE(path["truth"][1].is_null());
  EXPECT_EQ(path["status"], json({0, 3}));
  EXPECT_EQ(json::parse(path_message(0, {}))["estimate"], json::array());
}

TEST(Messages, MetricsAreLinesAsPrinted) {
  eval::Metrics metrics;
  metrics.ate_rmse_m = 0.0123;
  metrics.preset = "default";
  const json message = json::parse(metrics_message({metrics, Eigen::Vector3d(0, -0.6, -0.8)}));
  EXPECT_EQ(message["up"], json({0.0, -0.6, -0.8}));
  EXPECT_TRUE(json::parse(metrics_message({metrics}))["up"].is_null());
  EXPECT_EQ(message["type"], "metrics");
  ASSERT_EQ(message["lines"].size(), 2u) << "what was not measured is left out";
  EXPECT_EQ(message["lines"][0]["label"], "ATE RMSE");
  EXPECT_EQ(message["lines"][0]["value"], "1.23 cm");
  EXPECT_EQ(message["lines"][0]["main"], true);
}

TEST(Messages, PictureHeaderIsLittleEndian) {
  EXPECT_EQ(picture_message(Pane::kView, 0x01020304, "jpg"),
            std::string("\x02\x04\0\0\x04\x03\x02\x01jpg", 11));
}

template <class T>
T parsed(const std::string& text) {
  const auto request = parse_request(text);
  EXPECT_TRUE(request) << text;
  return request ? std::get<T>(*request) : T{};
}

TEST(Requests, AreUnderstood) {
  EXPECT_EQ(parsed<ControlRequest>(R"({"type":"control","action":"step"})").action,
            ControlRequest::Action::kStep);
  EXPECT_EQ(parsed<ControlRequest>(R"({"type":"control","action":"finish_and_refine"})").action,
            ControlRequest::Action::kFinishAndRefine);
  const auto subscribe =
      parsed<SubscribeRequest>(R"({"type":"subscribe","map":"points","panes":["depth","error"]})");
  EXPECT_TRUE(subscribe.map);
  EXPECT_EQ(subscribe.panes, bit(Pane::kDepth) | bit(Pane::kError));
  EXPECT_FALSE(parsed<SubscribeRequest>(R"({"type":"subscribe"})").map);
  const auto view = parsed<ViewRequest>(
      R"({"type":"view","seq":4294967295,"pose":[1,2,3,0,0,0,2],"fov_y":0.8,"width":320,"height":200})");
  EXPECT_EQ(view.sequence, 4294967295u);
  EXPECT_EQ(view.T_world_camera.t, Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(view.T_world_camera.R.isIdentity());
  EXPECT_EQ(view.width, 320);
}

TEST(Requests, ViewsAreClamped) {
  const auto view = parsed<ViewRequest>(
      R"({"type":"view","seq":0,"pose":[0,0,0,0,0,0,1],"fov_y":9,"width":1e30,"height":-5})");
  EXPECT_LE(view.fov_y_rad, 2.8);
  EXPECT_EQ(view.width, 1280);
  EXPECT_EQ(view.height, 16);
}

TEST(Requests, NonsenseIsAnError) {
  const std::vector<std::string> nonsense = {
      "",
      "{",
      "[]",
      "null",
      "\xff\xfe",
      R"({"type":1})",
      R"({"type":"hello"})",
      R"({"type":"control"})",
      R"({"type":"control","action":"stop"})",
      R"({"type":"control","action":["pause"]})",
      R"({"type":"subscribe","map":"all"})",
      R"({"type":"subscribe","map":3})",
      R"({"type":"subscribe","panes":"color"})",
      R"({"type":"subscribe","panes":[0]})",
      R"({"type":"subscribe","panes":["view"]})",
      R"({"type":"view"})",
      R"({"type":"view","seq":1,"pose":[0,0,0,0,0,0,0],"fov_y":1,"width":9,"height":9})",
      R"({"type":"view","seq":1,"pose":[1e99,0,0,0,0,0,1],"fov_y":1,"width":9,"height":9})",
      R"({"type":"view","seq":1,"pose":[0,0,0,0,0,1],"fov_y":1,"width":9,"height":9})",
      R"({"type":"view","seq":-1,"pose":[0,0,0,0,0,0,1],"fov_y":1,"width":9,"height":9})",
      R"({"type":"view","seq":1,"pose":[0,0,0,0,0,0,"1"],"fov_y":1,"width":9,"height":9})",
      std::string(3000, '['),
      R"({"type":"control","action":"pause","x":")" + std::string(kMaxRequestBytes, 'x') + "\"}"};
  for (const std::string& text : nonsense) EXPECT_FALSE(parse_request(text)) << text;
}

}  // namespace
}  // namespace sgs::viewer
