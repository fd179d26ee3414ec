// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A libOrbbecSDK that is none: it plays a scene (scene_player.h). Declared here once more, from the
// library's documentation, and not from what the program under test declares. Counts the frames
// that it has handed out and not got back (`left` in the state's folder).
#include <atomic>
#include <cstdint>
#include <cstring>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "scene_player.h"

namespace {

enum { kColor = 2, kDepth = 3, kAccel = 4, kGyro = 5 };
enum { kFrameColor = 2, kFrameDepth = 3, kFrameAccel = 4, kFrameSet = 5, kFrameGyro = 7 };
enum { kMjpg = 5, kY16 = 8, kRgb = 22 };

std::atomic<long> handed_out{0};

}  // namespace

// The layouts of the library's public headers.
struct ob_camera_intrinsic {
  float fx, fy, cx, cy;
  std::int16_t width, height;
};
struct ob_camera_distortion {
  float k1, k2, k3, k4, k5, k6, p1, p2;
  int model;
};
struct ob_extrinsic {
  float rot[9], trans[3];
};
struct ob_xyz {
  float x, y, z;
};

struct ob_error {
  std::string message;
};
struct ob_context {};
struct ob_device_list {
  std::vector<std::string> serials;
};
struct ob_device {
  std::string serial;
};
struct ob_sensor_list {
  std::vector<int> types;
};
struct ob_stream_profile {
  int sensor, format;
  std::uint32_t width, height, fps;
};
struct ob_stream_profile_list {
  std::vector<ob_stream_profile> profiles;
};
struct ob_config {
  std::vector<int> sensors;
  int aggregate = 0;
};
struct ob_frame {
  int type = kFrameSet;
  double stamp_ms = 0;
  std::string bytes;
  ob_xyz value{};
  std::vector<ob_frame*> parts;
  std::atomic<int> references{1};
};
using callback = void (*)(ob_frame*, void*);

namespace {

/// Counted until it is given back.
ob_frame* handed(ob_frame* frame) {
  ++handed_out;
  return frame;
}

void set_error(ob_error** error, const std::string& message) {
  if (error != nullptr) *error = new ob_error{message};
}

/// Who gets samples: they come in a pipeline of their own.
std::mutex motion_mutex;
callback on_motion = nullptr;
void* motion_user = nullptr;

ob_frame* image(int type, double stamp_ms, const std::string& bytes) {
  auto* frame = new ob_frame;
  frame->type = type;
  frame->stamp_ms = stamp_ms;
  frame->bytes = bytes;
  return frame;
}

const fake::Camera& camera_of(int sensor) {
  return sensor == kColor ? fake::scene().color : fake::scene().depth;
}

}  // namespace

struct ob_pipeline final : fake::Listener {
  callback on_frames = nullptr;
  void* user = nullptr;
  bool motion_only = false;
  std::optional<fake::Player> player;

  void images(double stamp_ms, const std::string& color, const std::string* depth) override {
    auto* set = handed(new ob_frame);
    set->parts.push_back(image(kFrameColor, stamp_ms, color));
    if (depth != nullptr) set->parts.push_back(image(kFrameDepth, stamp_ms, *depth));
    on_frames(set, user);
  }
  void motion(bool gyro, double stamp_ms, const float* xyz) override {
    const std::lock_guard lock(motion_mutex);
    if (on_motion == nullptr) return;
    auto* set = handed(new ob_frame);
    set->parts.push_back(image(gyro ? kFrameGyro : kFrameAccel, stamp_ms, {}));
    set->parts.back()->value = {xyz[0], xyz[1], xyz[2]};
    on_motion(set, motion_user);
  }
  void end() {
    if (player) {
      player.reset();
      fake::keep("left", handed_out);
    }
    if (!motion_only) return;
    const std::lock_guard lock(motion_mutex);
    on_motion = nullptr;
  }
};

extern "C" {

int ob_get_version() { return static_cast<int>(fake::number_of("VERSION", 20903)); }
const char* ob_error_get_message(const ob_error* error) { return error->message.c_str(); }
void ob_delete_error(ob_error* error) { delete error; }
void ob_set_logger_to_console(int, ob_error**) {}
void ob_set_logger_to_file(int severity, const char*, ob_error**) {
  fake::keep_option("log to file " + std::to_string(severity));
}

ob_context* ob_create_context(ob_error**) { return new ob_context; }
void ob_delete_context(ob_context* context, ob_error**) { delete context; }

ob_device_list* ob_query_device_list(ob_context*, ob_error**) {
  return new ob_device_list{fake::serials()};
}
void ob_delete_device_list(ob_device_list* list, ob_error**) { delete list; }
std::uint32_t ob_device_list_get_count(const ob_device_list* list, ob_error**) {
  return static_cast<std::uint32_t>(list->serials.size());
}
const char* ob_device_list_get_device_name(const ob_device_list*, std::uint32_t, ob_error**) {
  return "Fake Orbbec Gemini 2";
}
const char* ob_device_list_get_device_serial_number(const ob_device_list* list, std::uint32_t index,
                                                    ob_error**) {
  return list->serials.at(index).c_str();
}
const char* ob_device_list_get_device_connection_type(const ob_device_list*, std::uint32_t,
                                                      ob_error**) {
  static const std::string usb = "USB" + fake::text_of("USB", "3.0");
  return usb.c_str();
}
ob_device* ob_device_list_get_device(const ob_device_list* list, std::uint32_t index,
                                     ob_error** error) {
  if (!fake::failure().empty()) {
    set_error(error, fake::failure());
    return nullptr;
  }
  return new ob_device{list->serials.at(index)};
}
void ob_delete_device(ob_device* device, ob_error**) { delete device; }

ob_sensor_list* ob_device_get_sensor_list(const ob_device*, ob_error**) {
  auto* list = new ob_sensor_list{{kColor, kDepth}};
  if (fake::with_imu()) list->types.insert(list->types.end(), {kAccel, kGyro});
  return list;
}
void ob_delete_sensor_list(ob_sensor_list* list, ob_error**) { delete list; }
std::uint32_t ob_sensor_list_get_count(const ob_sensor_list* list, ob_error**) {
  return static_cast<std::uint32_t>(list->types.size());
}
int ob_sensor_list_get_sensor_type(const ob_sensor_list* list, std::uint32_t index, ob_error**) {
  return list->types.at(index);
}

bool ob_device_is_property_supported(const ob_device*, int property, int, ob_error**) {
  return property != 182;  // the laser is a switch
}
std::int32_t ob_device_get_int_property(ob_device*, int property, ob_error**) { return property; }
void ob_device_set_int_property(ob_device*, int property, std::int32_t value, ob_error**) {
  fake::keep_option(std::to_string(property) + ' ' + std::to_string(value));
}
bool ob_device_get_bool_property(ob_device*, int, ob_error**) { return true; }
void ob_device_set_bool_property(ob_device*, int property, bool value, ob_error**) {
  fake::keep_option(std::to_string(property) + (value ? " on" : " off"));
}

ob_pipeline* ob_create_pipeline_with_device(const ob_device*, ob_error**) {
  return new ob_pipeline;
}
void ob_delete_pipeline(ob_pipeline* pipeline, ob_error**) {
  pipeline->end();
  delete pipeline;
}

ob_stream_profile_list* ob_pipeline_get_stream_profile_list(const ob_pipeline*, int sensor,
                                                            ob_error**) {
  auto* list = new ob_stream_profile_list;
  if (sensor == kAccel || sensor == kGyro) {
    list->profiles.push_back({sensor, sensor == kAccel ? 16 : 17, 0, 0, 0});
    return list;
  }
  const fake::Camera& camera = camera_of(sensor);
  const auto width = static_cast<std::uint32_t>(camera.width);
  const auto height = static_cast<std::uint32_t>(camera.height);
  const int format = sensor == kColor ? kRgb : kY16;
  list->profiles = {{sensor, format, 1920, 1080, 30},
                    {sensor, kMjpg, width, height, 30},
                    {sensor, format, width, height, 15},
                    {sensor, format, width, height, 30}};
  return list;
}
void ob_delete_stream_profile_list(ob_stream_profile_list* list, ob_error**) { delete list; }
std::uint32_t ob_stream_profile_list_get_count(const ob_stream_profile_list* list, ob_error**) {
  return static_cast<std::uint32_t>(list->profiles.size());
}
#ifndef FAKE_MISSING
ob_stream_profile* ob_stream_profile_list_get_profile(const ob_stream_profile_list* list, int index,
                                                      ob_error**) {
  return new ob_stream_profile(list->profiles.at(static_cast<std::size_t>(index)));
}
#endif
void ob_delete_stream_profile(const ob_stream_profile* profile, ob_error**) { delete profile; }
int ob_stream_profile_get_format(const ob_stream_profile* profile, ob_error**) {
  return profile->format;
}
std::uint32_t ob_video_stream_profile_get_width(const ob_stream_profile* profile, ob_error**) {
  return profile->width;
}
std::uint32_t ob_video_stream_profile_get_height(const ob_stream_profile* profile, ob_error**) {
  return profile->height;
}
std::uint32_t ob_video_stream_profile_get_fps(const ob_stream_profile* profile, ob_error**) {
  return profile->fps;
}
ob_camera_intrinsic ob_video_stream_profile_get_intrinsic(const ob_stream_profile* profile,
                                                          ob_error**) {
  const fake::Camera& c = camera_of(profile->sensor);
  return {c.fx,
          c.fy,
          c.cx,
          c.cy,
          static_cast<std::int16_t>(c.width),
          static_cast<std::int16_t>(c.height)};
}
ob_camera_distortion ob_video_stream_profile_get_distortion(const ob_stream_profile* profile,
                                                            ob_error**) {
  const float* c = camera_of(profile->sensor).coefficients;
  return {c[0], c[1], c[4], 0, 0, 0, c[2], c[3], 4};
}
ob_extrinsic ob_stream_profile_get_extrinsic_to(const ob_stream_profile* from, ob_stream_profile*,
                                                ob_error**) {
  ob_extrinsic out{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
  if (from->sensor != kDepth) return out;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) out.rot[3 * i + j] = fake::scene().rotation[3 * j + i];
    out.trans[i] = 1000 * fake::scene().translation_m[i];
  }
  return out;
}

ob_config* ob_create_config(ob_error**) { return new ob_config; }
void ob_delete_config(ob_config* config, ob_error**) { delete config; }
void ob_config_enable_stream_with_stream_profile(ob_config* config,
                                                 const ob_stream_profile* profile, ob_error**) {
  config->sensors.push_back(profile->sensor);
}
void ob_config_set_frame_aggregate_output_mode(ob_config* config, int mode, ob_error**) {
  config->aggregate = mode;
}
void ob_pipeline_start_with_callback(ob_pipeline* pipeline, const ob_config* config,
                                     callback on_frames, void* user, ob_error** error) {
  if (config->aggregate != 2) return set_error(error, "frames would wait for each other");
  if (config->sensors.front() == kColor) {
    pipeline->on_frames = on_frames;
    pipeline->user = user;
    pipeline->player.emplace(*pipeline, fake::with_imu());
    return;
  }
  const std::lock_guard lock(motion_mutex);
  pipeline->motion_only = true;
  on_motion = on_frames;
  motion_user = user;
}
void ob_pipeline_stop(ob_pipeline* pipeline, ob_error**) { pipeline->end(); }

std::uint32_t ob_frameset_get_count(const ob_frame* set, ob_error**) {
  return static_cast<std::uint32_t>(set->parts.size());
}
ob_frame* ob_frameset_get_frame_by_index(const ob_frame* set, std::uint32_t index, ob_error**) {
  ob_frame* part = set->parts.at(index);
  ++part->references;
  return handed(part);
}
void ob_delete_frame(const ob_frame* given, ob_error**) {
  auto* frame = const_cast<ob_frame*>(given);
  --handed_out;
  if (--frame->references > 0) return;
  for (ob_frame* part : frame->parts) {
    if (--part->references == 0) delete part;
  }
  delete frame;
}
int ob_frame_get_type(const ob_frame* frame, ob_error**) { return frame->type; }
std::uint64_t ob_frame_get_timestamp_us(const ob_frame* frame, ob_error**) {
  return static_cast<std::uint64_t>(frame->stamp_ms * 1000);
}
std::uint8_t* ob_frame_get_data(const ob_frame* frame, ob_error**) {
  return reinterpret_cast<std::uint8_t*>(const_cast<char*>(frame->bytes.data()));
}
std::uint32_t ob_frame_get_data_size(const ob_frame* frame, ob_error**) {
  return static_cast<std::uint32_t>(frame->bytes.size());
}
bool ob_frame_has_metadata(const ob_frame*, int type, ob_error**) { return type <= 5; }
std::int64_t ob_frame_get_metadata_value(const ob_frame* frame, int type, ob_error**) {
  constexpr long kColorUnit_us = 100;
  if (type == 5) return fake::kGain;
  return frame->type == kFrameColor ? fake::kExposure_us / kColorUnit_us : fake::kExposure_us;
}
std::uint32_t ob_video_frame_get_width(const ob_frame* frame, ob_error**) {
  return static_cast<std::uint32_t>(camera_of(frame->type).width);
}
std::uint32_t ob_video_frame_get_height(const ob_frame* frame, ob_error**) {
  return static_cast<std::uint32_t>(camera_of(frame->type).height);
}
float ob_depth_frame_get_value_scale(const ob_frame*, ob_error**) {
  return 1000 * fake::scene().unit_m;
}
ob_xyz ob_accel_frame_get_value(const ob_frame* frame, ob_error**) { return frame->value; }
ob_xyz ob_gyro_frame_get_value(const ob_frame* frame, ob_error**) { return frame->value; }

}  // extern "C"
