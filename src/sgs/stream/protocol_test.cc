// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/stream/protocol.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sgs/stream/address.h"
#include "sgs/stream/frame_codec.h"

namespace sgs::stream {
namespace {

using testing::HasSubstr;
using Part = StreamParser::Part;

Hello sent_hello() {
  Hello hello;
  hello.name = "desk";
  hello.color_camera.camera = {12, 9, 15, 15.5, 5.5, 4.0};
  return hello;
}

RgbdFrame some_frame() {
  RgbdFrame frame;
  frame.timestamp_s = 1.0 / 3;
  frame.color = ColorImage(12, 9, {1, 2, 3});
  frame.depth = DepthImage(12, 9, 1.23456789f);
  frame.depth(1, 1) = 0;
  frame.given_T_world_camera = SE3(so3_exp({0.1, 0.2, 0.3}), {1, 2, 3});
  return frame;
}

std::string whole_stream(const Hello& hello) {
  const auto packet = encode_frame(some_frame(), hello);
  EXPECT_TRUE(packet);
  return encode_hello(hello) + encode_packet(*packet).value() + std::string(kEndMark);
}

/// A part with its JSON, as any program may write it.
std::string part(std::string mark, const std::string& json) {
  for (std::size_t n = json.size(), i = 0; i < 4; ++i, n >>= 8) mark += static_cast<char>(n & 255);
  return mark + json;
}

std::string error_of(const std::string& bytes) {
  StreamParser parser;
  parser.push(bytes);
  while (true) {
    const auto next = parser.next();
    if (!next) return next.error().text();
    if (*next == Part::kNone || *next == Part::kEnd) return "no error";
  }
}

TEST(StreamParser, FindsThePartsHoweverTheBytesCome) {
  const std::string bytes = whole_stream(sent_hello());
  for (const std::size_t step : {std::size_t{1}, std::size_t{7}, bytes.size()}) {
    StreamParser parser;
    std::vector<Part> parts;
    for (std::size_t at = 0; at < bytes.size(); at += step) {
      parser.push(std::string_view(bytes).substr(at, step));
      for (auto next = parser.next();; next = parser.next()) {
        ASSERT_TRUE(next) << next.error().text();
        if (*next == Part::kNone) break;
        parts.push_back(*next);
        if (*next == Part::kEnd) break;
      }
    }
    EXPECT_EQ(parts, (std::vector{Part::kHello, Part::kFrame, Part::kEnd})) << step;
    EXPECT_EQ(parser.hello().color_camera, sent_hello().color_camera);
    EXPECT_EQ(parser.hello().name, "desk");
  }
}

TEST(FrameCodec, WithoutLossEveryBitArrives) {
  StreamParser parser;
  parser.push(whole_stream(sent_hello()));
  ASSERT_EQ(parser.next().value(), Part::kHello);
  ASSERT_EQ(parser.next().value(), Part::kFrame);
  RgbdFrame frame;
  ASSERT_TRUE(FrameDecoder(parser.hello()).decode(parser.packet(), frame));
  const RgbdFrame sent = some_frame();
  EXPECT_EQ(frame.timestamp_s, sent.timestamp_s);
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 12; ++x) {
      EXPECT_EQ(frame.color(x, y), sent.color(x, y));
      EXPECT_EQ(frame.depth(x, y), sent.depth(x, y));
    }
  }
  ASSERT_TRUE(frame.given_T_world_camera);
  EXPECT_TRUE(frame.given_T_world_camera->R.isApprox(sent.given_T_world_camera->R, 1e-14));
}

TEST(FrameCodec, RawUnitsRoundAndWhatIsNoMeasurementIsZero) {
  Hello hello = sent_hello();
  hello.depth = StreamDepth::kU16;
  RgbdFrame frame = some_frame();
  frame.depth(0, 0) = 70;
  RgbdFrame back;
  ASSERT_TRUE(FrameDecoder(hello).decode(encode_frame(frame, hello).value(), back));
  EXPECT_FLOAT_EQ(back.depth(2, 2), 1.235f);
  EXPECT_EQ(back.depth(0, 0), 0);
  hello.depth = StreamDepth::kF32;
  frame.depth(0, 0) = std::numeric_limits<float>::quiet_NaN();
  frame.depth(1, 0) = -1;
  ASSERT_TRUE(FrameDecoder(hello).decode(encode_frame(frame, hello).value(), back));
  EXPECT_EQ(back.depth(0, 0), 0);
  EXPECT_EQ(back.depth(1, 0), 0);
}

TEST(FrameCodec, ImagesOfAnotherSizeAreRefused) {
  FrameDecoder decoder(sent_hello());
  Packet packet = encode_frame(some_frame(), sent_hello()).value();
  RgbdFrame frame;
  Packet cut = packet;
  cut.color.pop_back();
  EXPECT_THAT(decoder.decode(cut, frame).error().text(), HasSubstr("323 bytes where 12x9"));
  packet.depth += "x";
  EXPECT_THAT(decoder.decode(packet, frame).error().text(), HasSubstr("depth has 433 bytes"));
}

// Depth of a camera a little to the side, at two metres, lands where it belongs.
TEST(FrameCodec, DepthOfAnotherCameraIsRegistered) {
  Hello hello;
  hello.color_camera.camera = {40, 30, 50, 50, 19.5, 14.5};
  hello.depth_camera = hello.color_camera;
  hello.T_color_depth.t = {0.2, 0, 0};
  RgbdFrame frame;
  frame.color = ColorImage(40, 30);
  frame.depth = DepthImage(40, 30, 2.0f);
  frame.depth(10, 15) = 0;
  StreamParser parser;
  parser.push(encode_hello(hello));
  ASSERT_EQ(parser.next().value(), Part::kHello);
  ASSERT_TRUE(FrameDecoder(parser.hello()).decode(encode_frame(frame, hello).value(), frame));
  EXPECT_EQ(frame.depth(15, 15), 0);  // 0.2 m at 2 m are five pixels
  EXPECT_EQ(frame.depth(10, 15), 2);
  EXPECT_EQ(frame.depth(2, 15), 0);  // not seen by the depth camera
}

TEST(StreamParser, WhatIsNoStreamIsRefusedAtItsFirstBytes) {
  EXPECT_THAT(error_of("GET / HTTP/1.1\r\n"), HasSubstr("does not begin with SGS1"));
  EXPECT_THAT(error_of("SGX"), HasSubstr("does not begin with SGS1"));
  EXPECT_EQ(error_of("SG"), "no error");
  EXPECT_THAT(error_of(encode_hello(sent_hello()) + "x"), HasSubstr("byte 120, neither F nor E"));
}

TEST(StreamParser, LengthsAreBoundedBeforeAnythingIsReadForThem) {
  EXPECT_THAT(error_of(std::string("SGS1\xff\xff\xff\xff", 8)),
              HasSubstr("greeting of 4294967295"));
  EXPECT_THAT(error_of(encode_hello(sent_hello()) + std::string("F\0\0\x10\0", 5)),
              HasSubstr("header of 1048576 bytes"));
  const auto announced = [](const char* json) {
    return error_of(encode_hello(sent_hello()) + part("F", json));
  };
  EXPECT_THAT(announced(R"({"t":0,"color_bytes":1e18,"depth_bytes":0})"), HasSubstr("color_bytes"));
  EXPECT_THAT(announced(R"({"t":0,"color_bytes":-1,"depth_bytes":0})"), HasSubstr("color_bytes"));
  EXPECT_THAT(announced(R"({"t":0,"color_bytes":67108864,"depth_bytes":1})"),
              HasSubstr("announces 67108865 bytes"));
  EXPECT_THAT(announced(R"({"t":"x","color_bytes":1,"depth_bytes":1})"), HasSubstr("t"));
  EXPECT_THAT(announced("{}"), HasSubstr("needed: t, color_bytes"));
  EXPECT_THAT(announced("[[[["), HasSubstr("a frame's header"));
  EXPECT_THAT(announced(R"({"t":0,"color_bytes":1,"depth_bytes":1,"pose":[1,2,3,0,0,0,2]})"),
              HasSubstr("unit quaternion"));
}

TEST(StreamParser, ALensThatFoldsBackIsRefused) {
  Hello hello = sent_hello();
  hello.color_camera.distortion.k1 = -2;
  EXPECT_THAT(error_of(encode_hello(hello)),
              testing::AllOf(HasSubstr("from camera"), HasSubstr("folds back")));
}

TEST(StreamParser, GreetingsThatCannotBeUsedNameTheKey) {
  const auto greeted = [](const std::string& json) { return error_of(part("SGS1", json)); };
  const std::string camera = R"("camera":{"width":12,"height":9,"fx":5,"fy":5,"cx":1,"cy":1})";
  EXPECT_EQ(greeted("{" + camera + "}"), "no error");
  EXPECT_THAT(greeted("{}"), HasSubstr("camera {width"));
  EXPECT_THAT(greeted(R"({"camera":{"width":9000,"height":9,"fx":5,"fy":5,"cx":1,"cy":1}})"),
              HasSubstr("'width' is 9000"));
  EXPECT_THAT(greeted(R"({"camera":{"width":12,"height":9,"fx":0,"fy":5,"cx":1,"cy":1}})"),
              HasSubstr("camera"));
  EXPECT_THAT(greeted("{" + camera + R"(,"color":"rgb9"})"), HasSubstr("rgb8"));
  EXPECT_THAT(greeted("{" + camera + R"(,"depth_scale":0})"), HasSubstr("depth_scale"));
  EXPECT_THAT(greeted("{" + camera + "," + "\"depth_" + camera.substr(1) + "}"),
              HasSubstr("color_from_depth"));
  EXPECT_THAT(greeted(std::string(2000, '[')), HasSubstr("levels deep"));
}

TEST(EncodePacket, AFrameBeyondTheLimitIsNotSent) {
  Packet packet;
  packet.color.resize(kLargestImages_bytes + 1);
  EXPECT_THAT(encode_packet(packet).error().text(), HasSubstr("--max-width"));
}

/// A greeting of version 2 with everything.
Hello camera_hello() {
  Hello hello = sent_hello();
  hello.version = 2;
  hello.device_clock = hello.listens = true;
  hello.laser = false;
  hello.T_color_imu = SE3(so3_exp({0.1, 0, 0}), {0, 0, 0.01});
  return hello;
}

TEST(Version2, SaysWhatACameraKnows) {
  Packet packet = encode_frame(some_frame(), camera_hello()).value();
  packet.exposure_s = 0.008;
  packet.gain = 16;
  packet.received_s = 1.5e9;
  const std::array<InertialSample, 2> samples = {InertialSample{1, {1, 2, 3}},
                                                 InertialSample{2, {}, {4, 5, 6}}};
  StreamParser parser;
  parser.push(encode_hello(camera_hello()) + encode_imu(samples) + encode_packet(packet).value() +
              std::string(kEndMark));
  ASSERT_EQ(parser.next().value(), Part::kHello);
  const Hello& hello = parser.hello();
  EXPECT_TRUE(hello.version == 2 && hello.device_clock && hello.listens);
  EXPECT_EQ(hello.laser, false);
  ASSERT_TRUE(hello.T_color_imu);
  EXPECT_TRUE(hello.T_color_imu->R.isApprox(camera_hello().T_color_imu->R, 1e-14));
  ASSERT_EQ(parser.next().value(), Part::kImu);
  ASSERT_EQ(parser.imu().size(), 2u);
  EXPECT_EQ(parser.imu()[0].angular_velocity_rad_s[2], 3);
  EXPECT_TRUE(std::isnan(parser.imu()[0].acceleration_m_s2[0]));
  EXPECT_EQ(parser.imu()[1].acceleration_m_s2[0], 4);
  ASSERT_EQ(parser.next().value(), Part::kFrame);
  EXPECT_EQ(parser.packet().exposure_s, 0.008);
  EXPECT_EQ(parser.packet().gain, 16);
  EXPECT_EQ(parser.packet().received_s, 1.5e9);
  EXPECT_FALSE(parser.packet().depth_exposure_s);
  EXPECT_EQ(parser.next().value(), Part::kEnd);
}

TEST(Version2, SamplesAreBoundedAndOfVersion2Only) {
  const std::string hello = encode_hello(camera_hello());
  EXPECT_THAT(error_of(hello + std::string("I\xff\xff\xff\xff", 5)),
              HasSubstr("inertial samples of 4294967295 bytes"));
  EXPECT_THAT(error_of(hello + std::string("I\x37\0\0\0", 5)), HasSubstr("each takes 56"));
  EXPECT_THAT(error_of(encode_hello(sent_hello()) + encode_imu({})), HasSubstr("neither F nor E"));
  EXPECT_EQ(error_of(hello + encode_imu({})), "no error");
  const std::vector<InertialSample> many(5000);
  EXPECT_EQ(error_of(hello + encode_imu(many)), "no error");
  EXPECT_THAT(error_of("SGS4"), HasSubstr("SGS1, SGS2 or SGS3"));
  StreamParser parser;
  const std::array<InertialSample, 1> timeless = {InertialSample{InertialSample::kNone}};
  parser.push(hello + encode_imu(timeless));
  ASSERT_EQ(parser.next().value(), Part::kHello);
  ASSERT_EQ(parser.next().value(), Part::kImu);
  EXPECT_TRUE(parser.imu().empty());
}

Hello hello_with_masks() {
  Hello hello = sent_hello();
  hello.version = 3;
  return hello;
}

/// Somebody stands in the last two columns.
RgbdFrame frame_with_somebody() {
  RgbdFrame frame = some_frame();
  PixelMask still(12, 9, std::uint8_t{1});
  for (int y = 0; y < 9; ++y) still(10, y) = still(11, y) = 0;
  frame.still = std::make_shared<const PixelMask>(std::move(still));
  return frame;
}

TEST(Version3, AMaskSaysWhatMoves) {
  const RgbdFrame sent = frame_with_somebody();
  const Packet packet = encode_frame(sent, hello_with_masks()).value();
  ASSERT_EQ(packet.mask.size(), 12u * 9);
  EXPECT_EQ(packet.mask[9], '\0');
  EXPECT_NE(packet.mask[10], '\0');
  StreamParser parser;
  parser.push(encode_hello(hello_with_masks()) + encode_packet(packet).value() +
              encode_packet(encode_frame(some_frame(), hello_with_masks()).value()).value());
  ASSERT_EQ(parser.next().value(), Part::kHello);
  ASSERT_EQ(parser.next().value(), Part::kFrame);
  FrameDecoder decoder(parser.hello());
  RgbdFrame frame;
  ASSERT_TRUE(decoder.decode(parser.packet(), frame));
  ASSERT_TRUE(frame.still);
  for (int x = 0; x < 12; ++x) EXPECT_EQ((*frame.still)(x, 4) == 0, x >= 10) << x;
  EXPECT_EQ(frame.depth(11, 4), sent.depth(11, 4)) << "as it was sent";
  ASSERT_EQ(parser.next().value(), Part::kFrame);
  ASSERT_TRUE(decoder.decode(parser.packet(), frame));
  EXPECT_FALSE(frame.still) << "of a frame without a mask nothing is known";
}

TEST(Version3, AMaskThatMarksNothingIsNone) {
  Packet packet = encode_frame(some_frame(), hello_with_masks()).value();
  packet.mask.assign(12 * 9, '\0');
  RgbdFrame frame;
  ASSERT_TRUE(FrameDecoder(hello_with_masks()).decode(packet, frame));
  EXPECT_FALSE(frame.still);
}

TEST(Version3, MasksOfAnotherSizeOrTheOtherWayRoundAreRefused) {
  FrameDecoder decoder(hello_with_masks());
  Packet packet = encode_frame(frame_with_somebody(), hello_with_masks()).value();
  packet.mask.pop_back();
  RgbdFrame frame;
  EXPECT_THAT(decoder.decode(packet, frame).error().text(),
              HasSubstr("the mask has 107 bytes where 12x9"));
  packet.mask.assign(12 * 9, '\1');
  EXPECT_THAT(decoder.decode(packet, frame).error().text(),
              HasSubstr("0 stands for what is still"));
}

TEST(Version3, AMaskFollowsTheLens) {
  Hello hello = hello_with_masks();
  hello.color_camera.camera = {64, 48, 60, 60, 31.5, 23.5};
  hello.color_camera.distortion =
      *Distortion::from_coefficients(std::array{0.3, 0.1, 0.0, 0.0}, LensModel::kBrown);
  RgbdFrame sent;
  sent.color = ColorImage(64, 48, {0, 0, 0});
  sent.depth = DepthImage(64, 48, 1.0f);
  PixelMask still(64, 48, std::uint8_t{1});
  for (int y = 4; y < 44; ++y) {
    for (int x = 4; x < 20; ++x) {
      still(x, y) = 0;
      sent.color(x, y) = {255, 255, 255};  // what moves is white
    }
  }
  sent.still = std::make_shared<const PixelMask>(std::move(still));
  RgbdFrame frame;
  ASSERT_TRUE(FrameDecoder(hello).decode(encode_frame(sent, hello).value(), frame));
  ASSERT_TRUE(frame.still && frame.seen);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      const bool moves = (*frame.still)(x, y) == 0;
      const std::uint8_t red = frame.color(x, y).r;
      if (red != 0 && red != 255) continue;  // between both
      EXPECT_EQ(moves, red == 255) << x << " " << y;
      EXPECT_FALSE(moves && (*frame.seen)(x, y) == 0);
    }
  }
}

TEST(Version3, AMaskCountsToTheLimitAndIsOfVersion3Only) {
  Packet packet = encode_frame(frame_with_somebody(), hello_with_masks()).value();
  EXPECT_THAT(error_of(encode_hello(sent_hello()) + encode_packet(packet).value()),
              HasSubstr("does not begin with SGS3"));
  EXPECT_TRUE(encode_frame(frame_with_somebody(), sent_hello()).value().mask.empty());
  const std::string greeting = encode_hello(hello_with_masks());
  const auto announced = [&](const std::string& bytes) {
    return error_of(
        greeting +
        part("F", R"({"t":0,"color_bytes":324,"depth_bytes":432,"mask_bytes":)" + bytes + "}"));
  };
  EXPECT_EQ(announced("108"), "no error");
  EXPECT_THAT(announced("67108864"), HasSubstr("at most 67108864"));
  EXPECT_THAT(announced("-1"), HasSubstr("'mask_bytes' is -1"));
  packet.mask.resize(kLargestImages_bytes);
  EXPECT_FALSE(encode_packet(packet));
}

TEST(Version2, OddValuesAreErrorsOrLeftOut) {
  const std::string camera = R"({"camera":{"width":12,"height":9,"fx":5,"fy":5,"cx":1,"cy":1})";
  EXPECT_EQ(error_of(part("SGS2", camera + R"(,"clock":"sun"})")), "no error");
  EXPECT_THAT(error_of(part("SGS2", camera + R"(,"clock":1})")), HasSubstr("type"));
  EXPECT_THAT(error_of(part("SGS2", camera + R"(,"imu":{}})")), HasSubstr("color_from_imu"));
  EXPECT_EQ(error_of(part("SGS1", camera + R"(,"imu":{}})")), "no error");
  EXPECT_EQ(error_of(encode_hello(camera_hello()) +
                     part("F", R"({"t":0,"color_bytes":0,"depth_bytes":0,"exposure_s":"x"})")),
            "no error");
}

TEST(Address, OfACamera) {
  EXPECT_TRUE(is_stream("camera:"));
  EXPECT_FALSE(is_camera("live:camera:"));
  const auto plain = parse_address("camera:");
  ASSERT_TRUE(plain && plain->camera);
  EXPECT_EQ(plain->camera->family + plain->camera->serial, "");
  const auto whole = parse_address("camera:realsense:01A-3,size=848x480,lock=1.5,every=on");
  ASSERT_TRUE(whole && whole->camera);
  EXPECT_EQ(whole->camera->family, "realsense");
  EXPECT_EQ(whole->camera->serial, "01A-3");
  EXPECT_EQ(whole->camera->options, (std::vector<std::string>{"--size=848x480", "--every=on"}));
  EXPECT_EQ(whole->camera->lock_exposure_after_s, 1.5);
  EXPECT_TRUE(whole->camera->every_frame);
  for (const char* bad :
       {"camera::1", "camera:../x", "camera:a,b", "camera:a,=1", "camera:a,lock=x",
        "camera:a,lock=-1", "camera:a,every=yes", "camera:a,b c=1"}) {
    EXPECT_FALSE(parse_address(bad)) << bad;
  }
}

TEST(Address, HasThreeForms) {
  EXPECT_TRUE(is_stream("live:-"));
  EXPECT_FALSE(is_stream("folder/live:-"));
  EXPECT_EQ(parse_address("live:tcp://127.0.0.1:7447")->port, 7447);
  EXPECT_EQ(parse_address("live:tcp://[::1]:7447")->host, "::1");
  EXPECT_EQ(parse_address("live:-")->path, "-");
  EXPECT_EQ(parse_address("live:/tmp/pipe")->path, "/tmp/pipe");
  for (const char* bad : {"live:", "live:tcp://127.0.0.1", "live:tcp://:1", "live:tcp://a:x",
                          "live:tcp://a:70000", "live:rtsp://a:1"}) {
    EXPECT_FALSE(parse_address(bad)) << bad;
  }
}

/// What arrives of a frame that is sent with this delay.
double delay_received(double time_s, double delay_s) {
  RgbdFrame frame = some_frame();
  frame.timestamp_s = time_s;
  frame.depth_delay_s = delay_s;
  StreamParser parser;
  parser.push(encode_hello(sent_hello()) +
              encode_packet(encode_frame(frame, sent_hello()).value()).value());
  EXPECT_EQ(parser.next().value(), Part::kHello);
  EXPECT_EQ(parser.next().value(), Part::kFrame);
  RgbdFrame back;
  EXPECT_TRUE(FrameDecoder(parser.hello()).decode(parser.packet(), back));
  EXPECT_EQ(back.timestamp_s, time_s);
  return back.depth_delay_s;
}

TEST(FrameCodec, DepthKeepsItsOwnTime) {
  for (const double time_s : {0.0, 1.0 / 3, 1305031102.175304}) {
    for (const double depth_s : {time_s - 0.0171, time_s + 1.0 / 60}) {
      EXPECT_EQ(delay_received(time_s, depth_s - time_s), depth_s - time_s);
    }
    EXPECT_EQ(delay_received(time_s, 0), 0);
  }
}

TEST(FrameCodec, WithoutDelayNothingIsSentOfIt) {
  const std::string bytes = encode_packet(encode_frame(some_frame(), sent_hello()).value()).value();
  EXPECT_THAT(bytes, testing::Not(HasSubstr("depth_t")));
}

}  // namespace
}  // namespace sgs::stream
