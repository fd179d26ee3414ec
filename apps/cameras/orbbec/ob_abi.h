// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

// The part of the Orbbec SDK's C interface that is used: names, numbers and layouts as they have
// been from version 2.0.18 to 2.9.3. The library is opened at run time.
extern "C" {
struct ob_config;
struct ob_context;
struct ob_device;
struct ob_device_list;
struct ob_error;
struct ob_frame;
struct ob_pipeline;
struct ob_sensor_list;
struct ob_stream_profile;
struct ob_stream_profile_list;

struct ob_camera_intrinsic {
  float fx, fy, cx, cy;
  std::int16_t width, height;
};
struct ob_camera_distortion {
  float k1, k2, k3, k4, k5, k6, p1, p2;
  int model;
};
struct ob_extrinsic {
  float rot[9];    // by rows
  float trans[3];  // millimetres
};
struct ob_motion {
  float x, y, z;
};
using ob_frameset_callback = void (*)(ob_frame*, void*);
}

namespace sgs::cameras::ob {

enum Sensor : int { kSensorColor = 2, kSensorDepth = 3, kSensorAccel = 4, kSensorGyro = 5 };
enum FrameType : int { kFrameColor = 2, kFrameDepth = 3, kFrameAccel = 4, kFrameGyro = 7 };
enum Format : int { kFormatY16 = 8, kFormatRgb = 22, kFormatZ16 = 28 };
enum Lens : int { kLensNone = 0, kLensInverseBrown = 2, kLensBrownK6 = 4, kLensKannalaBrandt = 5 };
enum Metadata : int { kExposure = 4, kGain = 5 };
enum Permission : int { kRead = 1, kWrite = 2 };
enum Property : int {
  kLaser = 3,
  kDepthMirror = 14,
  kColorMirror = 81,
  kLaserControl = 182,
  kColorAutoExposure = 2000,
  kColorExposure = 2001,
  kColorAutoWhiteBalance = 2003,
  kColorWhiteBalance = 2004,
  kColorExposurePriority = 2012,
  kDepthAutoExposure = 2016,
  kDepthExposure = 2017
};
// Of framesets: whatever has come. Of the log: nothing.
constexpr int kAnySituation = 2, kLogOff = 5, kLogError = 3;

/// X(result, name, (parameters)) for every function.
#define SGS_OB_FUNCTIONS(X)                                                                       \
  X(int, ob_get_version, ())                                                                      \
  X(const char*, ob_error_get_message, (const ob_error*))                                         \
  X(void, ob_delete_error, (ob_error*))                                                           \
  X(void, ob_set_logger_to_console, (int, ob_error**))                                            \
  X(void, ob_set_logger_to_file, (int, const char*, ob_error**))                                  \
  X(ob_context*, ob_create_context, (ob_error**))                                                 \
  X(void, ob_delete_context, (ob_context*, ob_error**))                                           \
  X(ob_device_list*, ob_query_device_list, (ob_context*, ob_error**))                             \
  X(void, ob_delete_device_list, (ob_device_list*, ob_error**))                                   \
  X(std::uint32_t, ob_device_list_get_count, (const ob_device_list*, ob_error**))                 \
  X(const char*, ob_device_list_get_device_name,                                                  \
    (const ob_device_list*, std::uint32_t, ob_error**))                                           \
  X(const char*, ob_device_list_get_device_serial_number,                                         \
    (const ob_device_list*, std::uint32_t, ob_error**))                                           \
  X(const char*, ob_device_list_get_device_connection_type,                                       \
    (const ob_device_list*, std::uint32_t, ob_error**))                                           \
  X(ob_device*, ob_device_list_get_device, (const ob_device_list*, std::uint32_t, ob_error**))    \
  X(void, ob_delete_device, (ob_device*, ob_error**))                                             \
  X(ob_sensor_list*, ob_device_get_sensor_list, (const ob_device*, ob_error**))                   \
  X(void, ob_delete_sensor_list, (ob_sensor_list*, ob_error**))                                   \
  X(std::uint32_t, ob_sensor_list_get_count, (const ob_sensor_list*, ob_error**))                 \
  X(int, ob_sensor_list_get_sensor_type, (const ob_sensor_list*, std::uint32_t, ob_error**))      \
  X(bool, ob_device_is_property_supported, (const ob_device*, int, int, ob_error**))              \
  X(std::int32_t, ob_device_get_int_property, (ob_device*, int, ob_error**))                      \
  X(void, ob_device_set_int_property, (ob_device*, int, std::int32_t, ob_error**))                \
  X(bool, ob_device_get_bool_property, (ob_device*, int, ob_error**))                             \
  X(void, ob_device_set_bool_property, (ob_device*, int, bool, ob_error**))                       \
  X(ob_pipeline*, ob_create_pipeline_with_device, (const ob_device*, ob_error**))                 \
  X(void, ob_delete_pipeline, (ob_pipeline*, ob_error**))                                         \
  X(ob_stream_profile_list*, ob_pipeline_get_stream_profile_list,                                 \
    (const ob_pipeline*, int, ob_error**))                                                        \
  X(void, ob_delete_stream_profile_list, (ob_stream_profile_list*, ob_error**))                   \
  X(std::uint32_t, ob_stream_profile_list_get_count, (const ob_stream_profile_list*, ob_error**)) \
  X(ob_stream_profile*, ob_stream_profile_list_get_profile,                                       \
    (const ob_stream_profile_list*, int, ob_error**))                                             \
  X(void, ob_delete_stream_profile, (const ob_stream_profile*, ob_error**))                       \
  X(int, ob_stream_profile_get_format, (const ob_stream_profile*, ob_error**))                    \
  X(std::uint32_t, ob_video_stream_profile_get_width, (const ob_stream_profile*, ob_error**))     \
  X(std::uint32_t, ob_video_stream_profile_get_height, (const ob_stream_profile*, ob_error**))    \
  X(std::uint32_t, ob_video_stream_profile_get_fps, (const ob_stream_profile*, ob_error**))       \
  X(ob_camera_intrinsic, ob_video_stream_profile_get_intrinsic,                                   \
    (const ob_stream_profile*, ob_error**))                                                       \
  X(ob_camera_distortion, ob_video_stream_profile_get_distortion,                                 \
    (const ob_stream_profile*, ob_error**))                                                       \
  X(ob_extrinsic, ob_stream_profile_get_extrinsic_to,                                             \
    (const ob_stream_profile*, ob_stream_profile*, ob_error**))                                   \
  X(ob_config*, ob_create_config, (ob_error**))                                                   \
  X(void, ob_delete_config, (ob_config*, ob_error**))                                             \
  X(void, ob_config_enable_stream_with_stream_profile,                                            \
    (ob_config*, const ob_stream_profile*, ob_error**))                                           \
  X(void, ob_config_set_frame_aggregate_output_mode, (ob_config*, int, ob_error**))               \
  X(void, ob_pipeline_start_with_callback,                                                        \
    (ob_pipeline*, const ob_config*, ob_frameset_callback, void*, ob_error**))                    \
  X(void, ob_pipeline_stop, (ob_pipeline*, ob_error**))                                           \
  X(std::uint32_t, ob_frameset_get_count, (const ob_frame*, ob_error**))                          \
  X(ob_frame*, ob_frameset_get_frame_by_index, (const ob_frame*, std::uint32_t, ob_error**))      \
  X(void, ob_delete_frame, (const ob_frame*, ob_error**))                                         \
  X(int, ob_frame_get_type, (const ob_frame*, ob_error**))                                        \
  X(std::uint64_t, ob_frame_get_timestamp_us, (const ob_frame*, ob_error**))                      \
  X(std::uint8_t*, ob_frame_get_data, (const ob_frame*, ob_error**))                              \
  X(std::uint32_t, ob_frame_get_data_size, (const ob_frame*, ob_error**))                         \
  X(bool, ob_frame_has_metadata, (const ob_frame*, int, ob_error**))                              \
  X(std::int64_t, ob_frame_get_metadata_value, (const ob_frame*, int, ob_error**))                \
  X(std::uint32_t, ob_video_frame_get_width, (const ob_frame*, ob_error**))                       \
  X(std::uint32_t, ob_video_frame_get_height, (const ob_frame*, ob_error**))                      \
  X(float, ob_depth_frame_get_value_scale, (const ob_frame*, ob_error**))                         \
  X(ob_motion, ob_accel_frame_get_value, (const ob_frame*, ob_error**))                           \
  X(ob_motion, ob_gyro_frame_get_value, (const ob_frame*, ob_error**))

}  // namespace sgs::cameras::ob
