// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/depth_calibration.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sgs/core/error.h"

namespace sgs {
namespace {

/// Where one axis of the grid puts a pixel: the node before it and the share of the one after.
struct Place {
  int node = 0;
  double share = 0;
};

Place place_on_axis(double pixel, int pixels, int nodes) {
  if (nodes < 2 || pixels < 2) return {};
  const double x = std::clamp(pixel * (nodes - 1) / (pixels - 1), 0.0, double(nodes - 1));
  const int node = std::min(static_cast<int>(x), nodes - 2);
  return {node, x - node};
}

constexpr float kFarthest_m = 100;     // what an offset moves beyond is no measurement
constexpr float kSameSurface = 0.03f;  // relative spread of the depths of one surface

/// Inverse depth between four pixels, 0 = none.
struct Interpolator {
  float w00, w10, w01, w11;
  int nearest_x, nearest_y;  // 0 or 1

  Interpolator(float dx, float dy)
      : w00((1 - dx) * (1 - dy)),
        w10(dx * (1 - dy)),
        w01((1 - dx) * dy),
        w11(dx * dy),
        nearest_x(dx > 0.5f),
        nearest_y(dy > 0.5f) {}

  float operator()(const float* top, const float* bottom) const {
    const float a = top[0], b = top[1], c = bottom[0], d = bottom[1];
    const float low = std::min(std::min(a, b), std::min(c, d));
    const float high = std::max(std::max(a, b), std::max(c, d));
    if (low > 0 && high - low < kSameSurface * low) {
      return w00 / a + w10 / b + w01 / c + w11 / d;
    }
    const float z = nearest_y ? bottom[nearest_x] : top[nearest_x];
    return z > 0 ? 1 / z : 0;
  }
};

/// The offsets along one row of the image after the other.
class OffsetRows {
 public:
  explicit OffsetRows(const DepthCalibration& c)
      : c_(c), row_(c.offset_per_m.empty() ? 0 : static_cast<std::size_t>(c.grid.columns) + 1) {
    for (int x = 0; x < c.camera.width && !row_.empty(); ++x) {
      places_.push_back(place_on_axis(x - c.shift_px.x(), c.camera.width, c.grid.columns));
    }
  }

  /// Those of row `y` of the colour image.
  void write(int y, std::vector<float>& out) {
    out.resize(static_cast<std::size_t>(c_.camera.width), 0.0f);
    if (row_.empty()) return;
    const auto columns = static_cast<std::size_t>(c_.grid.columns);
    const Place at = place_on_axis(y - c_.shift_px.y(), c_.camera.height, c_.grid.rows);
    const double* above = c_.offset_per_m.data() + static_cast<std::size_t>(at.node) * columns;
    const double* below = c_.grid.rows > 1 ? above + columns : above;
    for (std::size_t k = 0; k < columns; ++k) {
      row_[k] = static_cast<float>((1 - at.share) * above[k] + at.share * below[k]);
    }
    row_[columns] = row_[columns - 1];
    for (std::size_t x = 0; x < out.size(); ++x) {
      const auto share = static_cast<float>(places_[x].share);
      const float* node = row_.data() + places_[x].node;
      out[x] = node[0] + share * (node[1] - node[0]);
    }
  }

 private:
  const DepthCalibration& c_;
  std::vector<float> row_;  // the grid at this height; one more, so that each node has a next one
  std::vector<Place> places_;
};

}  // namespace

GridWeights ImageGrid::at(double u, double v, const PinholeCamera& camera) const {
  const Place x = place_on_axis(u, camera.width, columns);
  const Place y = place_on_axis(v, camera.height, rows);
  const int first = y.node * columns + x.node;
  const int right = columns > 1 ? 1 : 0, down = rows > 1 ? columns : 0;
  return {{first, first + right, first + down, first + down + right},
          {(1 - x.share) * (1 - y.share), x.share * (1 - y.share), (1 - x.share) * y.share,
           x.share * y.share}};
}

std::vector<double> ImageGrid::area() const {
  const auto share = [](int node, int nodes) {
    if (nodes < 2) return 1.0;
    return (node == 0 || node == nodes - 1 ? 0.5 : 1.0) / (nodes - 1);
  };
  std::vector<double> out;
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) out.push_back(share(x, columns) * share(y, rows));
  }
  return out;
}

double DepthCalibration::mean_offset_per_m() const {
  if (offset_per_m.empty()) return 0;
  const std::vector<double> area = grid.area();
  return std::inner_product(area.begin(), area.end(), offset_per_m.begin(), 0.0);
}

bool DepthCalibration::corrects_nothing() const {
  const auto is_zero = [](double offset) { return offset == 0; };
  return shift_px.isZero(0) && std::all_of(offset_per_m.begin(), offset_per_m.end(), is_zero);
}

double DepthCalibration::offset_at(double u, double v) const {
  if (offset_per_m.empty()) return 0;
  const GridWeights w = grid.at(u, v, camera);
  double sum = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    sum += w.weight[k] * offset_per_m[static_cast<std::size_t>(w.node[k])];
  }
  return sum;
}

DepthImage DepthCalibration::apply(const DepthImage& measured) const {
  SGS_CHECK(measured.width() == camera.width && measured.height() == camera.height,
            "the depth image has another size than its calibration");
  if (corrects_nothing()) return measured;
  const int w = measured.width(), h = measured.height();
  DepthImage out(w, h);
  // Pixel x of the colour image is pixel x - shift of the depth image.
  const int x_shift = static_cast<int>(std::floor(-shift_px.x()));
  const int y_shift = static_cast<int>(std::floor(-shift_px.y()));
  const Interpolator interpolate(static_cast<float>(-shift_px.x() - x_shift),
                                 static_cast<float>(-shift_px.y() - y_shift));
  const bool whole = interpolate.w00 == 1;
  OffsetRows rows(*this);
  std::vector<float> offsets;
  for (int y = 0; y < h; ++y) {
    const int from_y = y + y_shift;
    const int next_y = whole ? from_y : from_y + 1;
    if (from_y < 0 || next_y >= h) continue;
    rows.write(y, offsets);
    const float *top = measured.row(from_y), *bottom = measured.row(next_y);
    const int begin = std::max(0, -x_shift), end = std::min(w, w - x_shift - (whole ? 0 : 1));
    for (int x = begin; x < end; ++x) {
      const float* a = top + x + x_shift;
      const float q0 = whole ? (*a > 0 ? 1 / *a : 0) : interpolate(a, bottom + x + x_shift);
      if (q0 <= 0) continue;
      const float q = q0 + offsets[static_cast<std::size_t>(x)];
      if (q > 1 / kFarthest_m) out(x, y) = 1 / q;
    }
  }
  return out;
}

}  // namespace sgs
