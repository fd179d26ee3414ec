// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// sgs-camera-ros2: what `sgs run camera:ros2` starts.
#include "common/helper_main.h"
#include "ros2_driver.h"

int main(int argc, char** argv) {
  using namespace sgs::cameras;
  auto options = std::make_shared<Ros2Options>();
  const auto add_options = [&](CLI::App& app) {
    CameraTopics& topics = options->topics;
    app.add_option("--color", topics.color, "Topic of colour");
    app.add_option("--depth", topics.depth, "Topic of depth");
    app.add_option("--info", topics.color_info, "Topic of colour's camera info");
    app.add_option("--depth-info", topics.depth_info, "Topic of depth's camera info");
    app.add_option("--imu-topic", topics.imu, "Topic of inertial samples");
    app.add_option("--domain", options->domain, "As ROS_DOMAIN_ID, which is the default")
        ->check(CLI::Range(0, 232));
    app.add_option("--registered", options->registered, "Depth lies on colour, whatever it says")
        ->check(CLI::IsMember({"on", "off"}));
    app.add_option("--wait", options->wait_s, "For publishers, seconds")
        ->check(CLI::Range(0.0, 25.0));
    app.get_option("--skip")->default_val(0);  // what is published has settled
  };
  return helper_main(argc, argv, "Frames that nodes of ROS 2 publish, for `sgs run live:-`",
                     make_ros2_driver(options), add_options);
}
