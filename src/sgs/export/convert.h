// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>

#include "sgs/core/error.h"
#include "sgs/dataset/tum_writer.h"
#include "sgs/input/input.h"

namespace sgs::run {

/// How an input is to be kept so that reading it back gives the same frames: depth in the units it
/// was stored in. Depths that were computed rather than stored come in steps of 0.2 mm.
dataset::TumSequenceWriter::Options recording_options(const Input& input);

/// What came of a conversion.
struct Conversion {
  std::int64_t frames = 0;      ///< written
  std::int64_t bad = 0;         ///< could not be read and were left out; the log says why
  std::int64_t pixels_far = 0;  ///< measurements beyond what 16 bits of depth hold, left out
  double farthest_m = 0;        ///< that 16 bits hold
  bool stopped = false;         ///< before the end; what is there is usable
};

/// Writes all frames of an input, and its ground truth, as a folder in TUM layout
/// (dataset/tum_writer.h). `folder` must not exist or be empty. After each frame the folder is a
/// complete sequence of the frames so far. An input without any readable frame is an error. `step`
/// is called after each frame, bad or not.
Result<Conversion> convert(Input& input, const std::filesystem::path& folder, bool jpeg_color,
                           const std::function<void()>& step, const std::stop_token& stop);

}  // namespace sgs::run
