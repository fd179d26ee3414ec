// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_link.h"

#include <fmt/format.h>

#include <cstdio>
#include <thread>
#include <utility>
#include <vector>

#include "helper_program.h"
#include "sgs/core/bounded_queue.h"
#include "sgs/core/log.h"
#include "sgs/export/scene_export.h"
#include "sgs/input/inertial.h"
#include "sgs/robot/live_grid.h"
#include "sgs/robot/news.h"
#include "sgs/robot/smooth_odometry.h"
#include "sgs/upright/gravity.h"
#include "sgs/upright/upright.h"

namespace sgs::app {
namespace {

/// What a frame came to, for the thread that tells it.
struct Told {
  std::shared_ptr<const RgbdFrame> frame;  ///< null: the run is over
  double timestamp_s = 0;
  bool tracked = false;
  history::Path path;
  map::SnapshotPtr map = {};  ///< where it is due
  bool last = false;
};

/// Which way is up in the run's world, and whether somebody knows it.
struct Up {
  SE3 T_upright_world;
  bool known = false;
};

/// Makes news of what is told, and hands them on. One thread.
class Teller {
 public:
  explicit Teller(HelperProgram program) : program_(std::move(program)) {}

  void set_up(const Up& up) {
    T_up_ = up.T_upright_world;
    if (up.known) grid_.emplace(robot::GridOptions{}, T_up_);
  }

  void tell(const Told& told) {
    if (told.tracked) tell_pose(told);
    if (!told.tracked && !told.last) odometry_.lose();
    const bool due = told.last || told.timestamp_s - path_s_ >= kEvery_s;
    if (due && !told.path.empty()) tell_path(told);
    if (told.map) tell_cloud(told);
  }

  /// Why the program ended, where it did so by itself.
  Status finish() { return program_.finish(); }

 private:
  static constexpr double kEvery_s = 1;

  void send(const robot::News& news) {
    if (gone_) return;
    const std::string bytes = robot::encode(news);
    gone_ = !program_.feed(std::as_bytes(std::span(bytes)));
    if (gone_) log().warn("nothing is published any more: the program that did it has ended");
  }

  void tell_pose(const Told& told) {
    robot::PoseNews news{told.timestamp_s, odometry_.step(told.path, told.frame->index)};
    robot::Standing& standing = news.standing;
    standing.T_odom_camera = T_up_ * standing.T_odom_camera;
    standing.T_map_odom = T_up_ * standing.T_map_odom * T_up_.inverse();
    send(news);
    if (grid_) grid_->see(*told.frame, told.path);
  }

  void tell_path(const Told& told) {
    path_s_ = told.timestamp_s;
    std::vector<StampedPose> poses;
    for (std::size_t k = 0; k < told.path.size(); ++k) {
      const auto& entry = told.path[k];
      if (entry.frame >= 0) poses.push_back({entry.timestamp_s, T_up_ * entry.T_odom_camera});
    }
    send(robot::PathNews{told.timestamp_s, Trajectory(std::move(poses))});
    if (!grid_) return;
    auto grid = told.last ? grid_->whole_grid(told.path) : grid_->grid(told.path);
    if (grid) {
      send(robot::GridNews{told.timestamp_s, std::move(*grid)});
    }
  }

  void tell_cloud(const Told& told) {
    // limit: points of the cloud that --ros1 and --ros2 publish; of more, every so many
    constexpr std::size_t kMostPublished = 300'000;
    const auto all = run::to_points(told.map->gaussians);
    const std::size_t step = 1 + all.size() / kMostPublished;
    robot::CloudNews news{told.timestamp_s, {}};
    for (std::size_t i = 0; i < all.size(); i += step) {
      news.points.push_back(all[i]);
      news.points.back().position = (T_up_ * all[i].position.cast<double>()).cast<float>();
    }
    send(news);
  }

  HelperProgram program_;
  bool gone_ = false;
  SE3 T_up_;
  robot::SmoothOdometry odometry_;
  std::optional<robot::LiveGrid> grid_;
  double path_s_ = -1e300;
};

class Telling final : public RobotLink {
 public:
  Telling(HelperProgram program, const run::Input& input, std::optional<Eigen::Vector3d> up,
          bool at_camera_rate)
      : input_(input),
        asked_up_(std::move(up)),
        teller_(std::move(program)),
        told_(kMostWaiting, at_camera_rate ? FullPolicy::kDropOldest : FullPolicy::kBlock),
        thread_([this] { work(); }) {}

  ~Telling() override {
    told_.close();
    if (thread_.joinable()) thread_.join();
  }

  void after_frame(slam::Session& session, const dataset::FeedItem& item,
                   const slam::FrameRecord& record) override {
    if (!item.frame) return;
    Told told{item.frame, item.timestamp_s,
              record.status != tracker::TrackingStatus::kLost && session.has_place(),
              session.revision().path};
    told.tracked = told.tracked && told.path.contains(item.frame->index);
    if (!decided_ && !(told.tracked && decide_up(told))) return;
    constexpr double kMapEvery_s = 2;
    if (item.timestamp_s - map_s_ >= kMapEvery_s) {
      map_s_ = item.timestamp_s;
      told.map = session.snapshot();
    }
    last_s_ = item.timestamp_s;
    told_.push(std::move(told));
  }

  void finish(slam::Session& session) override {
    if (decided_) {
      told_.push(
          {nullptr, last_s_, false, session.revision().path, session.final_snapshot(), true});
    }
    told_.close();
    thread_.join();
    if (told_.dropped() > 0) {
      log().warn("{} frames were not published: the program that does it is too slow",
                 told_.dropped());
    }
    if (const Status ended = teller_.finish(); !ended) log().warn("{}", ended.error().text());
  }

 private:
  static constexpr std::size_t kMostWaiting = 64;

  /// Up is known by what was asked for or is felt, else the first picture is taken for a level one.
  /// Samples may come a little later than the first frames: false then.
  bool decide_up(const Told& told) {
    const SE3& pose = told.path.at(told.frame->index);
    constexpr int kPatience = 10;  // frames
    Up up;
    Eigen::Vector3d up_in_camera = -Eigen::Vector3d::UnitY();
    if (asked_up_) {
      up_in_camera = *asked_up_;
      up.known = true;
    } else {
      // Of a recording all is there at once, and reading it takes long.
      if (!imu_ || input_.source->live()) imu_ = run::read_imu(input_);
      const auto felt = run::felt_up(*imu_, told.timestamp_s);
      if (!felt && imu_->R_camera_imu && ++tries_ < kPatience) return false;
      imu_.reset();
      constexpr double kUpsideDown = 0.5;
      up.known = felt && felt->y() < kUpsideDown;
      if (up.known) up_in_camera = *felt;
    }
    if (!up.known) {
      log().warn(
          "which way is up is not known: the first picture is taken for a level one, and no "
          "free floor is published; say it by --ros1-up or --ros2-up X,Y,Z");
    }
    up.T_upright_world = run::upright_turn(pose.R * up_in_camera, pose.R);
    teller_.set_up(up);  // before the thread is told anything
    decided_ = true;
    return true;
  }

  void work() {
    try {
      while (auto told = told_.pop()) teller_.tell(*told);
    } catch (const std::exception& error) {
      log().warn("nothing is published any more: {}", error.what());
      told_.close();
    }
  }

  const run::Input& input_;
  std::optional<Eigen::Vector3d> asked_up_;
  std::optional<dataset::ImuRecording> imu_;
  Teller teller_;
  BoundedQueue<Told> told_;
  std::thread thread_;
  bool decided_ = false;
  int tries_ = 0;
  double map_s_ = -1e300, last_s_ = 0;
};

Result<std::optional<Eigen::Vector3d>> direction_of(const std::string& text) {
  if (text.empty()) return std::optional<Eigen::Vector3d>();
  Eigen::Vector3d up;
  int end = 0;
  const int read = std::sscanf(text.c_str(), "%lf,%lf,%lf%n", &up.x(), &up.y(), &up.z(), &end);
  if (read != 3 || static_cast<std::size_t>(end) != text.size() || !up.allFinite() ||
      !(up.norm() > 0)) {
    return fail(
        ErrorCode::kInvalidArgument, fmt::format("--ros1-up or --ros2-up {}: no direction", text),
        "three numbers that are not all zero, in the axes of the camera (x right, y down, z "
        "forward), for example 0,-1,0 if the first picture is level");
  }
  return std::optional(up.normalized().eval());
}

HelperProgram::Kind program_of(const RobotRequest& request) {
  if (request.ros1) {
    return {"sgs-ros1", "messages of ROS 1", "install the package sgs-ros1 (docs/ros.md)",
            "please report it"};
  }
  return {"sgs-ros2", "messages of ROS 2",
          "install the package sgs-ros2, or build it: it needs cyclonedds-dev and "
          "cyclonedds-tools (docs/ros.md)",
          "please report it"};
}

}  // namespace

void RobotRequest::add_run_options(CLI::App& sub) {
  CLI::Option* first = nullptr;
  for (const std::string version : {"1", "2"}) {
    const std::string name = "--ros" + version;
    auto* flag = sub.add_flag(name, version == "1" ? ros1 : ros2,
                              "Publish odometry, tf, path, points and free floor to ROS " +
                                  version + " while the run goes on (docs/ros.md)");
    if (first == nullptr) {
      first = flag;
    } else {
      flag->excludes(first);
    }
    sub.add_option(name + "-camera-frame", camera_frame,
                   "Frame of the camera in tf (default sgs_camera_optical_frame)")
        ->needs(flag);
    sub.add_option(name + "-up", up,
                   "Where up is when the run begins, X,Y,Z in the axes of the camera (x right, y "
                   "down, z forward), instead of what an accelerometer feels")
        ->needs(flag);
    if (version == "1") continue;
    sub.add_option(name + "-domain", domain, "As ROS_DOMAIN_ID, which is the default")
        ->check(CLI::Range(0, 232))
        ->needs(flag);
  }
}

Result<std::unique_ptr<RobotLink>> RobotLink::open(const RobotRequest& request,
                                                   const run::Input& input, bool at_camera_rate) {
  if (!request.ros1 && !request.ros2) return nullptr;
  SGS_ASSIGN_OR_RETURN(auto up, direction_of(request.up));
  std::vector<std::string> arguments;
  if (request.domain) arguments.push_back(fmt::format("--domain={}", *request.domain));
  if (!request.camera_frame.empty()) {
    arguments.push_back("--camera-frame=" + request.camera_frame);
  }
  SGS_ASSIGN_OR_RETURN(auto program, HelperProgram::start(program_of(request), arguments));
  return std::make_unique<Telling>(std::move(program), input, up, at_camera_rate);
}

}  // namespace sgs::app
