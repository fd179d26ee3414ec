// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

// What all fakes of cameras' libraries share: a scene from a file, played as a camera would deliver
// it, with what goes wrong with cameras.
//
// Environment, each with FAKE_CAMERA_ before it:
//   SCENE     the file (fake_cameras.py writes it)
//   STATE     a folder: how far the scene was played, options that were set
//   VERSION   of the library, where it has one
//   DEVICES   serial numbers with commas, "0123"; "none"
//   FAIL      message of an error when the camera is started
//   USB, FIRMWARE
//   RATE      frames a second, 0: as fast as they are taken
//   WARM      dark frames before the scene, 15
//   DEPTH_EVERY  depth with every so manieth colour image
//   CLOCK     wrap, jump, back or drift
//   SHIFT_US  from the middle of the exposure to the stamp
//   IMU       rates of accelerometer and gyroscope, "200,400"
//   UNPLUG, CRASH, STALL  after so many frames of the scene, once
//   LOOP      1: to and fro without end, the clock going on
//   UNPLUG_EVERY, UNPLUGS  of a scene that loops: at every so manieth frame, so many times (10)
//   AWAY_S    seconds until an unplugged camera is plugged in again, 2
namespace fake {

std::string text_of(const std::string& name, const std::string& otherwise = "");
long number_of(const std::string& name, long otherwise);

struct Camera {
  int width = 0, height = 0;
  float fx = 0, fy = 0, cx = 0, cy = 0;
  int model = 0;  ///< as librealsense2 counts them
  float coefficients[5] = {};
};

struct Scene {
  Camera color, depth;
  float rotation[9] = {}, translation_m[3] = {};  ///< from depth to colour, by columns
  float unit_m = 0;
  int frames = 0;
  std::vector<double> times_ms;
  std::vector<std::string> colors, depths;

  Scene();
};
const Scene& scene();

/// A number in the folder of the state; 0 where there is none.
long kept(const std::string& name);
void keep(const std::string& name, long number);
/// Notes that an option was set.
void keep_option(const std::string& line);

/// Of the cameras that are plugged in now.
std::vector<std::string> serials();
bool with_imu();
/// What a library that is busy or has no permission would say; empty: nothing.
inline std::string failure() { return text_of("FAIL"); }

inline constexpr long kExposure_us = 8000, kGain = 16;
inline constexpr int kPadding_bytes = 16;
/// Rows of a real camera need not lie without gaps.
std::string with_gaps(const std::string& bytes, int row_bytes);

/// Takes what the camera delivers; called by the player's thread.
class Listener {
 public:
  virtual ~Listener() = default;
  virtual void images(double stamp_ms, const std::string& color, const std::string* depth) = 0;
  virtual void motion(bool gyro, double stamp_ms, const float* xyz) = 0;
  virtual void unplugged() {}
  /// Whether somebody takes what comes; the player waits for it.
  virtual bool ready() const { return true; }
};

/// Plays the scene from where it was left.
class Player {
 public:
  Player(Listener& listener, bool imu);
  ~Player();
  Player(const Player&) = delete;
  Player& operator=(const Player&) = delete;
  bool stopped() const { return stopped_; }

 private:
  void play();
  void send_motion(double from_ms, double to_ms);

  Listener& listener_;
  bool imu_;
  std::atomic<bool> stopped_{false};
  std::thread thread_;
};

}  // namespace fake
