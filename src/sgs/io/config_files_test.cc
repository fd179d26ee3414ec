// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sgs/io/atomic_file.h"
#include "sgs/io/calibration_io.h"
#include "sgs/io/camera_file.h"
#include "sgs/io/temporary_folder.h"
#include "sgs/io/toml_config.h"

namespace sgs::io {
namespace {

using testing::HasSubstr;

struct Settings {
  int window = 8;
  double rate = 0.5;
  bool fast = false;
  std::string mode = "a";
  std::uint64_t seed = 1;
  ParameterList list;
  Settings() {
    list.add("seed", seed, "The seed.");
    const auto outer = list.group("mapper");
    list.add("window", window, "The window.", "", {1, 64});
    list.add("fast", fast, "Fast or not.");
    const auto inner = list.group("adam");
    list.add("rate", rate, "The rate.", "", {0, 1});
    list.add("mode", mode, "The mode.", {"a", "b"});
  }
};

TEST(TomlConfig, SetsNestedKeys) {
  Settings s;
  const auto status = apply_toml_text(
      "seed = 42\n[mapper]\nwindow = 16\nfast = true\n[mapper.adam]\nrate = 1\nmode = \"b\"\n", "x",
      s.list);
  ASSERT_TRUE(status) << status.error().text();
  EXPECT_EQ(s.seed, 42u);
  EXPECT_EQ(s.window, 16);
  EXPECT_TRUE(s.fast);
  EXPECT_EQ(s.rate, 1.0);
  EXPECT_EQ(s.mode, "b");
}

TEST(TomlConfig, EffectiveConfigReadsBack) {
  Settings a, b;
  a.window = 3;
  a.rate = 0.1;
  a.mode = "b";
  const auto status = apply_toml_text(a.list.to_toml(), "x", b.list);
  ASSERT_TRUE(status) << status.error().text();
  EXPECT_EQ(a.list.to_toml(), b.list.to_toml());
}

TEST(TomlConfig, EveryTextAndSeedReadsBack) {
  struct Values {
    std::string text;
    std::uint64_t seed = 0;
    ParameterList list;
    Values() {
      list.add("text", text, "Any text.", {});
      list.add("seed", seed, "The seed.");
    }
  };
  Values a, b;
  a.seed = 18446744073709551615u;
  for (int c = 0; c < 128; ++c) a.text += static_cast<char>(c);
  a.text += "\xC3\xA4\xF0\x9F\x98\x80 \"\"\" ";
  const auto status = apply_toml_text(a.list.to_toml(), "x", b.list);
  ASSERT_TRUE(status) << status.error().text() << a.list.to_toml();
  EXPECT_EQ(b.text, a.text);
  EXPECT_EQ(b.seed, a.seed);
  EXPECT_FALSE(apply_toml_text("seed = \"-1\"", "x", b.list));
}

TEST(TomlConfig, FormerKeysAreRefusedByTheirNewName) {
  Settings s;
  s.list.renamed("mapper.speed", "mapper.fast");
  const auto status = apply_toml_text("[mapper]\nspeed = true\n", "run.toml", s.list);
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().message, HasSubstr("run.toml:2"));
  EXPECT_THAT(status.error().message, HasSubstr("is now called 'mapper.fast'"));
  EXPECT_FALSE(s.fast);
}

TEST(TomlConfig, ErrorsNameFileLineAndKey) {
  const auto message = [](const char* text) {
    Settings s;
    const auto status = apply_toml_text(text, "run.toml", s.list);
    return status ? std::string("no error") : status.error().text();
  };
  EXPECT_THAT(message("[mapper]\n\nwindov = 3\n"), HasSubstr("run.toml:3"));
  EXPECT_THAT(message("[mapper]\n\nwindov = 3\n"), HasSubstr("'mapper.window'"));
  EXPECT_THAT(message("[mapper]\nwindow = 65\n"), HasSubstr("run.toml:2"));
  EXPECT_THAT(message("[mapper]\nwindow = 65\n"), HasSubstr("1 .. 64"));
  EXPECT_THAT(message("[mapper]\nwindow = 1.5\n"), HasSubstr("whole number"));
  EXPECT_THAT(message("[mapper]\nwindow = \"8\"\n"), HasSubstr("must be a number"));
  EXPECT_THAT(message("[mapper]\nfast = 1\n"), HasSubstr("true or false"));
  EXPECT_THAT(message("[mapper.adam]\nmode = 3\n"), HasSubstr("must be a string"));
  EXPECT_THAT(message("[mapper.adam]\nmode = \"c\"\n"), HasSubstr("a | b"));
  EXPECT_THAT(message("[mapper.adam]\nrate = nan\n"), HasSubstr("'mapper.adam.rate'"));
  EXPECT_THAT(message("seed = [1]\n"), HasSubstr("must be a number"));
  EXPECT_THAT(message("seed = 1\nseed 2\n"), HasSubstr("run.toml:2"));
}

TEST(Calibration, CameraTxt) {
  const TemporaryFolder folder;
  const auto path = folder / "camera.txt";
  ASSERT_TRUE(
      write_file(path, "# c\n517.3 516.5 318.6 255.3 640 480 5000 0.26 -0.95 -0.01 0.02 1.2\n"));
  const auto c = load_camera_txt(path);
  ASSERT_TRUE(c) << c.error().text();
  EXPECT_EQ(c->camera, (PinholeCamera{640, 480, 517.3, 516.5, 318.6, 255.3}));
  EXPECT_EQ(c->distortion, (Distortion{0.26, -0.95, -0.01, 0.02, 1.2}));
  EXPECT_EQ(c->depth_scale, 5000);
  ASSERT_TRUE(save_camera_txt(folder / "b.txt", *c));
  EXPECT_EQ(load_camera_txt(folder / "b.txt").value(), *c);
  const Calibration rational{c->camera, {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8}, 1000};
  ASSERT_TRUE(save_camera_txt(folder / "c.txt", rational));
  EXPECT_EQ(load_camera_txt(folder / "c.txt").value(), rational);
  SequenceToml toml;
  toml.calibration = rational;
  ASSERT_TRUE(save_sequence_toml(folder / "c.toml", toml));
  EXPECT_EQ(load_sequence_toml(folder / "c.toml").value().calibration, rational);
  for (const char* bad : {"", "1 2 3", "1 1 1 1 640 480 5000 0.1", "0 1 1 1 640 480 5000",
                          "1 1 1 1 640.5 480 5000", "1 1 1 1 -640 480 5000", "1 1 1 1 640 480 0",
                          "1 1 nan 1 640 480 5000", "1 1 1 1 640 480 5000\n1 1 1 1 640 480 5000"}) {
    ASSERT_TRUE(write_file(path, bad));
    const auto result = load_camera_txt(path);
    ASSERT_FALSE(result) << bad;
    EXPECT_THAT(result.error().message, HasSubstr("camera.txt"));
  }
}

TEST(Calibration, CameraOption) {
  const auto option = parse_camera_option("525,526,319.5,239.5");
  ASSERT_TRUE(option);
  EXPECT_EQ(option->fy, 526);
  EXPECT_TRUE(option->distortion.is_zero());
  EXPECT_EQ(parse_camera_option("1,1,1,1,.1,.2,.3,.4,.5")->distortion.k3, 0.5);
  EXPECT_EQ(parse_camera_option("1,1,1,1,.1,.2,.3,.4,.5,.6,.7,.8")->distortion.k6, 0.8);
  const auto fisheye = parse_camera_option("1,1,1,1,fisheye,.1,.2,.3,.4");
  ASSERT_TRUE(fisheye);
  EXPECT_TRUE(fisheye->distortion.is_fisheye());
  EXPECT_EQ(fisheye->distortion.written(), (std::vector<double>{0.1, 0.2, 0.3, 0.4}));
  for (const char* bad :
       {"", "1,2,3", "1,2,3,4,5", "1,1,1,1,1,1,1,1,1,1", "a,b,c,d", "-1,1,1,1", "inf,1,1,1",
        "1,1,1,1,fisheye", "1,1,1,1,fisheye,1,2,3", "1,1,1,1,bent,1,2,3,4"}) {
    EXPECT_FALSE(parse_camera_option(bad)) << bad;
  }
}

TEST(Calibration, AFisheyeComesBackAsItWas) {
  const TemporaryFolder folder;
  const Calibration fisheye{
      {640, 480, 400, 401, 320, 240},
      *Distortion::from_coefficients(std::vector{-0.02, 0.01, -0.003, 5e-4}, LensModel::kFisheye),
      1000};
  ASSERT_TRUE(save_camera_txt(folder / "c.txt", fisheye));
  EXPECT_EQ(load_camera_txt(folder / "c.txt").value(), fisheye);
  SequenceToml toml;
  toml.calibration = fisheye;
  ASSERT_TRUE(save_sequence_toml(folder / "c.toml", toml));
  EXPECT_EQ(load_sequence_toml(folder / "c.toml").value().calibration, fisheye);
  ASSERT_TRUE(write_file(folder / "d.toml",
                         "[camera]\nfx = 1\nfy = 1\ncx = 1\ncy = 1\nwidth = 9\nheight = 9\n"
                         "lens = \"fisheye\"\ndistortion = [0, 0, 0, 0, 0]\n"));
  EXPECT_THAT(load_sequence_toml(folder / "d.toml").error().message, HasSubstr("[k1, k2, k3, k4]"));
}

TEST(Calibration, LensesAreKnownByManyNames) {
  for (const char* name : {"equidistant", "Kannala Brandt4", "OPENCV_FISHEYE", "kannala_brandt"}) {
    EXPECT_EQ(lens_model_named(name), LensModel::kFisheye) << name;
  }
  for (const char* name : {"", "plumb_bob", "rational_polynomial", "Inverse Brown Conrady"}) {
    EXPECT_EQ(lens_model_named(name), LensModel::kBrown) << name;
  }
  EXPECT_FALSE(lens_model_named("ftheta"));
  EXPECT_TRUE(lens_named("plumb_bob", std::vector<double>(14, 0.0)));
  EXPECT_FALSE(lens_named("equidistant", std::vector{0.1, 0.0, 0.0, 0.0, 0.1}));
}

TEST(Calibration, CamParamsJson) {
  const TemporaryFolder folder;
  const auto path = folder / "cam_params.json";
  ASSERT_TRUE(write_file(path, R"({"camera": {"w": 1200, "h": 680, "fx": 600.0, "fy": 600.0,
                                  "cx": 599.5, "cy": 339.5, "scale": 6553.5}})"));
  EXPECT_EQ(load_cam_params_json(path).value().camera,
            (PinholeCamera{1200, 680, 600, 600, 599.5, 339.5}));
  ASSERT_TRUE(write_file(path, R"({"camera": {"w": 1200}})"));
  EXPECT_THAT(load_cam_params_json(path).error().message, HasSubstr("cam_params.json"));
  ASSERT_TRUE(write_file(path, "{"));
  EXPECT_FALSE(load_cam_params_json(path));
}

// A number in JSON need not fit into any type (found by fuzzing).
TEST(Calibration, WidthsThatAreNoneAreRefused) {
  const TemporaryFolder folder;
  const auto path = folder / "cam_params.json";
  for (const char* width : {"1e27", "-5", "12.5", "0", "1e400"}) {
    ASSERT_TRUE(
        write_file(path, fmt::format(R"({{"camera": {{"w": {}, "h": 680, "fx": 600.0, "fy": 600.0,
                             "cx": 599.5, "cy": 339.5, "scale": 6553.5}}}})",
                                     width)));
    EXPECT_FALSE(load_cam_params_json(path)) << width;
  }
}

TEST(Calibration, SequenceTomlRoundTripAndErrors) {
  const TemporaryFolder folder;
  SequenceToml content;
  content.calibration =
      Calibration{{640, 480, 525, 525.25, 319.5, 239.5}, {0.1, 0, 0, 0, -1}, 1000};
  content.name = "a \"quoted\" name";
  content.color = "color/*.jpg";
  content.depth = "depth";
  content.match = FrameMatching::kStem;
  content.fps = 15;
  content.trajectory = "poses.txt";
  const auto path = folder / "sgs.toml";
  ASSERT_TRUE(save_sequence_toml(path, content));
  const auto back = load_sequence_toml(path);
  ASSERT_TRUE(back) << back.error().text();
  EXPECT_EQ(back->calibration, content.calibration);
  EXPECT_EQ(back->name, content.name);
  EXPECT_EQ(back->color, content.color);
  EXPECT_EQ(back->match, content.match);
  EXPECT_EQ(back->fps, 15);
  EXPECT_EQ(back->trajectory, "poses.txt");

  content.name = "two\nlines \\ \x01 \xC3\xA4";
  ASSERT_TRUE(save_sequence_toml(path, content));
  EXPECT_EQ(load_sequence_toml(path).value().name, content.name);
  content.name = "\xE4";
  ASSERT_FALSE(save_sequence_toml(path, content));
  EXPECT_THAT(save_sequence_toml(path, content).error().message, HasSubstr("UTF-8"));

  const auto message = [&](const char* text) {
    EXPECT_TRUE(write_file(path, text));
    const auto result = load_sequence_toml(path);
    return result ? std::string("no error") : result.error().text();
  };
  EXPECT_THAT(message("[sequence]\nfsp = 3\n"), HasSubstr("sequence.fps"));
  EXPECT_THAT(message("[camera]\nfx = 1\n"), HasSubstr("lacks 'fy'"));
  EXPECT_THAT(message("[camera]\nfx=1\nfy=1\ncx=1\ncy=1\nwidth=1\nheight=1\ndistortion=[1]\n"),
              HasSubstr("sgs.toml:8"));
  EXPECT_THAT(message("[camera]\nfx=-1\nfy=1\ncx=1\ncy=1\nwidth=1\nheight=1\n"),
              HasSubstr("sgs.toml:2"));
  EXPECT_THAT(message("[sequence]\ncolor = \"c\"\n"), HasSubstr("both"));
}

TEST(TomlConfig, KeysOfAHundredThousandPartsAreRefused) {
  Settings s;
  std::string key = "a";
  for (int i = 0; i < 100'000; ++i) key += ".a";
  for (const std::string& text : {key + " = 1", "[" + key + "]", "x = {" + key + " = 1}"}) {
    const auto status = apply_toml_text(text, "x.toml", s.list);
    ASSERT_FALSE(status);
    EXPECT_THAT(status.error().text(), HasSubstr("x.toml"));
  }
}

}  // namespace
}  // namespace sgs::io
