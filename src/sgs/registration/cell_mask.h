// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace sgs::registration {

/// Cells of a picture in which something holds. A value; empty by default, where it holds nowhere.
class CellMask {
 public:
  CellMask() = default;
  /// Squares of `cell_px` pixels, `columns` in a row; `cells`: 1 or 0 of each, row by row.
  CellMask(int cell_px, int columns, std::vector<std::uint8_t> cells)
      : cell_px_(cell_px), columns_(columns), cells_(std::move(cells)) {
    any_ = std::any_of(cells_.begin(), cells_.end(), [](std::uint8_t c) { return c != 0; });
  }

  /// Whether it holds anywhere.
  bool any() const { return any_; }
  /// Of the cell around a pixel of the picture; the last cells reach as far as it does.
  bool at(int u, int v) const {
    if (!any_) return false;
    const int column = std::min(u / cell_px_, columns_ - 1);
    const int row = std::min(v / cell_px_, rows() - 1);
    return cells_[static_cast<std::size_t>(row * columns_ + column)] != 0;
  }
  /// Where either holds, in the cells of this one if it holds anywhere: of `other` what is around
  /// their centres.
  CellMask united(const CellMask& other) const {
    if (!any_ || !other.any_) return any_ ? *this : other;
    CellMask out = *this;
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const int at = static_cast<int>(i), half = cell_px_ / 2;
      if (other.at(at % columns_ * cell_px_ + half, at / columns_ * cell_px_ + half)) {
        out.cells_[i] = 1;
      }
    }
    return out;
  }
  int cell_px() const { return cell_px_; }
  int columns() const { return columns_; }
  int rows() const { return columns_ > 0 ? static_cast<int>(cells_.size()) / columns_ : 0; }
  const std::vector<std::uint8_t>& cells() const { return cells_; }

 private:
  int cell_px_ = 1, columns_ = 0;
  std::vector<std::uint8_t> cells_;
  bool any_ = false;
};

}  // namespace sgs::registration
