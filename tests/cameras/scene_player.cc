// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "scene_player.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <utility>

namespace fake {
namespace {

namespace fs = std::filesystem;

fs::path state(const std::string& name) {
  return fs::path(text_of("STATE", "/nonexistent")) / name;
}

double seconds() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

bool unplugged() {
  const auto away_s = static_cast<double>(number_of("AWAY_S", 2));
  std::ifstream file(state("unplugged"));
  double since = 0;
  return (file >> since) && seconds() < since + away_s;
}

double stamp_of(double time_ms, int frame) {
  const std::string clock = text_of("CLOCK");
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

/// What happens once, after so many frames.
bool happens(const char* name, const char* done, int frame) {
  if (number_of(name, -1) != frame || kept(done) != 0) return false;
  keep(done, 1);
  return true;
}

/// LOOP=1: to and fro without end, so that the camera never jumps.
bool loops() { return number_of("LOOP", 0) != 0; }

std::size_t index_of(int frame) {
  const int last = scene().frames - 1, way = frame % std::max(1, 2 * last);
  return static_cast<std::size_t>(way <= last ? way : 2 * last - way);
}

/// UNPLUG_EVERY=N: at every N-th frame of a scene that loops, UNPLUGS times.
bool unplugs_again(int frame) {
  const long every = number_of("UNPLUG_EVERY", 0);
  if (every <= 0 || frame == 0 || frame > every * number_of("UNPLUGS", 10) || frame % every != 0 ||
      kept("pulled_at") == frame)
    return false;
  keep("pulled_at", frame);
  return true;
}

/// RATE frames a second. Who is kept from delivering in time does not hurry afterwards.
class Pace {
 public:
  void wait() {
    const long rate = number_of("RATE", 0);
    if (rate <= 0) return;
    const auto period = std::chrono::duration_cast<Clock::duration>(
        std::chrono::duration<double>(1.0 / static_cast<double>(rate)));
    due_ = std::max(due_ + period, Clock::now());
    std::this_thread::sleep_until(due_);
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point due_ = Clock::now();
};

}  // namespace

std::string text_of(const std::string& name, const std::string& otherwise) {
  const char* given = std::getenv(("FAKE_CAMERA_" + name).c_str());
  return given == nullptr ? otherwise : given;
}
long number_of(const std::string& name, long otherwise) {
  const std::string given = text_of(name);
  return given.empty() ? otherwise : std::strtol(given.c_str(), nullptr, 10);
}

Scene::Scene() {
  std::ifstream file(text_of("SCENE"), std::ios::binary);
  for (Camera* c : {&color, &depth}) {
    file >> c->width >> c->height >> c->fx >> c->fy >> c->cx >> c->cy >> c->model;
    for (float& value : c->coefficients) file >> value;
  }
  for (float& value : rotation) file >> value;
  for (float& value : translation_m) file >> value;
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

const Scene& scene() {
  static const Scene loaded;
  return loaded;
}

long kept(const std::string& name) {
  std::ifstream file(state(name));
  long number = 0;
  file >> number;
  return number;
}
/// Whole at any time: the process ends when it likes, and the test reads meanwhile.
void keep(const std::string& name, long number) {
  const fs::path written = state(name + ".written");
  std::ofstream(written) << number;
  fs::rename(written, state(name));
}
void keep_option(const std::string& line) {
  std::ofstream(state("options"), std::ios::app) << line << '\n';
}

std::vector<std::string> serials() {
  std::vector<std::string> there;
  std::istringstream given(text_of("DEVICES", "0123"));
  for (std::string serial; std::getline(given, serial, ',');) {
    if (serial != "none" && !unplugged()) there.push_back(serial);
  }
  return there;
}

bool with_imu() { return !text_of("IMU").empty(); }

std::string with_gaps(const std::string& bytes, int row_bytes) {
  std::string wide;
  const auto row = static_cast<std::size_t>(row_bytes);
  for (std::size_t at = 0; at < bytes.size(); at += row) {
    wide += bytes.substr(at, row);
    wide.append(kPadding_bytes, '\x7f');
  }
  return wide;
}

Player::Player(Listener& listener, bool imu) : listener_(listener), imu_(imu) {
  thread_ = std::thread([this] { play(); });
}

Player::~Player() {
  stopped_ = true;
  thread_.join();
}

/// Samples between two times.
void Player::send_motion(double from_ms, double to_ms) {
  static const float kFelt[] = {0, -9.81f, 0}, kTurned[] = {0.01f, 0.02f, 0.03f};
  double accel_hz = 0, gyro_hz = 0;
  char comma = 0;
  std::istringstream(text_of("IMU", "0,0")) >> accel_hz >> comma >> gyro_hz;
  for (const auto& [gyro, hz] : {std::pair(false, accel_hz), std::pair(true, gyro_hz)}) {
    if (hz <= 0) continue;
    const double period_ms = 1000 / hz;
    for (double t = std::ceil(from_ms / period_ms) * period_ms; t < to_ms; t += period_ms) {
      listener_.motion(gyro, t, gyro ? kTurned : kFelt);
    }
  }
}

void Player::play() {
  while (!listener_.ready() && !stopped_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  const Scene& s = scene();
  const auto first = static_cast<int>(kept("next"));
  const double period_ms = s.frames > 1 ? s.times_ms[1] - s.times_ms[0] : 33;
  if (first >= s.frames && !loops()) return;
  const auto time_of = [&](int i) {
    return loops() ? s.times_ms[0] + period_ms * i : s.times_ms[static_cast<std::size_t>(i)];
  };
  const long every = number_of("DEPTH_EVERY", 1);
  const std::string dark(s.colors[0].size(), '\x05'), nothing(s.depths[0].size(), '\0');
  const long warm = number_of("WARM", 15);
  Pace pace;
  for (long i = warm; i > 0 && !stopped_; --i) {
    const double time_ms = time_of(first);
    const double before_ms = period_ms * static_cast<double>(i);
    listener_.images(stamp_of(time_ms - before_ms, first), dark, &nothing);
    pace.wait();
  }
  for (int i = first; (i < s.frames || loops()) && !stopped_; ++i) {
    const std::size_t at = index_of(i);
    keep("next", i);
    if (happens("CRASH", "crashed", i)) std::raise(SIGSEGV);
    if (happens("STALL", "stalled", i)) return;
    if (happens("UNPLUG", "pulled", i) || unplugs_again(i)) {
      std::ofstream(state("unplugged")) << std::fixed << seconds();
      return listener_.unplugged();
    }
    const double before_ms = i > 0 ? time_of(i - 1) : time_of(i) - period_ms;
    if (imu_) send_motion(stamp_of(before_ms, i - 1), stamp_of(time_of(i), i));
    listener_.images(stamp_of(time_of(i), i), s.colors[at],
                     i % every == 0 ? &s.depths[at] : nullptr);
    pace.wait();
  }
  if (!stopped_) keep("next", s.frames);
}

}  // namespace fake
