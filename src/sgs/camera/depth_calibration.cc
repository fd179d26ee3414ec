// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/depth_calibration.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "sgs/camera/depth_row.h"
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
  DepthRow row;
  row.dx = static_cast<float>(-shift_px.x() - x_shift);
  row.dy = static_cast<float>(-shift_px.y() - y_shift);
  const int begin = std::max(0, -x_shift), end = std::min(w, w - x_shift - (row.dx > 0 ? 1 : 0));
  if (begin >= end) return out;
  OffsetRows offsets_of(*this);
  std::vector<float> offsets;
  for (int y = 0; y < h; ++y) {
    const int from_y = y + y_shift;
    const int next_y = row.dy > 0 ? from_y + 1 : from_y;
    if (from_y < 0 || next_y >= h) continue;
    offsets_of.write(y, offsets);
    row.top = measured.row(from_y) + begin + x_shift;
    row.bottom = measured.row(next_y) + begin + x_shift;
    row.offset_per_m = std::span(offsets).subspan(static_cast<std::size_t>(begin),
                                                  static_cast<std::size_t>(end - begin));
    correct_depth(row, out.row(y) + begin);
  }
  return out;
}

}  // namespace sgs
