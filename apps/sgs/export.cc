// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "commands.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/ply.h"
#include "sgs/io/trajectory_io.h"

namespace sgs::app {
namespace {

namespace fs = std::filesystem;

struct ExportCommand {
  std::string run, output, format;
};

/// Centres of the Gaussians that are more solid than not, as coloured points.
std::vector<io::ColoredPoint> to_points(const std::vector<map::Gaussian>& gaussians) {
  std::vector<io::ColoredPoint> points;
  const auto byte = [](float v) {
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(v, 0.0f, 1.0f)));
  };
  for (const map::Gaussian& g : gaussians) {
    if (g.opacity_logit < 0) continue;
    points.push_back(
        {{g.mean[0], g.mean[1], g.mean[2]}, {byte(g.rgb[0]), byte(g.rgb[1]), byte(g.rgb[2])}});
  }
  return points;
}

/// KITTI odometry text: the upper 3x4 of each pose, row by row, no times.
std::string kitti_text(const Trajectory& trajectory) {
  std::string text;
  for (const StampedPose& pose : trajectory.poses()) {
    const SE3& T = pose.T_world_camera;
    for (int row = 0; row < 3; ++row) {
      text += fmt::format("{}{:.9f} {:.9f} {:.9f} {:.9f}", row ? " " : "", T.R(row, 0), T.R(row, 1),
                          T.R(row, 2), T.t(row));
    }
    text += "\n";
  }
  return text;
}

Status export_run(const ExportCommand& command) {
  const fs::path run = command.run, output = command.output;
  if (command.format == "tum" || command.format == "kitti") {
    SGS_ASSIGN_OR_RETURN(const auto loaded, io::load_trajectory(run / "trajectory.txt"));
    return command.format == "tum" ? io::save_trajectory(output, loaded.trajectory)
                                   : io::write_file(output, kitti_text(loaded.trajectory));
  }
  SGS_ASSIGN_OR_RETURN(const auto gaussians, io::load_splats(run / "map.ply"));
  return command.format == "ply" ? io::save_splats(output, gaussians)
                                 : io::save_points(output, to_points(gaussians));
}

}  // namespace

void add_export(CLI::App& app, Action& action) {
  auto command = std::make_shared<ExportCommand>();
  auto* sub = app.add_subcommand("export", "Write a run's map or trajectory in another format");
  sub->add_option("RUN", command->run, "Run folder")->required();
  sub->add_option("FORMAT", command->format,
                  "ply (splats), points (coloured point PLY), tum or kitti (trajectory)")
      ->required()
      ->check(CLI::IsMember({"ply", "points", "tum", "kitti"}));
  sub->add_option("OUT", command->output, "File to write")->required();
  sub->callback([command, &action] {
    action = [command]() -> int {
      const Status status = export_run(*command);
      if (!status) return report(status.error());
      fmt::print("{}\n", command->output);
      return kExitDone;
    };
  });
}

}  // namespace sgs::app
