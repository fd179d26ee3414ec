// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// sgs-ros2: what `sgs run --ros2` starts. Publishes the news of a run (sgs/robot/news.h) that come
// by standard input.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cerrno>
#include <csignal>
#include <string_view>

#include "helper_end.h"
#include "ros2/published.h"

namespace {

using namespace sgs;

Status publish_all(const ros2::PublishOptions& options) {
  SGS_ASSIGN_OR_RETURN(const auto publisher, ros2::Publisher::open(options));
  robot::NewsParser parser;
  robot::News news;
  std::array<char, std::size_t{1} << 16> part{};
  ssize_t bytes = 0;
  while ((bytes = ::read(STDIN_FILENO, part.data(), part.size())) > 0 ||
         (bytes < 0 && errno == EINTR)) {
    if (bytes > 0) parser.push({part.data(), static_cast<std::size_t>(bytes)});
    while (true) {
      SGS_ASSIGN_OR_RETURN(const bool there, parser.next(news));
      if (!there) break;
      SGS_RETURN_IF_ERROR(publisher->publish(news));
    }
  }
  publisher->drain();
  return {};
}

}  // namespace

int main(int argc, char** argv) try {
  // Ctrl-C ends the run, and that ends this: its last words are still published.
  std::signal(SIGINT, SIG_IGN);
  CLI::App app{"Publishes a run to ROS 2; started by `sgs run --ros2`"};
  ros2::PublishOptions options;
  app.add_option("--domain", options.domain, "As ROS_DOMAIN_ID, which is the default")
      ->check(CLI::Range(0, 232));
  app.add_option("--camera-frame", options.camera_frame, "Frame of the camera");
  app.add_option("--map-frame", options.map_frame, "Frame of the map");
  app.add_option("--odom-frame", options.odom_frame, "Frame of the odometry");
  app.add_option("--prefix", options.prefix, "Of topics");
  CLI11_PARSE(app, argc, argv);
  return app::end_helper(publish_all(options));
} catch (...) {
  return sgs::app::end_helper(tl::unexpected(sgs::current_error()));
}
