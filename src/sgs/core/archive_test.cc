// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/core/archive.h"

#include <gtest/gtest.h>

namespace sgs {
namespace {

enum class Colour { kRed, kBlue };

/// As Eigen's matrices of fixed size look.
class Matrix {
 public:
  using Scalar = double;
  static constexpr int SizeAtCompileTime = 4;
  Scalar* data() { return values_.data(); }
  int size() const { return SizeAtCompileTime; }
  bool operator==(const Matrix&) const = default;

 private:
  std::array<double, 4> values_ = {1, 2, 3, 4};
};

struct Inner {
  double x = 0;
  std::optional<Matrix> matrix;

  template <class Archive>
  void archive(Archive& a) {
    a(x, matrix);
  }
  bool operator==(const Inner&) const = default;
};

struct Everything {
  bool flag = false;
  int number = 0;
  Colour colour = Colour::kRed;
  std::string text;
  std::vector<std::uint16_t> block;
  std::vector<Inner> objects;
  std::array<Inner, 2> pair;

  template <class Archive>
  void archive(Archive& a) {
    a(flag, number, colour, text, block, objects, pair);
  }
  bool operator==(const Everything&) const = default;
};

Everything example() {
  Everything e;
  e.flag = true;
  e.number = -7;
  e.colour = Colour::kBlue;
  e.text = "a word";
  e.block = {1, 2, 65535};
  e.objects.resize(3);
  e.objects[1].x = 0.1;
  e.objects[1].matrix.emplace();
  e.objects[1].matrix->data()[2] = -1;
  e.pair[1].x = -1e300;
  return e;
}

std::string bytes_of(Everything e) {
  ArchiveWriter writer;
  writer(e);
  return writer.take();
}

TEST(Archive, ReadsWhatItWrote) {
  const std::string bytes = bytes_of(example());
  Everything e;
  e.objects.resize(9);
  e.pair[0].matrix.emplace();
  ArchiveReader reader(bytes);
  reader(e);
  EXPECT_TRUE(reader.complete());
  EXPECT_TRUE(e == example());
}

TEST(Archive, KnowsEveryCutAndEveryByteTooMuch) {
  const std::string bytes = bytes_of(example());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    Everything e;
    ArchiveReader reader(std::string_view(bytes).substr(0, size));
    reader(e);
    EXPECT_FALSE(reader.complete()) << size;
  }
  Everything e;
  const std::string longer = bytes + '\0';
  ArchiveReader reader(longer);
  reader(e);
  EXPECT_FALSE(reader.failed());
  EXPECT_FALSE(reader.complete());
}

TEST(Archive, TakesNoMemoryForCountsThatCannotBe) {
  const std::uint64_t count = std::uint64_t{1} << 60;
  const std::string bytes(reinterpret_cast<const char*>(&count), sizeof count);
  ArchiveReader numbers(bytes);
  std::vector<double> v;
  numbers(v);
  EXPECT_TRUE(numbers.failed());
  ArchiveReader objects(bytes);
  std::vector<Inner> w;
  objects(w);
  EXPECT_TRUE(objects.failed());
  EXPECT_TRUE(v.empty());
  EXPECT_LE(w.size(), 1u);
}

}  // namespace
}  // namespace sgs
