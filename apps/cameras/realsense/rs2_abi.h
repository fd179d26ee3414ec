// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// The part of librealsense2's C interface that is used: names, numbers and layouts as they have
// been since version 2.31 (docs/decisions/0069-cameras-as-programs.md). The library is opened at
// run time.
extern "C" {
struct rs2_config;
struct rs2_context;
struct rs2_device;
struct rs2_device_list;
struct rs2_error;
struct rs2_frame;
struct rs2_options;
struct rs2_options_list;
struct rs2_pipeline;
struct rs2_pipeline_profile;
struct rs2_sensor;
struct rs2_sensor_list;
struct rs2_stream_profile;
struct rs2_stream_profile_list;

struct rs2_intrinsics {
  int width, height;
  float ppx, ppy, fx, fy;
  int model;
  float coeffs[5];
};
struct rs2_extrinsics {
  float rotation[9];  // by columns
  float translation[3];
};
using rs2_frame_callback_ptr = void (*)(rs2_frame*, void*);
}

namespace sgs::cameras::rs2 {

// Numbers that no version has changed. Options are found by name: theirs have moved.
enum Stream : int { kStreamDepth = 1, kStreamColor = 2, kStreamGyro = 5, kStreamAccel = 6 };
enum Format : int { kFormatZ16 = 1, kFormatRgb8 = 5, kFormatMotion = 16 };
enum Extension : int { kDepthSensor = 7, kCompositeFrame = 10 };
enum Lens : int {
  kLensNone = 0,
  kLensModifiedBrown = 1,
  kLensInverseBrown = 2,
  kLensFTheta = 3,
  kLensBrown = 4,
  kLensKannalaBrandt = 5
};
enum Info : int { kName = 0, kSerial = 1, kFirmware = 2, kRecommendedFirmware = 3, kUsbType = 9 };
enum Metadata : int { kFrameTimestamp = 1, kSensorTimestamp = 2, kExposure = 3, kGain = 4 };

/// X(result, name, (parameters)) for every function.
#define SGS_RS2_FUNCTIONS(X)                                                                  \
  X(int, rs2_get_api_version, (rs2_error**))                                                  \
  X(const char*, rs2_get_error_message, (const rs2_error*))                                   \
  X(void, rs2_free_error, (rs2_error*))                                                       \
  X(rs2_context*, rs2_create_context, (int, rs2_error**))                                     \
  X(void, rs2_delete_context, (rs2_context*))                                                 \
  X(rs2_device_list*, rs2_query_devices, (const rs2_context*, rs2_error**))                   \
  X(void, rs2_delete_device_list, (rs2_device_list*))                                         \
  X(int, rs2_get_device_count, (const rs2_device_list*, rs2_error**))                         \
  X(rs2_device*, rs2_create_device, (const rs2_device_list*, int, rs2_error**))               \
  X(void, rs2_delete_device, (rs2_device*))                                                   \
  X(int, rs2_supports_device_info, (const rs2_device*, int, rs2_error**))                     \
  X(const char*, rs2_get_device_info, (const rs2_device*, int, rs2_error**))                  \
  X(rs2_sensor_list*, rs2_query_sensors, (const rs2_device*, rs2_error**))                    \
  X(void, rs2_delete_sensor_list, (rs2_sensor_list*))                                         \
  X(int, rs2_get_sensors_count, (const rs2_sensor_list*, rs2_error**))                        \
  X(rs2_sensor*, rs2_create_sensor, (const rs2_sensor_list*, int, rs2_error**))               \
  X(void, rs2_delete_sensor, (rs2_sensor*))                                                   \
  X(const char*, rs2_get_sensor_info, (const rs2_sensor*, int, rs2_error**))                  \
  X(int, rs2_is_sensor_extendable_to, (const rs2_sensor*, int, rs2_error**))                  \
  X(float, rs2_get_depth_scale, (rs2_sensor*, rs2_error**))                                   \
  X(rs2_options_list*, rs2_get_options_list, (const rs2_options*, rs2_error**))               \
  X(void, rs2_delete_options_list, (rs2_options_list*))                                       \
  X(int, rs2_get_options_list_size, (const rs2_options_list*, rs2_error**))                   \
  X(int, rs2_get_option_from_list, (const rs2_options_list*, int, rs2_error**))               \
  X(const char*, rs2_get_option_name, (const rs2_options*, int, rs2_error**))                 \
  X(float, rs2_get_option, (const rs2_options*, int, rs2_error**))                            \
  X(void, rs2_set_option, (const rs2_options*, int, float, rs2_error**))                      \
  X(rs2_config*, rs2_create_config, (rs2_error**))                                            \
  X(void, rs2_delete_config, (rs2_config*))                                                   \
  X(void, rs2_config_enable_device, (rs2_config*, const char*, rs2_error**))                  \
  X(void, rs2_config_enable_stream, (rs2_config*, int, int, int, int, int, int, rs2_error**)) \
  X(rs2_pipeline*, rs2_create_pipeline, (rs2_context*, rs2_error**))                          \
  X(void, rs2_delete_pipeline, (rs2_pipeline*))                                               \
  X(rs2_pipeline_profile*, rs2_pipeline_start_with_config_and_callback,                       \
    (rs2_pipeline*, rs2_config*, rs2_frame_callback_ptr, void*, rs2_error**))                 \
  X(void, rs2_pipeline_stop, (rs2_pipeline*, rs2_error**))                                    \
  X(void, rs2_delete_pipeline_profile, (rs2_pipeline_profile*))                               \
  X(rs2_stream_profile_list*, rs2_pipeline_profile_get_streams,                               \
    (rs2_pipeline_profile*, rs2_error**))                                                     \
  X(void, rs2_delete_stream_profiles_list, (rs2_stream_profile_list*))                        \
  X(int, rs2_get_stream_profiles_count, (const rs2_stream_profile_list*, rs2_error**))        \
  X(const rs2_stream_profile*, rs2_get_stream_profile,                                        \
    (const rs2_stream_profile_list*, int, rs2_error**))                                       \
  X(void, rs2_get_stream_profile_data,                                                        \
    (const rs2_stream_profile*, int*, int*, int*, int*, int*, rs2_error**))                   \
  X(void, rs2_get_video_stream_intrinsics,                                                    \
    (const rs2_stream_profile*, rs2_intrinsics*, rs2_error**))                                \
  X(void, rs2_get_extrinsics,                                                                 \
    (const rs2_stream_profile*, const rs2_stream_profile*, rs2_extrinsics*, rs2_error**))     \
  X(int, rs2_is_frame_extendable_to, (const rs2_frame*, int, rs2_error**))                    \
  X(int, rs2_embedded_frames_count, (rs2_frame*, rs2_error**))                                \
  X(rs2_frame*, rs2_extract_frame, (rs2_frame*, int, rs2_error**))                            \
  X(void, rs2_release_frame, (rs2_frame*))                                                    \
  X(const rs2_stream_profile*, rs2_get_frame_stream_profile, (const rs2_frame*, rs2_error**)) \
  X(const void*, rs2_get_frame_data, (const rs2_frame*, rs2_error**))                         \
  X(int, rs2_get_frame_width, (const rs2_frame*, rs2_error**))                                \
  X(int, rs2_get_frame_height, (const rs2_frame*, rs2_error**))                               \
  X(int, rs2_get_frame_stride_in_bytes, (const rs2_frame*, rs2_error**))                      \
  X(double, rs2_get_frame_timestamp, (const rs2_frame*, rs2_error**))                         \
  X(int, rs2_get_frame_timestamp_domain, (const rs2_frame*, rs2_error**))                     \
  X(int, rs2_supports_frame_metadata, (const rs2_frame*, int, rs2_error**))                   \
  X(long long, rs2_get_frame_metadata, (const rs2_frame*, int, rs2_error**))

}  // namespace sgs::cameras::rs2
