// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "rs2_calibration.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <iterator>

namespace sgs::cameras::rs2 {

Result<LensCamera> lens_of(const rs2_intrinsics& intrinsics, const char* which,
                           std::vector<std::string>& notes) {
  constexpr std::size_t kFisheyeCoefficients = 4;
  LensCamera lens;
  lens.camera = {intrinsics.width,
                 intrinsics.height,
                 static_cast<double>(intrinsics.fx),
                 static_cast<double>(intrinsics.fy),
                 static_cast<double>(intrinsics.ppx),
                 static_cast<double>(intrinsics.ppy)};
  std::vector<double> values(std::begin(intrinsics.coeffs), std::end(intrinsics.coeffs));
  const bool straight = std::ranges::all_of(values, [](double value) { return value == 0; });
  if (straight || intrinsics.model == kLensNone) return lens;
  LensModel model = LensModel::kBrown;
  if (intrinsics.model == kLensKannalaBrandt) {
    model = LensModel::kFisheye;
    values.resize(kFisheyeCoefficients);
  } else if (intrinsics.model == kLensFTheta) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("the {} camera has a lens of the model f-theta", which),
                "please report it with the camera's name");
  } else if (intrinsics.model != kLensBrown) {
    notes.push_back(
        fmt::format("the lens of the {} camera is of the library's model {}: taken for "
                    "Brown-Conrady",
                    which, intrinsics.model));
  }
  lens.distortion = Distortion::from_coefficients(values, model).value_or(Distortion{});
  return lens;
}

SE3 transform_of(const rs2_extrinsics& extrinsics) {
  using ByColumns = Eigen::Matrix<float, 3, 3, Eigen::ColMajor>;
  const Eigen::Matrix3d R = Eigen::Map<const ByColumns>(extrinsics.rotation).cast<double>();
  const Eigen::Vector3d t =
      Eigen::Map<const Eigen::Vector3f>(extrinsics.translation).cast<double>();
  return SE3(R, t).normalized();
}

double units_per_metre(float unit_m) {
  constexpr double kRounding = 1e-5;
  const double units = 1 / static_cast<double>(unit_m);
  const double whole = std::round(units);
  return std::abs(units - whole) < kRounding * units ? whole : units;
}

void leave_out_equal_cameras(stream::Hello& hello) {
  const SE3& T = hello.T_color_depth;
  const bool same = hello.depth_camera == hello.color_camera && T.R.isIdentity(0) && T.t.isZero(0);
  if (same) hello.depth_camera.reset();
}

}  // namespace sgs::cameras::rs2
