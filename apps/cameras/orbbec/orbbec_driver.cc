// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "orbbec_driver.h"

#include <fmt/format.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <utility>

#include "common/calibration.h"
#include "common/family_driver.h"
#include "ob_calibration.h"
#include "ob_library.h"

namespace sgs::cameras {
namespace {

using namespace ob;
using capture::CameraImage;
using capture::CameraMode;
using capture::CameraSink;

/// Something of the library's, which is deleted by one of its functions.
template <class T>
class Owned {
 public:
  using Delete = void (*)(T*, ob_error**);
  Owned() = default;
  Owned(T* object, Delete end) : object_(object), end_(end) {}
  Owned(Owned&& other) noexcept
      : object_(std::exchange(other.object_, nullptr)), end_(other.end_) {}
  Owned& operator=(Owned&& other) noexcept {
    std::swap(object_, other.object_);
    std::swap(end_, other.end_);
    return *this;
  }
  ~Owned() {
    ob_error* ignored = nullptr;
    if (object_ != nullptr) end_(object_, &ignored);
  }
  T* get() const { return object_; }
  const T* known() const { return object_; }
  explicit operator bool() const { return object_ != nullptr; }

 private:
  T* object_ = nullptr;
  Delete end_ = nullptr;
};

using Profile = Owned<const ob_stream_profile>;

std::string text_or_nothing(const Result<const char*>& text) {
  return text && *text != nullptr ? *text : "";
}

class Orbbec final : public FamilyDriver {
 public:
  ~Orbbec() override { Orbbec::stop(); }

  Result<stream::Hello> start(const CameraMode& mode, CameraSink& sink) override {
    sink_ = &sink;
    period_s_ = 1.0 / mode.fps;
    SGS_RETURN_IF_ERROR(open());
    SGS_RETURN_IF_ERROR(choose_device(mode));
    set_up();
    SGS_RETURN_IF_ERROR(choose_profiles(mode));
    auto hello = greeting();
    if (!hello) return hello;
    SGS_RETURN_IF_ERROR(run_images());
    if (accel_ || gyro_) run_motion(*hello);
    const Status unit = wait_for_unit(*hello);
    if (unit) return hello;
    stop();
    return tl::unexpected<Error>(unit.error());
  }

  bool present() override {
    const auto devices = query();
    if (!devices) return false;
    for (const Found& device : *devices) {
      if (device.serial == serial_) return true;
    }
    return false;
  }

  Status lock_exposure() override {
    const auto exposure = get_int(kColorExposure), balance = get_int(kColorWhiteBalance);
    const auto depth_exposure = get_int(kDepthExposure);
    if (!set_bool(kColorAutoExposure, false)) {
      return fail(ErrorCode::kUnsupported, "the exposure of this camera cannot be locked");
    }
    if (exposure) set_int(kColorExposure, *exposure);
    if (set_bool(kColorAutoWhiteBalance, false) && balance) set_int(kColorWhiteBalance, *balance);
    if (set_bool(kDepthAutoExposure, false) && depth_exposure) {
      set_int(kDepthExposure, *depth_exposure);
    }
    return {};
  }

  void stop() override {
    for (Owned<ob_pipeline>* pipeline : {&motion_, &images_}) {
      if (*pipeline) (void)lib_->call(lib_->ob_pipeline_stop, pipeline->get());
      *pipeline = {};
    }
  }

 private:
  struct Found {
    std::string name, serial, connection;
    std::uint32_t index = 0;
  };

  Status open() {
    SGS_ASSIGN_OR_RETURN(lib_, open_library());
    // It would leave a folder with its log wherever it is started.
    (void)lib_->call(lib_->ob_set_logger_to_file, kLogOff, "");
    (void)lib_->call(lib_->ob_set_logger_to_console, kLogError);
    SGS_ASSIGN_OR_RETURN(ob_context * context, lib_->call(lib_->ob_create_context));
    context_ = {context, lib_->ob_delete_context};
    return {};
  }

  Result<Owned<ob_device_list>> device_list() const {
    SGS_ASSIGN_OR_RETURN(ob_device_list * listed,
                         lib_->call(lib_->ob_query_device_list, context_.get()));
    return Owned<ob_device_list>(listed, lib_->ob_delete_device_list);
  }

  Result<std::vector<Found>> query() const {
    SGS_ASSIGN_OR_RETURN(const auto list, device_list());
    return found_in(list);
  }

  Result<std::vector<Found>> found_in(const Owned<ob_device_list>& list) const {
    SGS_ASSIGN_OR_RETURN(const std::uint32_t count,
                         lib_->call(lib_->ob_device_list_get_count, list.known()));
    std::vector<Found> found;
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto text = [&](auto function) {
        return text_or_nothing(lib_->call(function, list.known(), i));
      };
      found.push_back({text(lib_->ob_device_list_get_device_name),
                       text(lib_->ob_device_list_get_device_serial_number),
                       text(lib_->ob_device_list_get_device_connection_type), i});
    }
    return found;
  }

  Status list_into(stream::CameraFamily& family) override {
    SGS_RETURN_IF_ERROR(open());
    family.library = fmt::format("{} {}", lib_->path, lib_->version_text());
    SGS_ASSIGN_OR_RETURN(const auto devices, query());
    for (const Found& device : devices) {
      // Without the firmware: to know it the camera must be opened, and another may have it.
      family.devices.push_back({device.name, device.serial, "", device.connection});
    }
    if (devices.empty()) return tl::unexpected<Error>(nothing_found(words()));
    return {};
  }

  Status choose_device(const CameraMode& mode) {
    SGS_ASSIGN_OR_RETURN(const auto list, device_list());
    SGS_ASSIGN_OR_RETURN(const auto found, found_in(list));
    std::vector<std::string> serials;
    for (const Found& device : found) serials.push_back(device.serial);
    SGS_ASSIGN_OR_RETURN(const std::size_t index, index_of_camera(serials, mode.serial, words()));
    serial_ = serials[index];
    constexpr std::string_view kUsb = "USB";
    const std::string& connection = found[index].connection;
    if (connection.starts_with(kUsb)) {
      SGS_RETURN_IF_ERROR(check_usb(connection.substr(kUsb.size()), mode, words(), notes_));
    }
    SGS_ASSIGN_OR_RETURN(ob_device * device, lib_->call(lib_->ob_device_list_get_device,
                                                        list.known(), found[index].index));
    device_ = {device, lib_->ob_delete_device};
    return {};
  }

  bool can(Property property, Permission permission) const {
    return lib_
        ->call(lib_->ob_device_is_property_supported, device_.known(), static_cast<int>(property),
               static_cast<int>(permission))
        .value_or(false);
  }
  std::optional<std::int32_t> get_int(Property property) const {
    if (!can(property, kRead)) return std::nullopt;
    const auto value =
        lib_->call(lib_->ob_device_get_int_property, device_.get(), static_cast<int>(property));
    return value ? std::optional(*value) : std::nullopt;
  }
  bool set_int(Property property, std::int32_t value) const {
    return can(property, kWrite) && lib_->call(lib_->ob_device_set_int_property, device_.get(),
                                               static_cast<int>(property), value);
  }
  bool set_bool(Property property, bool value) const {
    return can(property, kWrite) && lib_->call(lib_->ob_device_set_bool_property, device_.get(),
                                               static_cast<int>(property), value);
  }

  /// A frame rate that holds in the dark, images that are no mirror images, and the projector.
  void set_up() {
    set_int(kColorExposurePriority, 0);
    set_bool(kColorMirror, false);
    set_bool(kDepthMirror, false);
    if (const auto laser = get_int(kLaserControl)) {
      laser_ = *laser != 0;
    } else if (can(kLaser, kRead)) {
      const auto on =
          lib_->call(lib_->ob_device_get_bool_property, device_.get(), static_cast<int>(kLaser));
      if (on) laser_ = *on;
    }
  }

  bool has_sensor(Sensor sensor) const {
    const auto listed = lib_->call(lib_->ob_device_get_sensor_list, device_.known());
    if (!listed) return false;
    const Owned<ob_sensor_list> list(*listed, lib_->ob_delete_sensor_list);
    const std::uint32_t count =
        lib_->call(lib_->ob_sensor_list_get_count, list.known()).value_or(0);
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto type = lib_->call(lib_->ob_sensor_list_get_sensor_type, list.known(), i);
      if (type && *type == sensor) return true;
    }
    return false;
  }

  Result<Owned<ob_pipeline>> pipeline() const {
    SGS_ASSIGN_OR_RETURN(ob_pipeline * made,
                         lib_->call(lib_->ob_create_pipeline_with_device, device_.known()));
    return Owned<ob_pipeline>(made, lib_->ob_delete_pipeline);
  }

  Result<std::vector<Profile>> profiles_of(Sensor sensor) const {
    SGS_ASSIGN_OR_RETURN(const auto asked, pipeline());
    SGS_ASSIGN_OR_RETURN(ob_stream_profile_list * listed,
                         lib_->call(lib_->ob_pipeline_get_stream_profile_list, asked.known(),
                                    static_cast<int>(sensor)));
    const Owned<ob_stream_profile_list> list(listed, lib_->ob_delete_stream_profile_list);
    SGS_ASSIGN_OR_RETURN(const std::uint32_t count,
                         lib_->call(lib_->ob_stream_profile_list_get_count, list.known()));
    std::vector<Profile> profiles;
    for (std::uint32_t i = 0; i < count; ++i) {
      SGS_ASSIGN_OR_RETURN(
          const ob_stream_profile* profile,
          lib_->call(lib_->ob_stream_profile_list_get_profile, list.known(), static_cast<int>(i)));
      profiles.emplace_back(profile, lib_->ob_delete_stream_profile);
    }
    return profiles;
  }

  Status choose_profiles(const CameraMode& mode) {
    for (const auto& [sensor, name] :
         {std::pair(kSensorColor, "colour"), {kSensorDepth, "depth"}}) {
      if (has_sensor(sensor)) continue;
      return fail(ErrorCode::kUnsupported, fmt::format("this camera has no {} sensor", name),
                  "a camera with both colour and depth is needed");
    }
    SGS_ASSIGN_OR_RETURN(color_, image_profile(kSensorColor, mode, mode.given));
    // Depth comes in sizes of its own: the nearest one will do.
    SGS_ASSIGN_OR_RETURN(depth_, image_profile(kSensorDepth, mode, false));
    if (!mode.imu) return {};
    for (const auto& [sensor, chosen] : {std::pair(kSensorAccel, &accel_), {kSensorGyro, &gyro_}}) {
      auto profiles = has_sensor(sensor) ? profiles_of(sensor) : std::vector<Profile>();
      if (profiles && !profiles->empty()) *chosen = std::move(profiles->front());
    }
    return {};
  }

  Result<Profile> image_profile(Sensor sensor, const CameraMode& wanted, bool exactly) const {
    SGS_ASSIGN_OR_RETURN(auto profiles, profiles_of(sensor));
    const auto number = [&](auto function, const Profile& profile) {
      const auto value = lib_->call(function, profile.get());
      return value ? static_cast<int>(*value) : -1;
    };
    std::erase_if(profiles, [&](const Profile& profile) {
      const int format = number(lib_->ob_stream_profile_get_format, profile);
      return sensor == kSensorColor ? format != kFormatRgb
                                    : format != kFormatY16 && format != kFormatZ16;
    });
    std::vector<SensorMode> modes;
    for (const Profile& profile : profiles) {
      modes.push_back({number(lib_->ob_video_stream_profile_get_width, profile),
                       number(lib_->ob_video_stream_profile_get_height, profile),
                       number(lib_->ob_video_stream_profile_get_fps, profile)});
    }
    if (const auto nearest = nearest_mode(modes, wanted, exactly)) {
      return std::move(profiles[*nearest]);
    }
    return tl::unexpected<Error>(explained(fmt::format("no such mode: {} of {}x{} at {} Hz",
                                                       sensor == kSensorColor ? "colour" : "depth",
                                                       wanted.width, wanted.height, wanted.fps),
                                           words()));
  }

  Result<stream::Hello> greeting() {
    stream::Hello hello;
    hello.name = "orbbec-" + serial_;
    hello.depth = stream::StreamDepth::kU16;
    hello.laser = laser_;
    SGS_ASSIGN_OR_RETURN(hello.color_camera, lens(color_, "colour"));
    SGS_ASSIGN_OR_RETURN(hello.depth_camera, lens(depth_, "depth"));
    SGS_ASSIGN_OR_RETURN(hello.T_color_depth, to_color(depth_));
    leave_out_equal_cameras(hello);
    return hello;
  }

  Result<LensCamera> lens(const Profile& profile, const char* which) {
    SGS_ASSIGN_OR_RETURN(const ob_camera_intrinsic intrinsic,
                         lib_->call(lib_->ob_video_stream_profile_get_intrinsic, profile.get()));
    SGS_ASSIGN_OR_RETURN(const ob_camera_distortion distortion,
                         lib_->call(lib_->ob_video_stream_profile_get_distortion, profile.get()));
    return lens_of(intrinsic, distortion, which, notes_);
  }

  Result<SE3> to_color(const Profile& from) const {
    // The library does not change the target, and asks for one that it could.
    auto* target = const_cast<ob_stream_profile*>(color_.get());
    SGS_ASSIGN_OR_RETURN(const ob_extrinsic extrinsic,
                         lib_->call(lib_->ob_stream_profile_get_extrinsic_to, from.get(), target));
    return transform_of(extrinsic);
  }

  Result<Owned<ob_pipeline>> started(std::initializer_list<const Profile*> profiles) {
    SGS_ASSIGN_OR_RETURN(ob_config * made, lib_->call(lib_->ob_create_config));
    const Owned<ob_config> config(made, lib_->ob_delete_config);
    for (const Profile* profile : profiles) {
      if (!*profile) continue;
      SGS_RETURN_IF_ERROR(lib_->call(lib_->ob_config_enable_stream_with_stream_profile,
                                     config.get(), profile->get()));
    }
    SGS_RETURN_IF_ERROR(
        lib_->call(lib_->ob_config_set_frame_aggregate_output_mode, config.get(), kAnySituation));
    SGS_ASSIGN_OR_RETURN(auto runs, pipeline());
    SGS_RETURN_IF_ERROR(lib_->call(lib_->ob_pipeline_start_with_callback, runs.get(),
                                   config.known(), &Orbbec::on_frames, static_cast<void*>(this)));
    return runs;
  }

  Status run_images() {
    SGS_ASSIGN_OR_RETURN(images_, started({&color_, &depth_}));
    return {};
  }

  /// In a pipeline of its own: samples come far more often than images.
  void run_motion(stream::Hello& hello) {
    const auto T_color_imu = to_color(accel_ ? accel_ : gyro_);
    auto runs = started({&accel_, &gyro_});
    if (!runs) {
      notes_.push_back("the camera does not deliver inertial samples beside this mode");
      return;
    }
    motion_ = std::move(*runs);
    if (T_color_imu) hello.T_color_imu = *T_color_imu;
  }

  /// The unit stands in each depth image, and nowhere else.
  Status wait_for_unit(stream::Hello& hello) {
    constexpr std::chrono::seconds kMost(6);
    std::unique_lock lock(mutex_);
    if (!unit_came_.wait_for(lock, kMost, [this] { return unit_mm_ > 0; })) {
      return fail(ErrorCode::kIo, "the camera has started and gives no depth image",
                  "unplug it and plug it in again; a cable or port of USB 3 that is loose does "
                  "this");
    }
    constexpr double kMillimetre = 1e-3;
    hello.depth_scale = units_per_metre(kMillimetre * static_cast<double>(unit_mm_));
    return {};
  }

  /// Called by threads of the library, with sets of frames.
  static void on_frames(ob_frame* set, void* self) noexcept {
    auto* camera = static_cast<Orbbec*>(self);
    const Owned<const ob_frame> owned(set, camera->lib_->ob_delete_frame);
    try {
      camera->take_set(set);
    } catch (...) {
      // Memory ran out: this frame is lost, the next one may fit.
    }
  }

  void take_set(const ob_frame* set) {
    const std::uint32_t count = lib_->call(lib_->ob_frameset_get_count, set).value_or(0);
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto frame = lib_->call(lib_->ob_frameset_get_frame_by_index, set, i);
      if (!frame || *frame == nullptr) continue;
      const Owned<const ob_frame> owned(*frame, lib_->ob_delete_frame);
      take(owned.get());
    }
  }

  void take(const ob_frame* frame) {
    const auto type = lib_->call(lib_->ob_frame_get_type, frame);
    const auto stamp_us = lib_->call(lib_->ob_frame_get_timestamp_us, frame);
    if (!type || !stamp_us) return;
    const double stamp_s = kMicrosecond * static_cast<double>(*stamp_us);
    if (*type == kFrameAccel || *type == kFrameGyro) return take_motion(frame, *type, stamp_s);
    if (*type == kFrameColor || *type == kFrameDepth) take_image(frame, *type, stamp_s);
  }

  void take_motion(const ob_frame* frame, int type, double stamp_s) {
    const bool gyro = type == kFrameGyro;
    const auto value =
        lib_->call(gyro ? lib_->ob_gyro_frame_get_value : lib_->ob_accel_frame_get_value, frame);
    if (!value) return;
    stream::InertialSample sample;
    sample.timestamp_s = stamp_s;
    auto& half = gyro ? sample.angular_velocity_rad_s : sample.acceleration_m_s2;
    half = {static_cast<double>(value->x), static_cast<double>(value->y),
            static_cast<double>(value->z)};
    sink_->take(sample, 0);
  }

  /// Stamps are those of the middle of the exposure.
  void take_image(const ob_frame* frame, int type, double stamp_s) {
    const bool color = type == kFrameColor;
    CameraImage image;
    image.kind = color ? CameraImage::Kind::kColor : CameraImage::Kind::kDepth;
    image.stamp_s = stamp_s;
    image.exposure_s = exposure_s(frame, color);
    if (const auto gain = metadata(frame, kGain)) image.gain = static_cast<double>(*gain);
    image.bytes = pixels(frame, color ? 3 : 2);
    if (image.bytes.empty()) return;
    if (!color) note_unit(frame);
    sink_->take(std::move(image));
  }

  /// Of colour it is in units of 100 us, but not for every camera: longer than a period is none.
  std::optional<double> exposure_s(const ob_frame* frame, bool color) const {
    constexpr double kColorUnit_s = 1e-4;
    const auto value = metadata(frame, kExposure);
    if (!value || *value <= 0) return std::nullopt;
    const double seconds = static_cast<double>(*value) * (color ? kColorUnit_s : kMicrosecond);
    return seconds <= period_s_ ? std::optional(seconds) : std::nullopt;
  }

  std::optional<std::int64_t> metadata(const ob_frame* frame, Metadata which) const {
    const int number = which;
    if (!lib_->call(lib_->ob_frame_has_metadata, frame, number).value_or(false))
      return std::nullopt;
    const auto value = lib_->call(lib_->ob_frame_get_metadata_value, frame, number);
    return value ? std::optional(*value) : std::nullopt;
  }

  std::string pixels(const ob_frame* frame, int pixel_bytes) const {
    const auto width = lib_->call(lib_->ob_video_frame_get_width, frame).value_or(0);
    const auto height = lib_->call(lib_->ob_video_frame_get_height, frame).value_or(0);
    const auto size = lib_->call(lib_->ob_frame_get_data_size, frame).value_or(0);
    const auto data = lib_->call(lib_->ob_frame_get_data, frame);
    if (!data || height == 0 || size % height != 0) return {};
    return packed_rows(*data, static_cast<int>(width), static_cast<int>(height),
                       static_cast<int>(size / height), pixel_bytes);
  }

  void note_unit(const ob_frame* frame) {
    const auto unit = lib_->call(lib_->ob_depth_frame_get_value_scale, frame);
    if (!unit || !(*unit > 0)) return;
    const std::lock_guard lock(mutex_);
    unit_mm_ = *unit;
    unit_came_.notify_all();
  }

  static constexpr double kMicrosecond = 1e-6;

  std::shared_ptr<const Library> lib_;
  Owned<ob_context> context_;
  Owned<ob_device> device_;
  Profile color_, depth_, accel_, gyro_;
  Owned<ob_pipeline> images_, motion_;
  std::string serial_;
  double period_s_ = 0;
  std::optional<bool> laser_;
  std::mutex mutex_;
  std::condition_variable unit_came_;
  float unit_mm_ = 0;
};

}  // namespace

std::unique_ptr<capture::CameraDriver> make_orbbec_driver() { return std::make_unique<Orbbec>(); }

}  // namespace sgs::cameras
