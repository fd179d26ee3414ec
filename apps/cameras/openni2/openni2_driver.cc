// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "openni2_driver.h"

#include <fmt/format.h>
#include <pthread.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <exception>
#include <optional>
#include <span>
#include <utility>

#include "common/calibration.h"
#include "common/family_driver.h"
#include "openni2_library.h"

namespace sgs::cameras {
namespace {

using namespace openni2;
using capture::CameraImage;
using capture::CameraMode;
using capture::CameraSink;

/// Closes what its functions open.
using OpenDevice = std::unique_ptr<Device, int (*)(Device*)>;
using OpenStream = std::unique_ptr<Stream, void (*)(Stream*)>;

/// A camera as it is listed, and open.
struct Found {
  std::string uri, name, serial, firmware;
  OpenDevice device{nullptr, nullptr};
};

/// While it lives the library cannot end this thread. It does so by pthread_cancel() where a stream
/// is destroyed, which unwinds; in a function that must not throw that would end the program.
class NotCancelled {
 public:
  NotCancelled() { ::pthread_setcancelstate(PTHREAD_CANCEL_DISABLE, &before_); }
  ~NotCancelled() { ::pthread_setcancelstate(before_, nullptr); }
  NotCancelled(const NotCancelled&) = delete;
  NotCancelled& operator=(const NotCancelled&) = delete;

 private:
  int before_ = PTHREAD_CANCEL_ENABLE;
};

class OpenNi2 final : public FamilyDriver {
 public:
  ~OpenNi2() override { OpenNi2::stop(); }

  Result<stream::Hello> start(const CameraMode& mode, CameraSink& sink) override {
    sink_ = &sink;
    SGS_ASSIGN_OR_RETURN(lib_, open_library());
    SGS_RETURN_IF_ERROR(choose_device(mode));
    auto hello = run(mode);
    if (!hello) stop();
    return hello;
  }

  bool present() override {
    return std::ranges::any_of(listed(),
                               [this](const DeviceInfo& info) { return camera_.uri == info.uri; });
  }

  Status lock_exposure() override {
    const int off = 0;
    if (!set(color_, kAutoExposure, off)) {
      return fail(ErrorCode::kUnsupported, "the exposure of this camera cannot be locked");
    }
    set(color_, kAutoWhiteBalance, off);
    return {};
  }

  void stop() override {
    for (OpenStream* stream : {&color_, &depth_}) {
      if (*stream) lib_->oniStreamStop(stream->get());
      stream->reset();
    }
    camera_.device.reset();
  }

 private:
  std::vector<DeviceInfo> listed() const {
    DeviceInfo* first = nullptr;
    int count = 0;
    if (lib_->oniGetDeviceList(&first, &count) != kOk) return {};
    const std::vector<DeviceInfo> infos(first, first + count);
    lib_->oniReleaseDeviceList(first);
    return infos;
  }

  /// A property, if it is a text: some drivers answer with numbers.
  std::string text_of(Device* device, DeviceProperty property) const {
    std::array<char, 256> bytes{};
    int size = static_cast<int>(bytes.size()) - 1;
    if (lib_->oniDeviceGetProperty(device, property, bytes.data(), &size) != kOk) return {};
    const std::string text = bytes.data();
    const auto readable = [](unsigned char c) { return std::isprint(c) != 0; };
    return std::ranges::all_of(text, readable) ? text : "";
  }

  /// Those that can be opened: only then they say their serial number.
  Result<std::vector<Found>> open_all() const {
    std::vector<Found> found;
    std::optional<Error> problem;
    for (const DeviceInfo& info : listed()) {
      Device* device = nullptr;
      if (lib_->oniDeviceOpen(info.uri, &device) != kOk) {
        problem = lib_->failure("the camera cannot be opened");
        continue;
      }
      found.push_back({info.uri, fmt::format("{} {}", info.vendor, info.name),
                       text_of(device, kSerialNumber), text_of(device, kFirmware),
                       OpenDevice(device, lib_->oniDeviceClose)});
      if (found.back().serial.empty()) found.back().serial = word_of(info.uri);
    }
    if (!found.empty()) return found;
    return tl::unexpected<Error>(problem ? *problem : nothing_found(words()));
  }

  /// Where it is plugged in, for those without a number, in letters that an address may have.
  static std::string word_of(std::string uri) {
    std::ranges::replace_if(
        uri, [](unsigned char c) { return std::isalnum(c) == 0; }, '-');
    return uri;
  }

  Status list_into(stream::CameraFamily& family) override {
    SGS_ASSIGN_OR_RETURN(lib_, open_library());
    family.library = fmt::format("{} {}", lib_->path, lib_->version);
    SGS_ASSIGN_OR_RETURN(const auto cameras, open_all());
    for (const Found& camera : cameras) {
      family.devices.push_back({camera.name, camera.serial, camera.firmware, "USB"});
    }
    return {};
  }

  Status choose_device(const CameraMode& mode) {
    SGS_ASSIGN_OR_RETURN(auto cameras, open_all());
    std::vector<std::string> serials;
    for (const Found& camera : cameras) serials.push_back(camera.serial);
    SGS_ASSIGN_OR_RETURN(const std::size_t index, index_of_camera(serials, mode.serial, words()));
    camera_ = std::move(cameras[index]);
    return {};
  }

  template <class Value>
  bool set(const OpenStream& stream, StreamProperty property, const Value& value) const {
    return stream &&
           lib_->oniStreamSetProperty(stream.get(), property, &value, sizeof value) == kOk;
  }

  Result<stream::Hello> run(const CameraMode& wanted) {
    SGS_ASSIGN_OR_RETURN(color_, opened(kColor, wanted, wanted.given, color_mode_));
    SGS_ASSIGN_OR_RETURN(depth_, opened(kDepth, wanted, false, depth_mode_));
    const bool registered = register_depth();
    stream::Hello hello;
    hello.name = "openni2-" + camera_.serial;
    hello.depth = stream::StreamDepth::kU16;
    constexpr double kMillimetre = 1e-3, kTenth = 1e-4;
    hello.depth_scale = units_per_metre(depth_mode_.format == kDepthTenth ? kTenth : kMillimetre);
    SGS_ASSIGN_OR_RETURN(hello.color_camera, lens_of(color_, color_mode_));
    SGS_ASSIGN_OR_RETURN(hello.depth_camera, lens_of(depth_, depth_mode_));
    if (registered) {
      hello.depth_camera = hello.color_camera;
      if (depth_mode_.width != color_mode_.width) rescale(*hello.depth_camera);
    }
    leave_out_equal_cameras(hello);
    for (const OpenStream* stream : {&color_, &depth_}) {
      Callback* callback = nullptr;
      const bool runs = lib_->oniStreamRegisterNewFrameCallback(stream->get(), &OpenNi2::on_frame,
                                                                this, &callback) == kOk &&
                        lib_->oniStreamStart(stream->get()) == kOk;
      if (!runs) return tl::unexpected<Error>(lib_->failure("the camera does not start"));
    }
    return hello;
  }

  /// The interface says nothing of how the two cameras lie to each other: the device must bring
  /// depth into colour.
  bool register_depth() {
    const int mode = kDepthToColor;
    Device* device = camera_.device.get();
    if (lib_->oniDeviceIsImageRegistrationModeSupported(device, mode) != 0 &&
        lib_->oniDeviceSetProperty(device, kRegistration, &mode, sizeof mode) == kOk) {
      return true;
    }
    notes_.push_back(
        "the camera does not register depth to colour, and does not say where its cameras are: "
        "they are taken to be at one place");
    return false;
  }

  Result<OpenStream> opened(Sensor sensor, const CameraMode& wanted, bool exactly,
                            VideoMode& chosen) const {
    const char* name = sensor == kColor ? "colour" : "depth";
    const SensorInfo* info = lib_->oniDeviceGetSensorInfo(camera_.device.get(), sensor);
    if (info == nullptr) {
      return fail(ErrorCode::kUnsupported, fmt::format("this camera has no {} sensor", name),
                  "a camera with both colour and depth is needed");
    }
    std::vector<VideoMode> modes(info->mode, info->mode + info->modes);
    std::erase_if(modes, [&](const VideoMode& mode) {
      return sensor == kColor ? mode.format != kRgb
                              : mode.format != kDepthMillimetre && mode.format != kDepthTenth;
    });
    std::vector<SensorMode> sizes;
    for (const VideoMode& mode : modes) sizes.push_back({mode.width, mode.height, mode.fps});
    const auto nearest = nearest_mode(sizes, wanted, exactly);
    if (!nearest) {
      return tl::unexpected<Error>(explained(fmt::format("no such mode: {} of {}x{} at {} Hz", name,
                                                         wanted.width, wanted.height, wanted.fps),
                                             words()));
    }
    chosen = modes[*nearest];
    Stream* made = nullptr;
    if (lib_->oniDeviceCreateStream(camera_.device.get(), sensor, &made) != kOk) {
      return tl::unexpected<Error>(lib_->failure(fmt::format("no {} images", name)));
    }
    OpenStream stream(made, lib_->oniStreamDestroy);
    if (!set(stream, kVideoMode, chosen)) {
      return tl::unexpected<Error>(lib_->failure(fmt::format("no such mode of {}", name)));
    }
    const int off = 0;
    set(stream, kMirroring, off);
    return stream;
  }

  /// The fields of view are all that is said of a lens.
  Result<LensCamera> lens_of(const OpenStream& stream, const VideoMode& mode) const {
    std::array<float, 2> fov_rad{};
    int at = 0;
    for (const StreamProperty property : {kHorizontalFov, kVerticalFov}) {
      int size = sizeof(float);
      float& value = fov_rad[static_cast<std::size_t>(at++)];
      if (lib_->oniStreamGetProperty(stream.get(), property, &value, &size) != kOk ||
          !(value > 0)) {
        return tl::unexpected<Error>(lib_->failure("the camera does not say its field of view"));
      }
    }
    const auto focal = [](int pixels, float fov) {
      return pixels / 2.0 / std::tan(static_cast<double>(fov) / 2);
    };
    LensCamera lens;
    lens.camera = {mode.width,
                   mode.height,
                   focal(mode.width, fov_rad[0]),
                   focal(mode.height, fov_rad[1]),
                   (mode.width - 1) / 2.0,
                   (mode.height - 1) / 2.0};
    return lens;
  }

  /// The colour camera, in the size of the depth images.
  void rescale(LensCamera& lens) const {
    const double x = 1.0 * depth_mode_.width / color_mode_.width;
    const double y = 1.0 * depth_mode_.height / color_mode_.height;
    lens.camera = {depth_mode_.width,
                   depth_mode_.height,
                   x * lens.camera.fx,
                   y * lens.camera.fy,
                   (depth_mode_.width - 1) / 2.0,
                   (depth_mode_.height - 1) / 2.0};
  }

  /// Called by threads of the library, one for each stream. When a stream ends it may be called
  /// once more, for no frame; reading waits then until the library ends the thread (NotCancelled),
  /// so the way out is open for all but what is thrown here.
  static void on_frame(Stream* stream, void* self) {
    auto* camera = static_cast<OpenNi2*>(self);
    Frame* frame = nullptr;
    if (camera->lib_->oniStreamReadFrame(stream, &frame) != kOk || frame == nullptr) return;
    const NotCancelled until_taken;
    try {
      CameraImage image = image_of(*frame);
      // Before what may wait: the library has few frames.
      camera->lib_->oniFrameRelease(std::exchange(frame, nullptr));
      if (!image.bytes.empty()) camera->sink_->take(std::move(image));
    } catch (const std::exception&) {
      // Memory ran out: this image is lost, the next one may fit.
      if (frame != nullptr) camera->lib_->oniFrameRelease(frame);
    }
  }

  static CameraImage image_of(const Frame& frame) {
    constexpr double kMicrosecond = 1e-6;
    const bool color = frame.sensor == kColor;
    CameraImage image;
    image.kind = color ? CameraImage::Kind::kColor : CameraImage::Kind::kDepth;
    image.stamp_s = kMicrosecond * static_cast<double>(frame.timestamp_us);
    image.bytes = packed_rows(frame.data, frame.width, frame.height, frame.stride, color ? 3 : 2);
    return image;
  }

  std::shared_ptr<const Library> lib_;
  Found camera_;
  OpenStream color_{nullptr, nullptr}, depth_{nullptr, nullptr};
  VideoMode color_mode_{}, depth_mode_{};
};

}  // namespace

std::unique_ptr<capture::CameraDriver> make_openni2_driver() { return std::make_unique<OpenNi2>(); }

}  // namespace sgs::cameras
