// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "k4a_driver.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <optional>
#include <thread>
#include <utility>

#include "common/calibration.h"
#include "common/family_driver.h"
#include "k4a_library.h"

namespace sgs::cameras {
namespace {

using namespace k4a;
using capture::CameraImage;
using capture::CameraMode;
using capture::CameraSink;

constexpr double kMillimetre = 1e-3, kMicrosecond = 1e-6;
constexpr std::int32_t kPatience_ms = 100;

/// Sizes of colour, by the library's numbers from 1 on; and rates, from 0 on.
constexpr std::pair<int, int> kSizes[] = {{1280, 720},  {1920, 1080}, {2560, 1440},
                                          {2048, 1536}, {3840, 2160}, {4096, 3072}};
constexpr int kRates[] = {5, 15, 30};
constexpr int kSlowWidth = 4096;  // not at 30 Hz

/// A mode in the library's numbers.
struct Numbers {
  int resolution = 0, rate = 0;
};

Result<Numbers> numbers_of(const CameraMode& wanted) {
  std::vector<SensorMode> modes;
  std::vector<Numbers> numbers;
  for (int rate = 0; rate < static_cast<int>(std::size(kRates)); ++rate) {
    for (int i = 0; i < static_cast<int>(std::size(kSizes)); ++i) {
      const auto [width, height] = kSizes[i];
      if (width == kSlowWidth && rate == 2) continue;
      modes.push_back({width, height, kRates[rate]});
      numbers.push_back({i + 1, rate});
    }
  }
  if (const auto found = nearest_mode(modes, wanted, wanted.given)) return numbers[*found];
  return tl::unexpected<Error>(explained(
      fmt::format("no such mode: {}x{} at {} Hz; there is 1280x720, 1920x1080, 2560x1440, "
                  "2048x1536, 3840x2160 and 4096x3072, at 5, 15 and 30 Hz",
                  wanted.width, wanted.height, wanted.fps),
      words()));
}

Result<LensCamera> lens_of(const k4a_calibration_camera_t& c, const char* which) {
  constexpr int kRational = 3, kBrown = 4;
  if (c.type != kRational && c.type != kBrown) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("the {} camera has a lens of the library's model {}", which, c.type),
                "please report it with the camera's name");
  }
  LensCamera lens;
  lens.camera = {c.resolution_width,        c.resolution_height,       static_cast<double>(c.fx),
                 static_cast<double>(c.fy), static_cast<double>(c.cx), static_cast<double>(c.cy)};
  const float factors[] = {c.k1, c.k2, c.p1, c.p2, c.k3, c.k4, c.k5, c.k6};
  const std::vector<double> values(std::begin(factors), std::end(factors));
  lens.distortion = Distortion::from_coefficients(values).value_or(Distortion{});
  return lens;
}

SE3 to_color(const k4a_calibration_t& calibration, Sensor from) {
  const auto& extrinsics = calibration.extrinsics[from][kColor];
  return transform_of(extrinsics.rotation, extrinsics.translation, Order::kRows, kMillimetre);
}

/// A camera that is open.
class Device {
 public:
  Device() = default;
  Device(std::shared_ptr<const Library> lib, k4a_device* device)
      : lib_(std::move(lib)), device_(device) {}
  Device(Device&& other) noexcept
      : lib_(std::move(other.lib_)), device_(std::exchange(other.device_, nullptr)) {}
  Device& operator=(Device&& other) noexcept {
    std::swap(lib_, other.lib_);
    std::swap(device_, other.device_);
    return *this;
  }
  ~Device() {
    if (device_ != nullptr) lib_->k4a_device_close(device_);
  }
  k4a_device* get() const { return device_; }

  std::string serial() const {
    std::string text(64, '\0');
    std::size_t size = text.size();
    if (lib_->k4a_device_get_serialnum(device_, text.data(), &size) != kSucceeded) return {};
    return text.c_str();
  }
  std::string firmware() const {
    k4a_hardware_version_t version{};
    if (lib_->k4a_device_get_version(device_, &version) != kSucceeded) return {};
    return fmt::format("{}.{}.{} (colour), {}.{}.{} (depth)", version.rgb.major, version.rgb.minor,
                       version.rgb.iteration, version.depth.major, version.depth.minor,
                       version.depth.iteration);
  }

 private:
  std::shared_ptr<const Library> lib_;
  k4a_device* device_ = nullptr;
};

class AzureKinect final : public FamilyDriver {
 public:
  ~AzureKinect() override { AzureKinect::stop(); }

  Result<stream::Hello> start(const CameraMode& mode, CameraSink& sink) override {
    sink_ = &sink;
    SGS_ASSIGN_OR_RETURN(lib_, open_library());
    SGS_ASSIGN_OR_RETURN(const Numbers numbers, numbers_of(mode));
    SGS_RETURN_IF_ERROR(choose_device(mode));
    k4a_calibration_t calibration{};
    if (lib_->k4a_device_get_calibration(device_.get(), kDepthNarrow, numbers.resolution,
                                         &calibration) != kSucceeded) {
      return tl::unexpected<Error>(last_failure("the camera does not say its calibration"));
    }
    SGS_ASSIGN_OR_RETURN(stream::Hello hello, greeting(calibration));
    SGS_RETURN_IF_ERROR(run(numbers));
    if (mode.imu) run_imu(calibration, hello);
    return hello;
  }

  bool present() override { return !lost_ && lib_->k4a_device_get_installed_count() > 0; }

  Status lock_exposure() override {
    bool locked = false;
    for (const Control control : {kExposureTime, kWhiteBalance}) {
      int mode = 0;
      std::int32_t value = 0;
      if (lib_->k4a_device_get_color_control(device_.get(), control, &mode, &value) != kSucceeded) {
        continue;
      }
      locked |=
          lib_->k4a_device_set_color_control(device_.get(), control, kManual, value) == kSucceeded;
    }
    if (locked) return {};
    return tl::unexpected<Error>(last_failure("the exposure of this camera cannot be locked"));
  }

  void stop() override {
    stopped_ = true;
    for (std::thread* thread : {&images_, &samples_}) {
      if (thread->joinable()) thread->join();
    }
    if (std::exchange(imu_runs_, false)) lib_->k4a_device_stop_imu(device_.get());
    if (std::exchange(cameras_run_, false)) lib_->k4a_device_stop_cameras(device_.get());
    device_ = {};
  }

 private:
  Result<Device> opened(std::uint32_t index) const {
    k4a_device* device = nullptr;
    if (lib_->k4a_device_open(index, &device) == kSucceeded) return Device(lib_, device);
    return tl::unexpected<Error>(last_failure("the camera cannot be opened"));
  }

  /// Those that can be opened: only then they say their serial number.
  Result<std::vector<Device>> open_all() const {
    const std::uint32_t count = lib_->k4a_device_get_installed_count();
    std::vector<Device> devices;
    std::optional<Error> problem;
    for (std::uint32_t i = 0; i < count; ++i) {
      auto device = opened(i);
      if (device) {
        devices.push_back(std::move(*device));
      } else {
        problem = device.error();
      }
    }
    if (!devices.empty()) return devices;
    return tl::unexpected<Error>(problem ? *problem : nothing_found(words()));
  }

  Status list_into(stream::CameraFamily& family) override {
    SGS_ASSIGN_OR_RETURN(lib_, open_library());
    family.library = lib_->path;
    SGS_ASSIGN_OR_RETURN(const auto devices, open_all());
    for (const Device& device : devices) {
      family.devices.push_back({"Azure Kinect", device.serial(), device.firmware(), "USB 3"});
    }
    return {};
  }

  Status choose_device(const CameraMode& mode) {
    SGS_ASSIGN_OR_RETURN(auto devices, open_all());
    std::vector<std::string> serials;
    for (const Device& device : devices) serials.push_back(device.serial());
    SGS_ASSIGN_OR_RETURN(const std::size_t index, index_of_camera(serials, mode.serial, words()));
    device_ = std::move(devices[index]);
    serial_ = serials[index];
    return {};
  }

  Result<stream::Hello> greeting(const k4a_calibration_t& calibration) const {
    stream::Hello hello;
    hello.name = "k4a-" + serial_;
    hello.depth = stream::StreamDepth::kU16;
    hello.depth_scale = 1 / kMillimetre;
    SGS_ASSIGN_OR_RETURN(hello.color_camera,
                         lens_of(calibration.color_camera_calibration, "colour"));
    SGS_ASSIGN_OR_RETURN(hello.depth_camera,
                         lens_of(calibration.depth_camera_calibration, "depth"));
    hello.T_color_depth = to_color(calibration, kDepth);
    leave_out_equal_cameras(hello);
    return hello;
  }

  Status run(const Numbers& numbers) {
    k4a_device_configuration_t configuration{};
    configuration.color_format = kFormatBgra;
    configuration.color_resolution = numbers.resolution;
    configuration.depth_mode = kDepthNarrow;
    configuration.camera_fps = numbers.rate;
    if (lib_->k4a_device_start_cameras(device_.get(), &configuration) != kSucceeded) {
      return tl::unexpected<Error>(last_failure("the camera does not start"));
    }
    cameras_run_ = true;
    images_ = std::thread([this] { take_images(); });
    return {};
  }

  void run_imu(const k4a_calibration_t& calibration, stream::Hello& hello) {
    if (lib_->k4a_device_start_imu(device_.get()) != kSucceeded) {
      notes_.push_back("the camera does not deliver inertial samples");
      return;
    }
    imu_runs_ = true;
    hello.T_color_imu = to_color(calibration, kAccel);
    R_accel_gyro_ = (hello.T_color_imu->inverse() * to_color(calibration, kGyro)).R;
    samples_ = std::thread([this] { take_samples(); });
  }

  void take_images() {
    while (!stopped_) {
      k4a_capture* capture = nullptr;
      const int got = lib_->k4a_device_get_capture(device_.get(), &capture, kPatience_ms);
      if (got == kFailed) {
        lost_ = true;
        return;
      }
      if (got != kSucceeded) continue;
      take(lib_->k4a_capture_get_color_image(capture), CameraImage::Kind::kColor);
      take(lib_->k4a_capture_get_depth_image(capture), CameraImage::Kind::kDepth);
      lib_->k4a_capture_release(capture);
    }
  }

  /// Takes an image and releases it; null: there was none. Stamps are those of the middle of the
  /// exposure.
  void take(k4a_image* image, CameraImage::Kind kind) {
    if (image == nullptr) return;
    try {
      const bool color = kind == CameraImage::Kind::kColor;
      CameraImage taken;
      taken.kind = kind;
      taken.stamp_s =
          kMicrosecond * static_cast<double>(lib_->k4a_image_get_device_timestamp_usec(image));
      if (const auto us = lib_->k4a_image_get_exposure_usec(image); us > 0) {
        taken.exposure_s = kMicrosecond * static_cast<double>(us);
      }
      if (color) taken.gain = static_cast<double>(lib_->k4a_image_get_iso_speed(image));
      taken.bytes =
          packed_rows(lib_->k4a_image_get_buffer(image), lib_->k4a_image_get_width_pixels(image),
                      lib_->k4a_image_get_height_pixels(image),
                      lib_->k4a_image_get_stride_bytes(image), color ? 4 : 2);
      if (color) taken.bytes = rgb_of_bgra(std::move(taken.bytes));
      if (!taken.bytes.empty()) sink_->take(std::move(taken));
    } catch (...) {
      // Memory ran out: this image is lost, the next one may fit.
    }
    lib_->k4a_image_release(image);
  }

  void take_samples() {
    while (!stopped_) {
      k4a_imu_sample_t came{};
      const int got = lib_->k4a_device_get_imu_sample(device_.get(), &came, kPatience_ms);
      if (got == kFailed) return;
      if (got != kSucceeded) continue;
      stream::InertialSample felt, turned;
      felt.timestamp_s = kMicrosecond * static_cast<double>(came.acc_timestamp_usec);
      turned.timestamp_s = kMicrosecond * static_cast<double>(came.gyro_timestamp_usec);
      const Eigen::Vector3d by_gyro =
          Eigen::Map<const Eigen::Vector3f>(came.gyro_sample).cast<double>();
      const Eigen::Vector3d rate = R_accel_gyro_ * by_gyro;
      for (std::size_t i = 0; i < 3; ++i) {
        felt.acceleration_m_s2[i] = static_cast<double>(came.acc_sample[i]);
        turned.angular_velocity_rad_s[i] = rate(static_cast<Eigen::Index>(i));
      }
      sink_->take(felt, 0);
      sink_->take(turned, 0);
    }
  }

  std::shared_ptr<const Library> lib_;
  Device device_;
  std::string serial_;
  Eigen::Matrix3d R_accel_gyro_ = Eigen::Matrix3d::Identity();
  std::thread images_, samples_;
  std::atomic<bool> stopped_{false}, lost_{false};
  bool cameras_run_ = false, imu_runs_ = false;
};

}  // namespace

std::unique_ptr<capture::CameraDriver> make_k4a_driver() { return std::make_unique<AzureKinect>(); }

}  // namespace sgs::cameras
