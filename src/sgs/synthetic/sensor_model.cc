// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/sensor_model.h"

#include "sgs/synthetic/random.h"

namespace sgs::synthetic {

namespace {

/// Numbers of one sensor: the n-th is drawn between two limits.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : seed_(hash64(seed, hash_name("sensor model"))) {}
  double between(double least, double most) {
    return least + (most - least) * double{unit_float(hash64(seed_, ++count_))};
  }
  float between_f(double least, double most) { return static_cast<float>(between(least, most)); }
  double of_either_sign(double least, double most) {
    const double size = between(least, most);
    return between(-1, 1) < 0 ? -size : size;
  }

 private:
  std::uint64_t seed_, count_ = 0;
};

void draw_systematic_errors(Draw& draw, double least_px, double most_px, SensorModel& m) {
  m.misregistration_px = draw.between(least_px, most_px);
  m.pattern = draw.between_f(0.001, 0.0025);
  m.factor = static_cast<float>(draw.of_either_sign(0.003, 0.01));
  m.growth_per_m2 = static_cast<float>(draw.of_either_sign(0.0003, 0.001));
  m.disparity_per_m = static_cast<float>(draw.of_either_sign(0.001, 0.004));
}

/// The lens of a Kinect's colour camera as several calibrations give it (cushion, with the sign
/// turning twice towards the corners), or the barrel of other makers' cameras.
Distortion draw_lens(Draw& draw) {
  constexpr double kBarrels = 0.2;
  Distortion d;
  const bool barrel = draw.between(0, 1) < kBarrels;
  const double strength = draw.between(0.85, 1.1), shape = draw.between(0.95, 1.05);
  d.k1 = barrel ? -0.09 * strength : 0.262 * strength;
  d.k2 = barrel ? 0.03 * strength : -0.953 * strength * shape;
  d.k3 = barrel ? 0 : 1.163 * strength * shape;
  d.p1 = draw.between(-0.005, 0.003);
  d.p2 = draw.between(-0.003, 0.003);
  return d;
}

ClockModel draw_clocks(Draw& draw) {
  ClockModel c;
  c.free_running = true;
  c.color_rate = draw.between(0.9997, 1.0001);
  c.depth_rate = draw.between(0.9985, 0.9995);
  c.phase = draw.between(0, 1);
  c.jitter_s = draw.between(0.001, 0.002);
  c.stamp_late_s = draw.between(-0.004, 0.004);
  c.lost = draw.between(0, 0.01);
  return c;
}

ExposureModel draw_exposure(Draw& draw) {
  ExposureModel e;
  e.automatic = true;
  e.usual_s = draw.between(0.021, 0.03);
  e.shortest_s = 0.02;
  e.longest_s = 0.033;
  e.target = draw.between(0.46, 0.54);
  e.hold = draw.between(0.04, 0.08);
  e.largest_step = draw.between(0.12, 0.24);
  e.period = static_cast<int>(draw.between(1, 4));
  e.balance = draw.between(0.06, 0.15);
  e.balance_rate = draw.between(0.02, 0.06);
  return e;
}

ResponseModel draw_response(Draw& draw) {
  ResponseModel r;
  r.camera = true;
  r.blur_px = draw.between_f(0.25, 0.45);
  r.vignetting = draw.between_f(0.1, 0.3);
  r.full_well = draw.between_f(20000, 40000);
  r.read_noise = draw.between_f(0.0006, 0.0012);
  r.gamma = draw.between_f(0.85, 1.05);
  r.contrast = draw.between_f(1.1, 1.7);
  r.black = draw.between_f(2, 5);
  r.crosstalk = draw.between_f(0.3, 0.5);
  r.sharpening = draw.between_f(0.7, 1.3);
  for (float& c : r.cast) c = draw.between_f(0.94, 1.06);
  return r;
}

InfraredModel draw_infrared(Draw& draw) {
  InfraredModel i;
  i.camera = true;
  i.focal_ratio = draw.between(1.09, 1.13);
  i.offset_x_px = draw.between(-5, 5);
  i.offset_y_px = draw.between(-20, -8);
  i.baseline_m = draw.between(0.0235, 0.0255);
  i.readout_s = draw.between(0.012, 0.03);
  i.dimmest = draw.between_f(0.006, 0.012);
  i.patchiness = draw.between_f(0.4, 0.8);
  i.dark_objects = draw.between_f(0.15, 0.35);
  i.shiny_objects = draw.between_f(0.1, 0.25);
  i.edge_limit = draw.between_f(-0.8, -0.3);
  i.ragged_px = draw.between_f(0.7, 1.3);
  i.flying = draw.between_f(0.03, 0.1);
  return i;
}

SensorModel draw_real(Draw& draw, SensorModel m) {
  draw_systematic_errors(draw, 0.8, 3.3, m);
  m.rolling_shutter_s = draw.between(0.015, 0.028);
  m.lost_frames = 0;
  m.exposure_drift = 0;
  m.color_sigma = 0;
  m.edge_losses = 0;  // windows fail together: see infrared
  m.lens = draw_lens(draw);
  m.clocks = draw_clocks(draw);
  m.exposure = draw_exposure(draw);
  m.exposure_s = m.exposure.usual_s;
  m.response = draw_response(draw);
  m.infrared = draw_infrared(draw);
  return m;
}

}  // namespace

SensorModel SensorModel::of_level(const std::string& level, std::uint64_t seed) {
  SensorModel m;
  if (level == "clean") return m;
  m.noise = true;
  m.exposure_s = 0.012;
  m.color_sigma = 2.5f;
  m.min_depth_m = 0.45f;
  m.max_depth_m = 5.f;
  if (level == "kinect") return m;
  m.hard = true;
  m.lost_frames = 0.02;
  m.correlated_noise = 0.7f;
  m.exposure_drift = 0.2f;
  if (level == "hard") {
    m.rolling_shutter_s = 0.016;
    m.depth_delay_s = 0.004;
    m.misregistration_px = 1.5;
    m.pattern = 0.0025f;
    m.distortion = 0.01f;
    return m;
  }
  Draw draw(seed);
  if (level == "real") return draw_real(draw, m);
  m.rolling_shutter_s = draw.between(0.008, 0.024);
  m.depth_delay_s = draw.between(-0.002, 0.008);
  draw_systematic_errors(draw, 0.5, 2, m);
  return m;
}

}  // namespace sgs::synthetic
