// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include "sgs/dataset/imu.h"
#include "sgs/input/input.h"

namespace sgs::run {

/// What an inertial unit measured beside the frames of an input: what a stream has sent so far, or
/// what lies beside a recording.
dataset::ImuRecording read_imu(const Input& input);

/// Keeps what a stream has sent beside the frames that were recorded of it, as accelerometer.txt
/// (dataset/imu.h). Nothing is written of other inputs, or where the unit's axes are not known.
Status keep_imu(const Input& input, const std::filesystem::path& folder);

/// `source`, with the samples of the stream that it reads from: read_imu() finds them.
std::unique_ptr<dataset::FrameSource> with_imu(std::unique_ptr<dataset::FrameSource> source,
                                               std::function<dataset::ImuRecording()> imu);

}  // namespace sgs::run
