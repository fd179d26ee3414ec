// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/image_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <zlib.h>

#include <limits>
#include <new>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "sgs/io/atomic_file.h"
#include "sgs/io/temporary_folder.h"

namespace sgs::io {
namespace {

using testing::HasSubstr;

ColorImage test_picture() {
  ColorImage image(64, 48);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      image(x, y) = {static_cast<std::uint8_t>(4 * x), static_cast<std::uint8_t>(5 * y),
                     static_cast<std::uint8_t>((x * 37 + y * 91) % 256)};
    }
  }
  return image;
}

TEST(ImageIo, PngIsLosslessAndRedComesFirst) {
  const TemporaryFolder folder;
  const ColorImage image = test_picture();
  ASSERT_TRUE(save_color(folder / "a.png", image));
  const auto back = load_color(folder / "a.png");
  ASSERT_TRUE(back) << back.error().text();
  ASSERT_EQ(back->width(), 64);
  for (std::size_t i = 0; i < image.size(); ++i) ASSERT_EQ(back->data()[i], image.data()[i]);
  const cv::Mat bgr = cv::imread((folder / "a.png").string());
  EXPECT_EQ(bgr.at<cv::Vec3b>(3, 10)[2], image(10, 3).r);
}

TEST(ImageIo, JpegIsClose) {
  const TemporaryFolder folder;
  ColorImage image(64, 48, {200, 100, 50});
  ASSERT_TRUE(save_color(folder / "a.jpg", image));
  const auto back = load_color(folder / "a.jpg");
  ASSERT_TRUE(back);
  EXPECT_NEAR((*back)(20, 20).r, 200, 3);
  EXPECT_NEAR((*back)(20, 20).b, 50, 3);
}

TEST(ImageIo, GreyAndAlphaBecomeColor) {
  const TemporaryFolder folder;
  cv::imwrite((folder / "grey.png").string(), cv::Mat(8, 8, CV_8UC1, cv::Scalar(77)));
  cv::imwrite((folder / "alpha.png").string(), cv::Mat(8, 8, CV_8UC4, cv::Scalar(1, 2, 3, 0)));
  const Rgb8 grey{77, 77, 77}, rgb{3, 2, 1};
  EXPECT_EQ(load_color(folder / "grey.png").value()(4, 4), grey);
  EXPECT_EQ(load_color(folder / "alpha.png").value()(4, 4), rgb);
}

TEST(ImageIo, DepthRoundTripAndInvalidValues) {
  const TemporaryFolder folder;
  DepthImage depth(4, 1);
  depth(0, 0) = 1.2345f;
  depth(1, 0) = 100.0f;  // does not fit at scale 5000
  depth(2, 0) = std::numeric_limits<float>::quiet_NaN();
  depth(3, 0) = -1.0f;
  ASSERT_TRUE(save_depth(folder / "d.png", depth, 5000));
  const auto back = load_depth(folder / "d.png", 5000);
  ASSERT_TRUE(back);
  EXPECT_NEAR((*back)(0, 0), 1.2345f, 1e-4);
  for (int x = 1; x < 4; ++x) EXPECT_EQ((*back)(x, 0), 0.0f);

  cv::Mat raw(1, 3, CV_16UC1);
  raw.at<std::uint16_t>(0) = 0;
  raw.at<std::uint16_t>(1) = 65535;
  raw.at<std::uint16_t>(2) = 1000;
  cv::imwrite((folder / "raw.png").string(), raw);
  const auto loaded = load_depth(folder / "raw.png", 1000).value();
  EXPECT_EQ(loaded(0, 0), 0.0f);
  EXPECT_EQ(loaded(1, 0), 0.0f);
  EXPECT_EQ(loaded(2, 0), 1.0f);
}

TEST(ImageIo, EveryRawDepthBecomesTheNearestFloat) {
  constexpr int kValues = 65536;
  RawDepth raw(kValues, 1);
  for (int v = 0; v < kValues; ++v) raw(v, 0) = static_cast<std::uint16_t>(v);
  for (const double scale : {1.0, 1000.0, 5000.0, 6553.5, 3000.1, 1e8 / 3}) {
    const DepthImage metres = depth_in_metres(raw, scale);
    for (int v = 0; v < kValues - 1; ++v) {
      ASSERT_EQ(metres(v, 0), static_cast<float>(v / scale)) << v << " of " << scale;
    }
    EXPECT_EQ(metres(kValues - 1, 0), 0);
  }
}

TEST(ImageIo, EightBitDepthAndSwappedImagesAreNamed) {
  const TemporaryFolder folder;
  cv::imwrite((folder / "d8.png").string(), cv::Mat(8, 8, CV_8UC1, cv::Scalar(77)));
  cv::imwrite((folder / "d16.png").string(), cv::Mat(8, 8, CV_16UC1, cv::Scalar(770)));
  cv::imwrite((folder / "rgb16.png").string(), cv::Mat(8, 8, CV_16UC3, cv::Scalar(1, 2, 3)));
  const auto depth = load_depth(folder / "d8.png", 5000);
  ASSERT_FALSE(depth);
  EXPECT_EQ(depth.error().code, ErrorCode::kUnsupported);
  EXPECT_THAT(depth.error().message, HasSubstr("8-bit"));
  EXPECT_THAT(depth.error().message, HasSubstr("d8.png"));
  EXPECT_THAT(load_color(folder / "d16.png").error().text(), HasSubstr("swapped"));
  EXPECT_THAT(load_depth(folder / "rgb16.png", 1).error().message, HasSubstr("3 channels"));
}

// Every proper prefix of an image file is recognised as damaged, whatever the decoder makes of it.
TEST(ImageIo, EveryTruncationIsFound) {
  const TemporaryFolder folder;
  DepthImage depth(64, 48, 1.0f);
  ASSERT_TRUE(save_color(folder / "a.png", test_picture()));
  ASSERT_TRUE(save_color(folder / "a.jpg", test_picture()));
  ASSERT_TRUE(save_depth(folder / "depth.png", depth, 5000));
  for (const char* name : {"a.png", "a.jpg", "depth.png"}) {
    const bool is_depth = std::string(name) == "depth.png";
    const std::string bytes = read_file(folder / name).value();
    for (std::size_t length = 0; length < bytes.size(); length += 1 + bytes.size() / 97) {
      ASSERT_TRUE(write_file(folder / name, bytes.substr(0, length)));
      const Error error =
          is_depth ? load_depth(folder / name, 1).error() : load_color(folder / name).error();
      EXPECT_THAT(error.message, HasSubstr(name)) << length;
      EXPECT_TRUE(error.code == ErrorCode::kInvalidFormat || length < 3) << length << error.text();
    }
    ASSERT_TRUE(write_file(folder / name, bytes.substr(0, bytes.size() - 1)));
    EXPECT_FALSE(is_depth ? load_depth(folder / name, 1).has_value()
                          : load_color(folder / name).has_value());
  }
}

TEST(ImageIo, DamageInsideAPngIsFound) {
  const TemporaryFolder folder;
  ASSERT_TRUE(save_color(folder / "a.png", test_picture()));
  std::string bytes = read_file(folder / "a.png").value();
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x55);
  ASSERT_TRUE(write_file(folder / "a.png", bytes));
  EXPECT_FALSE(load_color(folder / "a.png"));
}

/// A PNG chunk: length, type, data, checksum.
std::string png_chunk(const std::string& type, const std::string& data) {
  const auto number = [](std::uint32_t value) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift);
    return bytes;
  };
  const std::string body = type + data;
  const auto crc =
      crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
  return number(static_cast<std::uint32_t>(data.size())) + body +
         number(static_cast<std::uint32_t>(crc));
}

// Every checksum is right, but the pixels end in the middle: libpng would make the rest up and tell
// the terminal. A wrong colour profile costs nothing and is not worth a word either.
TEST(ImageIo, MissingPixelsAreDamageAndNothingIsPrinted) {
  const TemporaryFolder folder;
  ASSERT_TRUE(save_color(folder / "a.png", test_picture()));
  const std::string whole = read_file(folder / "a.png").value();
  constexpr std::size_t kHeader = 33;  // signature and IHDR
  const std::string pixels(20, '\0');
  std::string squeezed(64, '\0');
  uLongf size = squeezed.size();
  ASSERT_EQ(compress(reinterpret_cast<Bytef*>(squeezed.data()), &size,
                     reinterpret_cast<const Bytef*>(pixels.data()), pixels.size()),
            Z_OK);
  squeezed.resize(size);
  testing::internal::CaptureStderr();
  ASSERT_TRUE(
      write_file(folder / "short.png",
                 whole.substr(0, kHeader) + png_chunk("IDAT", squeezed) + png_chunk("IEND", "")));
  const auto damaged = load_color(folder / "short.png");
  ASSERT_TRUE(write_file(folder / "profile.png", whole.substr(0, kHeader) + png_chunk("iCCP", "x") +
                                                     whole.substr(kHeader)));
  const auto harmless = load_color(folder / "profile.png");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  ASSERT_FALSE(damaged);
  EXPECT_THAT(damaged.error().text(), HasSubstr("short.png: damaged PNG"));
  ASSERT_TRUE(harmless) << harmless.error().text();
  EXPECT_EQ((*harmless)(10, 3), test_picture()(10, 3));
}

TEST(ImageIo, DamageInsideAJpegIsFoundAndNothingIsPrinted) {
  const TemporaryFolder folder;
  ASSERT_TRUE(save_color(folder / "a.jpg", test_picture()));
  const std::string whole = read_file(folder / "a.jpg").value();
  // The entropy-coded data is cut short; the end marker is in place.
  testing::internal::CaptureStderr();
  ASSERT_TRUE(write_file(folder / "a.jpg", whole.substr(0, whole.size() - 300) + "\xFF\xD9"));
  const auto damaged = load_color(folder / "a.jpg");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  ASSERT_FALSE(damaged);
  EXPECT_THAT(damaged.error().text(), HasSubstr("a.jpg: damaged JPEG"));
}

// Pixels are those of OpenCV's decoders, whatever the file stores.
TEST(ImageIo, EveryLayoutDecodesToTheSamePixelsAsElsewhere) {
  const TemporaryFolder folder;
  cv::Mat bgr(37, 53, CV_8UC3), bgra, grey;
  cv::randu(bgr, 0, 256);
  cv::cvtColor(bgr, bgra, cv::COLOR_BGR2BGRA);
  cv::cvtColor(bgr, grey, cv::COLOR_BGR2GRAY);
  cv::imwrite((folder / "rgb.png").string(), bgr);
  cv::imwrite((folder / "rgba.png").string(), bgra);
  cv::imwrite((folder / "grey.png").string(), grey);
  cv::imwrite((folder / "bits.png").string(), grey, {cv::IMWRITE_PNG_BILEVEL, 1});
  cv::imwrite((folder / "rgb.jpg").string(), bgr);
  cv::imwrite((folder / "progressive.jpg").string(), bgr, {cv::IMWRITE_JPEG_PROGRESSIVE, 1});
  cv::imwrite((folder / "grey.jpg").string(), grey);
  for (const char* name :
       {"rgb.png", "rgba.png", "grey.png", "bits.png", "rgb.jpg", "progressive.jpg", "grey.jpg"}) {
    const cv::Mat expected = cv::imread((folder / name).string());
    const auto image = load_color(folder / name);
    ASSERT_TRUE(image) << name << image.error().text();
    for (int y = 0; y < image->height(); ++y) {
      for (int x = 0; x < image->width(); ++x) {
        const auto& pixel = expected.at<cv::Vec3b>(y, x);
        ASSERT_EQ((*image)(x, y), (Rgb8{pixel[2], pixel[1], pixel[0]})) << name;
      }
    }
  }
}

TEST(ImageIo, MissingFilesOtherFormatsAndFullDisks) {
  const TemporaryFolder folder;
  EXPECT_EQ(load_color(folder / "none.png").error().code, ErrorCode::kNotFound);
  ASSERT_TRUE(write_file(folder / "text.png", "hello, this is not an image"));
  EXPECT_EQ(load_color(folder / "text.png").error().code, ErrorCode::kUnsupported);
  EXPECT_FALSE(save_color(folder / "a.bmp", test_picture()));
}

TEST(AtomicFile, ReplacesReportsAndLeavesNoTemporaries) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder / "sub/a.txt", "one"));
  ASSERT_TRUE(write_file(folder / "sub/a.txt", "two"));
  ASSERT_TRUE(append_file(folder / "sub/a.txt", " three"));
  EXPECT_EQ(read_file(folder / "sub/a.txt").value(), "two three");
  const auto entries = std::distance(std::filesystem::directory_iterator(folder / "sub"), {});
  EXPECT_EQ(entries, 1);
  EXPECT_FALSE(write_file(folder / "sub", "a folder"));
  EXPECT_FALSE(read_file(folder / "sub"));
  EXPECT_FALSE(write_file(folder / "sub/a.txt/b.txt", "below a file"));
}

TEST(AtomicFile, ComesInBlocks) {
  const TemporaryFolder folder;
  int left = 3;
  const auto count_down = [&]() -> std::string_view { return left-- > 0 ? "block " : ""; };
  ASSERT_TRUE(write_file_in_blocks(folder / "a.txt", count_down));
  EXPECT_EQ(read_file(folder / "a.txt"), "block block block ");
  const auto out_of_memory = [&]() -> std::string_view {
    if (left++ > 0) throw std::bad_alloc();
    return "first";
  };
  left = 0;
  EXPECT_THROW((void)write_file_in_blocks(folder / "a.txt", out_of_memory), std::bad_alloc);
  EXPECT_EQ(read_file(folder / "a.txt"), "block block block ") << "the old one stays";
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1)
      << "no temporary is left";
}

TEST(AtomicFile, FullDiskIsAnErrorWithARemedy) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  for (const auto& status : {write_file("/dev/full", "x"), append_file("/dev/full", "x")}) {
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().code, ErrorCode::kIo);
    EXPECT_THAT(status.error().text(), HasSubstr("No space left"));
    EXPECT_THAT(status.error().remedy, HasSubstr("space"));
  }
}

TEST(ReadFile, PipesDevicesAndGiantsAreRefused) {
  const TemporaryFolder folder;
  ASSERT_EQ(mkfifo((folder / "pipe.png").c_str(), 0600), 0);
  EXPECT_THAT(load_color(folder / "pipe.png").error().text(), HasSubstr("pipe"));
  EXPECT_THAT(read_file("/dev/zero").error().text(), HasSubstr("device"));
  ASSERT_TRUE(write_file(folder / "a", "12345"));
  EXPECT_TRUE(read_file(folder / "a", 5));
  EXPECT_THAT(read_file(folder / "a", 4).error().text(), HasSubstr("larger"));
}

TEST(MakeFolder, ANameThatIsTooLongIsAnError) {
  const TemporaryFolder folder;
  const auto status = make_folder(folder / std::string(5000, 'a'));
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().text(), HasSubstr("shorter"));
}

TEST(ImageIo, GiganticImagesAreRefusedByTheirHeader) {
  const TemporaryFolder folder;
  ASSERT_TRUE(save_color(folder / "a.png", test_picture()));
  std::string bytes = read_file(folder / "a.png").value();
  const std::string side{'\0', '\0', '\x4e', '\x20'};  // 20000
  bytes.replace(16, 8, side + side);
  const auto sum = crc32(0, reinterpret_cast<const Bytef*>(bytes.data()) + 12, 17);
  for (std::size_t i = 0; i < 4; ++i) bytes[29 + i] = static_cast<char>(sum >> (24 - 8 * i));
  ASSERT_TRUE(write_file(folder / "a.png", bytes));
  EXPECT_THAT(load_color(folder / "a.png").error().text(), HasSubstr("20000x20000"));
}

TEST(ImageIo, ASecondHeaderHidesNoSize) {
  const TemporaryFolder folder;
  ASSERT_TRUE(save_color(folder / "a.png", test_picture()));
  std::string bytes = read_file(folder / "a.png").value();
  bytes.insert(33, bytes.substr(8, 25));  // behind the first one
  ASSERT_TRUE(write_file(folder / "a.png", bytes));
  EXPECT_THAT(load_color(folder / "a.png").error().text(), HasSubstr("second header"));

  ASSERT_TRUE(save_color(folder / "a.jpg", test_picture()));
  bytes = read_file(folder / "a.jpg").value();
  const std::size_t at = bytes.find("\xff\xc0");
  ASSERT_NE(at, std::string::npos);
  const std::size_t length = 2 + static_cast<unsigned char>(bytes[at + 3]);
  bytes.insert(at + length, bytes.substr(at, length));
  ASSERT_TRUE(write_file(folder / "a.jpg", bytes));
  EXPECT_THAT(load_color(folder / "a.jpg").error().text(), HasSubstr("second header"));
}

}  // namespace
}  // namespace sgs::io
