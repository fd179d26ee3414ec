// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/frame_fit.h"

#include <algorithm>
#include <vector>

#include "sgs/camera/resample.h"
#include "sgs/camera/seen_area.h"

namespace sgs::dataset {
namespace {

Status check_size(std::string_view name, int width, int height, const PinholeCamera& camera) {
  if (width == camera.width && height == camera.height) return {};
  return fail(ErrorCode::kUnsupported,
              fmt::format("{} is {}x{} but the calibration is for {}x{}", name, width, height,
                          camera.width, camera.height),
              "such frames are left out; if it is most of them, give the calibration of that size: "
              "--camera fx,fy,cx,cy and --depth-scale S");
}

}  // namespace

PinholeCamera delivered_camera(const StoredCameras& stored, int max_width) {
  const PinholeCamera color = limited_to_width(stored.color, max_width);
  if (2 * stored.depth.width < color.width || stored.depth.width > color.width) return color;
  return stored.depth;
}

FrameFit::FrameFit(const PinholeCamera& delivered, const Distortion& distortion)
    : camera_(delivered) {
  if (!distortion.is_zero()) undistorter_.emplace(delivered, distortion);
}

std::shared_ptr<const PixelMask> FrameFit::seen(const PinholeCamera& color) const {
  auto seen = seen_by(color, camera_);
  if (!undistorter_) return seen;
  return seen ? std::make_shared<PixelMask>(undistorter_->mask(*seen)) : undistorter_->seen();
}

Status FrameFit::fit(ColorImage color, DepthImage depth, const StoredCameras& stored,
                     std::string_view color_name, std::string_view depth_name,
                     RgbdFrame& frame) const {
  SGS_RETURN_IF_ERROR(check_size(color_name, color.width(), color.height(), stored.color));
  SGS_RETURN_IF_ERROR(check_size(depth_name, depth.width(), depth.height(), stored.depth));
  // Distortion acts on directions, so it does not mind on which grid it is removed.
  if (stored.color != camera_) color = resample_color(color, stored.color, camera_);
  if (stored.depth != camera_) depth = resample_depth(depth, stored.depth, camera_);
  frame.camera = camera_;
  frame.seen = seen(stored.color);
  frame.color = undistorter_ ? undistorter_->color(color) : std::move(color);
  frame.depth = undistorter_ ? undistorter_->depth(depth) : std::move(depth);
  return {};
}

std::optional<std::string> little_is_seen(const PixelMask* seen, std::string_view source) {
  constexpr double kLittle = 1.0 / 3;
  if (seen == nullptr || seen_share(*seen) >= kLittle) return std::nullopt;
  return fmt::format(
      "undistorted by the calibration from {}, the camera has seen {:.0f} % of the picture only, "
      "and the rest is not used: if the picture does not look like that, its distortion or its "
      "intrinsics are of another camera or image size; give --camera "
      "fx,fy,cx,cy[,k1,k2,p1,p2,k3[,k4,k5,k6]]",
      source, 100 * seen_share(*seen));
}

double median_depth_m(const DepthImage& depth) {
  std::vector<float> measured;
  std::copy_if(depth.data(), depth.data() + depth.size(), std::back_inserter(measured),
               [](float z) { return z > 0; });
  if (measured.empty()) return 0;
  const auto middle = measured.begin() + static_cast<std::ptrdiff_t>(measured.size() / 2);
  std::nth_element(measured.begin(), middle, measured.end());
  return static_cast<double>(*middle);
}

void warn_of_doubtful_unit(double median_m, std::vector<std::string>& warnings) {
  constexpr double kNear_m = 0.25, kFar_m = 6;
  if (median_m == 0 || (median_m >= kNear_m && median_m <= kFar_m)) return;
  warnings.push_back(fmt::format(
      "the median depth of the first frame is {:.3g} m, which is {} for a room: if the unit of "
      "depth is another one, everything comes out in the wrong size; --depth-scale S says it, raw "
      "units per metre",
      median_m, median_m < kNear_m ? "near" : "far"));
}

void warn_of_doubtful_centre(const PinholeCamera& camera, std::string_view source,
                             std::vector<std::string>& warnings) {
  const bool inside = camera.cx > 0 && camera.cx < camera.width - 1 && camera.cy > 0 &&
                      camera.cy < camera.height - 1;
  if (inside || camera.width == 0) return;
  warnings.push_back(fmt::format(
      "the principal point from {} is {:g},{:g} in pictures of {}x{}, which is not inside them: if "
      "it was not filled in, everything comes out bent; --camera fx,fy,cx,cy says it",
      source, camera.cx, camera.cy, camera.width, camera.height));
}

Status check_depth_unit(const DepthImage& depth, double depth_scale, std::string_view source) {
  constexpr double kNearest_m = 0.05, kFarthest_m = 20;
  const double median_m = median_depth_m(depth);
  if (median_m == 0 || (median_m >= kNearest_m && median_m <= kFarthest_m)) return {};
  return fail(
      ErrorCode::kInvalidFormat,
      fmt::format("the median depth is {:.3g} m with {} raw units per metre (from {}); cameras "
                  "measure {} to {} m, so the unit is another one",
                  median_m, depth_scale, source, kNearest_m, kFarthest_m),
      "give the unit: --depth-scale 1000 for millimetres, 5000 for TUM recordings");
}

}  // namespace sgs::dataset
