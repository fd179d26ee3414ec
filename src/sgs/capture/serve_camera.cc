// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/capture/serve_camera.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "sgs/capture/device_clock.h"
#include "sgs/capture/inbox.h"

namespace sgs::capture {
namespace {

/// Stops a camera and lets its threads go, however serving it ends.
class Running {
 public:
  Running(CameraDriver& driver, Inbox& inbox) : driver_(driver), inbox_(inbox) {}
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;
  ~Running() {
    inbox_.close();
    driver_.stop();
  }

 private:
  CameraDriver& driver_;
  Inbox& inbox_;
};

class Server {
 public:
  Server(const ServeOptions& options, int descriptor, const std::function<void(std::string)>& say)
      : options_(options),
        descriptor_(descriptor),
        say_(say),
        pairs_(1.0 / options.mode.fps, kMostApart / options.mode.fps) {}

  /// False: nobody reads any more.
  bool write(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    return true;
  }

  /// Sends what has come; false: it is over.
  bool send(Inbox::Delivery delivery) {
    for (CameraImage& image : delivery.images) {
      last_image_s_ = image.host_s;
      image.stamp_s = clocks_.continuous(image.domain, image.stamp_s, image.host_s);
      pairs_.add(std::move(image));
    }
    tell_of_jumps();
    count_dropped(delivery.dropped);
    if (clocks_.reference() != nullptr && !send_samples(delivery.samples)) return false;
    while (auto pair = pairs_.next()) {
      if (skipped_ < options_.skip) {
        ++skipped_;
      } else if (!send_pair(std::move(*pair))) {
        return false;
      } else if (++sent_ == options_.frames) {
        return false;
      }
    }
    return true;
  }

  double last_image_s() const { return last_image_s_; }

  /// What the whole session was like.
  void sum_up() const {
    constexpr double kWorthTelling_ppm = 50;
    const double drift_ppm = clocks_.reference() == nullptr ? 0 : clocks_.reference()->drift_ppm();
    if (std::abs(drift_ppm) > kWorthTelling_ppm) {
      say_(fmt::format("the camera's clock runs {:.0f} ppm {} than this machine's",
                       std::abs(drift_ppm), drift_ppm > 0 ? "slower" : "faster"));
    }
    if (dropped_ > 0) {
      say_(fmt::format("{} images were dropped: they came faster than they were taken", dropped_));
    }
    if (pairs_.alone() > 0) {
      say_(fmt::format("{} depth images had no colour image near them", pairs_.alone()));
    }
  }

 private:
  // Of a period: nothing nearer can be missing.
  static constexpr double kMostApart = 0.6;

  bool send_pair(ImagePair pair) {
    stream::Packet packet;
    packet.timestamp_s = pair.color.stamp_s;
    packet.depth_delay_s = pair.depth.stamp_s - pair.color.stamp_s;
    packet.exposure_s = pair.color.exposure_s;
    packet.depth_exposure_s = pair.depth.exposure_s;
    packet.gain = pair.color.gain;
    packet.received_s = pair.color.system_s;
    packet.color = std::move(pair.color.bytes);
    packet.depth = std::move(pair.depth.bytes);
    const auto bytes = stream::encode_packet(packet);
    return bytes && write(*bytes);
  }

  bool send_samples(const std::vector<Inbox::Sample>& samples) {
    constexpr std::size_t kAtOnce = 512;
    std::vector<stream::InertialSample> part;
    for (const Inbox::Sample& came : samples) {
      part.push_back(came.sample);
      part.back().timestamp_s =
          clocks_.continuous(came.domain, came.sample.timestamp_s, came.host_s);
      if (part.size() < kAtOnce) continue;
      if (!write(stream::encode_imu(part))) return false;
      part.clear();
    }
    return part.empty() || write(stream::encode_imu(part));
  }

  void tell_of_jumps() {
    for (const double jump_s : clocks_.take_jumps_s()) {
      say_(fmt::format("the camera's clock jumped by {:+.3f} s; its times are moved to go on",
                       jump_s));
    }
  }

  void count_dropped(std::int64_t count) {
    if (count > 0 && dropped_ == 0)
      say_("images come faster than they are taken: some are dropped");
    dropped_ += count;
  }

  const ServeOptions& options_;
  int descriptor_;
  const std::function<void(std::string)>& say_;
  ImagePairs pairs_;
  DeviceClocks clocks_;
  double last_image_s_ = steady_now_s();
  int skipped_ = 0;
  std::int64_t sent_ = 0, dropped_ = 0;
};

/// Nothing has come for a while: is the camera still there?
Status check_silence(CameraDriver& driver, double silent_s, double& next_look_s) {
  constexpr double kPeriod_s = 1, kMost_s = 6;
  if (silent_s < next_look_s) return {};
  next_look_s = silent_s + kPeriod_s;
  if (!driver.present()) return tl::unexpected<Error>(driver.gone());
  if (silent_s < kMost_s) return {};
  return tl::unexpected<Error>(driver.silent(silent_s));
}

}  // namespace

Status serve_camera(CameraDriver& driver, const ServeOptions& options, int descriptor,
                    const ServeRequests& requests, const std::function<void(std::string)>& say) {
  constexpr std::chrono::milliseconds kLook(100);
  constexpr double kFirstLook_s = 1;
  Inbox inbox(options.mode.every_frame);
  SGS_ASSIGN_OR_RETURN(stream::Hello hello, driver.start(options.mode, inbox));
  const Running running(driver, inbox);
  for (std::string& note : driver.notes()) say(std::move(note));
  hello.version = 2;
  hello.device_clock = true;
  hello.listens = options.listens;
  Server server(options, descriptor, say);
  bool reads = server.write(stream::encode_hello(hello)), locked = false;
  double next_look_s = kFirstLook_s;
  while (reads && !requests.stop) {
    if (requests.lock_exposure && !std::exchange(locked, true)) {
      const Status done = driver.lock_exposure();
      say(done ? "exposure and white balance are locked" : done.error().text());
    }
    const double before_s = server.last_image_s();
    reads = server.send(inbox.collect(kLook));
    if (server.last_image_s() != before_s) next_look_s = kFirstLook_s;
    if (reads) {
      SGS_RETURN_IF_ERROR(
          check_silence(driver, steady_now_s() - server.last_image_s(), next_look_s));
    }
  }
  server.write(stream::kEndMark);
  server.sum_up();
  return {};
}

}  // namespace sgs::capture
