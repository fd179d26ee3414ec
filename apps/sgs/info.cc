// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "camera_json.h"
#include "commands.h"
#include "info_map.h"
#include "input_options.h"
#include "sgs/core/print.h"
#include "sgs/dataset/bags/bag_source.h"
#include "sgs/dataset/imu.h"
#include "sgs/eval/metrics.h"
#include "sgs/input/input.h"
#include "sgs/mapfile/map_file.h"
#include "sgs/runfolder/run_config.h"
#include "sgs/slam/frame_record.h"
#include "sgs/stream/camera_program.h"
#include "sgs/synthetic/source.h"

namespace sgs::app {
namespace {

struct InfoOptions {
  run::InputSpec input;
  bool config = false, markdown = false, scenes = false, json = false;
  bool columns = false, metrics = false, cameras = false;
  std::string preset = "default", audience = "all";
};

int print_config(const InfoOptions& options) {
  auto config = run::make_run_config(options.preset);
  if (!config) return report(config.error());
  const auto audience = from_string<Audience>("--for", options.audience);
  if (!audience) return report(audience.error());
  ParameterList list;
  config->declare(list);
  print("{}", options.markdown ? list.to_markdown(*audience) : list.to_toml(*audience));
  return kExitDone;
}

int print_scenes() {
  for (const auto& scene : synthetic::scene_names()) {
    print("synth:{:<34} {:>5} frames  {}\n", scene.name, scene.default_frames, scene.description);
  }
  print("\nOptions, each after a + behind the name (synth:room+walkers40+still:kinect):\n");
  for (const auto& option : synthetic::scene_options()) {
    print("  +{:<12} {}\n", option.name, option.description);
  }
  return kExitDone;
}

nlohmann::json family_json(const stream::CameraFamily& family) {
  nlohmann::json json = {{"family", family.program.family},
                         {"program", family.program.path.string()},
                         {"library", family.library},
                         {"devices", nlohmann::json::array()}};
  for (const auto& device : family.devices) {
    json["devices"].push_back(
        {{"input", fmt::format("camera:{}:{}", family.program.family, device.serial)},
         {"name", device.name},
         {"serial", device.serial},
         {"firmware", device.firmware},
         {"connection", device.connection}});
  }
  if (family.problem) {
    json["problem"] = {{"message", family.problem->message}, {"remedy", family.problem->remedy}};
  }
  return json;
}

void print_family(const stream::CameraFamily& family) {
  print("{:<12} {}\n", family.program.family,
        family.library.empty() ? "no library" : "library " + family.library);
  for (const auto& device : family.devices) {
    print("  camera:{}:{}  {}{}, {}\n", family.program.family, device.serial, device.name,
          device.firmware.empty() ? "" : ", firmware " + device.firmware, device.connection);
  }
  if (family.problem) {
    print("  {}\n  {}\n", family.problem->message, family.problem->remedy);
  }
}

/// The programs for cameras that are installed, the libraries that they find, and what is plugged
/// in.
int print_cameras(const InfoOptions& options) {
  const auto programs = stream::find_camera_programs();
  nlohmann::json all = nlohmann::json::array();
  for (const auto& program : programs) {
    const auto family = stream::ask_camera_program(program);
    if (options.json) {
      all.push_back(family_json(family));
    } else {
      print_family(family);
    }
  }
  if (options.json) {
    print("{}\n", all.dump(2));
  } else if (programs.empty()) {
    print("no program for cameras is installed: the package sgs-cameras has them\n");
  }
  return kExitDone;
}

std::string use_of(const dataset::TopicInfo& topic, const dataset::SequenceInfo* info) {
  if (info == nullptr) return "";
  if (topic.topic == info->color_topic) return "  <- colour";
  return topic.topic == info->depth_topic ? "  <- depth" : "";
}

/// The topics of a bag; `info` says which of them are read, where that is known.
void print_topics(const dataset::BagDescription& bag, const dataset::SequenceInfo* info) {
  print("topics       {} of a {}\n", bag.topics.size(), bag.format);
  for (const auto& topic : bag.topics) {
    print("  {:<50} {:<28} {:>8} {:>9}  {}{}\n", topic.topic, topic.type,
          topic.messages ? fmt::format("{}", *topic.messages) : "?",
          topic.rate_hz ? fmt::format("{:.1f} Hz", *topic.rate_hz) : "", topic.encoding,
          use_of(topic, info));
  }
}

nlohmann::json topics_json(const dataset::BagDescription& bag) {
  nlohmann::json topics = nlohmann::json::array();
  for (const auto& topic : bag.topics) {
    nlohmann::json entry = {{"topic", topic.topic}, {"type", topic.type}};
    if (topic.messages) entry["messages"] = *topic.messages;
    if (topic.rate_hz) entry["rate_hz"] = *topic.rate_hz;
    if (!topic.encoding.empty()) entry["encoding"] = topic.encoding;
    topics.push_back(std::move(entry));
  }
  return topics;
}

int print_sequence(const InfoOptions& options) {
  std::optional<dataset::BagDescription> bag;
  const auto place = dataset::locate_recording(options.input.input);
  if (place && place->is_bag) {
    dataset::OpenOptions files;
    files.more_files = run::more_files_of(options.input);
    auto described = dataset::describe_bag(place->path, files);
    if (!described) return report(described.error());
    bag = std::move(*described);
  }
  const auto input = run::open_input(options.input, 1);
  if (bag && !options.json) print_topics(*bag, input ? &input->info : nullptr);
  if (!input) return report(input.error());
  const auto& info = input->info;
  const auto& c = info.calibration;
  const bool counted = info.frames_in_folder > 0;  // bags without an index are not
  if (options.json) {
    const auto if_counted = [&](auto number) {
      return counted ? nlohmann::json(number) : nlohmann::json();
    };
    nlohmann::json json = {{"layout", info.layout},
                           {"name", info.name},
                           {"frames", if_counted(info.frames)},
                           {"frames_in_folder", if_counted(info.frames_in_folder)},
                           {"first_time_s", info.first_time_s},
                           {"last_time_s", if_counted(info.last_time_s)},
                           {"lens", to_string(c.distortion.model)},
                           {"distortion", c.distortion.written()},
                           {"depth_scale", c.depth_scale},
                           {"delivered", camera_json(info.delivered)},
                           {"sparse", info.sparse},
                           {"calibration_source", info.calibration_source},
                           {"unit_source", info.unit_source},
                           {"relation_source", info.relation_source},
                           {"times_source", info.times_source},
                           {"truth_rows", info.truth_rows},
                           {"accelerometer", dataset::accelerometer_file(info.folder).string()},
                           {"color_without_depth", info.color_without_depth},
                           {"depth_without_color", info.depth_without_color},
                           {"missing_images", info.missing_images},
                           {"warnings", info.warnings}};
    json.update(camera_json(c.camera));
    if (info.depth_delays) {
      json["depth_delay_s"] = {{"least", info.depth_delays->least_s},
                               {"median", info.depth_delays->median_s},
                               {"most", info.depth_delays->most_s}};
    }
    if (bag) {
      json["topics"] = topics_json(*bag);
      json["color_topic"] = info.color_topic;
      json["depth_topic"] = info.depth_topic;
    }
    print("{}\n", json.dump(2));
    return kExitDone;
  }
  print("name         {}\nlayout       {}\n", info.name, info.layout);
  print("frames       {}\n",
        counted ? fmt::format("{} of {}, {:.3f} s", info.frames, info.frames_in_folder,
                              info.last_time_s - info.first_time_s)
                : "not known before it is read");
  print("camera       {}x{}  fx {} fy {} cx {} cy {}  (from {})\n", c.camera.width, c.camera.height,
        c.camera.fx, c.camera.fy, c.camera.cx, c.camera.cy, info.calibration_source);
  if (c.distortion.is_zero()) {
    print("distortion   none  (from {})\n", info.calibration_source);
  } else {
    const std::string numbers = fmt::format("{}", fmt::join(c.distortion.written(), " "));
    print("distortion   {} ({}; removed while reading)  (from {})\n", numbers,
          c.distortion.is_fisheye()    ? "fisheye k1 k2 k3 k4"
          : c.distortion.is_rational() ? "k1 k2 p1 p2 k3 k4 k5 k6"
                                       : "k1 k2 p1 p2 k3",
          info.calibration_source);
  }
  if (info.delivered != c.camera) {
    const PinholeCamera& d = info.delivered;
    print("frames as    {}x{}  fx {:.6g} fy {:.6g} cx {:.6g} cy {:.6g}\n", d.width, d.height, d.fx,
          d.fy, d.cx, d.cy);
  }
  const auto from = [](const std::string& source) {
    return source.empty() ? std::string() : fmt::format("  (from {})", source);
  };
  print("depth scale  {} units per metre{}\n", c.depth_scale, from(info.unit_source));
  if (!info.relation_source.empty()) print("extrinsics   {}\n", info.relation_source);
  if (!info.times_source.empty()) print("times        {}\n", info.times_source);
  if (info.depth_delays) {
    const dataset::DepthDelays& d = *info.depth_delays;
    print("depth stamps {:+.1f} to {:+.1f} ms after colour's, {:+.1f} in the median\n",
          1e3 * d.least_s, 1e3 * d.most_s, 1e3 * d.median_s);
  }
  print("ground truth {}\n", info.truth_rows ? fmt::format("{} poses", info.truth_rows) : "none");
  if (const auto file = dataset::accelerometer_file(info.folder); !file.empty()) {
    print("accelerometer {}\n", file.filename().string());
  }
  if (info.sparse)
    print("sparse       single views, too far apart to be tracked: --tracker given\n");
  for (const std::string& warning : info.warnings) print("warning      {}\n", warning);
  return kExitDone;
}

}  // namespace

void add_info(CLI::App& app, Action& action) {
  auto options = std::make_shared<InfoOptions>();
  auto* sub =
      app.add_subcommand("info", "Describe a sequence, a map, the parameters or the scenes");
  add_input_argument(*sub, options->input,
                     "Sequence folder, bag (or the files of one), an Azure Kinect's .mkv, "
                     "synth:NAME[:LEVEL], or a "
                     "map (RUN/map.sgsmap)");
  add_recording_options(*sub, options->input);
  sub->add_option("--preset", options->preset, "default, paper or quality (with --config)");
  sub->add_flag("--config", options->config, "Print the parameters as TOML");
  sub->add_option("--for", options->audience,
                  "With --config: users (what is commonly set), experts (the others) or all");
  sub->add_flag("--markdown", options->markdown,
                "With --config: as a table, as in docs/parameters.md");
  sub->add_flag("--columns", options->columns, "Print what frames.csv holds, as Markdown");
  sub->add_flag("--metrics", options->metrics, "Print what metrics.json holds, as Markdown");
  sub->add_flag("--scenes", options->scenes, "List the synthetic scenes");
  sub->add_flag("--cameras", options->cameras,
                "List the cameras that are plugged in, and what to install for others");
  sub->add_flag("--json", options->json, "Print JSON");
  sub->callback([options, &action] {
    action = [options]() -> int {
      if (options->config) return print_config(*options);
      if (options->columns || options->metrics) {
        print("{}", options->columns ? slam::frame_columns_markdown() : eval::metrics_markdown());
        return kExitDone;
      }
      if (options->scenes) return print_scenes();
      if (options->cameras) return print_cameras(*options);
      if (options->input.input.empty()) {
        return report(
            {ErrorCode::kInvalidArgument, "nothing to describe",
             "give a sequence folder, --cameras, --config, --columns, --metrics or --scenes"});
      }
      if (mapfile::looks_like_map(options->input.input)) {
        return print_map(options->input.input, options->json);
      }
      return print_sequence(*options);
    };
  });
}

}  // namespace sgs::app
