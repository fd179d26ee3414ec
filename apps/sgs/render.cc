// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "commands.h"
#include "helper_program.h"
#include "interrupt.h"
#include "progress.h"
#include "sgs/core/print.h"
#include "sgs/export/camera_path.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/image_io.h"
#include "sgs/io/ply.h"
#include "sgs/io/trajectory_io.h"
#include "sgs/render/rendered_images.h"
#include "sgs/render/view_color.h"
#include "sgs/report/report_data.h"
#include "sgs/runfolder/run.h"
#include "sgs/runfolder/run_files.h"

namespace sgs::app {
namespace {

namespace fs = std::filesystem;

struct RenderCommand {
  std::string run, map, trajectory, output, camera;
  std::string size, video;
  double seconds = 12, fps = 30;
  bool turntable = false;
  int every = 30, threads = 2;
  bool depth = false, quiet = false;
};

/// Camera given as fx,fy,cx,cy with --size WxH.
Result<PinholeCamera> camera_from_options(const RenderCommand& command) {
  SGS_ASSIGN_OR_RETURN(const auto option, io::parse_camera_option(command.camera));
  PinholeCamera camera{0, 0, option.fx, option.fy, option.cx, option.cy};
  if (std::sscanf(command.size.c_str(), "%dx%d", &camera.width, &camera.height) != 2 ||
      !camera.valid()) {
    return fail(ErrorCode::kInvalidArgument, fmt::format("--size '{}' is not WxH", command.size),
                "for example --size 640x480");
  }
  return camera;
}

Result<Trajectory> trajectory_for(const RenderCommand& command) {
  if (command.trajectory.empty()) {
    SGS_ASSIGN_OR_RETURN(const auto run,
                         run::load_run(command.run, run::kTrajectory | run::kKeyframes));
    return run::view_poses(run);
  }
  SGS_ASSIGN_OR_RETURN(auto loaded, io::load_trajectory(command.trajectory));
  return std::move(loaded.trajectory);
}

/// sgs-video, to be fed with `count` pictures of the camera's size.
Result<HelperProgram> start_video(const RenderCommand& command, const PinholeCamera& camera,
                                  std::size_t count) {
  return HelperProgram::start(
      {.name = "sgs-video",
       .purpose = "videos",
       .to_install = "install the package sgs-video, or render pictures (without --video)",
       .to_fit = "is there enough memory?"},
      {command.video, fmt::format("{}", camera.width), fmt::format("{}", camera.height),
       fmt::format("{}", command.fps), fmt::format("{}", count)});
}

/// --video: the way of the camera without its shake, or once around.
Status render_video(const RenderCommand& command, const PinholeCamera& camera,
                    const map::SplatMap& map, const Trajectory& trajectory) {
  const int count = std::max(1, static_cast<int>(std::lround(command.seconds * command.fps)));
  const std::vector<SE3> views =
      command.turntable
          ? run::turntable(trajectory, map.gaussians,
                           run::level_up(map.gaussians, report::likely_up(trajectory)), count)
          : run::smooth_path(trajectory, count);
  if (views.empty()) {
    return fail(ErrorCode::kInvalidArgument, fmt::format("{} has no poses or no map", command.run),
                "name a run that mapped something");
  }
  SGS_ASSIGN_OR_RETURN(auto video, start_video(command, camera, views.size()));
  ThreadPool pool(command.threads);
  const auto rasterizer = render::make_cpu_rasterizer(&pool);
  render::ViewColors colors(&pool);
  render::Rendering rendering;
  Progress progress("pictures", static_cast<std::int64_t>(views.size()), command.quiet);
  for (const SE3& view : views) {
    if (interrupted()) return {};
    rasterizer->render(colors.seen(map.gaussians, map.harmonics, view.t), camera, view, rendering);
    const ColorImage picture = render::to_color_image(rendering.color);
    if (!video.feed(std::as_bytes(std::span(picture.data(), picture.size())))) break;
    progress.step("");
  }
  progress.finish();
  SGS_RETURN_IF_ERROR(video.finish());
  print("{}\n", command.video);
  return {};
}

Status render_all(const RenderCommand& command) {
  const fs::path folder = command.run;
  note_state(command.run);
  PinholeCamera camera;
  if (command.camera.empty()) {
    SGS_ASSIGN_OR_RETURN(const auto loaded, run::load_run(folder, run::kCamera));
    camera = loaded.camera;
  } else {
    SGS_ASSIGN_OR_RETURN(camera, camera_from_options(command));
  }
  SGS_ASSIGN_OR_RETURN(const auto map, command.map.empty() ? run::load_run_map(folder)
                                                           : io::load_splats(command.map));
  SGS_ASSIGN_OR_RETURN(const auto trajectory, trajectory_for(command));
  if (!command.video.empty()) return render_video(command, camera, map, trajectory);
  const fs::path output =
      command.output.empty() ? folder / run::files::kRenders : fs::path(command.output);
  SGS_RETURN_IF_ERROR(io::make_folder(output));

  ThreadPool pool(command.threads);
  const auto rasterizer = render::make_cpu_rasterizer(&pool);
  render::ViewColors colors(&pool);
  render::Rendering rendering;
  const auto& poses = trajectory.poses();
  const auto every = static_cast<std::size_t>(command.every);
  Progress progress("pictures", static_cast<std::int64_t>((poses.size() + every - 1) / every),
                    command.quiet);
  for (std::size_t i = 0; i < poses.size() && !interrupted(); i += every) {
    const SE3& T = poses[i].T_world_camera;
    rasterizer->render(colors.seen(map.gaussians, map.harmonics, T.t), camera, T, rendering);
    SGS_RETURN_IF_ERROR(io::save_color(output / fmt::format("render_{:06}.png", i),
                                       render::to_color_image(rendering.color)));
    if (command.depth) {
      constexpr double kDepthScale = 5000;
      constexpr float kSolid = 0.5f;
      SGS_RETURN_IF_ERROR(io::save_depth(output / fmt::format("depth_{:06}.png", i),
                                         render::mean_depth(rendering, kSolid), kDepthScale));
    }
    progress.step("");
  }
  progress.finish();
  print("{}\n", output.string());
  return {};
}

}  // namespace

void add_render(CLI::App& app, Action& action) {
  auto command = std::make_shared<RenderCommand>();
  auto* sub = app.add_subcommand("render", "Render pictures of a map along a trajectory");
  sub->add_option("RUN", command->run, "Run folder")->required();
  sub->add_option("-o,--output", command->output, "Folder for the pictures (default RUN/renders)");
  sub->add_option("--map", command->map, "Splat PLY instead of RUN/map.ply");
  sub->add_option("--trajectory", command->trajectory, "TUM poses instead of RUN/trajectory.txt");
  auto* camera = sub->add_option("--camera", command->camera, "fx,fy,cx,cy instead of the run's");
  sub->add_option("--size", command->size, "WxH of the pictures (with --camera)")->needs(camera);
  sub->add_option("--every", command->every, "Every n-th pose")->check(CLI::PositiveNumber);
  sub->add_option("--threads", command->threads, "Threads")->check(CLI::Range(1, 256));
  auto* video = sub->add_option("--video", command->video,
                                "One video instead of pictures (.mp4, .webm or .avi): the way of "
                                "the camera without its shake");
  sub->add_flag("--turntable", command->turntable, "With --video: once around what was seen")
      ->needs(video);
  sub->add_option("--seconds", command->seconds, "Length of the video")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str()
      ->needs(video);
  sub->add_option("--fps", command->fps, "Pictures per second of the video")
      ->check(CLI::Range(1.0, 240.0))
      ->capture_default_str()
      ->needs(video);
  sub->add_flag("--depth", command->depth, "Also write depth (16-bit PNG, 5000 units per metre)");
  sub->add_flag("--quiet", command->quiet, "No progress");
  sub->callback([command, &action] {
    action = [command]() -> int {
      const Status status = render_all(*command);
      if (!status) return report(status.error());
      return interrupted() ? kExitInterrupted : kExitDone;
    };
  });
}

}  // namespace sgs::app
