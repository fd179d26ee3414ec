// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/time.h>

#include <cstdint>

// The part of libfreenect's C interface that is used: names, numbers and layouts as version 0.5 has
// them (abi_test.cc compares them with the library's header). The library is opened at run time.
namespace sgs::cameras::freenect {

struct Context;
struct Device;

struct Attributes {
  Attributes* next;
  const char* camera_serial;
};
struct FrameMode {
  std::uint32_t reserved;
  int resolution;
  std::int32_t format;
  std::int32_t bytes;
  std::int16_t width, height;
  std::int8_t data_bits_per_pixel, padding_bits_per_pixel, framerate, is_valid;
};
using LogCallback = void (*)(Context*, int, const char*);
using ImageCallback = void (*)(Device*, void*, std::uint32_t);

constexpr int kSubdeviceCamera = 2, kResolutionMedium = 1, kVideoRgb = 0, kDepthRegistered = 4;
constexpr int kAutoExposure = 1 << 14, kAutoWhiteBalance = 1 << 1, kOff = 0, kLogError = 1;
constexpr int kMirrorDepth = 1 << 16, kMirrorVideo = 1 << 17;

/// X(result, name, (parameters)) for every function.
#define SGS_FREENECT_FUNCTIONS(X)                                                  \
  X(int, freenect_init, (Context**, void*))                                        \
  X(int, freenect_shutdown, (Context*))                                            \
  X(void, freenect_set_log_level, (Context*, int))                                 \
  X(void, freenect_set_log_callback, (Context*, LogCallback))                      \
  X(int, freenect_process_events_timeout, (Context*, timeval*))                    \
  X(int, freenect_list_device_attributes, (Context*, Attributes**))                \
  X(void, freenect_free_device_attributes, (Attributes*))                          \
  X(void, freenect_select_subdevices, (Context*, int))                             \
  X(int, freenect_open_device_by_camera_serial, (Context*, Device**, const char*)) \
  X(int, freenect_close_device, (Device*))                                         \
  X(void, freenect_set_depth_callback, (Device*, ImageCallback))                   \
  X(void, freenect_set_video_callback, (Device*, ImageCallback))                   \
  X(FrameMode, freenect_find_video_mode, (int, int))                               \
  X(FrameMode, freenect_find_depth_mode, (int, int))                               \
  X(int, freenect_set_video_mode, (Device*, FrameMode))                            \
  X(int, freenect_set_depth_mode, (Device*, FrameMode))                            \
  X(int, freenect_start_depth, (Device*))                                          \
  X(int, freenect_start_video, (Device*))                                          \
  X(int, freenect_stop_depth, (Device*))                                           \
  X(int, freenect_stop_video, (Device*))                                           \
  X(int, freenect_set_flag, (Device*, int, int))

}  // namespace sgs::cameras::freenect
