// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Text files of runs and recordings; the first byte chooses which. What loads can be written and
// loads again.
#include <cmath>

#include "harness.h"
#include "sgs/dataset/imu.h"
#include "sgs/eval/metrics.h"
#include "sgs/io/append_file.h"
#include "sgs/io/calibration_io.h"
#include "sgs/io/camera_file.h"
#include "sgs/io/depth_calibration_io.h"
#include "sgs/io/trajectory_io.h"
#include "sgs/slam/frame_record.h"
#include "sgs/upright/upright.h"

namespace {

using namespace sgs;

void trajectory(std::string_view text) {
  const auto loaded = io::trajectory_from_text(text, "fuzz");
  if (!loaded) return;
  const auto again = io::trajectory_from_text(io::trajectory_text(loaded->trajectory), "fuzz");
  fuzz::require(again.has_value(), "a trajectory loads again");
}

void frames(std::string_view text) {
  (void)slam::frames_from_csv(io::whole_lines(text), "fuzz");
  const auto records = slam::frames_from_csv(text, "fuzz");
  if (!records) return;
  const auto again = slam::frames_from_csv(slam::frames_csv(*records), "fuzz");
  fuzz::require(again && again->size() == records->size(), "frames load again");
}

void metrics(std::string_view text) {
  const auto loaded = eval::metrics_from_json(text, "fuzz");
  if (!loaded) return;
  fuzz::require(eval::metrics_from_json(eval::to_json(*loaded), "fuzz").has_value(),
                "metrics load again");
  (void)eval::metrics_table(*loaded);
}

void cameras(std::string_view text) {
  const fuzz::MemoryFile file(text);
  (void)io::parse_camera_option(text);
  (void)io::load_cam_params_json(file.path());
  (void)io::load_depth_calibration(file.path());
  if (const auto read = io::load_camera_yaml(file.path())) {
    fuzz::require(read->camera.fx > 0 && std::isfinite(read->camera.fx),
                  "a camera has a focal length");
    (void)io::check_calibration(*read, "fuzz");
  }
  const auto camera = io::load_camera_txt(file.path());
  if (!camera) return;
  fuzz::require(io::check_calibration(*camera, "fuzz").has_value(), "a camera that loads is one");
  const auto saved = fuzz::scratch_file("camera.txt");
  fuzz::require(io::save_camera_txt(saved, *camera).has_value(), "a camera can be saved");
  fuzz::require(io::load_camera_txt(saved).has_value(), "a camera loads again");
}

/// Accelerations along a path that turns, and which way they say is up.
void accelerometer(std::string_view text) {
  const auto imu = dataset::read_accelerometer_text(text, "fuzz");
  Trajectory path;
  for (int i = 0; i < 20; ++i) path.push_back({0.1 * i, SE3(so3_exp({0, 0.1 * i, 0}), {0, 0, 0})});
  std::vector<std::string> warnings;
  const auto upright = run::find_upright(imu, path, {}, warnings);
  fuzz::require(upright && std::abs(upright->up.norm() - 1) < 1e-6, "up is a direction");
  const auto saved = fuzz::scratch_file("upright.toml");
  fuzz::require(run::save_upright(saved, *upright).has_value(), "it can be saved");
  fuzz::require(run::load_upright(saved).has_value(), "it loads again");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::Choice input(data, size);
  // In this order '0' to '4', with which the corpus begins, are the parsers as they stand above.
  void (*const parsers[])(std::string_view) = {metrics, cameras, accelerometer, trajectory, frames};
  parsers[input.number % std::size(parsers)](input.rest);
  return 0;
}
