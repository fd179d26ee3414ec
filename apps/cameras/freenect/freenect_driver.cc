// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "freenect_driver.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <thread>
#include <utility>

#include "common/calibration.h"
#include "common/family_driver.h"
#include "freenect_library.h"
#include "tick_clock.h"

namespace sgs::cameras {
namespace {

using namespace freenect;
using capture::CameraImage;
using capture::CameraMode;
using capture::CameraSink;

class Kinect final : public FamilyDriver {
 public:
  ~Kinect() override { Kinect::stop(); }

  Result<stream::Hello> start(const CameraMode& mode, CameraSink& sink) override {
    sink_ = &sink;
    SGS_RETURN_IF_ERROR(check_mode(mode));
    SGS_RETURN_IF_ERROR(open());
    SGS_ASSIGN_OR_RETURN(const std::size_t index, index_of_camera(serials(), mode.serial, words()));
    serial_ = serials().at(index);
    const Status started = run();
    if (started) return greeting();
    stop();
    return tl::unexpected<Error>(started.error());
  }

  bool present() override { return !lost_ && std::ranges::count(serials(), serial_) > 0; }

  Status lock_exposure() override {
    if (lib_->freenect_set_flag(device_, kAutoExposure, kOff) < 0) {
      return tl::unexpected<Error>(last_failure("the exposure of this camera cannot be locked"));
    }
    lib_->freenect_set_flag(device_, kAutoWhiteBalance, kOff);
    return {};
  }

  void stop() override {
    stopped_ = true;
    if (events_.joinable()) events_.join();
    if (device_ != nullptr) {
      lib_->freenect_stop_depth(device_);
      lib_->freenect_stop_video(device_);
      lib_->freenect_close_device(std::exchange(device_, nullptr));
    }
    if (context_ != nullptr) lib_->freenect_shutdown(std::exchange(context_, nullptr));
  }

 private:
  /// There is one in which depth can be registered.
  static Status check_mode(const CameraMode& mode) {
    constexpr SensorMode kOnly[] = {{640, 480, 30}};
    if (nearest_mode(kOnly, mode, true)) return {};
    return tl::unexpected<Error>(
        explained(fmt::format("no such mode: {}x{} at {} Hz; there is 640x480 at 30 Hz", mode.width,
                              mode.height, mode.fps),
                  words()));
  }

  Status open() {
    SGS_ASSIGN_OR_RETURN(lib_, open_library());
    if (lib_->freenect_init(&context_, nullptr) < 0) {
      return tl::unexpected<Error>(last_failure("libfreenect does not start"));
    }
    lib_->freenect_set_log_level(context_, kLogError);
    lib_->freenect_set_log_callback(context_,
                                    [](Context*, int, const char* line) { log().add(line); });
    lib_->freenect_select_subdevices(context_, kSubdeviceCamera);
    return {};
  }

  std::vector<std::string> serials() const {
    std::vector<std::string> found;
    Attributes* first = nullptr;
    if (lib_->freenect_list_device_attributes(context_, &first) <= 0) return found;
    for (const Attributes* one = first; one != nullptr; one = one->next) {
      found.emplace_back(one->camera_serial == nullptr ? "" : one->camera_serial);
    }
    lib_->freenect_free_device_attributes(first);
    return found;
  }

  Status list_into(stream::CameraFamily& family) override {
    SGS_RETURN_IF_ERROR(open());
    family.library = lib_->path;
    for (const std::string& serial : serials()) {
      family.devices.push_back({"Kinect", serial, "", "USB 2"});
    }
    if (family.devices.empty()) return tl::unexpected<Error>(nothing_found(words()));
    return {};
  }

  Status run() {
    if (lib_->freenect_open_device_by_camera_serial(context_, &device_, serial_.c_str()) < 0) {
      device_ = nullptr;
      return tl::unexpected<Error>(last_failure("the camera cannot be opened"));
    }
    video_ = lib_->freenect_find_video_mode(kResolutionMedium, kVideoRgb);
    depth_ = lib_->freenect_find_depth_mode(kResolutionMedium, kDepthRegistered);
    lib_->freenect_set_video_callback(device_, on_video);
    lib_->freenect_set_depth_callback(device_, on_depth);
    const bool runs = video_.is_valid != 0 && depth_.is_valid != 0 &&
                      lib_->freenect_set_video_mode(device_, video_) >= 0 &&
                      lib_->freenect_set_depth_mode(device_, depth_) >= 0 &&
                      lib_->freenect_start_video(device_) >= 0 &&
                      lib_->freenect_start_depth(device_) >= 0;
    if (!runs) return tl::unexpected<Error>(last_failure("the camera does not start"));
    for (const int mirror : {kMirrorDepth, kMirrorVideo}) {
      lib_->freenect_set_flag(device_, mirror, kOff);
    }
    events_ = std::thread([this] { process_events(); });
    return {};
  }

  /// The factory's calibration is a table of shifts, which the library applies; it says no focal
  /// length of the colour camera.
  stream::Hello greeting() {
    constexpr double kFocal = 525.0 / 640;
    stream::Hello hello;
    hello.name = "freenect-" + serial_;
    hello.depth = stream::StreamDepth::kU16;
    hello.depth_scale = 1000;
    const double f = kFocal * video_.width;
    hello.color_camera.camera = {
        video_.width, video_.height, f, f, (video_.width - 1) / 2.0, (video_.height - 1) / 2.0};
    notes_.push_back(
        fmt::format("the camera does not say its focal length: {:.1f} pixels, as of most of its "
                    "kind, are assumed",
                    f));
    return hello;
  }

  void process_events() {
    served = this;
    constexpr suseconds_t kPatience_us = 100000;
    while (!stopped_) {
      timeval patience = {0, kPatience_us};
      if (lib_->freenect_process_events_timeout(context_, &patience) < 0) {
        lost_ = true;
        return;
      }
    }
  }

  // Called within process_events.
  static void on_video(Device*, void* data, std::uint32_t ticks) { take(data, ticks, true); }
  static void on_depth(Device*, void* data, std::uint32_t ticks) { take(data, ticks, false); }
  static void take(const void* data, std::uint32_t ticks, bool color) noexcept {
    if (served == nullptr) return;
    try {
      served->take_image(data, ticks, color);
    } catch (...) {
      // Memory ran out: this image is lost, the next one may fit.
    }
  }

  void take_image(const void* data, std::uint32_t ticks, bool color) {
    const FrameMode& mode = color ? video_ : depth_;
    const int pixel_bytes = color ? 3 : 2;
    CameraImage image;
    image.kind = color ? CameraImage::Kind::kColor : CameraImage::Kind::kDepth;
    image.stamp_s = clock_.seconds(ticks);
    image.bytes = packed_rows(data, mode.width, mode.height, mode.width * pixel_bytes, pixel_bytes);
    if (!image.bytes.empty()) sink_->take(std::move(image));
  }

  static thread_local Kinect* served;

  std::shared_ptr<const Library> lib_;
  Context* context_ = nullptr;
  Device* device_ = nullptr;
  FrameMode video_{}, depth_{};
  TickClock clock_;
  std::string serial_;
  std::thread events_;
  std::atomic<bool> stopped_{false}, lost_{false};
};

thread_local Kinect* Kinect::served = nullptr;

}  // namespace

std::unique_ptr<capture::CameraDriver> make_freenect_driver() { return std::make_unique<Kinect>(); }

}  // namespace sgs::cameras
