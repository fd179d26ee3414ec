// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A librealsense2 that is none: it plays a scene (scene_player.h). Declared here once more, from
// the library's documentation, and not from what the program under test declares.
#include <atomic>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scene_player.h"

namespace {

enum { kDepth = 1, kColor = 2, kGyro = 5, kAccel = 6 };

}  // namespace

// The layouts of the library's public headers.
struct rs2_intrinsics {
  int width, height;
  float ppx, ppy, fx, fy;
  int model;
  float coeffs[5];
};
struct rs2_extrinsics {
  float rotation[9], translation[3];
};

struct rs2_error {
  std::string message;
};
struct rs2_context {
  int version;
};
struct rs2_device {
  std::string serial;
};
struct rs2_device_list {
  std::vector<std::string> serials;
};
struct rs2_sensor {
  int kind;  // a stream
};
struct rs2_sensor_list {
  std::vector<int> kinds;
};
struct rs2_options_list {
  std::vector<int> options;
};
struct rs2_config {
  std::string serial;
  std::vector<int> streams;
};
struct rs2_stream_profile {
  int stream, format;
};
struct rs2_frame {
  const rs2_stream_profile* profile = nullptr;
  double stamp_ms = 0;
  std::string bytes;
  int width = 0, height = 0, stride = 0;
  std::vector<rs2_frame*> parts;
  std::atomic<int> references{1};
};
using callback = void (*)(rs2_frame*, void*);

namespace {

const rs2_stream_profile kProfiles[] = {{kColor, 5}, {kDepth, 1}, {kGyro, 16}, {kAccel, 16}};

const rs2_stream_profile* profile_of(int stream) {
  for (const auto& profile : kProfiles) {
    if (profile.stream == stream) return &profile;
  }
  return nullptr;
}

void set_error(rs2_error** error, const std::string& message) {
  if (error != nullptr) *error = new rs2_error{message};
}

rs2_intrinsics written(const fake::Camera& c) {
  rs2_intrinsics out{c.width, c.height, c.cx, c.cy, c.fx, c.fy, c.model, {}};
  std::memcpy(out.coeffs, c.coefficients, sizeof out.coeffs);
  return out;
}

rs2_frame* image(int stream, double stamp_ms, const std::string& bytes) {
  const auto& camera = stream == kColor ? fake::scene().color : fake::scene().depth;
  auto* frame = new rs2_frame;
  frame->profile = profile_of(stream);
  frame->stamp_ms = stamp_ms;
  frame->width = camera.width;
  frame->height = camera.height;
  const int row = camera.width * (stream == kColor ? 3 : 2);
  frame->stride = row + fake::kPadding_bytes;
  frame->bytes = fake::with_gaps(bytes, row);
  return frame;
}

}  // namespace

struct rs2_pipeline final : fake::Listener {
  callback on_frame = nullptr;
  void* user = nullptr;
  bool imu = false;
  std::optional<fake::Player> player;

  void images(double stamp_ms, const std::string& color, const std::string* depth) override {
    auto* set = new rs2_frame;
    set->parts.push_back(image(kColor, stamp_ms, color));
    if (depth != nullptr) set->parts.push_back(image(kDepth, stamp_ms, *depth));
    on_frame(set, user);
  }
  void motion(bool gyro, double stamp_ms, const float* xyz) override {
    auto* frame = new rs2_frame;
    frame->profile = profile_of(gyro ? kGyro : kAccel);
    frame->stamp_ms = stamp_ms;
    frame->bytes.assign(reinterpret_cast<const char*>(xyz), 3 * sizeof *xyz);
    on_frame(frame, user);
  }
};
struct rs2_pipeline_profile {
  bool imu;
};
struct rs2_stream_profile_list {
  std::vector<const rs2_stream_profile*> profiles;
};

namespace {

/// Options have numbers here that no version has.
constexpr int kFirstOption = 1000;
const char* const kOptions[] = {"Enable Auto Exposure",      "Exposure",
                                "Enable Auto White Balance", "White Balance",
                                "Emitter Enabled",           "Global Time Enabled",
                                "Auto Exposure Priority"};

}  // namespace

extern "C" {

int rs2_get_api_version(rs2_error**) { return static_cast<int>(fake::number_of("VERSION", 25600)); }
const char* rs2_get_error_message(const rs2_error* error) { return error->message.c_str(); }
void rs2_free_error(rs2_error* error) { delete error; }

rs2_context* rs2_create_context(int version, rs2_error** error) {
  std::puts("this library prints to standard output");
  std::fflush(stdout);
  const int own = rs2_get_api_version(nullptr);
  if (version / 10000 != own / 10000 || version / 100 > own / 100) {
    set_error(error, "API version mismatch");
    return nullptr;
  }
  return new rs2_context{version};
}
void rs2_delete_context(rs2_context* context) { delete context; }

rs2_device_list* rs2_query_devices(const rs2_context*, rs2_error**) {
  return new rs2_device_list{fake::serials()};
}
void rs2_delete_device_list(rs2_device_list* list) { delete list; }
int rs2_get_device_count(const rs2_device_list* list, rs2_error**) {
  return static_cast<int>(list->serials.size());
}
rs2_device* rs2_create_device(const rs2_device_list* list, int index, rs2_error**) {
  return new rs2_device{list->serials.at(static_cast<std::size_t>(index))};
}
void rs2_delete_device(rs2_device* device) { delete device; }
int rs2_supports_device_info(const rs2_device*, int info, rs2_error**) {
  return info <= 3 || info == 9;
}
const char* rs2_get_device_info(const rs2_device* device, int info, rs2_error** error) {
  static const std::string usb = fake::text_of("USB", "3.2");
  static const std::string firmware = fake::text_of("FIRMWARE", "5.16.0.1");
  if (info == 0) return "Fake RealSense D435";
  if (info == 1) return device->serial.c_str();
  if (info == 2) return firmware.c_str();
  if (info == 3) return "5.16.0.1";
  if (info == 9) return usb.c_str();
  set_error(error, "info not supported");
  return nullptr;
}

rs2_sensor_list* rs2_query_sensors(const rs2_device*, rs2_error**) {
  auto* list = new rs2_sensor_list{{kDepth, kColor}};
  if (fake::with_imu()) list->kinds.push_back(kAccel);
  return list;
}
void rs2_delete_sensor_list(rs2_sensor_list* list) { delete list; }
int rs2_get_sensors_count(const rs2_sensor_list* list, rs2_error**) {
  return static_cast<int>(list->kinds.size());
}
rs2_sensor* rs2_create_sensor(const rs2_sensor_list* list, int index, rs2_error**) {
  return new rs2_sensor{list->kinds.at(static_cast<std::size_t>(index))};
}
void rs2_delete_sensor(rs2_sensor* sensor) { delete sensor; }
const char* rs2_get_sensor_info(const rs2_sensor* sensor, int, rs2_error**) {
  return sensor->kind == kDepth   ? "Stereo Module"
         : sensor->kind == kColor ? "RGB Camera"
                                  : "Motion Module";
}
int rs2_is_sensor_extendable_to(const rs2_sensor* sensor, int extension, rs2_error**) {
  return extension == 7 && sensor->kind == kDepth;
}
float rs2_get_depth_scale(rs2_sensor*, rs2_error**) { return fake::scene().unit_m; }

struct rs2_options;
rs2_options_list* rs2_get_options_list(const rs2_options*, rs2_error**) {
  auto* list = new rs2_options_list;
  for (int i = 0; i < static_cast<int>(std::size(kOptions)); ++i) {
    list->options.push_back(kFirstOption + i);
  }
  return list;
}
void rs2_delete_options_list(rs2_options_list* list) { delete list; }
int rs2_get_options_list_size(const rs2_options_list* list, rs2_error**) {
  return static_cast<int>(list->options.size());
}
int rs2_get_option_from_list(const rs2_options_list* list, int index, rs2_error**) {
  return list->options.at(static_cast<std::size_t>(index));
}
const char* rs2_get_option_name(const rs2_options*, int option, rs2_error** error) {
  if (option >= kFirstOption) return kOptions[option - kFirstOption];
  set_error(error, "no such option");
  return nullptr;
}
float rs2_get_option(const rs2_options*, int, rs2_error**) { return 1; }
void rs2_set_option(const rs2_options* options, int option, float value, rs2_error**) {
  const auto* sensor = reinterpret_cast<const rs2_sensor*>(options);
  fake::keep_option(std::to_string(sensor->kind) + ' ' + kOptions[option - kFirstOption] + ' ' +
                    std::to_string(static_cast<int>(value)));
}

rs2_config* rs2_create_config(rs2_error**) { return new rs2_config; }
void rs2_delete_config(rs2_config* config) { delete config; }
void rs2_config_enable_device(rs2_config* config, const char* serial, rs2_error**) {
  config->serial = serial;
}
void rs2_config_enable_stream(rs2_config* config, int stream, int, int, int, int, int,
                              rs2_error**) {
  config->streams.push_back(stream);
}
rs2_pipeline* rs2_create_pipeline(rs2_context*, rs2_error**) { return new rs2_pipeline; }
void rs2_pipeline_stop(rs2_pipeline* pipe, rs2_error**) { pipe->player.reset(); }
void rs2_delete_pipeline(rs2_pipeline* pipe) {
  rs2_pipeline_stop(pipe, nullptr);
  delete pipe;
}
rs2_pipeline_profile* rs2_pipeline_start_with_config_and_callback(rs2_pipeline* pipe,
                                                                  rs2_config* config,
                                                                  callback on_frame, void* user,
                                                                  rs2_error** error) {
  const std::string failure = fake::failure();
  if (!failure.empty()) {
    set_error(error, failure);
    return nullptr;
  }
  for (const int stream : config->streams) pipe->imu |= stream == kAccel;
  pipe->on_frame = on_frame;
  pipe->user = user;
  pipe->player.emplace(*pipe, pipe->imu);
  return new rs2_pipeline_profile{pipe->imu};
}
void rs2_delete_pipeline_profile(rs2_pipeline_profile* profile) { delete profile; }

rs2_stream_profile_list* rs2_pipeline_profile_get_streams(rs2_pipeline_profile* profile,
                                                          rs2_error**) {
  auto* list = new rs2_stream_profile_list;
  for (const auto& one : kProfiles) {
    if (profile->imu || one.stream == kColor || one.stream == kDepth)
      list->profiles.push_back(&one);
  }
  return list;
}
void rs2_delete_stream_profiles_list(rs2_stream_profile_list* list) { delete list; }
int rs2_get_stream_profiles_count(const rs2_stream_profile_list* list, rs2_error**) {
  return static_cast<int>(list->profiles.size());
}
const rs2_stream_profile* rs2_get_stream_profile(const rs2_stream_profile_list* list, int index,
                                                 rs2_error**) {
  return list->profiles.at(static_cast<std::size_t>(index));
}
void rs2_get_stream_profile_data(const rs2_stream_profile* profile, int* stream, int* format,
                                 int* index, int* id, int* rate, rs2_error**) {
  *stream = profile->stream;
  *format = profile->format;
  *index = 0;
  *id = profile->stream;
  *rate = 30;
}
void rs2_get_video_stream_intrinsics(const rs2_stream_profile* profile, rs2_intrinsics* out,
                                     rs2_error**) {
  *out = written(profile->stream == kColor ? fake::scene().color : fake::scene().depth);
}
void rs2_get_extrinsics(const rs2_stream_profile* from, const rs2_stream_profile*,
                        rs2_extrinsics* out, rs2_error**) {
  *out = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
  if (from->stream != kDepth) return;
  std::memcpy(out->rotation, fake::scene().rotation, sizeof out->rotation);
  std::memcpy(out->translation, fake::scene().translation_m, sizeof out->translation);
}

int rs2_is_frame_extendable_to(const rs2_frame* frame, int extension, rs2_error**) {
  return extension == 10 && !frame->parts.empty();
}
int rs2_embedded_frames_count(rs2_frame* frame, rs2_error**) {
  return static_cast<int>(frame->parts.size());
}
#ifndef FAKE_MISSING
rs2_frame* rs2_extract_frame(rs2_frame* frame, int index, rs2_error**) {
  auto* part = frame->parts.at(static_cast<std::size_t>(index));
  ++part->references;
  return part;
}
#endif
void rs2_release_frame(rs2_frame* frame) {
  if (--frame->references > 0) return;
  for (auto* part : frame->parts) rs2_release_frame(part);
  delete frame;
}
const rs2_stream_profile* rs2_get_frame_stream_profile(const rs2_frame* frame, rs2_error**) {
  return frame->profile;
}
const void* rs2_get_frame_data(const rs2_frame* frame, rs2_error**) { return frame->bytes.data(); }
int rs2_get_frame_width(const rs2_frame* frame, rs2_error**) { return frame->width; }
int rs2_get_frame_height(const rs2_frame* frame, rs2_error**) { return frame->height; }
int rs2_get_frame_stride_in_bytes(const rs2_frame* frame, rs2_error**) { return frame->stride; }
double rs2_get_frame_timestamp(const rs2_frame* frame, rs2_error**) { return frame->stamp_ms; }
int rs2_get_frame_timestamp_domain(const rs2_frame*, rs2_error**) { return 0; }
int rs2_supports_frame_metadata(const rs2_frame*, int value, rs2_error**) { return value <= 4; }
long long rs2_get_frame_metadata(const rs2_frame* frame, int value, rs2_error** error) {
  const auto stamp_us = static_cast<long long>(frame->stamp_ms * 1000);
  if (value == 1) return stamp_us;
  if (value == 2) return stamp_us - fake::number_of("SHIFT_US", 0);
  if (value == 3) return fake::kExposure_us;
  if (value == 4) return fake::kGain;
  set_error(error, "no such metadata");
  return 0;
}

}  // extern "C"
