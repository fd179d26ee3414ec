// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// How soon a camera that was carried off, or blinded for two seconds, is found again in a place
// that it knows: one row per recording and kind.
//     sgs_relocalisation_benchmark [--trials N] [--set key=value] INPUT...
// INPUT may be synth:NAME:LEVEL@SEED. The whole recording is tracked first; then the camera is put
// at places of it, drawn by seed, and followed for two seconds each. Right is where the tracked way
// had it, or where the truth puts it next to any part of that way: ways drift, and what is seen on
// two visits lies at two places.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <vector>

#include "sgs/core/log.h"
#include "sgs/core/random.h"
#include "sgs/dataset/feed_item.h"
#include "sgs/geometry/trajectory.h"
#include "sgs/tracker/odometry.h"
#include "tracking_input.h"

namespace {

using namespace sgs;

constexpr int kFollowed = 60;  // frames after each trial
constexpr int kBlind = 60;     // black frames before it
constexpr double kSoon_s = 0.5;
constexpr std::size_t kEvery = 10;  // frames whose surroundings a place is compared in
constexpr double kRight_m = 0.05;

struct Outcome {
  int trials = 0, soon = 0, late = 0, wrong = 0;
};

/// A recording that was tracked from end to end.
class Known {
 public:
  Known(std::vector<std::shared_ptr<const RgbdFrame>> frames,
        std::unique_ptr<tracker::Tracker> tracker)
      : frames_(std::move(frames)), odometry_(std::move(tracker)) {
    for (const auto& frame : frames_) {
      clock_s_ = frame->timestamp_s;
      index_ = frame->index;
      poses_.push_back(odometry_.track(*frame, nullptr).T_odom_camera);
    }
  }

  Outcome try_it(int trials, bool blind) {
    SplitMix64 random(blind ? 2 : 1);
    Outcome out;
    for (; out.trials < trials; ++out.trials) {
      const auto places = static_cast<double>(frames_.size() - kFollowed);
      follow(static_cast<std::size_t>(random.uniform() * places), blind, out);
    }
    return out;
  }

 private:
  bool is_right(std::size_t k, const SE3& T_world_camera) const {
    const auto near = [&](const SE3& T) { return (T_world_camera.t - T.t).norm() <= kRight_m; };
    if (near(poses_[k])) return true;
    const auto& truth = frames_[k]->truth_T_world_camera;
    if (!truth) return false;
    for (std::size_t j = 0; j < frames_.size(); j += kEvery) {
      const auto& truth_then = frames_[j]->truth_T_world_camera;
      if (truth_then && near(poses_[j] * truth_then->inverse() * *truth)) return true;
    }
    return false;
  }
  // The recording goes on from frame `first`.
  void follow(std::size_t first, bool blind, Outcome& out) {
    if (blind) {
      RgbdFrame black = *frames_[first];
      black.color = ColorImage(black.color.width(), black.color.height());
      black.depth = DepthImage(black.depth.width(), black.depth.height());
      for (int k = 0; k < kBlind; ++k) track(black);
    }
    double since_s = clock_s_;
    bool found = false;
    for (std::size_t k = first; k < first + kFollowed; ++k) {
      const auto result = track(*frames_[k]);
      if (result.status == tracker::TrackingStatus::kLost) continue;
      if (!is_right(k, result.T_odom_camera)) {
        ++out.wrong;
        return;
      }
      if (!found) ++(clock_s_ - since_s <= kSoon_s ? out.soon : out.late);
      found = true;
    }
  }
  tracker::TrackResult track(const RgbdFrame& frame) {
    RgbdFrame now = frame;
    now.timestamp_s = clock_s_ += 1.0 / 30;
    now.index = ++index_;
    return odometry_.track(now, nullptr);
  }

  std::vector<std::shared_ptr<const RgbdFrame>> frames_;
  tracker::Odometry odometry_;
  std::int64_t index_ = 0;
  std::vector<SE3> poses_;
  double clock_s_ = 0;
};

Status judge(const std::string& name, const slam::SessionConfig& config, int trials) {
  SGS_ASSIGN_OR_RETURN(auto input, run::open_input(benchmarks::input_of(name), 2));
  SGS_ASSIGN_OR_RETURN(auto tracker,
                       tracker::make_tracker(config.tracker, input.source->camera(), SE3{}));
  std::vector<std::shared_ptr<const RgbdFrame>> frames;
  while (auto item = dataset::read_item(*input.source)) {
    if (item->frame) frames.push_back(item->frame);
  }
  if (frames.size() <= kFollowed) {
    return fail(ErrorCode::kInvalidArgument, "the recording is too short", "take a longer one");
  }
  Known known(std::move(frames), std::move(tracker));
  for (const bool blind : {false, true}) {
    const Outcome o = known.try_it(trials, blind);
    fmt::print("| {} | {} | {} | {} | {} | {} | {} |\n", benchmarks::short_name(name),
               blind ? "blinded" : "carried off", o.trials, o.soon, o.late, o.wrong,
               o.trials - o.soon - o.late);
    std::fflush(stdout);
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Being found again");
  std::vector<std::string> inputs, assignments;
  int trials = 20;
  app.add_option("INPUT", inputs)->required();
  app.add_option("--trials", trials, "of each kind")->check(CLI::PositiveNumber);
  app.add_option("--set", assignments, "key=value")->take_all()->allow_extra_args(false);
  CLI11_PARSE(app, argc, argv);
  log().set_level(spdlog::level::warn);
  const std::string header = fmt::format(
      "| recording | the camera was | trials | found in {} s | later | wrongly (> {} m) | never |\n"
      "|---|---|---|---|---|---|---|\n",
      kSoon_s, kRight_m);
  return benchmarks::print_table(header, inputs, assignments,
                                 [&](const std::string& name, const slam::SessionConfig& config) {
                                   return judge(name, config, trials);
                                 });
}
