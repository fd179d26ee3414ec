// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "ob_calibration.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/calibration.h"

namespace sgs::cameras::ob {

LensCamera lens_of(const ob_camera_intrinsic& intrinsic, const ob_camera_distortion& d,
                   const char* which, std::vector<std::string>& notes) {
  LensCamera lens;
  lens.camera = {intrinsic.width,
                 intrinsic.height,
                 static_cast<double>(intrinsic.fx),
                 static_cast<double>(intrinsic.fy),
                 static_cast<double>(intrinsic.cx),
                 static_cast<double>(intrinsic.cy)};
  const bool fisheye = d.model == kLensKannalaBrandt;
  std::vector<float> factors = {d.k1, d.k2, d.p1, d.p2, d.k3, d.k4, d.k5, d.k6};
  if (fisheye) factors = {d.k1, d.k2, d.k3, d.k4};
  const bool straight = std::ranges::all_of(factors, [](float value) { return value == 0; });
  if (d.model == kLensNone || (straight && !fisheye)) return lens;
  if (d.model == kLensInverseBrown) {
    notes.push_back(fmt::format(
        "the lens of the {} camera is of the model inverse Brown-Conrady: taken for Brown-Conrady",
        which));
  }
  const std::vector<double> values(factors.begin(), factors.end());
  const LensModel model = fisheye ? LensModel::kFisheye : LensModel::kBrown;
  lens.distortion = Distortion::from_coefficients(values, model).value_or(Distortion{});
  return lens;
}

SE3 transform_of(const ob_extrinsic& extrinsic) {
  constexpr double kMillimetre = 1e-3;
  return cameras::transform_of(extrinsic.rot, extrinsic.trans, Order::kRows, kMillimetre);
}

}  // namespace sgs::cameras::ob
