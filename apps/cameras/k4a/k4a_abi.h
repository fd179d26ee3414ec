// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

// The part of libk4a's C interface that is used: names, numbers and layouts as version 1.4 has
// them, the last one. The library is opened at run time.
extern "C" {
struct k4a_device;
struct k4a_capture;
struct k4a_image;

struct k4a_device_configuration_t {
  int color_format, color_resolution, depth_mode, camera_fps;
  bool synchronized_images_only;
  std::int32_t depth_delay_off_color_usec;
  int wired_sync_mode;
  std::uint32_t subordinate_delay_off_master_usec;
  bool disable_streaming_indicator;
};
struct k4a_calibration_extrinsics_t {
  float rotation[9];     // by rows
  float translation[3];  // millimetres
};
struct k4a_calibration_camera_t {
  k4a_calibration_extrinsics_t extrinsics;
  int type;
  unsigned parameter_count;
  float cx, cy, fx, fy, k1, k2, k3, k4, k5, k6, codx, cody, p2, p1, radius;
  int resolution_width, resolution_height;
  float metric_radius;
};
struct k4a_calibration_t {
  k4a_calibration_camera_t depth_camera_calibration, color_camera_calibration;
  k4a_calibration_extrinsics_t extrinsics[4][4];  // [from][to]
  int depth_mode, color_resolution;
};
struct k4a_version_t {
  std::uint32_t major, minor, iteration;
};
struct k4a_hardware_version_t {
  k4a_version_t rgb, depth, audio, depth_sensor;
  int firmware_build, firmware_signature;
};
struct k4a_imu_sample_t {
  float temperature;
  float acc_sample[3];
  std::uint64_t acc_timestamp_usec;
  float gyro_sample[3];
  std::uint64_t gyro_timestamp_usec;
};
using k4a_logging_message_cb_t = void(void*, int, const char*, int, const char*);
}

namespace sgs::cameras::k4a {

enum Returned : int { kSucceeded = 0, kFailed = 1, kTimeout = 2 };
enum Sensor : int { kDepth = 0, kColor = 1, kGyro = 2, kAccel = 3 };
enum Control : int { kExposureTime = 0, kWhiteBalance = 6 };
constexpr int kFormatBgra = 3, kDepthNarrow = 2, kManual = 1, kLogError = 1;

/// X(result, name, (parameters)) for every function.
#define SGS_K4A_FUNCTIONS(X)                                                         \
  X(std::uint32_t, k4a_device_get_installed_count, ())                               \
  X(int, k4a_set_debug_message_handler, (k4a_logging_message_cb_t*, void*, int))     \
  X(int, k4a_device_open, (std::uint32_t, k4a_device**))                             \
  X(void, k4a_device_close, (k4a_device*))                                           \
  X(int, k4a_device_get_serialnum, (k4a_device*, char*, std::size_t*))               \
  X(int, k4a_device_get_version, (k4a_device*, k4a_hardware_version_t*))             \
  X(int, k4a_device_get_calibration, (k4a_device*, int, int, k4a_calibration_t*))    \
  X(int, k4a_device_get_color_control, (k4a_device*, int, int*, std::int32_t*))      \
  X(int, k4a_device_set_color_control, (k4a_device*, int, int, std::int32_t))        \
  X(int, k4a_device_start_cameras, (k4a_device*, const k4a_device_configuration_t*)) \
  X(void, k4a_device_stop_cameras, (k4a_device*))                                    \
  X(int, k4a_device_start_imu, (k4a_device*))                                        \
  X(void, k4a_device_stop_imu, (k4a_device*))                                        \
  X(int, k4a_device_get_capture, (k4a_device*, k4a_capture**, std::int32_t))         \
  X(int, k4a_device_get_imu_sample, (k4a_device*, k4a_imu_sample_t*, std::int32_t))  \
  X(void, k4a_capture_release, (k4a_capture*))                                       \
  X(k4a_image*, k4a_capture_get_color_image, (k4a_capture*))                         \
  X(k4a_image*, k4a_capture_get_depth_image, (k4a_capture*))                         \
  X(void, k4a_image_release, (k4a_image*))                                           \
  X(std::uint8_t*, k4a_image_get_buffer, (k4a_image*))                               \
  X(int, k4a_image_get_width_pixels, (k4a_image*))                                   \
  X(int, k4a_image_get_height_pixels, (k4a_image*))                                  \
  X(int, k4a_image_get_stride_bytes, (k4a_image*))                                   \
  X(std::uint64_t, k4a_image_get_device_timestamp_usec, (k4a_image*))                \
  X(std::uint64_t, k4a_image_get_exposure_usec, (k4a_image*))                        \
  X(std::uint32_t, k4a_image_get_iso_speed, (k4a_image*))

}  // namespace sgs::cameras::k4a
