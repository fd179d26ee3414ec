// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// own_tracker SEQUENCE POSES OUTPUT: maps a recorded folder with poses that something else knows (a
// motion capture system, a robot's arm, another SLAM), given as a TUM trajectory.
#include <fmt/format.h>
#include <sgs/input/input.h>
#include <sgs/io/trajectory_io.h>
#include <sgs/run/play.h>
#include <sgs/runfolder/run.h>

namespace {

class KnownPoses : public sgs::tracker::Tracker {
 public:
  explicit KnownPoses(sgs::Trajectory poses) : poses_(std::move(poses)) {}

  sgs::tracker::TrackResult track(const sgs::RgbdFrame& frame, const sgs::history::Revision&,
                                  const sgs::map::SnapshotPtr&) override {
    sgs::tracker::TrackResult result;
    const auto T_odom_camera = poses_.at(frame.timestamp_s, kMaxGap_s);
    if (!T_odom_camera) {
      result.status = sgs::tracker::TrackingStatus::kLost;
      result.lost_reason = sgs::alignment::LostReason::kOther;
    }
    result.T_odom_camera = last_ = T_odom_camera.value_or(last_);
    return result;
  }
  bool follows_map() const override { return false; }

 private:
  static constexpr double kMaxGap_s = 0.1;  // between the two poses around a frame
  sgs::Trajectory poses_;
  sgs::SE3 last_;
};

sgs::Status run(const char* sequence, const char* poses_file, const char* output) {
  const sgs::run::InputSpec spec{.input = sequence};
  SGS_ASSIGN_OR_RETURN(const auto input, sgs::run::open_input(spec, 2));
  SGS_ASSIGN_OR_RETURN(const auto poses, sgs::io::load_trajectory(poses_file));
  SGS_ASSIGN_OR_RETURN(const auto config, sgs::slam::make_session_config("default"));
  SGS_ASSIGN_OR_RETURN(const auto slam,
                       sgs::slam::Session::create(config, input.source->camera(), {},
                                                  std::make_unique<KnownPoses>(poses.trajectory)));
  SGS_RETURN_IF_ERROR(sgs::run::play(*input.source, *slam, {}));
  fmt::print("{} Gaussians\n", slam->snapshot() ? slam->snapshot()->gaussians.size() : 0);
  return sgs::run::save_run(sgs::run::run_of(*slam, input, spec), output);
}

}  // namespace

int main(int argc, char** argv) {
  const sgs::Status status =
      argc == 4 ? run(argv[1], argv[2], argv[3])
                : sgs::fail(sgs::ErrorCode::kInvalidArgument, "own_tracker SEQUENCE POSES OUTPUT");
  if (!status) fmt::print(stderr, "{}\n", status.error().text());
  return status ? 0 : 1;
}
