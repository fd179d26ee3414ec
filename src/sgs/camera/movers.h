// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "sgs/camera/rgbd_frame.h"

namespace sgs {

/// Takes out of `frame` what moves by itself: where `still` is 0 there is no depth afterwards, and
/// the camera saw nothing (RgbdFrame::seen). Colour stays; RgbdFrame::still knows it. Null: nothing
/// moves, nothing changes. The mask has the frame's size.
void leave_out_movers(RgbdFrame& frame, const std::shared_ptr<const PixelMask>& still);

/// A copy without what moves, which knows what it was made of; the frame itself where `still` is
/// null.
std::shared_ptr<const RgbdFrame> without_movers(const std::shared_ptr<const RgbdFrame>& frame,
                                                const std::shared_ptr<const PixelMask>& still);

/// What is non-zero in both; null stands for a mask without zeros.
std::shared_ptr<const PixelMask> in_both(const std::shared_ptr<const PixelMask>& a,
                                         const std::shared_ptr<const PixelMask>& b);

/// Such a mask in squares of 8 pixels, one bit each, row by row, the first in the lowest bit: set
/// where something moves anywhere in the square.
std::string mover_blocks(const PixelMask& still);
/// And back, for a picture of that size; null where they are of another one.
std::shared_ptr<const PixelMask> still_from_blocks(std::string_view blocks, int width, int height);

}  // namespace sgs
