// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string_view>

#include "commands.h"
#include "export_mesh.h"
#include "export_occupancy.h"
#include "log_setup.h"
#include "sgs/core/print.h"
#include "sgs/export/bag_export.h"
#include "sgs/export/map_file_export.h"
#include "sgs/export/scene_export.h"
#include "sgs/export/turned_map.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/glb.h"
#include "sgs/io/ply.h"
#include "sgs/io/splat_file.h"
#include "sgs/io/spz.h"
#include "sgs/io/trajectory_io.h"
#include "sgs/report/map_page.h"
#include "sgs/runfolder/run.h"
#include "sgs/runfolder/run_files.h"

namespace sgs::app {
namespace {

namespace fs = std::filesystem;

struct ExportCommand {
  std::string run, format, output;
  MeshOptions mesh;
  OccupancyCommand occupancy;
  int spz_version = static_cast<int>(io::SpzVersion::kZstd);
  bool upright = false;  ///< z up, instead of the axes of the first camera
  SE3 T_out_world;       ///< from the run's world to that of the files
  /// Output of each format asked for by an option of its own, in the order of kFormats.
  std::vector<std::string> outputs;
};

/// A run's trajectory is TUM text already. Its rows stay as they are: poses made from rounded
/// quaternions and written again may differ in the last digit.
Status export_tum(const ExportCommand& command, const fs::path& out) {
  const std::string& run = command.run;
  if (command.upright) {
    SGS_ASSIGN_OR_RETURN(const auto poses, run::load_run_trajectory(run));
    return io::save_trajectory(out, run::moved_into(command.T_out_world, poses));
  }
  SGS_ASSIGN_OR_RETURN(const auto state, run::load_state(run));
  if (state.unfinished()) {
    SGS_ASSIGN_OR_RETURN(const auto poses, run::load_run_trajectory(run));
    return io::save_trajectory(out, poses);
  }
  const fs::path path = fs::path(run) / run::files::kTrajectory;
  SGS_ASSIGN_OR_RETURN(const auto loaded, io::load_trajectory(path));
  if (!loaded.warning.empty()) return io::save_trajectory(out, loaded.trajectory);
  SGS_ASSIGN_OR_RETURN(const auto text, io::read_file(path));
  return io::write_file(out, text);
}

/// Views of a run for its page; a map alone has none.
Result<report::MapPage> map_page_of(const ExportCommand& command) {
  const std::string& folder = command.run;
  report::MapPage page;
  std::error_code error;
  page.title = fs::weakly_canonical(folder, error).stem().string();
  if (command.upright) page.up = Eigen::Vector3d::UnitZ();
  if (!fs::is_directory(folder, error)) return page;
  SGS_ASSIGN_OR_RETURN(const auto run, run::load_run(folder, run::kCamera | run::kKeyframes));
  for (const StampedPose& pose : run.keyframes.poses()) {
    page.cameras.push_back(command.T_out_world * pose.T_world_camera);
  }
  if (run.upright) page.up = command.T_out_world.R * run.upright->up;
  // The page goes to others: where the recording lies is nobody's business.
  page.title = fs::path(run.input.input).filename().string();
  page.camera = run.camera;
  return page;
}

struct Format {
  const char* name;
  const char* what;
  Status (*write)(const ExportCommand& command, const fs::path& output);
};

template <class Save>
Status with_map(const ExportCommand& command, const Save& save) {
  SGS_ASSIGN_OR_RETURN(auto map, run::load_any_map(command.run));
  if (command.upright) run::move_into(command.T_out_world, map);
  return save(map);
}

const std::array<Format, 15> kFormats = {{
    {"ply", "splats in the 3DGS vertex layout",
     [](const ExportCommand& c, const fs::path& out) {
       return with_map(
           c, [&](const auto& map) { return io::save_splats(out, map.gaussians, map.harmonics); });
     }},
    {"splat", "splats in 32-byte records",
     [](const ExportCommand& c, const fs::path& out) {
       return with_map(c, [&](const auto& map) { return io::save_splat_file(out, map.gaussians); });
     }},
    {"spz", "splats compressed (Niantic SPZ)",
     [](const ExportCommand& c, const fs::path& out) {
       return with_map(c, [&](const auto& map) {
         return io::save_spz(out, map.gaussians, map.harmonics,
                             static_cast<io::SpzVersion>(c.spz_version));
       });
     }},
    {"glb", "splats as binary glTF (KHR_gaussian_splatting)",
     [](const ExportCommand& c, const fs::path& out) -> Status {
       SGS_ASSIGN_OR_RETURN(auto map, run::load_any_map(c.run));
       const SE3 T_gltf_out(c.upright ? io::gltf_from_upright_axes() : io::gltf_from_camera_axes(),
                            Eigen::Vector3d::Zero());
       run::move_into(T_gltf_out * c.T_out_world, map);
       return io::save_glb(out, map.gaussians, map.harmonics);
     }},
    {"points", "coloured point PLY",
     [](const ExportCommand& c, const fs::path& out) {
       return with_map(
           c, [&](const auto& map) { return io::save_points(out, run::to_points(map.gaussians)); });
     }},
    {"html", "one page that shows the map",
     [](const ExportCommand& c, const fs::path& out) {
       return with_map(c, [&](const auto& map) -> Status {
         SGS_ASSIGN_OR_RETURN(const auto page, map_page_of(c));
         return report::save_map_page(out, map, page);
       });
     }},
    {"mesh", "coloured mesh PLY by depth fusion",
     [](const ExportCommand& c, const fs::path& out) { return export_mesh(c.run, c.mesh, out); }},
    {"grid", "2-D occupancy for nav2 and map_server: NAME.yaml and NAME.pgm, or a folder for map.*",
     [](const ExportCommand& c, const fs::path& out) {
       return export_grid(c.run, c.occupancy, out);
     }},
    {"octomap", "3-D occupancy as OctoMap .bt",
     [](const ExportCommand& c, const fs::path& out) {
       return export_octomap(c.run, c.occupancy, out);
     }},
    {"esdf", "distances to the nearest surface as OpenVDB",
     [](const ExportCommand& c, const fs::path& out) {
       return export_esdf(c.run, c.occupancy, out);
     }},
    {"colmap", "folder with COLMAP text model and keyframe pictures",
     [](const ExportCommand& c, const fs::path& out) -> Status {
       SGS_ASSIGN_OR_RETURN(const auto map,
                            run::load_any_map(c.run));  // drawn where the run's poses are
       return run::export_colmap(c.run, map, c.T_out_world, out);
     }},
    {"tum", "trajectory, TUM text",
     [](const ExportCommand& c, const fs::path& out) { return export_tum(c, out); }},
    {"kitti", "trajectory, KITTI text",
     [](const ExportCommand& c, const fs::path& out) -> Status {
       SGS_ASSIGN_OR_RETURN(const auto poses, run::load_run_trajectory(c.run));
       return io::save_kitti(out, run::moved_into(c.T_out_world, poses));
     }},
    {"bag", "poses, path, points and tf as a ROS 1 bag",
     [](const ExportCommand& c, const fs::path& out) -> Status {
       SGS_ASSIGN_OR_RETURN(const auto map,
                            run::load_any_map(c.run));  // tf has the frame that is upright
       return run::export_bag(c.run, map.gaussians, *bag::make_rosbag1_writer(), out);
     }},
    {"mcap", "the same as MCAP with messages of ROS 2",
     [](const ExportCommand& c, const fs::path& out) -> Status {
       SGS_ASSIGN_OR_RETURN(const auto map, run::load_any_map(c.run));
       return run::export_bag(c.run, map.gaussians, *bag::make_mcap_writer(), out);
     }},
}};

/// Of paths and pictures, which a map file does not keep.
bool needs_run(std::string_view format) {
  constexpr std::string_view kOfRuns[] = {"mesh", "colmap", "tum", "kitti", "bag", "mcap"};
  return std::ranges::find(kOfRuns, format) != std::end(kOfRuns);
}

int run_export(ExportCommand command) {
  setup_logging({}, false);
  const bool of_map = mapfile::looks_like_map(command.run);
  if (!of_map) note_state(command.run);
  if (command.upright) {
    const auto T_upright_world = run::load_any_upright(command.run);
    if (!T_upright_world) return report(T_upright_world.error());
    command.T_out_world = *T_upright_world;
    command.mesh.upright = true;
  }
  command.occupancy.options.threads = command.mesh.threads;
  bool any = false;
  for (std::size_t i = 0; i < kFormats.size(); ++i) {
    if (command.format == kFormats[i].name) command.outputs[i] = command.output;
    if (command.outputs[i].empty()) continue;
    any = true;
    const Status status =
        of_map && needs_run(kFormats[i].name)
            ? fail(ErrorCode::kInvalidArgument,
                   fmt::format("{}: {} is made of a run folder, not of a map file", command.run,
                               kFormats[i].name),
                   "give the run folder")
            : kFormats[i].write(command, command.outputs[i]);
    if (!status) return report(status.error());
    print("{}\n", command.outputs[i]);
  }
  if (any) return kExitDone;
  return report({ErrorCode::kInvalidArgument, "nothing to export",
                 "name a format and a file, for example `sgs export RUN spz map.spz`"});
}

}  // namespace

void add_export(CLI::App& app, Action& action) {
  auto command = std::make_shared<ExportCommand>();
  auto* sub = app.add_subcommand(
      "export", "Write the map or trajectory of a run, or a map file, in other formats");
  sub->add_option("RUN", command->run, "Run folder, map file, or a splat PLY")->required();
  std::vector<std::string> names;
  std::string list;
  for (const Format& format : kFormats) {
    names.emplace_back(format.name);
    list += (list.empty() ? "" : ", ") + names.back();
  }
  auto* format = sub->add_option("FORMAT", command->format, list)->check(CLI::IsMember(names));
  auto* output =
      sub->add_option("OUT", command->output, "File (colmap: folder; grid: either) to write");
  format->needs(output);
  command->outputs.resize(kFormats.size());
  for (std::size_t i = 0; i < kFormats.size(); ++i) {
    sub->add_option("--" + names[i], command->outputs[i], kFormats[i].what)->type_name("OUT");
  }
  sub->add_flag("--upright", command->upright,
                "z up instead of the axes of the first camera (bag and mcap always have both)");
  sub->add_option("--spz-version", command->spz_version,
                  "spz: 4, or 2 for readers from before 2026")
      ->check(CLI::IsMember({2, 4}));
  sub->add_option("--voxel", command->mesh.voxel_m, "mesh: size of a voxel in metres")
      ->check(CLI::Range(0.001, 1.0));
  sub->add_flag("--measured-depth", command->mesh.measured,
                "mesh: fuse the camera's depth instead of the map's");
  add_occupancy_options(*sub, command->occupancy);
  sub->add_option("--threads", command->mesh.threads, "Threads")->check(CLI::Range(1, 256));
  sub->callback([command, &action] { action = [command] { return run_export(*command); }; });
}

}  // namespace sgs::app
