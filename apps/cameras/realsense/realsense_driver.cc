// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "realsense_driver.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <utility>

#include "common/calibration.h"
#include "common/camera_words.h"
#include "common/family_driver.h"
#include "rs2_calibration.h"
#include "rs2_library.h"

namespace sgs::cameras {
namespace {

using namespace rs2;
using capture::CameraImage;
using capture::CameraMode;
using capture::CameraSink;

template <class T>
using Owned = std::unique_ptr<T, void (*)(T*)>;

using LibraryPointer = std::shared_ptr<const Library>;

/// A sensor as what it is, too: something with options.
const rs2_options* options_of(const rs2_sensor* sensor) {
  return reinterpret_cast<const rs2_options*>(sensor);
}

/// A word about a device; empty where it does not know it.
std::string info_of(const Library& lib, const rs2_device* device, Info info) {
  const auto supported = lib.call(lib.rs2_supports_device_info, device, static_cast<int>(info));
  if (!supported || *supported == 0) return {};
  const auto text = lib.call(lib.rs2_get_device_info, device, static_cast<int>(info));
  return text && *text != nullptr ? *text : "";
}

/// Options of a sensor by their names: their numbers differ between versions.
class SensorOptions {
 public:
  SensorOptions(const Library& lib, const rs2_sensor* sensor) : lib_(lib), sensor_(sensor) {
    auto listed = lib.call(lib.rs2_get_options_list, options_of(sensor));
    if (!listed || *listed == nullptr) return;
    const Owned<rs2_options_list> list(*listed, lib.rs2_delete_options_list);
    const int count = lib.call(lib.rs2_get_options_list_size, list.get()).value_or(0);
    for (int i = 0; i < count; ++i) {
      const auto number = lib.call(lib.rs2_get_option_from_list, list.get(), i);
      if (!number) continue;
      const auto name = lib.call(lib.rs2_get_option_name, options_of(sensor), *number);
      if (name && *name != nullptr) numbers_[*name] = *number;
    }
  }

  std::optional<float> get(const std::string& name) const {
    const auto found = numbers_.find(name);
    if (found == numbers_.end()) return std::nullopt;
    const auto value = lib_.call(lib_.rs2_get_option, options_of(sensor_), found->second);
    return value ? std::optional(*value) : std::nullopt;
  }
  /// Whether there is such an option and it could be set.
  bool set(const std::string& name, float value) const {
    const auto found = numbers_.find(name);
    return found != numbers_.end() &&
           lib_.call(lib_.rs2_set_option, options_of(sensor_), found->second, value).has_value();
  }

 private:
  const Library& lib_;
  const rs2_sensor* sensor_;
  std::map<std::string, int> numbers_;
};

class RealSense final : public FamilyDriver {
 public:
  ~RealSense() override { RealSense::stop(); }

  Result<stream::Hello> start(const CameraMode& mode, CameraSink& sink) override {
    sink_ = &sink;
    SGS_RETURN_IF_ERROR(open());
    SGS_RETURN_IF_ERROR(choose_device(mode));
    SGS_RETURN_IF_ERROR(check_connection(mode));
    SGS_RETURN_IF_ERROR(take_sensors());
    SGS_RETURN_IF_ERROR(start_pipeline(mode));
    auto hello = greeting();
    if (!hello) stop();
    return hello;
  }

  bool present() override {
    const auto devices = query();
    if (!devices) return false;
    for (const auto& device : *devices) {
      if (info_of(*lib_, device.get(), kSerial) == serial_) return true;
    }
    return false;
  }

  Status lock_exposure() override {
    bool locked = false;
    for (const auto& sensor : sensors_) {
      const SensorOptions options(*lib_, sensor.get());
      // What is in force now, before the automatic is off: some firmware falls back to a default.
      const auto exposure = options.get("Exposure");
      const auto balance = options.get("White Balance");
      if (options.set("Enable Auto Exposure", 0)) {
        locked = true;
        if (exposure) options.set("Exposure", *exposure);
      }
      if (options.set("Enable Auto White Balance", 0) && balance) {
        options.set("White Balance", *balance);
      }
    }
    if (locked) return {};
    return fail(ErrorCode::kUnsupported, "the exposure of this camera cannot be locked");
  }

  void stop() override {
    if (running_) std::ignore = lib_->call(lib_->rs2_pipeline_stop, pipeline_.get());
    running_ = false;
  }

 private:
  using Devices = std::vector<Owned<rs2_device>>;

  Status open() {
    SGS_ASSIGN_OR_RETURN(lib_, open_library());
    // The version of the library itself: it refuses a newer one, and was asked no older question.
    SGS_ASSIGN_OR_RETURN(rs2_context * context,
                         lib_->call(lib_->rs2_create_context, lib_->version));
    context_ = Owned<rs2_context>(context, lib_->rs2_delete_context);
    return {};
  }

  Result<Devices> query() const {
    SGS_ASSIGN_OR_RETURN(
        rs2_device_list * listed,
        lib_->call(lib_->rs2_query_devices, static_cast<const rs2_context*>(context_.get())));
    const Owned<rs2_device_list> list(listed, lib_->rs2_delete_device_list);
    SGS_ASSIGN_OR_RETURN(
        const int count,
        lib_->call(lib_->rs2_get_device_count, static_cast<const rs2_device_list*>(list.get())));
    Devices devices;
    for (int i = 0; i < count; ++i) {
      SGS_ASSIGN_OR_RETURN(
          rs2_device * device,
          lib_->call(lib_->rs2_create_device, static_cast<const rs2_device_list*>(list.get()), i));
      devices.emplace_back(device, lib_->rs2_delete_device);
    }
    return devices;
  }

  Status list_into(stream::CameraFamily& family) override {
    SGS_RETURN_IF_ERROR(open());
    family.library = fmt::format("{} {}", lib_->path, lib_->version_text());
    SGS_ASSIGN_OR_RETURN(const auto devices, query());
    for (const auto& device : devices) {
      const auto info = [&](Info which) { return info_of(*lib_, device.get(), which); };
      family.devices.push_back(
          {info(kName), info(kSerial), info(kFirmware), "USB " + info(kUsbType)});
    }
    if (devices.empty()) return tl::unexpected<Error>(nothing_found(words()));
    return {};
  }

  Status choose_device(const CameraMode& mode) {
    SGS_ASSIGN_OR_RETURN(auto devices, query());
    std::vector<std::string> serials;
    for (const auto& device : devices) serials.push_back(info_of(*lib_, device.get(), kSerial));
    SGS_ASSIGN_OR_RETURN(const std::size_t index, index_of_camera(serials, mode.serial, words()));
    serial_ = serials[index];
    device_ = std::move(devices[index]);
    return {};
  }

  /// How it is connected; and old firmware is worth a word.
  Status check_connection(const CameraMode& mode) {
    SGS_RETURN_IF_ERROR(check_usb(info_of(*lib_, device_.get(), kUsbType), mode, words(), notes_));
    const std::string firmware = info_of(*lib_, device_.get(), kFirmware);
    const std::string wanted = info_of(*lib_, device_.get(), kRecommendedFirmware);
    if (!wanted.empty() && firmware != wanted) {
      notes_.push_back(
          fmt::format("the camera has firmware {}; librealsense {} recommends {} "
                      "(rs-fw-update)",
                      firmware, lib_->version_text(), wanted));
    }
    return {};
  }

  Status take_sensors() {
    SGS_ASSIGN_OR_RETURN(
        rs2_sensor_list * listed,
        lib_->call(lib_->rs2_query_sensors, static_cast<const rs2_device*>(device_.get())));
    const Owned<rs2_sensor_list> list(listed, lib_->rs2_delete_sensor_list);
    const auto* sensors = static_cast<const rs2_sensor_list*>(list.get());
    SGS_ASSIGN_OR_RETURN(const int count, lib_->call(lib_->rs2_get_sensors_count, sensors));
    for (int i = 0; i < count; ++i) {
      SGS_ASSIGN_OR_RETURN(rs2_sensor * made, lib_->call(lib_->rs2_create_sensor, sensors, i));
      sensors_.emplace_back(made, lib_->rs2_delete_sensor);
      SGS_RETURN_IF_ERROR(look_at_sensor(made));
    }
    if (depth_scale_ > 0) return {};
    return fail(ErrorCode::kUnsupported, "this camera has no depth sensor",
                "a camera of the D400 family is needed");
  }

  Status look_at_sensor(rs2_sensor* sensor) {
    const auto* known = static_cast<const rs2_sensor*>(sensor);
    const auto name = lib_->call(lib_->rs2_get_sensor_info, known, static_cast<int>(kName));
    if (name && *name != nullptr && std::strstr(*name, "Motion") != nullptr) has_imu_ = true;
    const SensorOptions options(*lib_, sensor);
    // Stamps by the camera's own clock, which we follow; and a frame rate that holds in the dark.
    options.set("Global Time Enabled", 0);
    options.set("Auto Exposure Priority", 0);
    const auto depth =
        lib_->call(lib_->rs2_is_sensor_extendable_to, known, static_cast<int>(kDepthSensor));
    if (!depth || *depth == 0) return {};
    SGS_ASSIGN_OR_RETURN(const float unit_m, lib_->call(lib_->rs2_get_depth_scale, sensor));
    if (!(unit_m > 0)) return fail(ErrorCode::kUnsupported, "the camera does not say its unit");
    depth_scale_ = units_per_metre(static_cast<double>(unit_m));
    if (const auto laser = options.get("Emitter Enabled")) laser_ = *laser != 0;
    return {};
  }

  Status start_pipeline(const CameraMode& mode) {
    const Status started = try_to_start(mode, mode.imu && has_imu_);
    if (started || !(mode.imu && has_imu_) || started.error().code != ErrorCode::kInvalidArgument) {
      return started;
    }
    SGS_RETURN_IF_ERROR(try_to_start(mode, false));
    notes_.push_back("the camera does not deliver inertial samples beside this mode");
    return {};
  }

  Status try_to_start(const CameraMode& mode, bool imu) {
    SGS_ASSIGN_OR_RETURN(rs2_config * made, lib_->call(lib_->rs2_create_config));
    const Owned<rs2_config> config(made, lib_->rs2_delete_config);
    SGS_ASSIGN_OR_RETURN(rs2_pipeline * pipeline,
                         lib_->call(lib_->rs2_create_pipeline, context_.get()));
    pipeline_ = Owned<rs2_pipeline>(pipeline, lib_->rs2_delete_pipeline);
    SGS_RETURN_IF_ERROR(lib_->call(lib_->rs2_config_enable_device, config.get(), serial_.c_str()));
    const auto enable = [&](Stream stream, int width, int height, Format format, int fps) {
      return lib_->call(lib_->rs2_config_enable_stream, config.get(), static_cast<int>(stream), -1,
                        width, height, static_cast<int>(format), fps);
    };
    SGS_RETURN_IF_ERROR(enable(kStreamColor, mode.width, mode.height, kFormatRgb8, mode.fps));
    SGS_RETURN_IF_ERROR(enable(kStreamDepth, mode.width, mode.height, kFormatZ16, mode.fps));
    if (imu) {
      SGS_RETURN_IF_ERROR(enable(kStreamGyro, 0, 0, kFormatMotion, 0));
      SGS_RETURN_IF_ERROR(enable(kStreamAccel, 0, 0, kFormatMotion, 0));
    }
    SGS_ASSIGN_OR_RETURN(
        rs2_pipeline_profile * profile,
        lib_->call(lib_->rs2_pipeline_start_with_config_and_callback, pipeline_.get(), config.get(),
                   &RealSense::on_frame, static_cast<void*>(this)));
    profile_ = Owned<rs2_pipeline_profile>(profile, lib_->rs2_delete_pipeline_profile);
    running_ = true;
    imu_runs_ = imu;
    return {};
  }

  Result<stream::Hello> greeting() {
    SGS_ASSIGN_OR_RETURN(rs2_stream_profile_list * listed,
                         lib_->call(lib_->rs2_pipeline_profile_get_streams, profile_.get()));
    const Owned<rs2_stream_profile_list> list(listed, lib_->rs2_delete_stream_profiles_list);
    const auto* profiles = static_cast<const rs2_stream_profile_list*>(list.get());
    SGS_ASSIGN_OR_RETURN(const int count,
                         lib_->call(lib_->rs2_get_stream_profiles_count, profiles));
    std::map<int, const rs2_stream_profile*> of_stream;
    for (int i = 0; i < count; ++i) {
      SGS_ASSIGN_OR_RETURN(const rs2_stream_profile* profile,
                           lib_->call(lib_->rs2_get_stream_profile, profiles, i));
      SGS_ASSIGN_OR_RETURN(const int stream, stream_of(profile));
      of_stream.emplace(stream, profile);
    }
    const auto* color = of_stream[kStreamColor];
    const auto* depth = of_stream[kStreamDepth];
    if (color == nullptr || depth == nullptr) {
      return fail(ErrorCode::kUnsupported, "the camera delivers colour or depth alone",
                  "a camera with both is needed");
    }
    stream::Hello hello;
    hello.name = "realsense-" + serial_;
    hello.depth = stream::StreamDepth::kU16;
    hello.depth_scale = depth_scale_;
    hello.laser = laser_;
    SGS_ASSIGN_OR_RETURN(hello.color_camera, lens(color, "colour"));
    SGS_ASSIGN_OR_RETURN(hello.depth_camera, lens(depth, "depth"));
    SGS_ASSIGN_OR_RETURN(hello.T_color_depth, transform(depth, color));
    leave_out_equal_cameras(hello);
    const auto* accel = of_stream[kStreamAccel];
    if (imu_runs_ && accel != nullptr) {
      SGS_ASSIGN_OR_RETURN(hello.T_color_imu, transform(accel, color));
    }
    return hello;
  }

  Result<int> stream_of(const rs2_stream_profile* profile) const {
    int stream = 0, format = 0, index = 0, id = 0, rate = 0;
    SGS_RETURN_IF_ERROR(lib_->call(lib_->rs2_get_stream_profile_data, profile, &stream, &format,
                                   &index, &id, &rate));
    return stream;
  }

  Result<LensCamera> lens(const rs2_stream_profile* profile, const char* which) {
    rs2_intrinsics intrinsics{};
    SGS_RETURN_IF_ERROR(lib_->call(lib_->rs2_get_video_stream_intrinsics, profile, &intrinsics));
    return lens_of(intrinsics, which, notes_);
  }

  Result<SE3> transform(const rs2_stream_profile* from, const rs2_stream_profile* to) const {
    rs2_extrinsics extrinsics{};
    SGS_RETURN_IF_ERROR(lib_->call(lib_->rs2_get_extrinsics, from, to, &extrinsics));
    return transform_of(extrinsics);
  }

  /// Called by threads of the library: single frames, and sets of those that belong together.
  static void on_frame(rs2_frame* frame, void* self) noexcept {
    auto* camera = static_cast<RealSense*>(self);
    try {
      camera->take(frame);
    } catch (...) {
      // Memory ran out: this frame is lost, the next one may fit.
    }
    camera->lib_->rs2_release_frame(frame);
  }

  void take(rs2_frame* frame) {
    const auto* known = static_cast<const rs2_frame*>(frame);
    const auto set =
        lib_->call(lib_->rs2_is_frame_extendable_to, known, static_cast<int>(kCompositeFrame));
    if (!set || *set == 0) return take_single(known);
    const int count = lib_->call(lib_->rs2_embedded_frames_count, frame).value_or(0);
    for (int i = 0; i < count; ++i) {
      const auto part = lib_->call(lib_->rs2_extract_frame, frame, i);
      if (!part || *part == nullptr) continue;
      const Owned<rs2_frame> owned(*part, lib_->rs2_release_frame);
      take_single(owned.get());
    }
  }

  void take_single(const rs2_frame* frame) {
    const auto profile = lib_->call(lib_->rs2_get_frame_stream_profile, frame);
    const auto stream = profile ? stream_of(*profile) : Result<int>(0);
    const auto stamp_ms = lib_->call(lib_->rs2_get_frame_timestamp, frame);
    const auto domain = lib_->call(lib_->rs2_get_frame_timestamp_domain, frame);
    const auto data = lib_->call(lib_->rs2_get_frame_data, frame);
    if (!stream || !stamp_ms || !domain || !data || *data == nullptr) return;
    constexpr double kMs = 1000;
    const double stamp_s = *stamp_ms / kMs;
    if (*stream == kStreamGyro || *stream == kStreamAccel) {
      return take_motion(*stream, stamp_s, *domain, static_cast<const float*>(*data));
    }
    if (*stream != kStreamColor && *stream != kStreamDepth) return;
    CameraImage image;
    image.kind = *stream == kStreamColor ? CameraImage::Kind::kColor : CameraImage::Kind::kDepth;
    image.domain = *domain;
    image.stamp_s = stamp_s - readout_after_exposure_s(frame, *domain);
    if (const auto exposure_us = metadata(frame, kExposure)) {
      constexpr double kMicroseconds = 1e-6;
      image.exposure_s = kMicroseconds * static_cast<double>(*exposure_us);
    }
    if (const auto gain = metadata(frame, kGain)) image.gain = static_cast<double>(*gain);
    image.bytes = rows_of(frame, *data, image.kind);
    if (!image.bytes.empty()) sink_->take(std::move(image));
  }

  void take_motion(int stream, double stamp_s, int domain, const float* xyz) {
    stream::InertialSample sample;
    sample.timestamp_s = stamp_s;
    auto& half = stream == kStreamGyro ? sample.angular_velocity_rad_s : sample.acceleration_m_s2;
    for (std::size_t i = 0; i < half.size(); ++i) half[i] = static_cast<double>(xyz[i]);
    sink_->take(sample, domain);
  }

  /// Images are stamped when they are read out, and show what was there in the middle of their
  /// exposure.
  double readout_after_exposure_s(const rs2_frame* frame, int domain) const {
    constexpr int kHardwareClock = 0;
    constexpr double kMicroseconds = 1e-6, kMost_s = 0.1;
    if (domain != kHardwareClock) return 0;
    const auto readout = metadata(frame, kFrameTimestamp),
               middle = metadata(frame, kSensorTimestamp);
    if (!readout || !middle) return 0;
    const double after_s = kMicroseconds * static_cast<double>(*readout - *middle);
    return after_s > 0 && after_s < kMost_s ? after_s : 0;
  }

  std::optional<long long> metadata(const rs2_frame* frame, Metadata which) const {
    const auto has = lib_->call(lib_->rs2_supports_frame_metadata, frame, static_cast<int>(which));
    if (!has || *has == 0) return std::nullopt;
    const auto value = lib_->call(lib_->rs2_get_frame_metadata, frame, static_cast<int>(which));
    return value ? std::optional(*value) : std::nullopt;
  }

  std::string rows_of(const rs2_frame* frame, const void* data, CameraImage::Kind kind) const {
    const int width = lib_->call(lib_->rs2_get_frame_width, frame).value_or(0);
    const int height = lib_->call(lib_->rs2_get_frame_height, frame).value_or(0);
    const int stride = lib_->call(lib_->rs2_get_frame_stride_in_bytes, frame).value_or(0);
    return packed_rows(data, width, height, stride, kind == CameraImage::Kind::kColor ? 3 : 2);
  }

  LibraryPointer lib_;
  Owned<rs2_context> context_{nullptr, [](rs2_context*) {}};
  Owned<rs2_device> device_{nullptr, [](rs2_device*) {}};
  std::vector<Owned<rs2_sensor>> sensors_;
  Owned<rs2_pipeline> pipeline_{nullptr, [](rs2_pipeline*) {}};
  Owned<rs2_pipeline_profile> profile_{nullptr, [](rs2_pipeline_profile*) {}};
  std::string serial_;
  double depth_scale_ = 0;
  std::optional<bool> laser_;
  bool has_imu_ = false, imu_runs_ = false, running_ = false;
};

}  // namespace

std::unique_ptr<capture::CameraDriver> make_realsense_driver() {
  return std::make_unique<RealSense>();
}

}  // namespace sgs::cameras
