// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "input_options.h"

#include "sgs/dataset/open.h"

namespace sgs::app {
namespace {

/// One input, or the files of one recording without what lies beside them.
void take_files(std::vector<std::string> files, run::InputSpec& input) {
  auto rest = files;
  std::erase_if(rest, [](const std::string& file) { return dataset::lies_beside_recording(file); });
  if (!rest.empty()) files = std::move(rest);
  input.input = files.front();
  input.more_files.clear();
  for (std::size_t i = 1; i < files.size(); ++i) {
    input.more_files += (i > 1 ? "\n" : "") + files[i];
  }
}

}  // namespace

CLI::Option* add_input_argument(CLI::App& app, run::InputSpec& input, const std::string& meaning) {
  return app.add_option_function<std::vector<std::string>>(
      "INPUT", [&input](const std::vector<std::string>& files) { take_files(files, input); },
      meaning);
}

// One argument, since options may stand behind it: then the parser would not know which is the
// last.
CLI::Option* add_input_and_output(CLI::App& app, run::InputSpec& input, std::string& output,
                                  const std::string& output_name, const std::string& meaning) {
  return app
      .add_option_function<std::vector<std::string>>(
          "INPUT",
          [&input, &output](std::vector<std::string> files) {
            output = std::move(files.back());
            files.pop_back();
            take_files(std::move(files), input);
          },
          meaning)
      ->required()
      ->expected(2, CLI::detail::expected_max_vector_size)
      ->type_name(output_name);
}

void add_recording_options(CLI::App& app, run::InputSpec& input) {
  app.add_option("--camera", input.camera,
                 "fx,fy,cx,cy[,k1,k2,p1,p2,k3[,k4,k5,k6]] or fx,fy,cx,cy,fisheye,k1,k2,k3,k4, or a "
                 "calibration of ROS, OpenCV, Kalibr, ORB-SLAM or Open3D (YAML, JSON)");
  app.add_option("--depth-scale", input.depth_scale, "Raw depth units per metre")
      ->check(CLI::PositiveNumber);
  app.add_option("--max-width", input.max_width,
                 "Reduce wider images of a recording to this width; 0 = never")
      ->check(CLI::Range(0, 16384))
      ->capture_default_str();
  app.add_option("--topics", input.topics,
                 "Bag: color=/a,depth=/b[,color_info=/c][,depth_info=/d] where guessing fails");
  app.add_option("--extrinsics", input.extrinsics,
                 "Bag: depth camera to colour camera, tx,ty,tz,qx,qy,qz,qw; or: aligned");
  app.add_option("--truth-topic", input.truth_topic,
                 "Bag: ground truth from a topic of poses, or WORLD:CAMERA of tf");
  app.add_option("--stamps", input.stamps,
                 "Bag: times of the camera, or received: those of the recorder")
      ->check(CLI::IsMember({"camera", "received"}))
      ->capture_default_str();
}

void add_tracking_options(CLI::App& app, run::InputSpec& input, run::ConfigSources& config) {
  app.add_option("--config", config.file, "TOML file, e.g. a run's config.toml");
  app.add_option("--tracker", config.tracker, "spectral, paper, gicp, orb, cvm, given or render");
  app.add_option("--set", config.assignments, "key=value, see `sgs info --config`")
      ->take_all()
      ->allow_extra_args(false);
  app.add_option("--frames", input.frames, "a:b, frames a to b-1 of the sequence");
  app.add_option("--poses", input.poses,
                 "With --tracker given: TUM file, or COLMAP's images.txt; default: the "
                 "recording's own");
  add_recording_options(app, input);
  app.add_option("--trajectory", input.trajectory,
                 "Synthetic input: fly along this TUM trajectory");
  app.add_option("--synth-seed", input.synth_seed, "Synthetic input: scene and noise");
}

}  // namespace sgs::app
