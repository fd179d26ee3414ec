// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/bags/bag_source.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "sgs/bag/bag.h"
#include "sgs/bag/messages.h"
#include "sgs/bag/pictures.h"
#include "sgs/core/log.h"
#include "sgs/dataset/bags/bag_decoder.h"
#include "sgs/dataset/bags/bag_pairs.h"
#include "sgs/dataset/bags/bag_plan.h"
#include "sgs/dataset/bags/bag_time.h"
#include "sgs/dataset/bags/bag_topics.h"
#include "sgs/dataset/bags/bag_truth.h"
#include "sgs/dataset/frame_fit.h"
#include "sgs/dataset/frame_list.h"
#include "sgs/dataset/prefetch.h"
#include "sgs/dataset/time_unit.h"
#include "sgs/io/calibration_io.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

/// Ground truth is interpolated over at most this, as for sequences of files.
constexpr double kMaxBagTruthGap_s = 0.1;

class BagSource : public FrameSource {
 public:
  BagSource(std::unique_ptr<bag::Bag> bag, BagPlan plan, Trajectory truth)
      : bag_(std::move(bag)),
        plan_(std::move(plan)),
        truth_(std::move(truth)),
        decoder_(*bag_, plan_.topics, plan_.cameras),
        pairs_(pairs_of(*bag_, plan_)) {}

  std::string name() const override { return plan_.name; }
  PinholeCamera camera() const override { return plan_.cameras.color.camera; }
  std::optional<std::int64_t> size() const override { return std::nullopt; }
  const Trajectory& ground_truth() const override { return truth_; }

  FrameRead next(RgbdFrame& frame, Error& error) override {
    while (position_ < plan_.last) {
      BagPairs::Event event = pairs_.next();
      if (event.kind == BagPairs::Event::Kind::kEnd) break;
      if (event.kind == BagPairs::Event::Kind::kBack) {
        log().warn("{}: {}", plan_.name, event.error.message);
        continue;
      }
      if (position_ < plan_.first) {
        ++position_;
        continue;
      }
      frame = RgbdFrame{};
      frame.index = position_++ - plan_.first;
      frame.timestamp_s = seconds_of(event.time_ns);
      tell_gap(frame.timestamp_s);
      frame.depth_delay_s = seconds_of(event.depth_delay_ns);
      frame.camera = camera();
      // Ground truth has the times of the clock before it was set back.
      if (!event.moved) {
        frame.truth_T_world_camera = truth_.at(frame.timestamp_s, kMaxBagTruthGap_s);
      }
      Status status;
      if (event.kind == BagPairs::Event::Kind::kBad) {
        status = tl::unexpected<Error>(std::move(event.error));
      } else {
        status = decoder_.read(event, frame);
      }
      if (status) return FrameRead::kOk;
      error = std::move(status.error());
      return FrameRead::kBadFrame;
    }
    report_leftovers();
    return FrameRead::kEnd;
  }

 private:
  /// Says once where the clock was set ahead.
  void tell_gap(double time_s) {
    const auto before_s = std::exchange(last_time_s_, time_s);
    if (before_s && is_no_pause(time_s - *before_s) && !std::exchange(gap_told_, true)) {
      log().warn("{}: {}", plan_.name, clock_set_ahead(*before_s, time_s));
    }
  }

  void report_leftovers() {
    if (std::exchange(reported_, true)) return;
    const auto say = [&](std::size_t count, const char* what) {
      if (count == 0) return;
      const bool many = 10 * count > static_cast<std::size_t>(position_);
      log().log(many ? spdlog::level::warn : spdlog::level::info, "{}: {} {}", plan_.name, count,
                what);
    };
    say(pairs_.color_without_depth(), "colour images without depth near in time, left out");
    say(pairs_.depth_without_color(), "depth images without colour near in time, left out");
    say(pairs_.depth_running_backwards(), "depth images whose time runs backwards, left out");
  }

  std::unique_ptr<bag::Bag> bag_;
  BagPlan plan_;
  Trajectory truth_;
  BagDecoder decoder_;
  BagPairs pairs_;
  std::int64_t position_ = 0;
  bool reported_ = false;
  std::optional<double> last_time_s_;
  bool gap_told_ = false;
};

/// How many pairs there are at most; 0 = not known.
std::int64_t expected_pairs(const bag::Bag& bag, const BagTopics& topics) {
  const auto color = bag.channels()[topics.color.channel].messages;
  const auto depth = bag.channels()[topics.depth.channel].messages;
  return color && depth ? static_cast<std::int64_t>(std::min(*color, *depth)) : 0;
}

/// What an index and the first images tell: single views, as is_sparse() means it. A clock that
/// jumps makes a recording long, not sparse.
bool few_a_second(const SequenceInfo& info, double median_step_s) {
  constexpr double kGap_s = 0.2;
  return info.frames_in_folder > 1 && median_step_s > kGap_s &&
         info.last_time_s - info.first_time_s > kGap_s * static_cast<double>(info.frames_in_folder);
}

/// What `sgs info` shows of it.
void describe_plan(const bag::Bag& bag, const BagPlan& plan, const OpenOptions& options,
                   SequenceInfo& info) {
  info.layout = bag.format();
  info.name = plan.name;
  info.frames_in_folder = expected_pairs(bag, plan.topics);
  info.color_images =
      static_cast<std::int64_t>(bag.channels()[plan.topics.color.channel].messages.value_or(0));
  info.frames =
      std::clamp<std::int64_t>(info.frames_in_folder - plan.first, 0, plan.last - plan.first);
  info.last_time_s = info.first_time_s;
  if (bag.first_time_ns() && bag.last_time_ns()) {
    info.last_time_s += 1e-9 * static_cast<double>(*bag.last_time_ns() - *bag.first_time_ns());
  }
  info.sparse = few_a_second(info, plan.clock.median_step_s);
  const bool floats = plan.topics.depth.encoding.find("32FC1") != std::string::npos;
  constexpr double kUnitsForFloats = 5000;
  info.calibration = {
      plan.cameras.color.camera, plan.cameras.color.distortion,
      floats && !options.depth_scale ? kUnitsForFloats : plan.cameras.unit.units_per_metre};
  info.calibration_source = plan.cameras.color_source;
  info.unit_source = plan.cameras.unit_source;
  info.relation_source = plan.cameras.relation_source;
  info.color_topic = bag.channels()[plan.topics.color.channel].topic;
  info.depth_topic = bag.channels()[plan.topics.depth.channel].topic;
  for (const auto* warnings : {&plan.clock.warnings, &plan.cameras.warnings}) {
    info.warnings.insert(info.warnings.end(), warnings->begin(), warnings->end());
  }
  if (!options.depth_scale) warn_of_doubtful_unit(plan.median_depth_m, info.warnings);
  warn_of_doubtful_centre(plan.cameras.color.camera, plan.cameras.color_source, info.warnings);
}

Result<Sequence> open_bag_as_sequence(std::unique_ptr<bag::Bag> bag, const fs::path& path,
                                      const OpenOptions& options) {
  Sequence sequence;
  SequenceInfo& info = sequence.info;
  info.folder = path;
  info.more_files = options.more_files;
  info.warnings = bag->warnings();
  SGS_ASSIGN_OR_RETURN(BagPlan plan, plan_bag(*bag, path, options));
  info.first_time_s = plan.first_time_s;
  info.times_source = plan.clock.source;
  SGS_ASSIGN_OR_RETURN(auto truth,
                       read_bag_truth(*bag, options.truth_topic, plan.topics.color.frame_id));
  describe_plan(*bag, plan, options, info);
  SGS_RETURN_IF_ERROR(io::check_calibration(info.calibration, info.calibration_source));
  const PinholeCamera& lens = info.calibration.camera;
  const auto seen = FrameFit(lens, info.calibration.distortion).seen(lens);
  if (auto warning = little_is_seen(seen.get(), info.calibration_source)) {
    info.warnings.push_back(*warning);
  }
  info.truth_rows = truth.poses.size();
  info.warnings.insert(info.warnings.end(), truth.warnings.begin(), truth.warnings.end());
  for (const std::string& warning : info.warnings) log().warn("{}", warning);
  sequence.frames =
      std::make_unique<BagSource>(std::move(bag), std::move(plan), std::move(truth.poses));
  if (options.prefetch > 0) {
    sequence.frames =
        std::make_unique<PrefetchingSource>(std::move(sequence.frames), options.prefetch);
  }
  return sequence;
}

Result<std::unique_ptr<bag::Bag>> open_files(const fs::path& path, const OpenOptions& options) {
  if (options.more_files.empty()) return bag::open_bag(path);
  std::vector<fs::path> files = {path};
  files.insert(files.end(), options.more_files.begin(), options.more_files.end());
  return bag::open_bags(files);
}

}  // namespace

Result<Sequence> open_bag_sequence(const fs::path& path, const OpenOptions& options) {
  SGS_ASSIGN_OR_RETURN(auto bag, open_files(path, options));
  auto sequence = open_bag_as_sequence(std::move(bag), path, options);
  if (!sequence && sequence.error().message.find(path.string()) == std::string::npos) {
    Error error = std::move(sequence.error());
    error.message = fmt::format("{}: {}", path.string(), error.message);
    return tl::unexpected<Error>(std::move(error));
  }
  return sequence;
}

Result<BagDescription> describe_bag(const fs::path& path, const OpenOptions& options) {
  SGS_ASSIGN_OR_RETURN(const auto bag, open_files(path, options));
  return BagDescription{bag->format(), describe_topics(*bag), bag->warnings()};
}

}  // namespace sgs::dataset
