// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "sgs/core/error.h"
#include "sgs/core/image.h"
#include "sgs/synthetic/source.h"

namespace sgs::synthetic {

/// What moves in the pictures of a synthetic sequence, as the truth has it.
class MovingMasks {
 public:
  virtual ~MovingMasks() = default;
  /// Of a frame of the source for the same options: a byte for each pixel of its colour as it is
  /// recorded (behind the lens of level real). 0: what cannot move; 85: a mover that rests, 170:
  /// that moves by more than 3 mm, 255: by more than 3 cm in 1/30 s. `index` within the sequence.
  virtual GrayImage mask(std::int64_t index) = 0;
};

/// Empty where nobody is in the scene.
Result<std::unique_ptr<MovingMasks>> make_moving_masks(const SynthOptions& options);

}  // namespace sgs::synthetic
