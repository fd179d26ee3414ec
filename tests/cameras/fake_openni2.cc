// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A driver of OpenNI2 for a camera that is none: it plays a scene (scene_player.h). The library is
// the real one; it loads what lies in the folder OpenNI2/Drivers beside it. With FAKE_MISSING it is
// a library that lacks nearly everything.
#include <Driver/OniDriverAPI.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "scene_player.h"

#ifdef FAKE_MISSING
extern "C" {
OniStatus oniInitialize(int) { return ONI_STATUS_OK; }
OniVersion oniGetVersion() { return {static_cast<int>(fake::number_of("VERSION", 2)), 2, 0, 33}; }
}
#else
#define XN_NEW(type, argument) new type(argument)
#define XN_DELETE(object) delete object

namespace {

using namespace oni::driver;

/// The library's frame begins with this; its number of owners is the next thing in it. The library
/// keeps only the newest frame of a stream: who must not lose any looks whether it was taken.
struct Counted : OniFrame {
  int owners;
};

class Stream final : public StreamBase {
 public:
  explicit Stream(bool color) : color_(color) {}

  OniStatus start() override {
    running_ = true;
    return ONI_STATUS_OK;
  }
  /// Afterwards nothing is sent any more: the library takes the stream apart.
  void stop() override {
    running_ = false;
    const std::lock_guard lock(sending_);
  }
  bool running() const { return running_; }

  OniBool isPropertySupported(int) override { return TRUE; }
  OniStatus setProperty(int property, const void* data, int) override {
    int value = 0;
    std::memcpy(&value, data, sizeof value);
    fake::keep_option((color_ ? "color " : "depth ") + std::to_string(property) + ' ' +
                      std::to_string(value));
    return ONI_STATUS_OK;
  }
  OniStatus getProperty(int property, void* data, int* size) override {
    const fake::Camera& c = camera();
    const auto answer = [&](const auto& value) {
      std::memcpy(data, &value, sizeof value);
      *size = sizeof value;
      return ONI_STATUS_OK;
    };
    const auto fov = [](int pixels, float focal) {
      return 2 * std::atan(static_cast<float>(pixels) / 2 / focal);
    };
    if (property == ONI_STREAM_PROPERTY_HORIZONTAL_FOV) return answer(fov(c.width, c.fx));
    if (property == ONI_STREAM_PROPERTY_VERTICAL_FOV) return answer(fov(c.height, c.fy));
    if (property == ONI_STREAM_PROPERTY_VIDEO_MODE) return answer(mode());
    if (property == ONI_STREAM_PROPERTY_STRIDE) return answer(row_bytes() + fake::kPadding_bytes);
    return ONI_STATUS_NOT_SUPPORTED;
  }
  int getRequiredFrameSize() override {
    return (row_bytes() + fake::kPadding_bytes) * camera().height;
  }

  void send(double stamp_ms, const std::string& bytes, const fake::Player& player) {
    const std::lock_guard lock(sending_);
    if (!running_) return;
    OniFrame* frame = getServices().acquireFrame();
    const std::string wide = fake::with_gaps(bytes, row_bytes());
    std::memcpy(frame->data, wide.data(), wide.size());
    frame->dataSize = static_cast<int>(wide.size());
    frame->sensorType = color_ ? ONI_SENSOR_COLOR : ONI_SENSOR_DEPTH;
    frame->timestamp = static_cast<std::uint64_t>(stamp_ms * 1000);
    frame->frameIndex = ++index_;
    frame->width = camera().width;
    frame->height = camera().height;
    frame->videoMode = mode();
    frame->stride = row_bytes() + fake::kPadding_bytes;
    raiseNewFrame(frame);
    const std::atomic_ref<int> owners(static_cast<Counted*>(frame)->owners);
    while (owners > 1 && running_ && !player.stopped()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    getServices().releaseFrame(frame);
  }

  OniVideoMode mode() const {
    return {color_ ? ONI_PIXEL_FORMAT_RGB888 : ONI_PIXEL_FORMAT_DEPTH_1_MM, camera().width,
            camera().height, 30};
  }

 private:
  const fake::Camera& camera() const { return color_ ? fake::scene().color : fake::scene().depth; }
  int row_bytes() const { return camera().width * (color_ ? 3 : 2); }

  bool color_;
  std::atomic<bool> running_{false};
  std::mutex sending_;
  int index_ = 0;
};

OniDeviceInfo info_of(const std::string& serial) {
  OniDeviceInfo info{};
  std::strcpy(info.uri, ("fake/" + serial).c_str());
  std::strcpy(info.vendor, "Fake");
  std::strcpy(info.name, "OpenNI2");
  return info;
}

class Camera final : public DeviceBase, public fake::Listener {
 public:
  using Gone = void (*)(const std::string& serial, void* driver);
  Camera(std::string serial, Gone gone, void* driver)
      : serial_(std::move(serial)), gone_(gone), driver_(driver) {
    OniVideoMode large = color_.mode();
    large.resolutionX = 1280;
    large.resolutionY = 1024;
    color_modes_ = {large, color_.mode()};
    depth_modes_ = {depth_.mode()};
    sensors_ = {{ONI_SENSOR_COLOR, 2, color_modes_.data()},
                {ONI_SENSOR_DEPTH, 1, depth_modes_.data()}};
    player_.emplace(*this, false);
  }

  OniStatus getSensorInfoList(OniSensorInfo** sensors, int* count) override {
    *sensors = sensors_.data();
    *count = static_cast<int>(sensors_.size());
    return ONI_STATUS_OK;
  }
  StreamBase* createStream(OniSensorType sensor) override {
    return sensor == ONI_SENSOR_COLOR ? &color_ : &depth_;
  }
  void destroyStream(StreamBase*) override {}

  OniStatus getProperty(int property, void* data, int* size) override {
    const std::string text = property == ONI_DEVICE_PROPERTY_SERIAL_NUMBER ? serial_ : "1.2";
    std::strcpy(static_cast<char*>(data), text.c_str());
    *size = static_cast<int>(text.size()) + 1;
    return ONI_STATUS_OK;
  }
  OniStatus setProperty(int property, const void* data, int) override {
    int value = 0;
    std::memcpy(&value, data, sizeof value);
    fake::keep_option("device " + std::to_string(property) + ' ' + std::to_string(value));
    return ONI_STATUS_OK;
  }
  OniBool isPropertySupported(int) override { return TRUE; }
  OniBool isImageRegistrationModeSupported(OniImageRegistrationMode) override {
    return fake::text_of("REGISTERS") != "no";
  }

  void images(double stamp_ms, const std::string& color, const std::string* depth) override {
    color_.send(stamp_ms, color, *player_);
    if (depth != nullptr) depth_.send(stamp_ms, *depth, *player_);
  }
  void motion(bool, double, const float*) override {}
  bool ready() const override { return color_.running() && depth_.running(); }
  void unplugged() override { gone_(serial_, driver_); }

 private:
  std::string serial_;
  Gone gone_;
  void* driver_;
  Stream color_{true}, depth_{false};
  std::vector<OniVideoMode> color_modes_, depth_modes_;
  std::vector<OniSensorInfo> sensors_;
  std::optional<fake::Player> player_;
};

class Driver final : public DriverBase {
 public:
  explicit Driver(OniDriverServices* services) : DriverBase(services) {}

  OniStatus initialize(DeviceConnectedCallback connected, DeviceDisconnectedCallback disconnected,
                       DeviceStateChangedCallback changed, void* cookie) override {
    DriverBase::initialize(connected, disconnected, changed, cookie);
    for (const std::string& serial : fake::serials()) {
      const OniDeviceInfo info = info_of(serial);
      deviceConnected(&info);
    }
    return ONI_STATUS_OK;
  }
  DeviceBase* deviceOpen(const char* uri, const char*) override {
    if (!fake::failure().empty()) {
      getServices().errorLoggerAppend("%s", fake::failure().c_str());
      return nullptr;
    }
    const auto gone = [](const std::string& serial, void* self) {
      const OniDeviceInfo info = info_of(serial);
      static_cast<Driver*>(self)->deviceDisconnected(&info);
    };
    return new Camera(std::string(uri).substr(std::strlen("fake/")), gone, this);
  }
  void deviceClose(DeviceBase* device) override { delete static_cast<Camera*>(device); }
  void shutdown() override {}
};

}  // namespace

ONI_EXPORT_DRIVER(Driver)
#endif
