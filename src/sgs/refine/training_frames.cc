// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/refine/training_frames.h"

#include <algorithm>

#include "sgs/core/stopwatch.h"

namespace sgs::refine {
namespace {

constexpr double kMaxDepth_m = 20;  // farther measurements say little about a room

double gray(const Rgb8& c) { return (0.299 * c.r + 0.587 * c.g + 0.114 * c.b) / 255; }

/// Weights from sharpness: that of a frame beside the median of its neighbours in time, which see
/// nearly the same place.
void weigh(std::vector<RefineFrame>& frames) {
  constexpr std::ptrdiff_t kReach = 8;  // frames before and after
  constexpr double kLeast = 0.25, kMost = 1.5;
  const auto count = static_cast<std::ptrdiff_t>(frames.size());
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    std::vector<double> around;
    const std::ptrdiff_t end = std::min(count, i + kReach + 1);
    for (std::ptrdiff_t k = std::max<std::ptrdiff_t>(0, i - kReach); k < end; ++k) {
      around.push_back(frames[static_cast<std::size_t>(k)].sharpness);
    }
    const double usual = quantile(std::move(around), 0.5);
    RefineFrame& frame = frames[static_cast<std::size_t>(i)];
    frame.weight = usual > 0 ? std::clamp(frame.sharpness / usual, kLeast, kMost) : 1.0;
  }
}

}  // namespace

double sharpness(const ColorImage& color) {
  constexpr int kStep = 2;  // every other row and column tells enough
  double sum = 0;
  std::int64_t count = 0;
  for (int y = 1; y + 1 < color.height(); y += kStep) {
    for (int x = 1; x + 1 < color.width(); x += kStep) {
      const double laplacian = gray(color(x - 1, y)) + gray(color(x + 1, y)) +
                               gray(color(x, y - 1)) + gray(color(x, y + 1)) -
                               4 * gray(color(x, y));
      sum += laplacian * laplacian;
      ++count;
    }
  }
  return count > 0 ? sum / static_cast<double>(count) : 0.0;
}

FrameSelection::FrameSelection(const PinholeCamera& camera, std::int64_t expected,
                               std::size_t budget_bytes) {
  constexpr std::size_t kBytesPerPixel = sizeof(Rgb8) + sizeof(std::uint16_t);
  const std::size_t bytes = static_cast<std::size_t>(camera.width) *
                            static_cast<std::size_t>(camera.height) * kBytesPerPixel;
  const auto room = static_cast<std::int64_t>(std::max<std::size_t>(1, budget_bytes / bytes));
  group_ = std::max<std::int64_t>(1, (expected + room - 1) / room);
}

void FrameSelection::offer(const RgbdFrame& frame, const SE3& T_world_camera,
                           const Vector6d& readout) {
  const bool begins = offered_++ % group_ == 0;
  const double sharp = sharpness(frame.color);
  if (!begins && sharp <= frames_.back().sharpness) return;
  RefineFrame taken{mapper::MapKeyframe(frame, T_world_camera, kMaxDepth_m), frame.timestamp_s,
                    sharp, 1, readout};
  if (begins) {
    frames_.push_back(std::move(taken));
  } else {
    frames_.back() = std::move(taken);
  }
}

std::vector<RefineFrame> FrameSelection::finish() {
  weigh(frames_);
  return std::move(frames_);
}

}  // namespace sgs::refine
