// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "rs2_calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "common/calibration.h"

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
  return cameras::transform_of(extrinsics.rotation, extrinsics.translation, Order::kColumns, 1);
}

}  // namespace sgs::cameras::rs2
