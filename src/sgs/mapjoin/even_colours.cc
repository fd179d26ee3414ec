// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapjoin/even_colours.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

namespace sgs::mapjoin {
namespace {

constexpr float kCell_m = 0.03f, kLeastWeight = 0.1f;
constexpr float kDarkest = 0.1f,
                kBrightest = 0.9f;         // what is darker is noise, what is brighter is cut off
constexpr std::size_t kEnoughCells = 200;  // cells

using Cell = std::array<int, 3>;
/// Colours in a cell, weighted by opacity: of the base and of the other map.
struct Colours {
  std::array<std::array<float, 3>, 2> sum = {};
  std::array<float, 2> weight = {};
};

Cell cell_of(const map::Gaussian& g) {
  Cell cell;
  for (std::size_t k = 0; k < 3; ++k) cell[k] = static_cast<int>(std::floor(g.mean[k] / kCell_m));
  return cell;
}

}  // namespace

std::array<float, 3> even_colours(Part& part, std::uint16_t first_session) {
  auto& gaussians = part.gaussians.splats.gaussians;
  const auto side = [&](std::size_t i) -> std::size_t {
    return part.gaussians.born_in[i] < first_session ? 0 : 1;
  };
  std::map<Cell, Colours> cells;
  for (std::size_t i = 0; i < gaussians.size(); ++i) {
    Colours& cell = cells[cell_of(gaussians[i])];
    const float weight = map::opacity(gaussians[i]);
    for (std::size_t k = 0; k < 3; ++k) cell.sum[side(i)][k] += weight * gaussians[i].rgb[k];
    cell.weight[side(i)] += weight;
  }
  std::array<float, 3> factors = {1, 1, 1};
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<float> ratios;
    for (const auto& [place, c] : cells) {
      if (!(c.weight[0] > kLeastWeight && c.weight[1] > kLeastWeight)) continue;
      const float a = c.sum[0][k] / c.weight[0], b = c.sum[1][k] / c.weight[1];
      if (a > kDarkest && a < kBrightest && b > kDarkest && b < kBrightest) ratios.push_back(a / b);
    }
    if (ratios.size() < kEnoughCells) return {1, 1, 1};
    const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
    std::nth_element(ratios.begin(), middle, ratios.end());
    factors[k] = *middle;
  }
  for (std::size_t i = 0; i < gaussians.size(); ++i) {
    if (side(i) == 0) continue;
    for (std::size_t k = 0; k < 3; ++k) gaussians[i].rgb[k] *= factors[k];
  }
  return factors;
}

}  // namespace sgs::mapjoin
