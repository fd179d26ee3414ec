// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A librealsense2 that is none: it plays a scene from a file as a camera would deliver it, with
// what goes wrong with cameras. Declared here once more, from the library's documentation, and not
// from what the program under test declares.
//
// Environment:
//   FAKE_RS2_SCENE     the file (camera_test.py writes it)
//   FAKE_RS2_STATE     a folder: how far the scene was played, options that were set
//   FAKE_RS2_VERSION   of the interface, 25600
//   FAKE_RS2_DEVICES   serial numbers with commas, "0123"; "none"
//   FAKE_RS2_FAIL      message of an error when the camera is started
//   FAKE_RS2_USB, FAKE_RS2_FIRMWARE
//   FAKE_RS2_RATE      frames a second, 0: as fast as they are taken
//   FAKE_RS2_WARM      dark frames before the scene, 15
//   FAKE_RS2_DEPTH_EVERY  depth with every so manieth colour image
//   FAKE_RS2_CLOCK     wrap, jump, back or drift
//   FAKE_RS2_SHIFT_US  from the middle of the exposure to the stamp
//   FAKE_RS2_IMU       rates of accelerometer and gyroscope, "200,400"
//   FAKE_RS2_UNPLUG, FAKE_RS2_CRASH, FAKE_RS2_STALL  after so many frames of the scene, once
//   FAKE_RS2_AWAY_S    seconds until an unplugged camera is plugged in again, 2
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#ifndef FAKE_RS2_OTHER
namespace {

namespace fs = std::filesystem;

std::string text_of(const char* name, const char* otherwise) {
  const char* given = std::getenv(name);
  return given == nullptr ? otherwise : given;
}
long number_of(const char* name, long otherwise) {
  const char* given = std::getenv(name);
  return given == nullptr ? otherwise : std::strtol(given, nullptr, 10);
}

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

struct Scene {
  rs2_intrinsics color{}, depth{};
  rs2_extrinsics color_from_depth{};
  float unit_m = 0;
  int frames = 0;
  std::vector<double> times_ms;
  std::vector<std::string> colors, depths;

  Scene() {
    std::ifstream file(text_of("FAKE_RS2_SCENE", ""), std::ios::binary);
    const auto camera = [&](rs2_intrinsics& c) {
      file >> c.width >> c.height >> c.fx >> c.fy >> c.ppx >> c.ppy >> c.model;
      for (float& value : c.coeffs) file >> value;
    };
    camera(color);
    camera(depth);
    for (float& value : color_from_depth.rotation) file >> value;
    for (float& value : color_from_depth.translation) file >> value;
    file >> unit_m >> frames;
    file.get();
    for (int i = 0; i < frames; ++i) {
      double time_ms = 0;
      file.read(reinterpret_cast<char*>(&time_ms), sizeof time_ms);
      times_ms.push_back(time_ms);
      colors.emplace_back(static_cast<std::size_t>(color.width * color.height * 3), '\0');
      file.read(colors.back().data(), static_cast<std::streamsize>(colors.back().size()));
      depths.emplace_back(static_cast<std::size_t>(depth.width * depth.height * 2), '\0');
      file.read(depths.back().data(), static_cast<std::streamsize>(depths.back().size()));
    }
  }
};

Scene& scene() {
  static Scene loaded;
  return loaded;
}

fs::path state(const char* name) {
  return fs::path(text_of("FAKE_RS2_STATE", "/nonexistent")) / name;
}

long kept(const char* name) {
  std::ifstream file(state(name));
  long number = 0;
  file >> number;
  return number;
}
void keep(const char* name, long number) { std::ofstream(state(name)) << number; }

double seconds() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

bool unplugged() {
  const auto away_s = static_cast<double>(number_of("FAKE_RS2_AWAY_S", 2));
  std::ifstream file(state("unplugged"));
  double since = 0;
  return (file >> since) && seconds() < since + away_s;
}

void set_error(rs2_error** error, const std::string& message) {
  if (error != nullptr) *error = new rs2_error{message};
}

double stamp_of(double time_ms, int frame) {
  const std::string clock = text_of("FAKE_RS2_CLOCK", "");
  const double first_ms = scene().times_ms.front(), half = scene().frames / 2;
  constexpr double kWrap_ms = 4294967.296, kHour_ms = 3.6e6, kDrift = 200e-6;
  if (clock == "wrap") {
    const double base_ms = kWrap_ms - scene().times_ms[static_cast<std::size_t>(half)];
    return std::fmod(time_ms + base_ms, kWrap_ms);
  }
  if (clock == "jump" && frame >= half) return time_ms + kHour_ms;
  if (clock == "back" && frame >= half) return time_ms - first_ms / 2;
  if (clock == "drift") return first_ms + (time_ms - first_ms) * (1 + kDrift);
  return time_ms;
}

rs2_frame* image(int stream, double stamp_ms, const std::string& bytes) {
  constexpr int kPadding = 16;  // rows of a real camera need not lie without gaps
  const auto& camera = stream == kColor ? scene().color : scene().depth;
  auto* frame = new rs2_frame;
  frame->profile = profile_of(stream);
  frame->stamp_ms = stamp_ms;
  frame->width = camera.width;
  frame->height = camera.height;
  const int row = camera.width * (stream == kColor ? 3 : 2);
  frame->stride = row + kPadding;
  for (int y = 0; y < camera.height; ++y) {
    frame->bytes += bytes.substr(static_cast<std::size_t>(y * row), static_cast<std::size_t>(row));
    frame->bytes.append(kPadding, '\x7f');
  }
  return frame;
}

rs2_frame* motion(int stream, double stamp_ms) {
  auto* frame = new rs2_frame;
  frame->profile = profile_of(stream);
  frame->stamp_ms = stamp_ms;
  const float felt[] = {0, -9.81f, 0}, turned[] = {0.01f, 0.02f, 0.03f};
  frame->bytes.assign(reinterpret_cast<const char*>(stream == kAccel ? felt : turned), sizeof felt);
  return frame;
}

}  // namespace

struct rs2_pipeline {
  callback on_frame = nullptr;
  void* user = nullptr;
  bool imu = false;
  std::atomic<bool> stopped{false};
  std::thread player;
};
struct rs2_pipeline_profile {
  bool imu;
};
struct rs2_stream_profile_list {
  std::vector<const rs2_stream_profile*> profiles;
};

namespace {

void send(rs2_pipeline& pipe, rs2_frame* frame) { pipe.on_frame(frame, pipe.user); }

void send_set(rs2_pipeline& pipe, double stamp_ms, const std::string& color,
              const std::string* depth) {
  auto* set = new rs2_frame;
  set->parts.push_back(image(kColor, stamp_ms, color));
  if (depth != nullptr) set->parts.push_back(image(kDepth, stamp_ms, *depth));
  send(pipe, set);
}

/// Samples between two times.
void send_motion(rs2_pipeline& pipe, double from_ms, double to_ms) {
  double accel_hz = 0, gyro_hz = 0;
  char comma = 0;
  std::istringstream(text_of("FAKE_RS2_IMU", "0,0")) >> accel_hz >> comma >> gyro_hz;
  for (const auto& [stream, hz] : {std::pair(kAccel, accel_hz), std::pair(kGyro, gyro_hz)}) {
    if (hz <= 0) continue;
    const double period_ms = 1000 / hz;
    for (double t = std::ceil(from_ms / period_ms) * period_ms; t < to_ms; t += period_ms) {
      send(pipe, motion(stream, t));
    }
  }
}

/// What happens once, after so many frames.
bool happens(const char* name, const char* done, int frame) {
  if (number_of(name, -1) != frame || kept(done) != 0) return false;
  keep(done, 1);
  return true;
}

void wait_for_next() {
  if (const long rate = number_of("FAKE_RS2_RATE", 0); rate > 0) {
    std::this_thread::sleep_for(std::chrono::duration<double>(1.0 / static_cast<double>(rate)));
  }
}

void play(rs2_pipeline& pipe) {
  const Scene& s = scene();
  const auto first = static_cast<int>(kept("next"));
  const double period_ms = s.frames > 1 ? s.times_ms[1] - s.times_ms[0] : 33;
  if (first >= s.frames) return;
  const long every = number_of("FAKE_RS2_DEPTH_EVERY", 1);
  const std::string dark(s.colors[0].size(), '\x05'), nothing(s.depths[0].size(), '\0');
  const long warm = number_of("FAKE_RS2_WARM", 15);
  for (long i = warm; i > 0 && !pipe.stopped; --i) {
    const double time_ms = s.times_ms[static_cast<std::size_t>(first)];
    send_set(pipe, stamp_of(time_ms - period_ms * static_cast<double>(i), first), dark, &nothing);
    wait_for_next();
  }
  for (int i = first; i < s.frames && !pipe.stopped; ++i) {
    const auto at = static_cast<std::size_t>(i);
    keep("next", i);
    if (happens("FAKE_RS2_CRASH", "crashed", i)) std::raise(SIGSEGV);
    if (happens("FAKE_RS2_STALL", "stalled", i)) return;
    if (happens("FAKE_RS2_UNPLUG", "pulled", i)) {
      std::ofstream(state("unplugged")) << std::fixed << seconds();
      return;
    }
    const double before_ms = i > 0 ? s.times_ms[at - 1] : s.times_ms[at] - period_ms;
    if (pipe.imu) send_motion(pipe, stamp_of(before_ms, i - 1), stamp_of(s.times_ms[at], i));
    send_set(pipe, stamp_of(s.times_ms[at], i), s.colors[at],
             i % every == 0 ? &s.depths[at] : nullptr);
    wait_for_next();
  }
  if (!pipe.stopped) keep("next", s.frames);
}

/// Options have numbers here that no version has.
constexpr int kFirstOption = 1000;
const char* const kOptions[] = {"Enable Auto Exposure",      "Exposure",
                                "Enable Auto White Balance", "White Balance",
                                "Emitter Enabled",           "Global Time Enabled",
                                "Auto Exposure Priority"};

bool with_imu() { return std::getenv("FAKE_RS2_IMU") != nullptr; }

}  // namespace

extern "C" {

int rs2_get_api_version(rs2_error**) {
  return static_cast<int>(number_of("FAKE_RS2_VERSION", 25600));
}
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
  auto list = std::make_unique<rs2_device_list>();
  std::istringstream serials(text_of("FAKE_RS2_DEVICES", "0123"));
  for (std::string serial; std::getline(serials, serial, ',');) {
    if (serial != "none" && !unplugged()) list->serials.push_back(serial);
  }
  return list.release();
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
  static const std::string usb = text_of("FAKE_RS2_USB", "3.2");
  static const std::string firmware = text_of("FAKE_RS2_FIRMWARE", "5.16.0.1");
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
  if (with_imu()) list->kinds.push_back(kAccel);
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
float rs2_get_depth_scale(rs2_sensor*, rs2_error**) { return scene().unit_m; }

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
  std::ofstream(state("options"), std::ios::app)
      << sensor->kind << ' ' << kOptions[option - kFirstOption] << ' ' << value << '\n';
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
void rs2_pipeline_stop(rs2_pipeline* pipe, rs2_error**) {
  pipe->stopped = true;
  if (pipe->player.joinable()) pipe->player.join();
}
void rs2_delete_pipeline(rs2_pipeline* pipe) {
  rs2_pipeline_stop(pipe, nullptr);
  delete pipe;
}
rs2_pipeline_profile* rs2_pipeline_start_with_config_and_callback(rs2_pipeline* pipe,
                                                                  rs2_config* config,
                                                                  callback on_frame, void* user,
                                                                  rs2_error** error) {
  const std::string failure = text_of("FAKE_RS2_FAIL", "");
  if (!failure.empty()) {
    set_error(error, failure);
    return nullptr;
  }
  for (const int stream : config->streams) pipe->imu |= stream == kAccel;
  pipe->on_frame = on_frame;
  pipe->user = user;
  pipe->player = std::thread([pipe] { play(*pipe); });
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
  *out = profile->stream == kColor ? scene().color : scene().depth;
}
void rs2_get_extrinsics(const rs2_stream_profile* from, const rs2_stream_profile*,
                        rs2_extrinsics* out, rs2_error**) {
  *out = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
  if (from->stream == kDepth) *out = scene().color_from_depth;
}

int rs2_is_frame_extendable_to(const rs2_frame* frame, int extension, rs2_error**) {
  return extension == 10 && !frame->parts.empty();
}
int rs2_embedded_frames_count(rs2_frame* frame, rs2_error**) {
  return static_cast<int>(frame->parts.size());
}
#ifndef FAKE_RS2_MISSING
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
  constexpr long long kExposure_us = 8000, kGain = 16;
  const auto stamp_us = static_cast<long long>(frame->stamp_ms * 1000);
  if (value == 1) return stamp_us;
  if (value == 2) return stamp_us - number_of("FAKE_RS2_SHIFT_US", 0);
  if (value == 3) return kExposure_us;
  if (value == 4) return kGain;
  set_error(error, "no such metadata");
  return 0;
}

}  // extern "C"
#endif
