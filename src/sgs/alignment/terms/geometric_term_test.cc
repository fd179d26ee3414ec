// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/alignment/terms/geometric_term.h"

#include <gtest/gtest.h>

#include <vector>

#include "sgs/alignment/test_textured_wall.h"
#include "sgs/degeneracy/observability.h"

namespace sgs::alignment {
namespace {

// The right of the wall is hidden by somebody, whose surface faces all ways.
RgbdFrame somebody_before_the_wall() {
  RgbdFrame frame = see_wall({}, 0);
  for (int v = 0; v < kWallCamera.height; ++v) {
    for (int u = kWallCamera.width / 2; u < kWallCamera.width; ++u) {
      const double x = u % 80 / 40.0 - 1, y = v % 80 / 40.0 - 1;
      frame.depth(u, v) = static_cast<float>(1 + 0.1 * (x * x + y * y));
    }
  }
  return frame;
}

TEST(GeometricTerm, SurfacesOfWhatMovesPinDownNoAxis) {
  GeometricTerm term({}, kWallCamera, SE3{});
  LocalPast past;
  term.set_frame(somebody_before_the_wall(), past, nullptr);
  const auto mask_of = [&] {
    degeneracy::HysteresisState state;
    const auto surfaces = term.surface_information(1);
    return degeneracy::observe(surfaces, degeneracy::DegeneracyConfig{}, state).mask;
  };
  EXPECT_EQ(mask_of(), 0u);
  constexpr int kCell_px = 8, kAcross = 40, kDown = 30;
  std::vector<std::uint8_t> cells(kAcross * kDown, 0);
  for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = i % kAcross >= kAcross / 2 ? 1 : 0;
  term.set_moving({kCell_px, kAcross, std::move(cells)});
  EXPECT_EQ(mask_of(), 7u);  // along the wall, and about its normal
  term.set_moving({});
  EXPECT_EQ(mask_of(), 0u);
}

}  // namespace
}  // namespace sgs::alignment
