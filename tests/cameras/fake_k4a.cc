// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A libk4a that is none: it plays a scene (scene_player.h). Declared here once more, from the
// library's documentation, and not from what the program under test declares. Images are of the
// scene's size, whatever the mode. Counts what it has handed out and not got back.
#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "scene_player.h"
#include "waiting.h"

// The layouts of the library's public headers.
struct k4a_calibration_extrinsics_t {
  float rotation[9], translation[3];
};
struct k4a_calibration_intrinsics_t {
  int type;
  unsigned int parameter_count;
  float v[15];  // cx cy fx fy k1 to k6 codx cody p2 p1 radius
};
struct k4a_calibration_camera_t {
  k4a_calibration_extrinsics_t extrinsics;
  k4a_calibration_intrinsics_t intrinsics;
  int resolution_width, resolution_height;
  float metric_radius;
};
struct k4a_calibration_t {
  k4a_calibration_camera_t depth, color;
  k4a_calibration_extrinsics_t extrinsics[4][4];
  int depth_mode, color_resolution;
};
struct k4a_hardware_version_t {
  std::uint32_t rgb[3], depth[3], audio[3], depth_sensor[3];
  int firmware_build, firmware_signature;
};
struct k4a_imu_sample_t {
  float temperature;
  float acc_sample[3];
  std::uint64_t acc_timestamp_usec;
  float gyro_sample[3];
  std::uint64_t gyro_timestamp_usec;
};
struct k4a_device_configuration_t {
  int color_format, color_resolution, depth_mode, camera_fps;
  bool synchronized_images_only;
  std::int32_t depth_delay_off_color_usec;
  int wired_sync_mode;
  std::uint32_t subordinate_delay_off_master_usec;
  bool disable_streaming_indicator;
};
using log_callback = void(void*, int, const char*, int, const char*);

struct k4a_image {
  bool color = false;
  double stamp_ms = 0;
  std::string bytes;
};
struct k4a_capture {
  std::unique_ptr<k4a_image> color, depth;
};

namespace {

std::atomic<long> handed_out{0};
log_callback* on_log = nullptr;
void* log_user = nullptr;

int failed(const std::string& why) {
  if (on_log != nullptr) on_log(log_user, 1, "fake_k4a.cc", 1, why.c_str());
  return 1;
}

std::string bgra_of(const std::string& rgb) {
  std::string bgra;
  for (std::size_t i = 0; i < rgb.size(); i += 3) {
    bgra += {rgb[i + 2], rgb[i + 1], rgb[i], '\x01'};
  }
  return bgra;
}

const fake::Camera& camera_of(const k4a_image* image) {
  return image->color ? fake::scene().color : fake::scene().depth;
}

k4a_calibration_camera_t written(const fake::Camera& c) {
  const float* k = c.coefficients;  // k1 k2 p1 p2 k3
  return {{},
          {4, 14, {c.cx, c.cy, c.fx, c.fy, k[0], k[1], k[4], 0, 0, 0, 0, 0, k[3], k[2], 0}},
          c.width,
          c.height,
          1.7f};
}

}  // namespace

struct k4a_device final : fake::Listener {
  std::string serial;
  fake::Waiting<std::unique_ptr<k4a_capture>> captures;
  fake::Waiting<k4a_imu_sample_t> samples;
  std::deque<k4a_imu_sample_t> felt;
  std::atomic<bool> gone{false}, imu{false};
  std::optional<fake::Player> player;

  void images(double stamp_ms, const std::string& color, const std::string* depth) override {
    auto capture = std::make_unique<k4a_capture>();
    capture->color = image(true, stamp_ms, bgra_of(color), fake::scene().color.width * 4);
    if (depth != nullptr) {
      capture->depth = image(false, stamp_ms, *depth, fake::scene().depth.width * 2);
    }
    captures.push(std::move(capture));
  }
  /// Both halves come in one sample.
  void motion(bool gyro, double stamp_ms, const float* xyz) override {
    if (!imu) return;
    const auto stamp_us = static_cast<std::uint64_t>(stamp_ms * 1000);
    if (!gyro) {
      felt.push_back({25, {xyz[0], xyz[1], xyz[2]}, stamp_us, {}, 0});
      return;
    }
    if (felt.empty()) return;
    k4a_imu_sample_t sample = felt.front();
    felt.pop_front();
    std::copy_n(xyz, 3, sample.gyro_sample);
    sample.gyro_timestamp_usec = stamp_us;
    samples.push(sample);
  }
  void unplugged() override { gone = true; }

  static std::unique_ptr<k4a_image> image(bool color, double stamp_ms, const std::string& bytes,
                                          int row_bytes) {
    auto made = std::make_unique<k4a_image>();
    made->color = color;
    made->stamp_ms = stamp_ms;
    made->bytes = fake::with_gaps(bytes, row_bytes);
    return made;
  }
};

extern "C" {

std::uint32_t k4a_device_get_installed_count() {
  return static_cast<std::uint32_t>(fake::serials().size());
}
int k4a_set_debug_message_handler(log_callback* callback, void* user, int) {
  on_log = callback;
  log_user = user;
  return 0;
}

int k4a_device_open(std::uint32_t index, k4a_device** device) {
  const auto serials = fake::serials();
  if (index >= serials.size()) return failed("no such device");
  if (!fake::failure().empty()) return failed(fake::failure());
  *device = new k4a_device;
  (*device)->serial = serials[index];
  return 0;
}
void k4a_device_close(k4a_device* device) { delete device; }
int k4a_device_get_serialnum(k4a_device* device, char* text, std::size_t* size) {
  if (text == nullptr || *size <= device->serial.size()) return 2;
  std::strcpy(text, device->serial.c_str());
  *size = device->serial.size() + 1;
  return 0;
}
int k4a_device_get_version(k4a_device*, k4a_hardware_version_t* version) {
  *version = {{1, 6, 110}, {1, 6, 80}, {1, 6, 14}, {6109, 7, 0}, 0, 0};
  return 0;
}

int k4a_device_get_calibration(k4a_device*, int depth_mode, int resolution,
                               k4a_calibration_t* out) {
  *out = {};
  out->depth = written(fake::scene().depth);
  out->color = written(fake::scene().color);
  out->depth_mode = depth_mode;
  out->color_resolution = resolution;
  for (auto& from : out->extrinsics) {
    for (auto& to : from) to = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
  }
  auto& color_from_depth = out->extrinsics[0][1];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      color_from_depth.rotation[3 * i + j] = fake::scene().rotation[3 * j + i];
    }
    color_from_depth.translation[i] = 1000 * fake::scene().translation_m[i];
  }
  return 0;
}

int k4a_device_get_color_control(k4a_device*, int command, int* mode, std::int32_t* value) {
  *mode = 0;
  *value = command == 0 ? 8330 : 4500;
  return 0;
}
int k4a_device_set_color_control(k4a_device*, int command, int mode, std::int32_t value) {
  fake::keep_option(std::to_string(command) + (mode == 1 ? " manual " : " auto ") +
                    std::to_string(value));
  return 0;
}

int k4a_device_start_cameras(k4a_device* device, const k4a_device_configuration_t* c) {
  if (c->color_format != 3 || c->synchronized_images_only) return failed("not what was agreed on");
  if (!fake::text_of("START").empty()) return failed(fake::text_of("START"));
  fake::keep_option("resolution " + std::to_string(c->color_resolution) + " depth " +
                    std::to_string(c->depth_mode) + " rate " + std::to_string(c->camera_fps));
  device->player.emplace(*device, fake::with_imu());
  return 0;
}
void k4a_device_stop_cameras(k4a_device* device) {
  device->captures.close();
  device->samples.close();
  device->player.reset();
  fake::keep("left", handed_out);
}
int k4a_device_start_imu(k4a_device* device) {
  if (!fake::with_imu()) return failed("no such sensor");
  device->imu = true;
  return 0;
}
void k4a_device_stop_imu(k4a_device* device) {
  device->imu = false;
  device->samples.close();
}

int k4a_device_get_capture(k4a_device* device, k4a_capture** capture, std::int32_t timeout_ms) {
  auto next = device->captures.pop(timeout_ms);
  if (!next) return device->gone ? failed("the device is gone") : 2;
  ++handed_out;
  *capture = next->release();
  return 0;
}
int k4a_device_get_imu_sample(k4a_device* device, k4a_imu_sample_t* sample,
                              std::int32_t timeout_ms) {
  const auto next = device->samples.pop(timeout_ms);
  if (!next) return device->gone ? 1 : 2;
  *sample = *next;
  return 0;
}
void k4a_capture_release(k4a_capture* capture) {
  --handed_out;
  delete capture;
}
k4a_image* k4a_capture_get_color_image(k4a_capture* capture) {
  if (capture->color) ++handed_out;
  return capture->color.release();
}
k4a_image* k4a_capture_get_depth_image(k4a_capture* capture) {
  if (capture->depth) ++handed_out;
  return capture->depth.release();
}
void k4a_image_release(k4a_image* image) {
  --handed_out;
  delete image;
}
std::uint8_t* k4a_image_get_buffer(k4a_image* image) {
  return reinterpret_cast<std::uint8_t*>(image->bytes.data());
}
int k4a_image_get_width_pixels(k4a_image* image) { return camera_of(image).width; }
int k4a_image_get_height_pixels(k4a_image* image) { return camera_of(image).height; }
int k4a_image_get_stride_bytes(k4a_image* image) {
  return camera_of(image).width * (image->color ? 4 : 2) + fake::kPadding_bytes;
}
#ifndef FAKE_MISSING
std::uint64_t k4a_image_get_device_timestamp_usec(k4a_image* image) {
  return static_cast<std::uint64_t>(image->stamp_ms * 1000);
}
#endif
std::uint64_t k4a_image_get_exposure_usec(k4a_image* image) {
  return image->color ? fake::kExposure_us : 0;
}
std::uint32_t k4a_image_get_iso_speed(k4a_image*) { return fake::kGain; }

}  // extern "C"
