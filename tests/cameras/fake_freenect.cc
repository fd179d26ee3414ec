// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A libfreenect that is none: it plays a scene (scene_player.h), in its size whatever the mode.
// Declared by the library's own header.
#include <libfreenect.h>

#include <atomic>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "scene_player.h"
#include "waiting.h"

namespace {

struct Image {
  bool color = false;
  std::uint32_t ticks = 0;
  std::string bytes;
};

}  // namespace

struct _freenect_device final : fake::Listener {
  fake::Waiting<Image> waiting;
  freenect_video_cb on_video = nullptr;
  freenect_depth_cb on_depth = nullptr;
  bool video = false, depth = false;
  std::optional<fake::Player> player;

  void images(double stamp_ms, const std::string& color, const std::string* depths) override {
    constexpr double kTicksPerMs = 60000;
    // 32 bits of a counter.
    const auto ticks =
        static_cast<std::uint32_t>(static_cast<std::uint64_t>(stamp_ms * kTicksPerMs));
    waiting.push({true, ticks, color});
    if (depths != nullptr) waiting.push({false, ticks, *depths});
  }
  void motion(bool, double, const float*) override {}
};

struct _freenect_context {
  freenect_log_cb on_log = nullptr;
  std::unique_ptr<freenect_device> device;

  int failed(const std::string& why) {
    if (on_log != nullptr) on_log(this, FREENECT_LOG_ERROR, (why + "\n").c_str());
    return -1;
  }
};

namespace {

freenect_context* running = nullptr;

freenect_frame_mode mode_of(const fake::Camera& camera, int bytes) {
  freenect_frame_mode mode{};
  mode.width = static_cast<std::int16_t>(camera.width);
  mode.height = static_cast<std::int16_t>(camera.height);
  mode.bytes = camera.width * camera.height * bytes;
  mode.framerate = 30;
  mode.is_valid = 1;
  return mode;
}

int play_when_both_run(freenect_device* device) {
  if (device->video && device->depth) device->player.emplace(*device, false);
  return 0;
}
int end(freenect_device* device) {
  device->waiting.close();
  device->player.reset();
  return 0;
}

}  // namespace

extern "C" {

int freenect_init(freenect_context** context, freenect_usb_context*) {
  *context = running = new freenect_context;
  return 0;
}
int freenect_shutdown(freenect_context* context) {
  delete context;
  return 0;
}
void freenect_set_log_level(freenect_context*, freenect_loglevel) {}
void freenect_set_log_callback(freenect_context* context, freenect_log_cb callback) {
  context->on_log = callback;
}
void freenect_select_subdevices(freenect_context*, freenect_device_flags) {}

int freenect_list_device_attributes(freenect_context*, freenect_device_attributes** list) {
  *list = nullptr;
  int count = 0;
  for (const std::string& serial : fake::serials()) {
    auto* one = new freenect_device_attributes{nullptr, strdup(serial.c_str())};
    // In their order.
    freenect_device_attributes** last = list;
    while (*last != nullptr) last = &(*last)->next;
    *last = one;
    ++count;
  }
  return count;
}
void freenect_free_device_attributes(freenect_device_attributes* list) {
  while (list != nullptr) {
    freenect_device_attributes* next = list->next;
    std::free(const_cast<char*>(list->camera_serial));
    delete list;
    list = next;
  }
}

int freenect_open_device_by_camera_serial(freenect_context* context, freenect_device** device,
                                          const char*) {
  if (!fake::failure().empty()) return context->failed(fake::failure());
  context->device = std::make_unique<freenect_device>();
  *device = context->device.get();
  return 0;
}
int freenect_close_device(freenect_device* device) {
  end(device);
  running->device.reset();
  return 0;
}

void freenect_set_depth_callback(freenect_device* device, freenect_depth_cb callback) {
  device->on_depth = callback;
}
void freenect_set_video_callback(freenect_device* device, freenect_video_cb callback) {
  device->on_video = callback;
}
freenect_frame_mode freenect_find_video_mode(freenect_resolution, freenect_video_format format) {
  if (format != FREENECT_VIDEO_RGB) return {};
  return mode_of(fake::scene().color, 3);
}
freenect_frame_mode freenect_find_depth_mode(freenect_resolution, freenect_depth_format format) {
  if (format != FREENECT_DEPTH_REGISTERED) return {};
  return mode_of(fake::scene().depth, 2);
}
int freenect_set_video_mode(freenect_device*, freenect_frame_mode) { return 0; }
int freenect_set_depth_mode(freenect_device*, freenect_frame_mode) { return 0; }
int freenect_start_video(freenect_device* device) {
  device->video = true;
  return play_when_both_run(device);
}
int freenect_start_depth(freenect_device* device) {
  device->depth = true;
  return play_when_both_run(device);
}
int freenect_stop_video(freenect_device* device) { return end(device); }
int freenect_stop_depth(freenect_device* device) { return end(device); }

#ifndef FAKE_MISSING
int freenect_process_events_timeout(freenect_context* context, timeval* timeout) {
  const auto wait_ms = static_cast<std::int32_t>(timeout->tv_sec * 1000 + timeout->tv_usec / 1000);
  freenect_device* device = context->device.get();
  auto image = device->waiting.pop(wait_ms);
  if (!image) return 0;
  if (image->color) {
    device->on_video(device, image->bytes.data(), image->ticks);
  } else {
    device->on_depth(device, image->bytes.data(), image->ticks);
  }
  return 0;
}
#endif
int freenect_set_flag(freenect_device*, freenect_flag flag, freenect_flag_value value) {
  fake::keep_option("flag " + std::to_string(flag) + ' ' + std::to_string(value));
  return 0;
}

}  // extern "C"
