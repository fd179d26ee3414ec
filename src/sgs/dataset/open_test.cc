// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/open.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <opencv2/imgcodecs.hpp>

#include "sgs/dataset/calibration_lookup.h"
#include "sgs/dataset/tum_writer.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/image_io.h"
#include "sgs/io/temporary_folder.h"

namespace sgs::dataset {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;

constexpr int kWidth = 32, kHeight = 24;
const PinholeCamera kFolderCamera{kWidth, kHeight, 30, 30, 15.5, 11.5};

RgbdFrame make_frame(int i) {
  RgbdFrame frame;
  frame.timestamp_s = 100 + i / 30.0;
  frame.camera = kFolderCamera;
  frame.color = ColorImage(kWidth, kHeight, {static_cast<std::uint8_t>(10 * i), 100, 50});
  frame.depth = DepthImage(kWidth, kHeight, 1.0f + 0.1f * static_cast<float>(i));
  frame.truth_T_world_camera = SE3(Eigen::Matrix3d::Identity(), {0.1 * i, 0, 0});
  return frame;
}

/// A small valid sequence in TUM layout, to be damaged by the tests.
class TumFolder : public testing::Test {
 protected:
  void write(int frames) {
    auto writer = TumSequenceWriter::create(folder(), kFolderCamera, {"small", 5000, false, 95});
    ASSERT_TRUE(writer) << writer.error().text();
    for (int i = 0; i < frames; ++i) ASSERT_TRUE(writer->add(make_frame(i)));
  }
  fs::path folder() const { return temporary_ / "sequence"; }
  void put(const fs::path& name, std::string_view text) {
    ASSERT_TRUE(io::write_file(folder() / name, text));
  }
  std::string get(const fs::path& name) { return io::read_file(folder() / name).value(); }
  static fs::path image(const char* kind, int i) {
    return fs::path(kind) / fmt::format("{:.6f}.png", 100 + i / 30.0);
  }
  void remove_calibration() {
    fs::remove(folder() / "camera.txt");
    fs::remove(folder() / "sgs.toml");
  }
  std::string open_error(const OpenOptions& options = {}) {
    const auto sequence = open_sequence(folder(), options);
    return sequence ? "no error" : sequence.error().text();
  }
  /// One letter per frame: o for good, x for bad; the errors of bad frames go to `errors`.
  std::string read_all(const OpenOptions& options = {}) {
    auto sequence = open_sequence(folder(), options);
    if (!sequence) return sequence.error().text();
    info = sequence->info;
    errors.clear();
    std::string letters;
    RgbdFrame frame;
    Error error;
    for (std::int64_t i = 0;; ++i) {
      const FrameRead read = sequence->frames->next(frame, error);
      if (read == FrameRead::kEnd) break;
      EXPECT_EQ(frame.index, i);
      if (read == FrameRead::kOk) {
        EXPECT_EQ(frame.color.width(), frame.camera.width);
        EXPECT_EQ(frame.depth.height(), frame.camera.height);
      } else {
        errors += error.text() + "\n";
      }
      letters += read == FrameRead::kOk ? 'o' : 'x';
    }
    EXPECT_EQ(sequence->frames->next(frame, error), FrameRead::kEnd);
    return letters;
  }

  const io::TemporaryFolder temporary_;
  SequenceInfo info;
  std::string errors;
};

TEST_F(TumFolder, ReadsWhatTheWriterWrote) {
  write(5);
  auto sequence = open_sequence(folder());
  ASSERT_TRUE(sequence) << sequence.error().text();
  EXPECT_EQ(sequence->info.layout, "tum");
  EXPECT_EQ(sequence->info.name, "small");
  EXPECT_EQ(sequence->info.frames, 5);
  EXPECT_EQ(sequence->info.truth_rows, 5u);
  EXPECT_EQ(sequence->info.calibration.camera, kFolderCamera);
  EXPECT_THAT(sequence->info.calibration_source, HasSubstr("sgs.toml"));
  EXPECT_TRUE(sequence->info.warnings.empty());
  EXPECT_EQ(sequence->frames->size(), 5);
  RgbdFrame frame;
  Error error;
  for (int i = 0; i < 5; ++i) {
    ASSERT_EQ(sequence->frames->next(frame, error), FrameRead::kOk) << error.text();
    const RgbdFrame expected = make_frame(i);
    EXPECT_NEAR(frame.timestamp_s, expected.timestamp_s, 1e-6);
    EXPECT_EQ(frame.color(3, 4), expected.color(3, 4));
    EXPECT_NEAR(frame.depth(3, 4), expected.depth(3, 4), 1e-4);
    ASSERT_TRUE(frame.truth_T_world_camera);
    EXPECT_NEAR(frame.truth_T_world_camera->t.x(), 0.1 * i, 1e-4);
  }
}

TEST_F(TumFolder, WriterRefusesAFullFolder) {
  write(1);
  EXPECT_FALSE(TumSequenceWriter::create(folder(), kFolderCamera));
}

TEST_F(TumFolder, FrameRangeAndOneFrameOnly) {
  write(6);
  OpenOptions options;
  options.first = 2;
  options.last = 4;
  EXPECT_EQ(read_all(options), "oo");
  EXPECT_EQ(info.frames, 2);
  EXPECT_EQ(info.frames_in_folder, 6);
  EXPECT_NEAR(info.first_time_s, 100 + 2 / 30.0, 1e-6);
  options.last = 3;
  EXPECT_EQ(read_all(options), "o");
  options.first = 6;
  options.last = 9;
  EXPECT_THAT(open_error(options), HasSubstr("the sequence has 6"));
}

TEST_F(TumFolder, MissingFolderAndUnknownLayout) {
  EXPECT_THAT(open_error(), HasSubstr("no such file or folder"));
  fs::create_directories(folder());
  for (const char* wanted : {"rgb.txt", "associations.txt", "results/", "sgs.toml"}) {
    EXPECT_THAT(open_error(), HasSubstr(wanted));
  }
}

TEST_F(TumFolder, NoCalibrationSaysHowToGiveIt) {
  write(2);
  remove_calibration();
  const std::string text = open_error();
  for (const char* wanted :
       {"camera.txt", "cam_params.json", "sgs.toml", "freiburg1", "--camera", "--depth-scale"}) {
    EXPECT_THAT(text, HasSubstr(wanted));
  }
  OpenOptions options;
  options.camera = io::CameraOption{40, 41, 15, 11, {}};
  EXPECT_THAT(open_error(options), HasSubstr("depth scale unknown"));
  options.depth_scale = 2500;
  EXPECT_EQ(read_all(options), "oo");
  EXPECT_EQ(info.calibration.camera, (PinholeCamera{kWidth, kHeight, 40, 41, 15, 11}));
  EXPECT_EQ(info.calibration.depth_scale, 2500);
  options.depth_scale = -1;
  EXPECT_THAT(open_error(options), HasSubstr("must be positive"));
}

TEST_F(TumFolder, CalibrationOrder) {
  write(2);
  put("camera.txt", "31 31 15.5 11.5 32 24 1000\n");
  put("cam_params.json",
      R"({"camera": {"w": 32, "h": 24, "fx": 33, "fy": 33, "cx": 15, "cy": 11, "scale": 4000}})");
  EXPECT_EQ(read_all(), "oo");
  EXPECT_EQ(info.calibration.camera.fx, 30);
  fs::remove(folder() / "sgs.toml");
  EXPECT_EQ(read_all(), "oo");
  EXPECT_EQ(info.calibration.camera.fx, 31);
  OpenOptions options;
  options.depth_scale = 77;
  EXPECT_EQ(read_all(options), "oo");
  EXPECT_EQ(info.calibration.depth_scale, 77);
  fs::remove(folder() / "camera.txt");
  EXPECT_EQ(read_all(), "oo");
  EXPECT_EQ(info.calibration.camera.fx, 33);
}

TEST_F(TumFolder, KnownSequenceNameAndSizeMismatch) {
  write(2);
  remove_calibration();
  const fs::path named = temporary_ / "rgbd_dataset_freiburg3_small";
  fs::rename(folder(), named);
  const auto sequence = open_sequence(named);
  ASSERT_FALSE(sequence);  // the published calibration is for 640x480
  EXPECT_THAT(sequence.error().text(), HasSubstr("known sequence freiburg3"));
  EXPECT_THAT(sequence.error().text(), HasSubstr("640x480"));
  EXPECT_THAT(sequence.error().text(), HasSubstr("32x24"));
}

TEST_F(TumFolder, SequenceNamesAreKnownInAnyCaseAndByTheirShortNames) {
  for (const auto& [name, fx] :
       {std::pair("RGBD_Dataset_Freiburg2_Small", 520.9), std::pair("tum_fr1_small", 517.3),
        std::pair("fr3-small", 535.4)}) {
    FrameList list;
    list.layout = "tum";
    list.folder = temporary_ / name;
    const auto found = find_calibration({list.folder}, list, {});
    ASSERT_TRUE(found) << found.error().text();
    EXPECT_EQ(found->calibration.camera.fx, fx);
    EXPECT_EQ(found->calibration.distortion.k1 != 0, fx < 530);  // fr3 was undistorted before
  }
}

TEST_F(TumFolder, ReplicaScenesHaveOneCameraWhereItsFileWasLeftBehind) {
  FrameList list;
  list.layout = "replica";
  list.folder = temporary_ / "office3";
  const auto found = find_calibration({list.folder}, list, {});
  ASSERT_TRUE(found) << found.error().text();
  EXPECT_EQ(found->calibration.camera, (PinholeCamera{1200, 680, 600, 600, 599.5, 339.5}));
  EXPECT_EQ(found->calibration.depth_scale, 6553.5);
  list.layout = "tum";
  EXPECT_FALSE(find_calibration({list.folder}, list, {}));
}

TEST_F(TumFolder, ListedImageMissingIsABadFrame) {
  write(4);
  fs::remove(folder() / image("rgb", 1));
  fs::remove(folder() / image("depth", 2));
  EXPECT_EQ(read_all(), "oxxo");
  EXPECT_EQ(info.missing_images, 2u);
  EXPECT_THAT(errors, HasSubstr(image("rgb", 1).string()));
  EXPECT_THAT(errors, HasSubstr("rgb.txt:3"));
  EXPECT_THAT(errors, HasSubstr("depth.txt:4"));
  fs::remove_all(folder() / "rgb");
  EXPECT_THAT(open_error(), HasSubstr("none of 4 frames"));
}

TEST_F(TumFolder, TruncatedAndEmptyImagesAreBadFrames) {
  write(6);
  const auto cut = [&](const fs::path& name, std::size_t part, std::size_t parts) {
    const std::string bytes = get(name);
    put(name, bytes.substr(0, bytes.size() * part / parts));
  };
  cut(image("rgb", 0), 1, 2);
  cut(image("depth", 1), 9, 10);
  cut(image("rgb", 3), 0, 1);
  cut(image("depth", 4), 0, 1);
  EXPECT_EQ(read_all(), "xxoxxo");
  EXPECT_THAT(errors, HasSubstr("truncated"));
  EXPECT_THAT(errors, HasSubstr("0 bytes"));
}

TEST_F(TumFolder, WriterKeepsTheLensAndTheStampsOfDepth) {
  const Distortion lens{0.1, -0.02, 0.001, 0, 0};
  TumSequenceWriter::Options options;
  options.distortion = lens;
  auto writer = TumSequenceWriter::create(folder(), kFolderCamera, options);
  ASSERT_TRUE(writer);
  RgbdFrame frame = make_frame(0);
  frame.depth_delay_s = 0.007;
  ASSERT_TRUE(writer->add(frame));
  EXPECT_THAT(get("rgb.txt"), HasSubstr("\n100.000000 rgb/"));
  EXPECT_THAT(get("depth.txt"), HasSubstr("\n100.007000 depth/"));
  const auto sequence = open_sequence(folder());
  ASSERT_TRUE(sequence) << sequence.error().text();
  EXPECT_EQ(sequence->info.calibration.distortion, lens);
}

/// Depth's delays of all frames as delivered.
std::vector<double> delays_of(const Sequence& sequence) {
  std::vector<double> delays_s;
  RgbdFrame frame;
  Error error;
  while (sequence.frames->next(frame, error) == FrameRead::kOk) {
    delays_s.push_back(frame.depth_delay_s);
  }
  return delays_s;
}

TEST_F(TumFolder, DelaysOfDepthSurviveWritingAndReadingToTheBit) {
  auto writer = TumSequenceWriter::create(folder(), kFolderCamera, {"", 5000, false, 95});
  ASSERT_TRUE(writer);
  std::vector<double> sent_s;
  for (int i = 0; i < 6; ++i) {
    RgbdFrame frame = make_frame(i);
    frame.timestamp_s = 1305031102.175304 + i / 30.0;
    // As two stamps of a camera give it.
    const double depth_s = 1305031102.160407 + i / 29.97;
    frame.depth_delay_s = depth_s - frame.timestamp_s;
    sent_s.push_back(frame.depth_delay_s);
    ASSERT_TRUE(writer->add(frame));
  }
  const auto sequence = open_sequence(folder());
  ASSERT_TRUE(sequence) << sequence.error().text();
  ASSERT_TRUE(sequence->info.depth_delays);
  EXPECT_EQ(sequence->info.depth_delays->least_s, sent_s[0]);
  EXPECT_EQ(sequence->info.depth_delays->most_s, sent_s[5]);
  EXPECT_EQ(delays_of(*sequence), sent_s);
  EXPECT_TRUE(sequence->info.warnings.empty());
}

TEST_F(TumFolder, DepthWithTheStampsOfItsColourHasNoDelay) {
  write(3);
  const auto sequence = open_sequence(folder());
  ASSERT_TRUE(sequence);
  EXPECT_FALSE(sequence->info.depth_delays);
  EXPECT_EQ(delays_of(*sequence), std::vector<double>(3, 0.0));
}

TEST_F(TumFolder, AssociationsGiveTheDelaysOfDepthInEitherOrder) {
  write(2);
  fs::remove(folder() / "depth.txt");
  put("associations.txt",
      "100.0 rgb/100.000000.png 100.01 depth/100.000000.png\n"
      "100.05 depth/100.033333.png 100.03 rgb/100.033333.png\n");
  const auto sequence = open_sequence(folder());
  ASSERT_TRUE(sequence) << sequence.error().text();
  const auto delays_s = delays_of(*sequence);
  ASSERT_EQ(delays_s.size(), 2u);
  EXPECT_NEAR(delays_s[0], 0.01, 1e-9);
  EXPECT_NEAR(delays_s[1], 0.02, 1e-9);
}

TEST_F(TumFolder, StampsOfDepthThatAreNoneOrOfAnotherClockAreToldAndDropped) {
  write(4);
  fs::remove(folder() / "depth.txt");
  const auto associations = [&](const std::function<double(int)>& depth_s) {
    std::string text;
    for (int i = 0; i < 4; ++i) {
      text += fmt::format("{:.6f} {} {:.6f} {}\n", 100 + i / 30.0, image("rgb", i).string(),
                          depth_s(i), image("depth", i).string());
    }
    put("associations.txt", text);
  };
  for (const auto& depth_s :
       {std::function<double(int)>([](int) { return 0.0; }),
        std::function<double(int)>([](int i) { return 7 + i / 30.0; }),
        std::function<double(int)>([](int i) { return 100.08 + i / 30.0; })}) {
    associations(depth_s);
    const auto sequence = open_sequence(folder());
    ASSERT_TRUE(sequence) << sequence.error().text();
    EXPECT_THAT(sequence->info.warnings, Contains(HasSubstr("not the clock of colour")));
    EXPECT_THAT(sequence->info.warnings, Contains(HasSubstr(folder().string())));
    EXPECT_FALSE(sequence->info.depth_delays);
    EXPECT_EQ(delays_of(*sequence), std::vector<double>(4, 0.0));
  }
}

TEST_F(TumFolder, TruncatedJpegIsABadFrame) {
  auto writer = TumSequenceWriter::create(folder(), kFolderCamera, {"", 5000, true, 90});
  ASSERT_TRUE(writer);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(writer->add(make_frame(i)));
  const fs::path name = image("rgb", 1).replace_extension(".jpg");
  const std::string bytes = get(name);
  put(name, bytes.substr(0, bytes.size() - 3));
  EXPECT_EQ(read_all(), "oxo");
}

TEST_F(TumFolder, DifferentSizesAndEightBitDepth) {
  write(3);
  const fs::path first = folder() / image("depth", 0), later = folder() / image("depth", 1);
  const std::string good = get(image("depth", 0));
  ASSERT_TRUE(io::save_depth(first, DepthImage(16, 16, 1.0f), 5000));
  EXPECT_THAT(open_error(), HasSubstr("16x16"));
  cv::imwrite(first.string(), cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(9)));
  EXPECT_THAT(open_error(), HasSubstr("8-bit"));
  put(image("depth", 0), good);
  ASSERT_TRUE(io::save_depth(later, DepthImage(16, 16, 1.0f), 5000));
  cv::imwrite((folder() / image("depth", 2)).string(),
              cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(9)));
  EXPECT_EQ(read_all(), "oxx");
}

TEST_F(TumFolder, DepthOfTheSameShapeIsTheSameView) {
  write(3);
  // Of one frame: it is brought to the others. Of all: frames come on the coarser grid.
  ASSERT_TRUE(io::save_depth(folder() / image("depth", 0), DepthImage(16, 12, 1.0f), 5000));
  EXPECT_EQ(read_all(), "ooo");
  EXPECT_EQ(info.delivered.width, kWidth);
  for (int i = 1; i < 3; ++i) {
    ASSERT_TRUE(io::save_depth(folder() / image("depth", i), DepthImage(16, 12, 1.0f), 5000));
  }
  EXPECT_EQ(read_all(), "ooo");
  EXPECT_EQ(info.delivered.width, 16);
  EXPECT_THAT(info.warnings, Contains(HasSubstr("taken for the same view")));
}

TEST_F(TumFolder, RepeatedTimesThatAreNearlyAllAreRefused) {
  write(8);
  for (const char* list : {"rgb.txt", "depth.txt"}) {
    std::string text;
    for (int i = 0; i < 8; ++i) {
      text += fmt::format(
          "100 {}\n", image(std::string(list).starts_with("rgb") ? "rgb" : "depth", i).string());
    }
    put(list, text);
  }
  EXPECT_THAT(open_error(), HasSubstr("lost their digits"));
  EXPECT_THAT(open_error(), HasSubstr("sgs.toml"));
}

TEST_F(TumFolder, WhatSystemsLeaveBehindIsIgnoredAndOneFolderDeeperIsFound) {
  write(3);
  put("._rgb.txt", "x");
  put(".DS_Store", "x");
  put("rgb/._100.000000.png", "x");
  put("rgb.txt", "0 rgb/._100.000000.png\n" + get("rgb.txt"));
  EXPECT_EQ(read_all(), "ooo");
  const auto found = locate_recording(folder().parent_path());
  ASSERT_TRUE(found) << found.error().text();
  EXPECT_FALSE(found->is_bag);
}

TEST_F(TumFolder, AllZeroDepthIsAFrame) {
  write(3);
  ASSERT_TRUE(io::save_depth(folder() / image("depth", 1), DepthImage(kWidth, kHeight), 5000));
  EXPECT_EQ(read_all(), "ooo");
}

TEST_F(TumFolder, UnsortedAndDuplicateTimes) {
  write(3);
  put("rgb.txt", get("rgb.txt") + "100.000000 rgb/100.000000.png\n");
  EXPECT_EQ(read_all(), "ooo");
  EXPECT_THAT(info.warnings, Contains(HasSubstr("sorted")));
  EXPECT_THAT(info.warnings, Contains(HasSubstr("1 rows with a repeated time")));
}

TEST_F(TumFolder, AClockThatIsSetBackInAListGoesOn) {
  write(12);
  for (const char* kind : {"rgb", "depth"}) {
    std::string text;
    for (int i = 0; i < 12; ++i) {
      // Depth is a little later than colour; the clock is set back by two seconds.
      const double time = 100 + i * 0.5 - (i >= 6 ? 2.0 : 0) + (kind[0] == 'd' ? 0.004 : 0);
      text += fmt::format("{:.6f} {}\n", time, image(kind, i).string());
    }
    put(fmt::format("{}.txt", kind), text);
  }
  EXPECT_EQ(read_all(), std::string(12, 'o'));
  EXPECT_THAT(info.warnings, Contains(HasSubstr("set back by")));
  EXPECT_NEAR(info.last_time_s - info.first_time_s, 5.5, 1e-6);
}

TEST_F(TumFolder, GapsAreCountedAndNoOverlapIsAnError) {
  write(4);
  put("depth.txt",
      "100.000000 depth/100.000000.png\n100.066667 depth/100.066667.png\n"
      "100.5 depth/100.066667.png\n");
  EXPECT_EQ(read_all(), "oo");
  EXPECT_EQ(info.color_without_depth, 2u);
  EXPECT_EQ(info.depth_without_color, 1u);
  put("depth.txt", "200.000000 depth/100.000000.png\n201 depth/100.066667.png\n");
  EXPECT_THAT(open_error(), HasSubstr("colour covers 100.000000 .. 100.100000"));
  EXPECT_THAT(open_error(), HasSubstr("200.000000 .. 201.000000"));
}

TEST_F(TumFolder, MalformedListNamesTheLine) {
  write(2);
  put("rgb.txt", "# h\nabc rgb/x.png\n");
  EXPECT_THAT(open_error(), HasSubstr("rgb.txt:2"));
  put("rgb.txt", "# only a comment\n");
  EXPECT_THAT(open_error(), HasSubstr("lists no images"));
}

TEST_F(TumFolder, BadGroundTruthRowsAreSkippedAndTruthIsOptional) {
  write(3);
  put("groundtruth.txt", get("groundtruth.txt") + "100.2 nan 0 0 0 0 0 1\n100.3 0 0 0 0 0 0 2\n");
  EXPECT_EQ(read_all(), "ooo");
  EXPECT_EQ(info.truth_rows, 3u);
  EXPECT_THAT(info.warnings, Contains(HasSubstr("2 rows with NaN")));
  put("groundtruth.txt", "5 0 0 0 0 0 0 1\n");
  EXPECT_EQ(read_all(), "ooo");
  EXPECT_THAT(info.warnings, Contains(HasSubstr("none of the frames")));
  fs::remove(folder() / "groundtruth.txt");
  EXPECT_EQ(read_all(), "ooo");
  EXPECT_EQ(info.truth_rows, 0u);
}

TEST_F(TumFolder, AssociationsAloneInEitherOrder) {
  write(2);
  fs::remove(folder() / "depth.txt");
  put("associations.txt",
      "100.0 rgb/100.000000.png 100.01 depth/100.000000.png\n"
      "100.04 depth/100.033333.png 100.033333 rgb/100.033333.png\n");
  EXPECT_EQ(read_all(), "oo");
  EXPECT_NEAR(info.last_time_s, 100.033333, 1e-9);
}

TEST_F(TumFolder, DistortionIsRemoved) {
  write(1);
  OpenOptions options;
  options.camera = io::CameraOption{30, 30, 15.5, 11.5, {0.8, 0, 0, 0, 0}};
  options.depth_scale = 5000;
  auto sequence = open_sequence(folder(), options);
  ASSERT_TRUE(sequence);
  RgbdFrame frame;
  Error error;
  ASSERT_EQ(sequence->frames->next(frame, error), FrameRead::kOk);
  EXPECT_EQ(frame.depth(0, 0), 0.0f);  // seen outside the distorted image
  EXPECT_NEAR(frame.depth(16, 12), 1.0f, 1e-4);
}

TEST_F(TumFolder, FramesSayWhatTheirLensDidNotShow) {
  write(1);
  OpenOptions options;
  options.depth_scale = 5000;
  options.camera = io::CameraOption{30, 30, 15.5, 11.5, {0.4, 0, 0, 0, 0}};
  auto sequence = open_sequence(folder(), options);
  ASSERT_TRUE(sequence);
  RgbdFrame frame;
  Error error;
  ASSERT_EQ(sequence->frames->next(frame, error), FrameRead::kOk);
  ASSERT_NE(frame.seen, nullptr);
  EXPECT_FALSE(frame.sees(0, 0));
  EXPECT_TRUE(frame.sees(16, 12));
  EXPECT_TRUE(sequence->info.warnings.empty());
  options.camera->distortion = {};
  sequence = open_sequence(folder(), options);
  ASSERT_TRUE(sequence);
  ASSERT_EQ(sequence->frames->next(frame, error), FrameRead::kOk);
  EXPECT_EQ(frame.seen, nullptr);
}

TEST_F(TumFolder, ALensThatLeavesLittleOfThePictureIsTold) {
  write(2);
  OpenOptions options;
  options.depth_scale = 5000;
  options.camera = io::CameraOption{30, 30, 15.5, 11.5, {14, 0, 0, 0, 0}};
  EXPECT_EQ(read_all(options), "oo");
  EXPECT_THAT(info.warnings,
              Contains(testing::AllOf(HasSubstr("% of the picture only"), HasSubstr("--camera"),
                                      HasSubstr(folder().string()))));
}

TEST_F(TumFolder, ALensThatFoldsBackWithinThePictureIsRefused) {
  write(1);
  put("camera.txt", "30 30 15.5 11.5 32 24 5000 -1.2 0 0 0 0\n");
  fs::remove(folder() / "sgs.toml");
  EXPECT_THAT(open_error(), testing::AllOf(HasSubstr("folds back within the picture"),
                                           HasSubstr("camera.txt"), HasSubstr("--camera")));
  OpenOptions options;
  options.depth_scale = 5000;
  options.camera = io::CameraOption{30, 30, 15.5, 11.5, {-1.2, 0, 0, 0, 0}};
  EXPECT_THAT(open_error(options), testing::AllOf(HasSubstr("folds back within the picture"),
                                                  HasSubstr("from --camera")));
  options.camera->distortion = {-0.2, 0, 0, 0, 0};
  EXPECT_EQ(read_all(options), "o");
  // Folds at a distance that is pictured 0.633 from the axis, the corners being 0.643 away.
  options.camera->distortion = {-0.37, 0, 0, 0, 0};
  EXPECT_EQ(read_all(options), "o");
}

TEST_F(TumFolder, PlainFolderByOrderAndByStem) {
  for (const int i : {0, 1, 2}) {
    ASSERT_TRUE(io::save_color(folder() / fmt::format("c/{}.jpg", i), make_frame(i).color));
    ASSERT_TRUE(io::save_depth(folder() / fmt::format("d/{}.png", i), make_frame(i).depth, 1000));
  }
  io::SequenceToml toml;
  toml.calibration = Calibration{kFolderCamera, {}, 1000};
  toml.color = "c";
  toml.depth = "d/*.png";
  toml.fps = 10;
  const fs::path path = folder() / "sgs.toml";
  ASSERT_TRUE(io::save_sequence_toml(path, toml));
  EXPECT_EQ(read_all(), "ooo");
  EXPECT_EQ(info.layout, "folder");
  EXPECT_EQ(info.last_time_s, 0.2);
  fs::remove(folder() / "d/1.png");
  EXPECT_THAT(open_error(), HasSubstr("3 colour but 2 depth"));
  toml.match = io::FrameMatching::kStem;
  ASSERT_TRUE(io::save_sequence_toml(path, toml));
  EXPECT_EQ(read_all(), "oo");
  EXPECT_EQ(info.color_without_depth, 1u);
  toml.color = "none";
  ASSERT_TRUE(io::save_sequence_toml(path, toml));
  EXPECT_THAT(open_error(), HasSubstr("'none'"));
}

TEST_F(TumFolder, ReplicaInBothShapesAndFromTheParent) {
  const char* params =
      R"({"camera": {"w": 32, "h": 24, "fx": 30, "fy": 30, "cx": 15.5, "cy": 11.5, "scale": 1000}})";
  put("cam_params.json", params);
  const auto write_images = [&](const char* color, const char* depth) {
    for (const int i : {0, 1, 2}) {
      ASSERT_TRUE(io::save_color(folder() / fmt::format("office/{}/frame{:06}.jpg", color, i),
                                 make_frame(i).color));
      ASSERT_TRUE(io::save_depth(folder() / fmt::format("office/{}/depth{:06}.png", depth, i),
                                 make_frame(i).depth, 1000));
    }
  };
  write_images("results", "results");
  put("office/traj.txt",
      "1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1\nnan 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n"
      "0 -1 0 1 1 0 0 2 0 0 1 3 0 0 0 1\n");
  EXPECT_EQ(read_all(), "ooo");
  EXPECT_EQ(info.layout, "replica");
  EXPECT_EQ(info.name, "office");
  EXPECT_EQ(info.truth_rows, 2u);
  auto sequence = open_sequence(folder() / "office");
  ASSERT_TRUE(sequence) << sequence.error().text();
  const auto& truth = sequence->frames->ground_truth().poses();
  EXPECT_EQ(truth[0].T_world_camera.t, Eigen::Vector3d(5, 6, 7));
  EXPECT_NEAR(truth[1].timestamp_s, 2 / 30.0, 1e-12);
  EXPECT_NEAR(truth[1].T_world_camera.R(1, 0), 1, 1e-12);
  fs::remove_all(folder() / "office/results");
  write_images("images", "depth_images");
  EXPECT_EQ(read_all(), "ooo");
  fs::copy(folder() / "office", folder() / "room", fs::copy_options::recursive);
  EXPECT_THAT(open_error(), HasSubstr("2 scenes"));
}

struct RealCase {
  const char* folder;
  std::int64_t frames;
  const char* layout;
};
// Without this the test's name would be the addresses of the strings.
void PrintTo(const RealCase& real, std::ostream* out) { *out << real.folder; }
class RealSequences : public testing::TestWithParam<RealCase> {};

TEST_P(RealSequences, OpenAndLookPlausible) {
  const char* variable = std::getenv("SGS_SHARED_DIR");
  const fs::path shared = variable ? fs::path(variable) : fs::path(SGS_SOURCE_DIR) / "../shared";
  const fs::path folder = shared / "data" / GetParam().folder;
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is not there";
  auto sequence = open_sequence(folder);
  ASSERT_TRUE(sequence) << sequence.error().text();
  EXPECT_EQ(sequence->info.frames, GetParam().frames);
  EXPECT_EQ(sequence->info.layout, GetParam().layout);
  EXPECT_GT(sequence->info.truth_rows, 0u);
  RgbdFrame frame;
  Error error;
  std::int64_t count = 0;
  while (count < 20) {
    const FrameRead read = sequence->frames->next(frame, error);
    if (read == FrameRead::kEnd) break;
    ASSERT_EQ(read, FrameRead::kOk) << error.text();
    EXPECT_TRUE(frame.truth_T_world_camera) << count;
    std::vector<float> depths;
    for (std::size_t i = 0; i < frame.depth.size(); ++i) {
      if (frame.depth.data()[i] > 0) depths.push_back(frame.depth.data()[i]);
    }
    EXPECT_GT(depths.size(), frame.depth.size() / 3);
    std::nth_element(depths.begin(), depths.begin() + depths.size() / 2, depths.end());
    EXPECT_GT(depths[depths.size() / 2], 0.5f);
    EXPECT_LT(depths[depths.size() / 2], 4.0f);
    ++count;
  }
  EXPECT_EQ(count, std::min<std::int64_t>(20, GetParam().frames));
  // fr1 has distortion: the undistorted picture differs from the stored one.
  if (!sequence->info.calibration.distortion.is_zero()) {
    const auto stored = io::load_color(folder / "rgb/1305031102.175304.png");
    auto again = open_sequence(folder);
    ASSERT_EQ(again->frames->next(frame, error), FrameRead::kOk);
    ASSERT_TRUE(stored);
    std::size_t different = 0;
    for (std::size_t i = 0; i < stored->size(); ++i) {
      different += stored->data()[i] == frame.color.data()[i] ? 0 : 1;
    }
    EXPECT_GT(different, stored->size() / 2);
  } else {
    EXPECT_STRNE(GetParam().folder, "tum_fr1_xyz_10frames");
  }
}
INSTANTIATE_TEST_SUITE_P(Data, RealSequences,
                         testing::Values(RealCase{"7scenes_redkitchen_600", 600, "tum"},
                                         RealCase{"tum_fr1_xyz_10frames", 10, "tum"},
                                         RealCase{"replica_room0_first20", 20, "replica"}));

TEST_F(TumFolder, ALineOfSeparatorsIsNamed) {
  for (const char* list : {"rgb.txt", "depth.txt"}) {
    fs::remove_all(folder());
    write(3);
    put(list, get(list) + ",\n");
    EXPECT_THAT(open_error(), HasSubstr(list));
  }
  put("associations.txt", " , ,\n");
  fs::remove(folder() / "rgb.txt");
  EXPECT_THAT(open_error(), HasSubstr("associations.txt:1"));
}

TEST_F(TumFolder, TimesTooCloseToRecordAreAnErrorNotAMistake) {
  auto writer = TumSequenceWriter::create(folder(), kFolderCamera);
  ASSERT_TRUE(writer);
  RgbdFrame frame = make_frame(0);
  ASSERT_TRUE(writer->add(frame));
  frame.timestamp_s += 1e-7;
  const Status second = writer->add(frame);
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().text(), HasSubstr("microsecond"));
}

TEST_F(TumFolder, ImagesTooSmallToTrackAreRefused) {
  const PinholeCamera tiny{2, 2, 30, 30, 0.5, 0.5};
  auto writer = TumSequenceWriter::create(folder(), tiny);
  ASSERT_TRUE(writer);
  RgbdFrame frame = make_frame(0);
  frame.camera = tiny;
  frame.color = ColorImage(2, 2);
  frame.depth = DepthImage(2, 2, 1.0f);
  ASSERT_TRUE(writer->add(frame));
  EXPECT_THAT(open_error(), HasSubstr("2x2"));
}

}  // namespace
}  // namespace sgs::dataset
