// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/bags/bag_lens.h"

#include <algorithm>
#include <cmath>

#include "sgs/camera/resample.h"
#include "sgs/io/calibration_io.h"
#include "sgs/io/camera_file.h"
#include "sgs/io/text.h"

namespace sgs::dataset {
namespace {

constexpr const char* kGiveCamera = "give --camera fx,fy,cx,cy[,k1,k2,p1,p2,k3[,k4,k5,k6]]";
constexpr const char* kLensesKnown =
    "plumb_bob and rational_polynomial with up to eight coefficients and equidistant with four are "
    "known; rectify the images first (image_proc), or, if they are plane already, give --camera "
    "fx,fy,cx,cy";

int side_px(std::uint32_t side) { return static_cast<int>(std::min(side, 1u << 20)); }

/// The lens of a camera info's D.
Result<Distortion> distortion_of(const bag::CameraInfoMessage& info, const std::string& topic,
                                 std::vector<std::string>& warnings) {
  const std::string& model = info.distortion_model;
  const bool straight =
      std::all_of(info.D.begin(), info.D.end(), [](double value) { return value == 0; });
  if (straight && io::lens_model_named(model) != LensModel::kBrown) {
    const auto& K = info.K;
    warnings.push_back(fmt::format(
        "{}: the lens model is '{}' without coefficients; the pictures are taken for plane ones "
        "(pinhole), as many drivers mean it. If straight lines look bent in them, the lens is a "
        "fisheye and everything comes out wrong: give --camera {},{},{},{},fisheye,0,0,0,0 then, "
        "or "
        "record rectified images",
        topic, model, K[0], K[4], K[2], K[5]));
  }
  if (straight) return Distortion{};
  const auto lens = io::lens_named(model, info.D);
  if (!lens) {
    return fail(
        ErrorCode::kUnsupported,
        fmt::format("{}: distortion '{}' with {} coefficients", topic, model, info.D.size()),
        kLensesKnown);
  }
  if (io::lower_case(model).find("inverse") != std::string::npos) {
    warnings.push_back(
        fmt::format("{}: '{}' is taken for Brown-Conrady, as realsense-ros does", topic, model));
  }
  return *lens;
}

/// Which of its matrices a camera info means, at its own size.
Result<LensCamera> whole_lens(const bag::CameraInfoMessage& info, const std::string& topic,
                              bool rectified, std::vector<std::string>& warnings) {
  const auto& K = info.K;
  const auto& P = info.P;
  // Drivers without a calibration write zeros or the unit matrix.
  constexpr double kNoFocalLength_px = 2;
  const auto filled_in = [](double fx, double fy) {
    return fx > kNoFocalLength_px && fy > kNoFocalLength_px;
  };
  const bool has_K = filled_in(K[0], K[4]), has_P = filled_in(P[0], P[5]);
  LensCamera lens;
  if (!has_K && !has_P) {
    return fail(
        ErrorCode::kNotFound,
        fmt::format("{}: neither K nor P is filled in (zeros, or the unit matrix): the camera was "
                    "not calibrated",
                    topic),
        fmt::format("{}, or name another topic: --topics color_info=/TOPIC", kGiveCamera));
  }
  if (has_P && (rectified || !has_K)) {
    lens.camera = {0, 0, P[0], P[5], P[2], P[6]};
    if (!rectified) {
      warnings.push_back(fmt::format("{}: K is empty, P is taken in its place", topic));
    }
  } else {
    lens.camera = {0, 0, K[0], K[4], K[2], K[5]};
  }
  if (!(has_P && rectified)) {
    SGS_ASSIGN_OR_RETURN(lens.distortion, distortion_of(info, topic, warnings));
  }
  lens.camera.width = side_px(info.width);
  lens.camera.height = side_px(info.height);
  return lens;
}

/// The camera of the part that was read out, with pixels put together.
LensCamera read_out(LensCamera lens, const bag::CameraInfoMessage& info) {
  PinholeCamera& c = lens.camera;
  const double bx = std::max(info.binning_x, 1u), by = std::max(info.binning_y, 1u);
  const bool part = info.roi_width > 0 && info.roi_height > 0;
  if (part) {
    c.width = side_px(info.roi_width);
    c.height = side_px(info.roi_height);
    c.cx -= info.roi_x;
    c.cy -= info.roi_y;
  }
  c.width = static_cast<int>(c.width / bx);
  c.height = static_cast<int>(c.height / by);
  // Pixel centres lie at whole numbers: of n pixels put together in the middle.
  c.fx /= bx;
  c.fy /= by;
  c.cx = (c.cx + 0.5) / bx - 0.5;
  c.cy = (c.cy + 0.5) / by - 0.5;
  return lens;
}

ImageSize size_of(const LensCamera& lens) { return {lens.camera.width, lens.camera.height}; }

Result<LensCamera> fitted(LensCamera lens, const bag::CameraInfoMessage& info,
                          const std::string& topic, ImageSize images,
                          std::vector<std::string>& warnings) {
  const LensCamera part = read_out(lens, info);
  const bool whole = part.camera == lens.camera;
  if (!size_of(lens).known()) {
    lens.camera.width = images.width;
    lens.camera.height = images.height;
    return lens;
  }
  if (!images.known()) return part;
  if (images == size_of(part)) {
    if (!whole) {
      warnings.push_back(
          fmt::format("{}: its binning or region of interest is allowed for", topic));
    }
    return part;
  }
  const std::string sizes =
      fmt::format("{}: it is for pictures of {}x{}, these have {}x{}", topic, size_of(part).width,
                  size_of(part).height, images.width, images.height);
  if (images == size_of(lens)) {
    warnings.push_back(sizes + "; its binning or region of interest is left out of account");
    return lens;
  }
  if (same_shape(images, size_of(part))) {
    warnings.push_back(sizes + ", which are taken for the same view; the camera is scaled");
    return scaled_lens(part, images);
  }
  return fail(ErrorCode::kUnsupported, sizes,
              fmt::format("{} of pictures of this size, or choose another topic with --topics "
                          "color_info=/TOPIC,depth_info=/TOPIC",
                          kGiveCamera));
}

}  // namespace

bool is_rectified(const std::string& image_topic) {
  std::string base = image_topic;
  if (const auto at = base.find("/compressed"); at != std::string::npos) base.resize(at);
  return base.substr(base.rfind('/') + 1).find("rect") != std::string::npos;
}

Result<LensCamera> lens_of(const bag::CameraInfoMessage& info, const std::string& topic,
                           bool rectified, ImageSize images, std::vector<std::string>& warnings) {
  SGS_ASSIGN_OR_RETURN(LensCamera lens, whole_lens(info, topic, rectified, warnings));
  SGS_ASSIGN_OR_RETURN(lens, fitted(lens, info, topic, images, warnings));
  if (!size_of(lens).known()) return lens;  // that of the first picture
  SGS_RETURN_IF_ERROR(io::check_calibration({lens.camera, lens.distortion, 1}, topic));
  return lens;
}

LensCamera scaled_lens(const LensCamera& lens, ImageSize size) {
  return {scaled_to(lens.camera, size.width, size.height), lens.distortion};
}

bool same_lens(const LensCamera& a, const LensCamera& b) {
  constexpr double kSame_px = 0.1;
  const PinholeCamera &p = a.camera, &q = b.camera;
  if (p.width != q.width || p.height != q.height) return false;
  if (a == b) return true;
  for (const double u : {0.0, p.width - 1.0}) {
    for (const double v : {0.0, p.height - 1.0}) {
      const auto ray = a.distortion.invert({(u - p.cx) / p.fx, (v - p.cy) / p.fy});
      if (!ray) return false;
      const Eigen::Vector2d d = b.distortion.apply(*ray);
      if (std::hypot(d.x() * q.fx + q.cx - u, d.y() * q.fy + q.cy - v) > kSame_px) return false;
    }
  }
  return true;
}

bool same_view(const PinholeCamera& a, const PinholeCamera& b) {
  constexpr double kTolerance = 0.02;
  const double centre_px = kTolerance * std::max(a.width, a.height);
  return std::abs(a.fx / b.fx - 1) <= kTolerance && std::abs(a.fy / b.fy - 1) <= kTolerance &&
         std::abs(a.cx - b.cx) <= centre_px && std::abs(a.cy - b.cy) <= centre_px;
}

}  // namespace sgs::dataset
