// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "sgs/dataset/source_failure.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/temporary_folder.h"
#include "sgs/stream/camera_program.h"
#include "sgs/stream/frame_codec.h"
#include "sgs/stream/stream_source.h"

namespace sgs::stream {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

Hello own_greeting() {
  Hello hello;
  hello.version = 2;
  hello.device_clock = hello.listens = true;
  hello.name = "own";
  hello.color_camera.camera = {32, 24, 50, 50, 15.5, 11.5};
  return hello;
}

std::string own_frame(double time_s) {
  RgbdFrame frame;
  frame.timestamp_s = time_s;
  frame.color = ColorImage(32, 24, {1, 2, 3});
  frame.depth = DepthImage(32, 24, 2.0f);
  return encode_packet(encode_frame(frame, own_greeting()).value()).value();
}

/// Programs for cameras that are scripts: they write files that lie ready.
class Camera : public testing::Test {
 protected:
  void SetUp() override { ::setenv("SGS_CAMERA_PROGRAMS", folder_.path().c_str(), 1); }
  void TearDown() override { ::unsetenv("SGS_CAMERA_PROGRAMS"); }

  /// A script in the folder of its files; it is listed with one device.
  void program(const std::string& script) {
    const fs::path path = folder_.path() / "sgs-camera-own";
    const std::string list = R"({"library":"own 1","devices":[{"name":"a","serial":"7"}]})";
    ASSERT_TRUE(io::write_file(path, fmt::format("#!/bin/sh\ncd {}\nif [ \"$1\" = --list ]; then\n"
                                                 "echo '{}'\nexit 0\nfi\n{}\n",
                                                 folder_.path().string(), list, script)));
    fs::permissions(path, fs::perms::owner_all);
  }
  void file(const std::string& name, const std::string& bytes) {
    ASSERT_TRUE(io::write_file(folder_.path() / name, bytes));
  }
  Result<std::unique_ptr<StreamSource>> open(const std::string& input = "camera:own") {
    Patience patience;
    patience.first_s = patience.wait_s = 20;
    return open_stream(parse_address(input).value(), patience, {});
  }
  /// All that a source gives: "frame TIME", "bad REASON", "event WHAT"; then "end" or "failure".
  static std::vector<std::string> all(StreamSource& source) {
    std::vector<std::string> came;
    try {
      while (true) {
        RgbdFrame frame;
        Error error;
        const auto read = source.next(frame, error);
        if (read == dataset::FrameRead::kOk)
          came.push_back(fmt::format("frame {}", frame.timestamp_s));
        if (read == dataset::FrameRead::kBadFrame) came.push_back("bad " + error.text());
        if (read == dataset::FrameRead::kEvent) came.push_back("event " + error.text());
        if (read == dataset::FrameRead::kEnd) break;
      }
    } catch (const dataset::SourceFailure& failure) {
      came.push_back("failure " + failure.error().text());
    }
    return came;
  }

  io::TemporaryFolder folder_;
};

TEST_F(Camera, FramesAndWhatItSays) {
  file("frames", encode_hello(own_greeting()) + own_frame(1) + own_frame(2) + "E");
  program(
      "echo 'note: the lens is dusty' >&2\necho 'WARNING of an SDK' >&2\nsleep 0.2\ncat frames");
  auto source = open();
  ASSERT_TRUE(source) << source.error().text();
  const auto came = all(**source);
  EXPECT_THAT(came, testing::Contains("event the lens is dusty"));
  EXPECT_THAT(came, testing::Not(testing::Contains(HasSubstr("WARNING"))));
  EXPECT_THAT(came, testing::IsSupersetOf({"frame 1", "frame 2"}));
}

TEST_F(Camera, TheOnlyOneIsFoundAndListed) {
  file("frames", encode_hello(own_greeting()) + "E");
  program("echo \"$@\" > arguments\ncat frames");
  EXPECT_TRUE(open("camera:,fps=15"));
  EXPECT_EQ(io::read_file(folder_.path() / "arguments").value(), "--listen --serial=7 --fps=15\n");
  const auto family = ask_camera_program(find_camera_programs().front());
  EXPECT_EQ(family.library, "own 1");
  ASSERT_EQ(family.devices.size(), 1u);
  EXPECT_EQ(family.devices[0].serial, "7");
  EXPECT_THAT(open("camera:other").error().text(), HasSubstr("there is camera:own"));
}

TEST_F(Camera, WhyThereIsNoneIsItsOwnReason) {
  program("echo 'error: the lens cap is on' >&2\necho 'remedy: take it off' >&2\nexit 1");
  EXPECT_THAT(open().error().text(), HasSubstr("the lens cap is on (take it off)"));
  program("exit 0");
  EXPECT_THAT(open().error().text(), HasSubstr("ended without a word"));
  program("kill -SEGV $$");
  EXPECT_THAT(open().error().text(), HasSubstr("ended by signal 11"));
  program("echo nonsense");
  EXPECT_THAT(open().error().text(), HasSubstr("does not begin with SGS1"));
}

// The first time it dies after two frames; then its clock stands elsewhere.
TEST_F(Camera, ItIsStartedAgainAndItsClockFollows) {
  file("first", encode_hello(own_greeting()) + own_frame(1000) + own_frame(1000.1));
  file("then", encode_hello(own_greeting()) + own_frame(5) + own_frame(5.1) + "E");
  program(
      "if [ -e died ]; then cat then; exit 0; fi\ntouch died\ncat first\n"
      "echo 'error: the camera was unplugged' >&2\nexit 1");
  auto source = open();
  ASSERT_TRUE(source) << source.error().text();
  const auto came = all(**source);
  EXPECT_THAT(came, testing::Contains(HasSubstr("the camera was unplugged; waiting 20 s")));
  EXPECT_THAT(came, testing::Contains(HasSubstr("moved to follow those before")));
  std::vector<double> times_s;
  for (const std::string& what : came) {
    if (what.starts_with("frame")) times_s.push_back(std::stod(what.substr(6)));
  }
  ASSERT_EQ(times_s.size(), 4u);
  EXPECT_GT(times_s[2], 1000.1);
  EXPECT_NEAR(times_s[3] - times_s[2], 0.1, 1e-9);
}

TEST_F(Camera, StampsOfTheFuture) {
  std::string bytes = encode_hello(own_greeting());
  for (const double t : {1.0, 2.0, 1e8, 3.0, 1e5, 1e5 + 1, 1e5 + 2, 1e5 + 3, 1e5 + 4})
    bytes += own_frame(t);
  file("frames", bytes + "E");
  program("cat frames");
  auto source = open();
  ASSERT_TRUE(source) << source.error().text();
  const auto came = all(**source);
  EXPECT_EQ(std::ranges::count_if(came, [](auto& what) { return what.starts_with("bad"); }), 4);
  EXPECT_EQ(std::ranges::count_if(came, [](auto& what) { return what.starts_with("frame"); }), 5);
  EXPECT_THAT(came, testing::Contains(HasSubstr("in the future")));
  EXPECT_THAT(came, testing::Contains(HasSubstr("set forward")));
}

TEST_F(Camera, ALineComesBack) {
  file("frames", encode_hello(own_greeting()) + own_frame(1) + own_frame(2) + own_frame(3));
  program("cat frames\nhead -n 2 > lines\nprintf E");
  auto source = open("camera:own,lock=1");
  ASSERT_TRUE(source) << source.error().text();
  all(**source);
  EXPECT_EQ(io::read_file(folder_.path() / "lines").value(), "ok\nlock_exposure\n");
}

TEST_F(Camera, OneThatDoesNotStopIsEnded) {
  file("frames", encode_hello(own_greeting()) + own_frame(1));
  program("trap '' TERM PIPE\ncat frames\necho $$ > number\nwhile true; do sleep 0.1; done");
  {
    auto source = open();
    ASSERT_TRUE(source) << source.error().text();
    RgbdFrame frame;
    Error error;
    EXPECT_EQ((*source)->next(frame, error), dataset::FrameRead::kOk);
    for (int i = 0; i < 500 && !fs::exists(folder_.path() / "number"); ++i) ::usleep(10000);
  }
  const auto number = io::read_file(folder_.path() / "number").value();
  EXPECT_FALSE(fs::exists("/proc/" + number.substr(0, number.size() - 1)));
}

}  // namespace
}  // namespace sgs::stream
