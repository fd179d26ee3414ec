// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace sgs::registration {

/// Columns of a window that are read, whatever its width; the ones beyond it are masked.
inline constexpr int kWindowColumns = 8;

/// A window of samples, `step` pixels apart, in a row-major image of inverse depths (0 = none).
struct Window {
  const float* first = nullptr;  ///< top left sample; kWindowColumns of each row must be readable
  int stride = 0;                ///< from row to row, in floats
  int rows = 0;
  int half = 0;        ///< 2 half + 1 columns count, the centre is column `half`
  float step = 1;      ///< px between samples
  float first_dy = 0;  ///< of the top row from the centre, px
};

/// Samples within `gate` of the plane q = alpha dx + beta dy + gamma are accepted.
struct WindowPlane {
  float alpha = 0, beta = 0, gamma = 0;
  float gate = 0;
};

/// Sums over the accepted samples: their number, moments of the position (dx, dy) in px and of the
/// residual e = q - plane.
struct WindowSums {
  float n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  float e = 0, xe = 0, ye = 0, ee = 0;
};

/// Same bits for the same instruction set.
WindowSums sum_window(const Window& window, const WindowPlane& plane);

}  // namespace sgs::registration
