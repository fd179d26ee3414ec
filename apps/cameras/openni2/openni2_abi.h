// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

// The part of OpenNI2's C interface that is used: names, numbers and layouts as version 2.2 has
// them, the last one (abi_test.cc compares them with the library's header). The library is opened
// at run time.
namespace sgs::cameras::openni2 {

struct Device;
struct Stream;
struct Callback;

struct Version {
  int major, minor, maintenance, build;
};
struct VideoMode {
  int format, width, height, fps;
};
struct SensorInfo {
  int sensor, modes;
  VideoMode* mode;
};
struct DeviceInfo {
  char uri[256], vendor[256], name[256];
  std::uint16_t usb_vendor, usb_product;
};
struct Frame {
  int bytes;
  void* data;
  int sensor;
  std::uint64_t timestamp_us;
  int index, width, height;
  VideoMode mode;
  int cropped, crop_x, crop_y, stride;
};
using NewFrame = void (*)(Stream*, void*);

constexpr int kApiVersion = 2002, kOk = 0;
enum Sensor : int { kColor = 2, kDepth = 3 };
enum Format : int { kDepthMillimetre = 100, kDepthTenth = 101, kRgb = 200 };
enum DeviceProperty : int { kFirmware = 0, kSerialNumber = 3, kRegistration = 5 };
enum StreamProperty : int {
  kHorizontalFov = 1,
  kVerticalFov = 2,
  kVideoMode = 3,
  kMirroring = 7,
  kAutoWhiteBalance = 100,
  kAutoExposure = 101,
};
constexpr int kDepthToColor = 1;

/// X(result, name, (parameters)) for every function.
#define SGS_OPENNI2_FUNCTIONS(X)                                    \
  X(int, oniInitialize, (int))                                      \
  X(Version, oniGetVersion, ())                                     \
  X(const char*, oniGetExtendedError, ())                           \
  X(int, oniGetDeviceList, (DeviceInfo**, int*))                    \
  X(int, oniReleaseDeviceList, (DeviceInfo*))                       \
  X(int, oniDeviceOpen, (const char*, Device**))                    \
  X(int, oniDeviceClose, (Device*))                                 \
  X(const SensorInfo*, oniDeviceGetSensorInfo, (Device*, int))      \
  X(int, oniDeviceGetProperty, (Device*, int, void*, int*))         \
  X(int, oniDeviceSetProperty, (Device*, int, const void*, int))    \
  X(int, oniDeviceIsImageRegistrationModeSupported, (Device*, int)) \
  X(int, oniDeviceCreateStream, (Device*, int, Stream**))           \
  X(void, oniStreamDestroy, (Stream*))                              \
  X(int, oniStreamStart, (Stream*))                                 \
  X(void, oniStreamStop, (Stream*))                                 \
  X(int, oniStreamReadFrame, (Stream*, Frame**))                    \
  X(void, oniFrameRelease, (Frame*))                                \
  X(int, oniStreamGetProperty, (Stream*, int, void*, int*))         \
  X(int, oniStreamSetProperty, (Stream*, int, const void*, int))    \
  X(int, oniStreamRegisterNewFrameCallback, (Stream*, NewFrame, void*, Callback**))

}  // namespace sgs::cameras::openni2
