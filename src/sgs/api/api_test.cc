// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <thread>

#include "sgs/api/sgs.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/temporary_folder.h"

namespace sgs::api {
namespace {

using testing::Eq;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// What a call throws; fails the test where it throws nothing.
template <class Call>
Error error_of(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "nothing was thrown";
  return Error(ErrorCode::kInternal, "");
}

/// The fewest steps that still make a map.
Config quick_config() {
  Config config;
  config.set("mapper.iterations_per_frame", "1");
  return config;
}

std::vector<Frame> room_frames(int count) {
  Recording room = Recording::open("synth:room_desk", {{"frames", "0:" + std::to_string(count)}});
  std::vector<Frame> frames;
  while (auto frame = room.next()) frames.push_back(*frame);
  return frames;
}

ColorView color_of(const Frame& frame) { return {frame.color(), frame.width(), frame.height()}; }
DepthView depth_of(const Frame& frame) {
  return {frame.depth(), frame.width(), frame.height(), 0, DepthFormat::kFloat32, 1};
}

TEST(ApiConfig, ReadsAndWritesEveryKind) {
  Config config;
  config.set("mapper.iterations_per_frame", "4");
  config.set("tracker.type", "gicp");
  config.set("loops.enabled", "false");
  EXPECT_THAT(std::get<double>(config.get("mapper.iterations_per_frame")), Eq(4));
  EXPECT_THAT(std::get<std::string>(config.get("tracker.type")), Eq("gicp"));
  EXPECT_FALSE(std::get<bool>(config.get("loops.enabled")));
  EXPECT_THAT(std::get<std::int64_t>(config.get("slam.seed")), Eq(0));
  EXPECT_THAT(config.info("tracker.type").choices, testing::Contains("gicp"));
}

TEST(ApiConfig, CopiesAreIndependent) {
  Config config;
  Config copy = config;
  copy.set("slam.seed", "7");
  EXPECT_THAT(std::get<std::int64_t>(config.get("slam.seed")), Eq(0));
}

TEST(ApiConfig, EveryKeyCanBeRead) {
  const Config config;
  for (const std::string& key : config.keys()) EXPECT_NO_THROW(config.get(key)) << key;
}

TEST(ApiConfig, LoadsWhatItWrites) {
  const io::TemporaryFolder folder;
  Config config;
  config.set("slam.seed", "42");
  const auto path = folder.path() / "config.toml";
  ASSERT_TRUE(io::write_file(path, config.to_toml()));
  EXPECT_THAT(Config::load(path.string()).to_toml(), Eq(config.to_toml()));
}

TEST(ApiConfig, ErrorsNameTheRemedy) {
  Config config;
  const Error unknown = error_of([&] { config.set("mapper.iterations_per_fram", "4"); });
  EXPECT_THAT(unknown.code(), Eq(ErrorCode::kUnknownKey));
  EXPECT_THAT(unknown.what(), HasSubstr("mapper.iterations_per_frame"));
  EXPECT_THAT(error_of([&] { config.get("nonsense"); }).code(), Eq(ErrorCode::kUnknownKey));
  EXPECT_THAT(error_of([&] { config.set("slam.snapshot_lag", "0"); }).code(),
              Eq(ErrorCode::kInvalidArgument));
  EXPECT_THAT(error_of([] { Config("defaul"); }).what(), HasSubstr("default"));
  EXPECT_THAT(error_of([] { Config::load("/no/such/file"); }).what(), HasSubstr("/no/such/file"));
}

TEST(ApiRecording, TellsWhatIsMissing) {
  EXPECT_THAT(error_of([] { Recording::open("/no/such/folder"); }).what(),
              HasSubstr("/no/such/folder"));
  const Error unknown = error_of([] { Recording::open("synth:room_desk", {{"frame", "0:3"}}); });
  EXPECT_THAT(unknown.code(), Eq(ErrorCode::kUnknownKey));
  EXPECT_THAT(unknown.what(), HasSubstr("frames"));
}

TEST(ApiRecording, KnowsItsCameraAndItsTruth) {
  Recording room = Recording::open("synth:room_desk", {{"frames", "0:3"}});
  EXPECT_THAT(room.size(), Eq(3));
  const auto frame = room.next();
  ASSERT_TRUE(frame);
  EXPECT_THAT(frame->width(), Eq(room.camera().width));
  ASSERT_TRUE(frame->truth());
  EXPECT_THAT(room.ground_truth().size(), testing::Ge(3u));
  room.stop();
}

TEST(ApiSession, CopiedFramesGiveTheBitsOfSharedOnes) {
  const auto frames = room_frames(6);
  Session shared(frames[0].camera(), quick_config());
  Session copied(frames[0].camera(), quick_config());
  for (const Frame& frame : frames) {
    shared.feed(frame);
    copied.feed(color_of(frame), depth_of(frame), frame.timestamp_s());
  }
  shared.finish();
  copied.finish();
  EXPECT_THAT(copied.trajectory().poses, Eq(shared.trajectory().poses));
  ASSERT_TRUE(copied.map() && shared.map());
  ASSERT_THAT(copied.map()->size(), Eq(shared.map()->size()));
  const ArrayView a = copied.map()->positions(), b = shared.map()->positions();
  for (std::size_t i = 0; i < a.rows; ++i) ASSERT_THAT(a.row(i)[0], Eq(b.row(i)[0]));
}

TEST(ApiSession, EveryFormatOfPixelsMeansTheSame) {
  const auto frames = room_frames(1);
  const Frame& frame = frames[0];
  const auto pixels = static_cast<std::size_t>(frame.width()) * frame.height();
  // Rows with gaps, colours in the other order and with a fourth channel; raw depth.
  const std::ptrdiff_t color_stride = 4 * frame.width() + 12, depth_stride = 2 * frame.width() + 6;
  std::vector<std::uint8_t> bgra(static_cast<std::size_t>(color_stride) * frame.height());
  std::vector<std::uint8_t> raw(static_cast<std::size_t>(depth_stride) * frame.height());
  std::vector<float> metres(pixels);
  for (int y = 0; y < frame.height(); ++y) {
    for (int x = 0; x < frame.width(); ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * frame.width() + x;
      std::uint8_t* to = bgra.data() + y * color_stride + 4 * x;
      for (int c = 0; c < 3; ++c) to[2 - c] = frame.color()[3 * i + c];
      const auto units = static_cast<std::uint16_t>(std::lround(1000 * frame.depth()[i]));
      std::memcpy(raw.data() + y * depth_stride + 2 * x, &units, 2);
      metres[i] = static_cast<float>(units / 1000.0);
    }
  }
  metres[0] = std::numeric_limits<float>::quiet_NaN();
  metres[1] = -std::numeric_limits<float>::infinity();
  const std::uint16_t none = 65535, zero = 0;
  std::memcpy(raw.data(), &none, 2);
  std::memcpy(raw.data() + 2, &zero, 2);
  Session plain(frame.camera(), quick_config()), gapped(frame.camera(), quick_config());
  plain.feed(color_of(frame),
             {metres.data(), frame.width(), frame.height(), 0, DepthFormat::kFloat32, 1}, 0);
  gapped.feed({bgra.data(), frame.width(), frame.height(), color_stride, ColorFormat::kBgra},
              {raw.data(), frame.width(), frame.height(), depth_stride, DepthFormat::kUint16, 1000},
              0);
  plain.finish();
  gapped.finish();
  const Map a = plain.map().value(), b = gapped.map().value();
  ASSERT_THAT(a.size(), Eq(b.size()));
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_THAT(a.positions().row(i)[2], Eq(b.positions().row(i)[2]));
    ASSERT_THAT(a.colors().row(i)[0], Eq(b.colors().row(i)[0]));
  }
}

TEST(ApiSession, RefusesFramesThatCannotBeAndIsUnharmed) {
  const auto frames = room_frames(2);
  const Frame& first = frames[0];
  Session session(first.camera(), quick_config());
  const auto code_of = [&](const ColorView& color, const DepthView& depth, double time) {
    return error_of([&] { session.feed(color, depth, time); }).code();
  };
  const ColorView color = color_of(first);
  const DepthView depth = depth_of(first);
  ColorView wrong = color;
  wrong.width /= 2;
  EXPECT_THAT(code_of(wrong, depth, 0), Eq(ErrorCode::kInvalidArgument));
  wrong = color;
  wrong.stride = 5;
  EXPECT_THAT(code_of(wrong, depth, 0), Eq(ErrorCode::kInvalidArgument));
  EXPECT_THAT(code_of({}, depth, 0), Eq(ErrorCode::kInvalidArgument));
  DepthView far = depth;
  far.scale = 0;
  EXPECT_THAT(code_of(color, far, 0), Eq(ErrorCode::kInvalidArgument));
  far.scale = 0.001;  // thousands of metres
  EXPECT_THAT(code_of(color, far, 0), Eq(ErrorCode::kInvalidFormat));
  EXPECT_THAT(code_of(color, depth, std::nan("")), Eq(ErrorCode::kInvalidArgument));
  EXPECT_THAT(session.frames(), IsEmpty());

  EXPECT_THAT(session.feed(first).index, Eq(0));
  EXPECT_THAT(code_of(color, depth, first.timestamp_s()), Eq(ErrorCode::kInvalidArgument));
  EXPECT_THAT(error_of([&] { session.feed(first); }).code(), Eq(ErrorCode::kInvalidArgument));
  EXPECT_THAT(session.feed(frames[1]).index, Eq(1));
  EXPECT_THAT(error_of([&] { session.save("/tmp/unused"); }).what(), HasSubstr("finish"));
  session.finish();
  session.finish();
  EXPECT_THAT(error_of([&] { session.feed(frames[1]); }).what(), HasSubstr("finished"));
}

TEST(ApiSession, RefusesCamerasThreadsAndPosesThatCannotBe) {
  const Camera good = {64, 48, 50, 50, 31.5, 23.5, {}};
  const auto code_with = [&](auto&& change) {
    Camera camera = good;
    SessionOptions options;
    change(camera, options);
    return error_of([&] { Session(camera, Config(), options); }).code();
  };
  using enum ErrorCode;
  EXPECT_THAT(code_with([](auto& c, auto&) { c.fx = 0; }), Eq(kInvalidArgument));
  EXPECT_THAT(code_with([](auto& c, auto&) { c.width = 1 << 30; }), Eq(kInvalidArgument));
  EXPECT_THAT(code_with([](auto& c, auto&) { c.distortion = {0.1}; }), Eq(kInvalidArgument));
  EXPECT_THAT(code_with([](auto& c, auto&) {
                c.lens = Lens::kFisheye;
                c.distortion = {0.1, 0, 0, 0, 0};
              }),
              Eq(kInvalidArgument));
  EXPECT_THAT(code_with([](auto&, auto& o) { o.threads = 0; }), Eq(kInvalidArgument));
  EXPECT_THAT(code_with([](auto&, auto& o) { o.threads = 1000; }), Eq(kInvalidArgument));
  EXPECT_THAT(code_with([](auto&, auto& o) { o.T_world_first[0] = 2; }), Eq(kInvalidArgument));
}

TEST(ApiSession, TakesTheLensOutOfTheFrames) {
  const auto frames = room_frames(1);
  Camera lens = frames[0].camera();
  Session straight(lens, quick_config());
  lens.distortion = {0.2, 0, 0, 0};
  Session bent(lens, quick_config());
  straight.feed(color_of(frames[0]), depth_of(frames[0]), 0);
  bent.feed(color_of(frames[0]), depth_of(frames[0]), 0);
  straight.finish();
  bent.finish();
  EXPECT_THAT(bent.camera().distortion, IsEmpty());
  EXPECT_THAT(bent.map()->size(), Not(Eq(straight.map()->size())));
}

TEST(ApiSession, AFisheyeIsALensEvenWithoutCoefficients) {
  const auto frames = room_frames(1);
  std::vector<std::size_t> sizes;
  for (const Lens model : {Lens::kBrown, Lens::kFisheye}) {
    Camera lens = frames[0].camera();
    lens.lens = model;
    Session session(lens, quick_config());
    session.feed(color_of(frames[0]), depth_of(frames[0]), 0);
    session.finish();
    EXPECT_THAT(session.camera().lens, Eq(Lens::kBrown));
    sizes.push_back(session.map()->size());
  }
  EXPECT_THAT(sizes[1], Not(Eq(sizes[0])));
}

TEST(ApiSession, ReadersMayRunBesideTheFeeder) {
  const auto frames = room_frames(8);
  Session session(frames[0].camera(), quick_config());
  std::jthread reader([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      const auto map = session.map();
      if (map) {
        EXPECT_THAT(map->positions().rows, Eq(map->size()));
      }
      EXPECT_THAT(session.trajectory().size(), testing::Le(frames.size()));
    }
  });
  for (const Frame& frame : frames) session.feed(frame);
  session.finish();
  reader.request_stop();
}

TEST(ApiSession, EveryFrameIsFedOnceWhateverTwoFeedersDo) {
  const auto frames = room_frames(8);
  Session session(frames[0].camera(), quick_config());
  std::atomic<int> fed = 0, busy = 0;
  const auto feeder = [&] {
    for (const Frame& frame : frames) {
      try {
        session.feed(frame);
        ++fed;
      } catch (const Error& error) {
        busy += error.code() == ErrorCode::kBusy ? 1 : 0;
      }
    }
  };
  { const std::jthread a(feeder), b(feeder); }
  session.finish();
  EXPECT_THAT(session.frames().size(), Eq(static_cast<std::size_t>(fed)));
}

TEST(ApiMap, LivesOnAfterItsSessionAndRenders) {
  const auto frames = room_frames(4);
  std::optional<Map> map;
  {
    Session session(frames[0].camera(), quick_config());
    EXPECT_FALSE(session.map());
    for (const Frame& frame : frames) session.feed(frame);
    session.finish();
    map = session.map();
  }
  ASSERT_TRUE(map);
  const Rendering picture = map->render(frames[0].camera(), kIdentityPose);
  EXPECT_THAT(picture.color.size(), Eq(3u * picture.width * picture.height));
  double error = 0;
  for (std::size_t i = 0; i < picture.color.size(); ++i) {
    error += std::abs(255.0 * picture.color[i] - frames[0].color()[i]);
  }
  EXPECT_LT(error / static_cast<double>(picture.color.size()), 40);
  Pose bent = kIdentityPose;
  bent[5] = 3;
  EXPECT_THAT(error_of([&] { map->render(frames[0].camera(), bent); }).code(),
              Eq(ErrorCode::kInvalidArgument));

  const io::TemporaryFolder folder;
  const std::string path = (folder.path() / "map.ply").string();
  map->save(path);
  EXPECT_THAT(Map::load(path).size(), Eq(map->size()));
}

TEST(ApiEvaluate, ScoresTrajectories) {
  Trajectory truth;
  for (int i = 0; i < 10; ++i) {
    Pose pose = kIdentityPose;
    pose[3] = 0.1 * i * i;
    pose[7] = i % 3;
    truth.times.push_back(0.1 * i);
    truth.poses.push_back(pose);
  }
  const auto ate_of = [&](const Trajectory& estimate) {
    for (const Metric& metric : evaluate(estimate, truth)) {
      if (metric.key == "ate_rmse_m") return std::get<double>(metric.value);
    }
    return -1.0;
  };
  EXPECT_THAT(ate_of(truth), testing::DoubleNear(0, 1e-9));
  Trajectory shaken = truth;
  shaken.poses[4][3] += 0.5;
  EXPECT_THAT(ate_of(shaken), testing::Gt(0.1));
  shaken.times[3] = shaken.times[2];
  EXPECT_THAT(error_of([&] { evaluate(shaken, truth); }).code(), Eq(ErrorCode::kInvalidArgument));
  EXPECT_THAT(error_of([&] { evaluate(truth, truth, "near"); }).what(), HasSubstr("nearest"));
}

TEST(ApiRun, DoesWhatTheProgramDoesAndCanBeStopped) {
  const io::TemporaryFolder folder;
  const std::string out = (folder.path() / "out").string();
  RunOptions options;
  options.output = out;
  std::int64_t told = 0;
  const auto summary = run("synth:room_desk", {{"frames", "0:4"}}, quick_config(), options,
                           [&](std::int64_t frames) { told = frames; });
  EXPECT_THAT(told, Eq(4));
  EXPECT_THAT(summary.frames, Eq(4));
  for (const char* file : {"trajectory.txt", "map.ply", "metrics.json", "report.html"}) {
    EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(out) / file)) << file;
  }
  const auto again = evaluate_run(out);
  ASSERT_THAT(again.size(), Eq(summary.metrics.size()));
  for (std::size_t i = 0; i < again.size(); ++i) {
    if (again[i].key == "psnr_db") {
      EXPECT_EQ(again[i].value, summary.metrics[i].value);
    }
  }

  Stop stop;
  const auto stopped = run(
      "synth:room_desk", {{"frames", "0:50"}}, quick_config(), options,
      [&](std::int64_t) { stop.request(); }, stop);
  EXPECT_TRUE(stopped.stopped);
  EXPECT_THAT(stopped.frames, testing::Lt(50));
}

TEST(ApiRun, ThePresetQualityIsWhole) {
  const io::TemporaryFolder folder;
  Config config("quality");
  EXPECT_THAT(std::get<double>(config.get("refine.steps_per_frame")), testing::Gt(0));
  config.set("mapper.iterations_per_frame", "1");
  config.set("refine.least_steps", "10");
  RunOptions options;
  options.output = (folder.path() / "out").string();
  options.pictures = false;
  const auto steps_of = [&](const Config& used) {
    const auto summary = run("synth:room_desk", {{"frames", "0:4"}}, used, options);
    const auto steps =
        std::find_if(summary.metrics.begin(), summary.metrics.end(),
                     [](const Metric& metric) { return metric.key == "mapping_iterations"; });
    return std::get<std::int64_t>(steps->value);
  };
  Config without = config;
  without.set("refine.steps_per_frame", "0");
  const std::int64_t mapped = steps_of(without);
  EXPECT_THAT(steps_of(config), testing::Gt(mapped));
  const auto kept = io::read_file(folder.path() / "out" / "config.toml");
  ASSERT_TRUE(kept);
  EXPECT_THAT(*kept, HasSubstr("steps_per_frame = 15"));

  options.realtime = true;
  const Error refused = error_of([&] { steps_of(config); });
  EXPECT_THAT(refused.code(), Eq(ErrorCode::kInvalidArgument));
  EXPECT_THAT(refused.what(), HasSubstr("refine.steps_per_frame"));
}

}  // namespace
}  // namespace sgs::api
