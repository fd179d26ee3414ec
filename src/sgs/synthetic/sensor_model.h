// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "sgs/camera/distortion.h"

namespace sgs::synthetic {

/// Colour and depth that run free of each other. Each image has a stamp; a frame is a pair whose
/// stamps are near. Default: one clock, no errors.
struct ClockModel {
  bool free_running = false;
  double color_rate = 1, depth_rate = 1;  ///< of the nominal rate
  double phase = 0;         ///< of depth after colour at the start, in periods of depth, 0..1
  double jitter_s = 0;      ///< standard deviation of each stamp
  double stamp_late_s = 0;  ///< by how much later than colour's the stamps of depth are than true
  double lost = 0;          ///< fraction of the images of either camera that are not recorded
};

/// Automatic exposure and white balance: control loops on the picture. Default: none.
struct ExposureModel {
  bool automatic = false;
  double usual_s = 0;                    ///< of a row, as the first picture needs it
  double shortest_s = 0, longest_s = 0;  ///< the gain does what the time cannot
  double target = 0;                     ///< mean luma that is aimed at, 0..1
  double hold = 0;                       ///< relative deviation of the luma that is borne
  double largest_step = 0;               ///< of the logarithm of the exposure
  int period = 1;                        ///< frames from one step to the next
  double balance = 0;       ///< share of the picture's cast that white balance removes, 0..1
  double balance_rate = 0;  ///< part of what is missing that it moves by in a frame, 0..1
};

/// From light to bytes: optics, mosaic of colour filters, noise, tone curve. Default: no camera of
/// this kind; Sensor::color() is one.
struct ResponseModel {
  bool camera = false;
  float blur_px = 0;     ///< standard deviation of the optics' spot, at 640 columns
  float vignetting = 0;  ///< light that is missing in the corners, 0..1
  float full_well = 1;   ///< number of electrons of a white pixel, for the shot noise
  float read_noise = 0;  ///< standard deviation, of white = 1
  float gamma = 1;       ///< exponent from light to grey
  float contrast = 0;    ///< 0 = a pure power, 1 = an S with flat ends, 2 = an S of that S
  float black = 0;       ///< grey value of no light, 0..255
  float crosstalk = 0;   ///< share of the light of all colours in what each filter lets through
  float sharpening = 0;  ///< share of a pixel's difference from its neighbours that is added
  std::array<float, 3> cast{1, 1, 1};  ///< factors of red, green, blue before white balance
};

/// A depth camera that matches a projected pattern in infrared, registered to colour by its driver.
/// Default: none; depth is seen on colour's own rays.
struct InfraredModel {
  bool camera = false;
  double focal_ratio = 1;                   ///< focal length by that of colour, in equal images
  double offset_x_px = 0, offset_y_px = 0;  ///< of its principal point from that of colour, at 640
  double baseline_m = 0;                    ///< of its centre to the side of colour's
  double readout_s = 0;                     ///< from the first to the last row
  float dimmest = 0;        ///< least return that is matched; 1 = white, head on, at 1 m
  float patchiness = 0;     ///< scatter of that limit's logarithm over the image
  float dark_objects = 0;   ///< share of small things that are dark in infrared
  float shiny_objects = 0;  ///< share of small things that mirror
  float ragged_px = 0;      ///< standard deviation of the place of silhouettes, at 640 columns
  float edge_limit = -9;    ///< silhouettes fail where a normal number, alike nearby, is below
  float flying = 0;         ///< share of the pixels at silhouettes that mix both depths
};

/// What a sensor does to an ideal picture. Default: nothing. Every effect stands alone.
struct SensorModel {
  bool noise = false;             ///< depth and colour noise, drop-outs, range limits, blur
  bool hard = false;              ///< the systematic errors on top
  double exposure_s = 0;          ///< of one row
  double rolling_shutter_s = 0;   ///< from the first to the last row
  double depth_delay_s = 0;       ///< of the depth image after the colour image
  double misregistration_px = 0;  ///< of depth against colour, constant over the sequence
  double lost_frames = 0;         ///< fraction
  float color_sigma = 0;          ///< 0..255
  float min_depth_m = 0, max_depth_m = 1e9f;
  float pattern = 0;           ///< fixed-pattern depth error in metres at 1 m, grows with z^2
  float distortion = 0;        ///< relative low-frequency depth error
  float factor = 0;            ///< relative depth error over the image, as large in all depths
  float growth_per_m2 = 0;     ///< relative depth error at 1 m that grows with z^2
  float disparity_per_m = 0;   ///< by how much inverse depths are too small everywhere
  float correlated_noise = 0;  ///< sigma of noise correlated over 8 px, in units of sigma_z
  float exposure_drift = 0;    ///< the gain stays within 1 -+ this
  float edge_losses = 0.8f;    ///< share of the pixels at silhouettes without depth
  Distortion lens;             ///< of both images; frames come out without it
  ClockModel clocks;
  ExposureModel exposure;
  ResponseModel response;
  InfraredModel infrared;

  /// "clean", "kinect", "hard", "varied" or "real". How a sensor of the last two kinds errs is
  /// drawn from the seed. "varied": systematic errors of another form than those of "hard", some
  /// with the other sign. "real": what a Kinect v1 does, in the ranges that recordings show
  /// (docs/decisions/0059-a-level-real.md).
  static SensorModel of_level(const std::string& level, std::uint64_t seed);
};

}  // namespace sgs::synthetic
