// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// ScanNet's .sens files.
#include "harness.h"
#include "sgs/dataset/open.h"
#include "sgs/dataset/sens_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sgs;
  const auto path = fuzz::scratch_file("x.sens");
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  fuzz::write_plainly(path, bytes);
  auto file = dataset::SensFile::open(path);
  if (!file) return 0;
  constexpr std::size_t kMostPixels = 1 << 20;  // larger images only cost time here
  for (const PinholeCamera& c : {file->color_camera(), file->depth_camera()}) {
    const double pixels = static_cast<double>(c.width) * c.height;
    if (pixels > static_cast<double>(kMostPixels)) return 0;
  }
  for (std::size_t i = 0; i < std::min<std::size_t>(file->frames().size(), 4); ++i) {
    if (const auto depth = file->depth(i)) {
      fuzz::require(depth->width() == file->depth_camera().width, "depth has its camera's size");
    }
    (void)file->color(i);
  }
  dataset::OpenOptions options;
  options.prefetch = 0;
  const auto sequence = dataset::open_sequence(path, options);
  if (!sequence) return 0;
  RgbdFrame frame;
  Error error;
  for (int i = 0; i < 4; ++i) {
    if (sequence->frames->next(frame, error) == dataset::FrameRead::kEnd) break;
  }
  return 0;
}
