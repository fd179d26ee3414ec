// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Whole recordings of foreign writers are in tests/bags; here is what those cannot show.
#include "sgs/bag/bag.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "sgs/bag/messages.h"
#include "sgs/bag/pictures.h"
#include "sgs/bag/unpack.h"
#include "sgs/bag/wire.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/image_io.h"
#include "sgs/io/temporary_folder.h"

namespace sgs::bag {
namespace {

using ::testing::HasSubstr;

template <class T>
std::string raw(T value) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  return bytes;
}

std::string ros_string(const std::string& text) {
  return raw(static_cast<std::uint32_t>(text.size())) + text;
}

TEST(Wire, CdrAlignsToItsOwnBeginningAndTurnsBytes) {
  // A byte, three of padding, a u32, a string of five with its zero, seven of padding, a double.
  const std::string body = std::string("\x07\0\0\0", 4) + raw(0x01020304u) + raw(6u) +
                           std::string("hello\0", 6) + std::string(6, '\0') + raw(2.5);
  const std::string message = std::string("\0\1\0\0", 4) + body;
  Wire little(message, Encoding::kCdr);
  EXPECT_EQ(little.number<std::uint8_t>(), 7);
  EXPECT_EQ(little.number<std::uint32_t>(), 0x01020304u);
  EXPECT_EQ(little.string(), "hello");
  EXPECT_EQ(little.number<double>(), 2.5);
  EXPECT_TRUE(little.ok());
  EXPECT_EQ(little.number<std::uint8_t>(), 0);
  EXPECT_FALSE(little.ok());

  const std::string swapped = std::string("\0\0\0\0", 4) + std::string("\x01\x02\x03\x04", 4);
  Wire big(swapped, Encoding::kCdr);
  EXPECT_EQ(big.number<std::uint32_t>(), 0x01020304u);
  // Parameter lists and version 2 are packed otherwise.
  for (const char representation : {2, 3, 6, 7}) {
    const std::string other = std::string("\0", 1) + representation + "\0\0xxxx";
    EXPECT_FALSE(Wire(other, Encoding::kCdr).ok());
  }
  EXPECT_FALSE(Wire("", Encoding::kCdr).ok());
  EXPECT_FALSE(Wire("xxxx", Encoding::kOther).ok());
}

TEST(Wire, LengthsAreCheckedAgainstWhatIsLeft) {
  const std::string lie = raw(0xfffffff0u) + "abc";
  Wire wire(lie, Encoding::kRos1);
  EXPECT_EQ(wire.string(), "");
  EXPECT_FALSE(wire.ok());
}

std::string ros1_header(std::uint32_t sec, std::uint32_t nsec, const std::string& frame) {
  return raw(1u) + raw(sec) + raw(nsec) + ros_string(frame);
}

TEST(Messages, ImagesOfBothEncodingsAreTheSame) {
  const std::string pixels = "abcdef";
  const Message ros1{0, 0,
                     ros1_header(5, 6, "/cam") + raw(1u) + raw(2u) + ros_string("rgb8") +
                         raw<std::uint8_t>(0) + raw(6u) + ros_string(pixels)};
  const Message cdr{0, 0,
                    std::string("\0\1\0\0", 4) + raw(5) + raw(6u) + raw(4u) +
                        std::string("cam\0", 4) + raw(1u) + raw(2u) + raw(5u) +
                        std::string("rgb8\0", 5) + std::string("\0", 1) + std::string("\0\0", 2) +
                        raw(6u) + raw(6u) + pixels};
  for (const auto& [message, encoding] :
       {std::pair(ros1, Encoding::kRos1), std::pair(cdr, Encoding::kCdr)}) {
    const auto image = read_image(message, encoding);
    ASSERT_TRUE(image) << image.error().text();
    EXPECT_EQ(image->header.stamp_ns, 5'000'000'006);
    EXPECT_EQ(image->header.frame_id, "cam");
    EXPECT_EQ(image->width, 2u);
    EXPECT_EQ(image->encoding, "rgb8");
    EXPECT_EQ(image->data, pixels);
    const auto color = decode_color(*image);
    ASSERT_TRUE(color) << color.error().text();
    EXPECT_EQ((*color)(1, 0), (Rgb8{'d', 'e', 'f'}));
    EXPECT_FALSE(read_image({0, 0, message.data.substr(0, message.data.size() - 1)}, encoding));
  }
}

TEST(Messages, TransformsThatAreNoneCostThemselvesOnly) {
  const auto message = [](double w) {
    return Message{0, 0,
                   raw(1u) + ros1_header(1, 0, "a") + ros_string("b") + raw(1.0) + raw(2.0) +
                       raw(3.0) + raw(0.0) + raw(0.0) + raw(0.0) + raw(w)};
  };
  const auto read = read_transforms(message(1), Encoding::kRos1);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->transforms.at(0).child, "b");
  EXPECT_EQ(read->transforms.at(0).T_parent_child.t, Eigen::Vector3d(1, 2, 3));
  for (const double w : {0.0, 2.0, std::nan("")}) {
    // Beside one that is right.
    std::string both = message(w).data + message(1).data.substr(4);
    both[0] = 2;
    const auto rest = read_transforms({0, 0, both}, Encoding::kRos1);
    ASSERT_TRUE(rest) << w;
    EXPECT_EQ(rest->transforms.size(), 1u) << w;
    EXPECT_EQ(rest->unusable, std::vector<std::string>{"b"}) << w;
  }
  // A count of four thousand million of them.
  EXPECT_FALSE(read_transforms({0, 0, raw(0xffffffffu)}, Encoding::kRos1));
}

TEST(Messages, ExtrinsicsWithAndWithoutHeaderAreByColumns) {
  std::string body;
  // A quarter turn about z: its columns are (0 1 0), (-1 0 0), (0 0 1).
  for (const double v : {0., 1., 0., -1., 0., 0., 0., 0., 1., 0.1, 0.2, 0.3}) body += raw(v);
  for (const std::string& head : {std::string(), ros1_header(1, 2, "x")}) {
    const auto T = read_extrinsics({0, 0, head + body}, Encoding::kRos1, RotationOrder::kColumns);
    ASSERT_TRUE(T) << T.error().text();
    EXPECT_TRUE((*T * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(0.1, 1.2, 0.3)));
  }
  EXPECT_FALSE(
      read_extrinsics({0, 0, std::string(96, '\0')}, Encoding::kRos1, RotationOrder::kRows));
}

ImageMessage image_of(const std::string& encoding, std::uint32_t width, std::uint32_t height,
                      std::uint32_t step, std::string_view data) {
  ImageMessage image;
  image.encoding = encoding;
  image.width = width;
  image.height = height;
  image.step = step;
  image.data = data;
  return image;
}

TEST(Pictures, EveryColourEncoding) {
  const Rgb8 red{200, 30, 20};
  const std::string rgb = "\xc8\x1e\x14", bgr = "\x14\x1e\xc8";
  for (const auto& [encoding, pixel] :
       std::vector<std::pair<std::string, std::string>>{{"rgb8", rgb},
                                                        {"bgr8", bgr},
                                                        {"8UC3", bgr},
                                                        {"rgba8", rgb + "x"},
                                                        {"bgra8", bgr + "x"}}) {
    const std::string data = pixel + pixel;
    const auto width = static_cast<std::uint32_t>(pixel.size());
    const auto color = decode_color(image_of(encoding, 2, 1, 2 * width, data));
    ASSERT_TRUE(color) << encoding;
    EXPECT_EQ((*color)(1, 0), red) << encoding;
  }
  EXPECT_EQ((*decode_color(image_of("mono8", 1, 1, 1, "\x50")))(0, 0), (Rgb8{80, 80, 80}));
  // Grey in YUV: luma 126 of 16..235 is 128 of 0..255.
  EXPECT_EQ((*decode_color(image_of("yuv422", 2, 1, 4, "\x80\x7e\x80\x7e")))(1, 0),
            (Rgb8{128, 128, 128}));
  EXPECT_EQ((*decode_color(image_of("yuv422_yuy2", 2, 1, 4, "\x7e\x80\x7e\x80")))(1, 0),
            (Rgb8{128, 128, 128}));
  const auto bayer = decode_color(image_of("bayer_rggb8", 4, 4, 4, std::string(16, '\x50')));
  ASSERT_TRUE(bayer);
  EXPECT_EQ((*bayer)(1, 1), (Rgb8{80, 80, 80}));
  EXPECT_FALSE(decode_color(image_of("bayer_rggb8", 2, 1, 2, "ab")));
  const auto unknown = decode_color(image_of("bayer_rggb16", 2, 1, 4, "abcd"));
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::kUnsupported);
}

TEST(Pictures, SizesThatDoNotFitAreRefused) {
  for (const auto& image : {image_of("rgb8", 2, 2, 6, std::string_view("elevenbytes")),
                            image_of("rgb8", 2, 1, 5, "sixsix"), image_of("rgb8", 0, 1, 0, ""),
                            image_of("rgb8", 0x40000000u, 4, 0xc0000000u, "abc"),
                            image_of("rgb8", 1, 0xffffffffu, 3, "abc")}) {
    EXPECT_FALSE(decode_color(image)) << image.width << "x" << image.height;
  }
  for (const auto& image :
       {image_of("16UC1", 2, 2, 4, "seven b"), image_of("32FC1", 2, 1, 7, "eight by"),
        image_of("16UC1", 0x80000000u, 0x80000000u, 0, "abc")}) {
    EXPECT_FALSE(decode_depth(image, {})) << image.width << "x" << image.height;
  }
  // Rows may be longer than their pixels; the last one need not be.
  EXPECT_TRUE(decode_color(image_of("rgb8", 1, 2, 8, "abcxxxxxdef")));
}

TEST(Pictures, RowsThatAreSaidFarTooShortHaveNoGaps) {
  for (const std::uint32_t step : {0u, 2u}) {
    const auto image = image_of("rgb8", 2, 2, step, "abcdefghijkl");
    EXPECT_TRUE(row_length_contradicts(image));
    const auto color = decode_color(image);
    ASSERT_TRUE(color);
    EXPECT_EQ((*color)(0, 1), (Rgb8{'g', 'h', 'i'}));
  }
  const auto depth = decode_depth(image_of("16UC1", 2, 1, 2, std::string(4, '\1')), {});
  ASSERT_TRUE(depth);
  EXPECT_FLOAT_EQ((*depth)(1, 0), 0.257f);
  EXPECT_FALSE(row_length_contradicts(image_of("rgb8", 2, 2, 6, "abcdefghijkl")));
  EXPECT_FALSE(row_length_contradicts(image_of("nv12", 2, 2, 2, "abcdef")));
  EXPECT_FALSE(row_length_contradicts(image_of("mjpg", 2, 2, 0, "abcdef")));
  const auto grey = decode_color(image_of("mono16", 1, 1, 2, std::string_view("\0\x50", 2)));
  ASSERT_TRUE(grey);
  EXPECT_EQ((*grey)(0, 0), (Rgb8{80, 80, 80}));
}

TEST(Pictures, DepthOfIntegersAndFloats) {
  const std::string integers = raw<std::uint16_t>(1500) + raw<std::uint16_t>(0) +
                               raw<std::uint16_t>(65535) + raw<std::uint16_t>(2);
  const auto depth = decode_depth(image_of("16UC1", 4, 1, 8, integers), {});
  ASSERT_TRUE(depth);
  EXPECT_EQ((*depth)(0, 0), 1.5f);
  EXPECT_EQ((*depth)(1, 0), 0.0f);
  EXPECT_EQ((*depth)(2, 0), 0.0f);
  EXPECT_EQ((*depth)(3, 0), 0.002f);

  auto big = image_of("mono16", 1, 1, 2, std::string_view("\x05\xdc", 2));
  big.big_endian = true;
  EXPECT_EQ((*decode_depth(big, {}))(0, 0), 1.5f);

  constexpr float kInf = std::numeric_limits<float>::infinity();
  const std::string floats = raw(1.25f) + raw(std::nanf("")) + raw(kInf) + raw(-1.0f);
  const auto metres = decode_depth(image_of("32FC1", 4, 1, 16, floats), {});
  ASSERT_TRUE(metres);
  EXPECT_EQ((*metres)(0, 0), 1.25f);
  for (int x = 1; x < 4; ++x) EXPECT_EQ((*metres)(x, 0), 0.0f);
  EXPECT_EQ((*decode_depth(image_of("32FC1", 4, 1, 16, floats), {1000, true}))(0, 0), 0.00125f);
  EXPECT_FALSE(decode_depth(image_of("rgb8", 1, 1, 3, "abc"), {}));
}

TEST(Pictures, CompressedDepthOfFloatsIsInverse) {
  const io::TemporaryFolder folder;
  DepthImage stored(2, 1);
  stored(0, 0) = 101;
  ASSERT_TRUE(io::save_depth(folder / "inverse.png", stored, 1));
  CompressedImageMessage image;
  image.format = "32FC1; compressedDepth png";
  // v = a / z + b with a = 200, b = 1: v = 101 is 2 m, v = 0 is nothing.
  const std::string data =
      raw<std::int32_t>(0) + raw(200.0f) + raw(1.0f) + *io::read_file(folder / "inverse.png");
  image.data = data;
  const auto depth = decode_depth(image, {});
  ASSERT_TRUE(depth) << depth.error().text();
  EXPECT_EQ((*depth)(0, 0), 2.0f);
  EXPECT_EQ((*depth)(1, 0), 0.0f);
  image.format = "32FC1; compressedDepth rvl";
  EXPECT_THAT(decode_depth(image, {}).error().text(), HasSubstr("RVL"));
  image.format = "16UC1; compressedDepth";
  image.data = "short";
  EXPECT_FALSE(decode_depth(image, {}));
}

// A few bytes that announce a gigabyte, and streams with more or less in them than announced.
TEST(Unpack, OutputIsWhatWasAnnouncedOrAnError) {
  // "hello\n" as bzip2, lz4 and zstd pack it.
  const std::string bz2(
      "BZh91AY&"
      "SY\xc1\xc0\x80\xe2\x00\x00\x01\x41\x00\x00\x10\x02\x44\xa0\x00\x30\xcd\x00\xc3\x46\x29"
      "\x97\x17\x72\x45\x38\x50\x90\xc1\xc0\x80\xe2",
      42);
  const std::string lz4(
      "\x04\x22\x4d\x18\x64\x40\xa7\x06\x00\x00\x80\x68\x65\x6c\x6c\x6f\x0a\x00\x00\x00\x00\xf9\x5b"
      "\x6b"
      "\x94",
      25);
  const std::string zstd(
      "\x28\xb5\x2f\xfd\x04\x58\x31\x00\x00\x68\x65\x6c\x6c\x6f\x0a\x53\x88\xbd\x91", 19);
  for (const auto& [name, packed] :
       {std::pair(std::string("bz2"), bz2), std::pair(std::string("lz4"), lz4),
        std::pair(std::string("zstd"), zstd)}) {
    EXPECT_EQ(unpack(name, packed, 6).value_or("failed"), "hello\n") << name;
    for (const std::uint64_t wrong : {0, 5, 7, 1 << 30}) {
      EXPECT_FALSE(unpack(name, packed, wrong)) << name << wrong;
    }
    EXPECT_FALSE(unpack(name, packed.substr(0, packed.size() - 9), 6)) << name;
    EXPECT_FALSE(unpack(name, "no such thing", 6)) << name;
    EXPECT_FALSE(unpack(name, "", 6)) << name;
    EXPECT_EQ(unpack(name, packed, std::uint64_t{1} << 40).error().code, ErrorCode::kUnsupported);
  }
  EXPECT_EQ(unpack("none", "ab", 2).value_or("failed"), "ab");
  EXPECT_FALSE(unpack("none", "ab", 3));
  EXPECT_EQ(unpack("lzma", "ab", 2).error().code, ErrorCode::kUnsupported);
}

TEST(Bag, RecognisedByNameAndContent) {
  const io::TemporaryFolder folder;
  EXPECT_TRUE(looks_like_bag("x.bag"));
  EXPECT_TRUE(looks_like_bag("x.mcap"));
  EXPECT_TRUE(looks_like_bag("x.db3"));
  EXPECT_FALSE(looks_like_bag("x.png"));
  EXPECT_FALSE(looks_like_bag(folder.path()));
  ASSERT_TRUE(io::write_file(folder / "metadata.yaml", "title: holiday\n"));
  EXPECT_FALSE(looks_like_bag(folder.path()));
  ASSERT_TRUE(io::write_file(folder / "metadata.yaml", "rosbag2_bagfile_information:\n"));
  EXPECT_TRUE(looks_like_bag(folder.path()));
  EXPECT_EQ(open_bag(folder / "none.bag").error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace sgs::bag
