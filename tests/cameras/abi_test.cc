// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What programs for cameras declare of libraries that they open at run time, against the headers of
// those libraries that Debian has: compiling it is the test.
#include <OniCAPI.h>
#include <libfreenect.h>

#include <cstddef>
#include <type_traits>

#include "freenect/freenect_abi.h"
#include "openni2/openni2_abi.h"

namespace sgs::cameras {
namespace {

#define SAME_SIZE(mine, theirs) static_assert(sizeof(mine) == sizeof(theirs))
#define SAME_PLACE(mine, member, theirs, their_member) \
  static_assert(offsetof(mine, member) == offsetof(theirs, their_member))
#define SAME_NUMBER(mine, theirs) static_assert(int{mine} == int{theirs})

SAME_SIZE(freenect::FrameMode, freenect_frame_mode);
SAME_PLACE(freenect::FrameMode, width, freenect_frame_mode, width);
SAME_PLACE(freenect::FrameMode, is_valid, freenect_frame_mode, is_valid);
SAME_SIZE(freenect::Attributes, freenect_device_attributes);
SAME_PLACE(freenect::Attributes, camera_serial, freenect_device_attributes, camera_serial);
SAME_NUMBER(freenect::kSubdeviceCamera, FREENECT_DEVICE_CAMERA);
SAME_NUMBER(freenect::kResolutionMedium, FREENECT_RESOLUTION_MEDIUM);
SAME_NUMBER(freenect::kVideoRgb, FREENECT_VIDEO_RGB);
SAME_NUMBER(freenect::kDepthRegistered, FREENECT_DEPTH_REGISTERED);
SAME_NUMBER(freenect::kAutoExposure, FREENECT_AUTO_EXPOSURE);
SAME_NUMBER(freenect::kAutoWhiteBalance, FREENECT_AUTO_WHITE_BALANCE);
SAME_NUMBER(freenect::kMirrorDepth, FREENECT_MIRROR_DEPTH);
SAME_NUMBER(freenect::kMirrorVideo, FREENECT_MIRROR_VIDEO);
SAME_NUMBER(freenect::kLogError, FREENECT_LOG_ERROR);

SAME_SIZE(openni2::Version, OniVersion);
SAME_SIZE(openni2::VideoMode, OniVideoMode);
SAME_PLACE(openni2::VideoMode, fps, OniVideoMode, fps);
SAME_SIZE(openni2::SensorInfo, OniSensorInfo);
SAME_PLACE(openni2::SensorInfo, mode, OniSensorInfo, pSupportedVideoModes);
SAME_SIZE(openni2::DeviceInfo, OniDeviceInfo);
SAME_PLACE(openni2::DeviceInfo, usb_product, OniDeviceInfo, usbProductId);
SAME_SIZE(openni2::Frame, OniFrame);
SAME_PLACE(openni2::Frame, data, OniFrame, data);
SAME_PLACE(openni2::Frame, sensor, OniFrame, sensorType);
SAME_PLACE(openni2::Frame, timestamp_us, OniFrame, timestamp);
SAME_PLACE(openni2::Frame, width, OniFrame, width);
SAME_PLACE(openni2::Frame, stride, OniFrame, stride);
SAME_NUMBER(openni2::kColor, ONI_SENSOR_COLOR);
SAME_NUMBER(openni2::kDepth, ONI_SENSOR_DEPTH);
SAME_NUMBER(openni2::kRgb, ONI_PIXEL_FORMAT_RGB888);
SAME_NUMBER(openni2::kDepthMillimetre, ONI_PIXEL_FORMAT_DEPTH_1_MM);
SAME_NUMBER(openni2::kDepthTenth, ONI_PIXEL_FORMAT_DEPTH_100_UM);
SAME_NUMBER(openni2::kSerialNumber, ONI_DEVICE_PROPERTY_SERIAL_NUMBER);
SAME_NUMBER(openni2::kRegistration, ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION);
SAME_NUMBER(openni2::kVideoMode, ONI_STREAM_PROPERTY_VIDEO_MODE);
SAME_NUMBER(openni2::kMirroring, ONI_STREAM_PROPERTY_MIRRORING);
SAME_NUMBER(openni2::kAutoExposure, ONI_STREAM_PROPERTY_AUTO_EXPOSURE);
SAME_NUMBER(openni2::kDepthToColor, ONI_IMAGE_REGISTRATION_DEPTH_TO_COLOR);

/// How many parameters a function has.
template <class Function>
struct Parameters;
template <class Result, class... Types>
struct Parameters<Result (*)(Types...)> : std::integral_constant<std::size_t, sizeof...(Types)> {};

}  // namespace

#define MEMBER(result, name, declared) result(*name) declared;
#define SAME_PARAMETERS(result, name, declared) \
  static_assert(Parameters<decltype(Mine::name)>() == Parameters<decltype(&::name)>());
namespace freenect {
struct Mine {
  SGS_FREENECT_FUNCTIONS(MEMBER)
};
SGS_FREENECT_FUNCTIONS(SAME_PARAMETERS)
}  // namespace freenect
namespace openni2 {
struct Mine {
  SGS_OPENNI2_FUNCTIONS(MEMBER)
};
SGS_OPENNI2_FUNCTIONS(SAME_PARAMETERS)
}  // namespace openni2

}  // namespace sgs::cameras
