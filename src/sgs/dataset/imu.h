// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sgs/bag/bag.h"
#include "sgs/camera/imu_sample.h"
#include "sgs/dataset/open.h"

namespace sgs::dataset {

/// What an inertial unit measured beside the frames of a recording.
struct ImuRecording {
  std::string source;              ///< file, or file and topic, for people; empty: there is no unit
  std::vector<ImuSample> samples;  ///< in order of time, on the recording's clock
  /// From the unit's axes to those of the colour camera, where that is known or usual.
  std::optional<Eigen::Matrix3d> R_camera_imu = {};
  std::vector<std::string> warnings = {};  ///< lines that cannot be read, and the like
};

/// The file of the accelerometer in a folder, "accelerometer.txt" of the TUM RGB-D benchmark; empty
/// where there is none.
std::filesystem::path accelerometer_file(const std::filesystem::path& folder);

/// Reads what lies beside the frames of a recording: accelerometer.txt, or a topic of a bag.
/// Nothing of it is needed to read the frames: what is wrong here is a warning, and the samples
/// that can be used are there.
ImuRecording read_imu(const SequenceInfo& info);

/// Lines `timestamp ax ay az` in the axes of a Kinect: x left, y up, z forward as the camera sees
/// it (found from TUM's recordings and their motion capture). `source` names the file in warnings.
ImuRecording read_accelerometer_text(std::string_view text, const std::string& source);

/// The accelerations of a bag: the topic of sensor_msgs/Imu that measures any, if possible one
/// whose frame tf, or an SDK, joins to the colour camera's. Gyroscopes with topics of their own are
/// left alone.
ImuRecording read_bag_imu(const bag::Bag& bag, const std::string& camera_frame);

}  // namespace sgs::dataset
