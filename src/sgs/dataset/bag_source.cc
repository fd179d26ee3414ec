// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/bag_source.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "sgs/bag/bag.h"
#include "sgs/bag/messages.h"
#include "sgs/bag/pictures.h"
#include "sgs/camera/pair_rectifier.h"
#include "sgs/core/log.h"
#include "sgs/dataset/bag_cameras.h"
#include "sgs/dataset/bag_pairs.h"
#include "sgs/dataset/bag_time.h"
#include "sgs/dataset/bag_topics.h"
#include "sgs/dataset/bag_truth.h"
#include "sgs/dataset/frame_fit.h"
#include "sgs/dataset/frame_list.h"
#include "sgs/dataset/prefetch.h"
#include "sgs/io/calibration_io.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

/// Ground truth is interpolated over at most this, as for sequences of files.
constexpr double kMaxBagTruthGap_s = 0.1;
/// What a depth camera for rooms can measure; outside, the unit is another one.
constexpr float kNearestMedian_m = 0.05f, kFarthestMedian_m = 20.0f;

/// Turns a pair of messages into a frame.
class BagDecoder {
 public:
  BagDecoder(const bag::Bag& bag, const BagTopics& topics, const BagCameras& cameras)
      : topics_(topics),
        unit_(cameras.unit),
        color_encoding_(bag.channels()[topics.color.channel].encoding),
        depth_encoding_(bag.channels()[topics.depth.channel].encoding),
        rectifier_(cameras.color, cameras.depth, cameras.T_color_depth) {}

  Result<ColorImage> color(const bag::Message& message) const {
    if (topics_.color.compressed) {
      SGS_ASSIGN_OR_RETURN(const auto image, bag::read_compressed_image(message, color_encoding_));
      return bag::decode_color(image);
    }
    SGS_ASSIGN_OR_RETURN(const auto image, bag::read_image(message, color_encoding_));
    return bag::decode_color(image);
  }
  Result<DepthImage> depth(const bag::Message& message) const {
    if (topics_.depth.compressed) {
      SGS_ASSIGN_OR_RETURN(const auto image, bag::read_compressed_image(message, depth_encoding_));
      return bag::decode_depth(image, unit_);
    }
    SGS_ASSIGN_OR_RETURN(const auto image, bag::read_image(message, depth_encoding_));
    return bag::decode_depth(image, unit_);
  }

  /// Undistorted colour and depth in the colour camera.
  Status read(const BagPairs::Event& pair, RgbdFrame& frame) {
    SGS_ASSIGN_OR_RETURN(ColorImage color_seen, color(pair.color));
    SGS_ASSIGN_OR_RETURN(DepthImage depth_seen, depth(pair.depth));
    SGS_RETURN_IF_ERROR(check(color_seen, rectifier_.color_camera(), "colour"));
    SGS_RETURN_IF_ERROR(check(depth_seen, rectifier_.depth_camera(), "depth"));
    rectifier_.rectify(std::move(color_seen), std::move(depth_seen), frame);
    return {};
  }

 private:
  template <class T>
  static Status check(const Image<T>& image, const PinholeCamera& camera, const char* what) {
    if (image.width() == camera.width && image.height() == camera.height) return {};
    return fail(ErrorCode::kUnsupported,
                fmt::format("{} is {}x{} but its calibration is for {}x{}", what, image.width(),
                            image.height(), camera.width, camera.height),
                "give the calibration of images of this size: --camera, or --topics "
                "color_info=/TOPIC,depth_info=/TOPIC");
  }

  BagTopics topics_;
  bag::DepthUnit unit_;
  bag::Encoding color_encoding_, depth_encoding_;
  PairRectifier rectifier_;
};

/// Everything that was found out about a bag.
struct BagPlan {
  std::string name;
  BagTopics topics;
  BagCameras cameras;
  BagClock clock = BagClock::kStamp;
  double max_difference_s = 0;
  std::int64_t first = 0, last = 0;
};

BagPairs pairs_of(const bag::Bag& bag, const BagPlan& plan) {
  return {bag, plan.topics.color.channel, plan.topics.depth.channel, plan.clock,
          plan.max_difference_s};
}

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
    for (; position_ < plan_.last; ++position_) {
      BagPairs::Event event = pairs_.next();
      if (event.kind == BagPairs::Event::Kind::kEnd) break;
      if (position_ < plan_.first) continue;
      frame = RgbdFrame{};
      frame.index = position_++ - plan_.first;
      frame.timestamp_s = seconds_of(event.time_ns);
      frame.depth_delay_s = seconds_of(event.depth_delay_ns);
      frame.camera = camera();
      frame.truth_T_world_camera = truth_.at(frame.timestamp_s, kMaxBagTruthGap_s);
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
  void report_leftovers() {
    if (std::exchange(reported_, true)) return;
    const auto say = [&](std::size_t count, const char* what) {
      if (count > 0) log().info("{}: {} {}", plan_.name, count, what);
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
};

/// Stamps are the cameras' own; some drivers leave them at zero.
BagClock choose_clock(const BagTopics& topics, std::vector<std::string>& warnings) {
  if (topics.color.stamp_ns != 0 && topics.depth.stamp_ns != 0) return BagClock::kStamp;
  warnings.push_back(
      fmt::format("the {} images have no time stamps; the times of recording are "
                  "taken, which are less exact",
                  topics.color.stamp_ns == 0 ? "colour" : "depth"));
  return BagClock::kRecord;
}

float median_of(const DepthImage& depth) {
  std::vector<float> values;
  std::copy_if(depth.data(), depth.data() + depth.size(), std::back_inserter(values),
               [](float z) { return z > 0; });
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Status check_unit(const DepthImage& depth, const bag::DepthUnit& unit, const std::string& topic) {
  const float median = median_of(depth);
  if (median == 0 || (median >= kNearestMedian_m && median <= kFarthestMedian_m)) return {};
  return fail(
      ErrorCode::kInvalidArgument,
      fmt::format("{}: the median depth would be {:.4g} m, so its unit is not what was assumed "
                  "({} per metre for integers, metres for floats)",
                  topic, median, unit.units_per_metre),
      "give --depth-scale S, raw units per metre (1000 for millimetres, 10000 for tenths of them)");
}

tl::unexpected<Error> never_together(const bag::Bag& bag, const BagPlan& plan,
                                     const BagPairs& pairs) {
  const auto& channels = bag.channels();
  const std::string nearest = pairs.nearest_ns()
                                  ? fmt::format("the nearest are {:.3f} s apart",
                                                1e-9 * static_cast<double>(*pairs.nearest_ns()))
                                  : std::string("one of them has no images");
  return fail(
      ErrorCode::kInvalidFormat,
      fmt::format("{} and {}: no colour and depth image within {} s of each other; {}",
                  channels[plan.topics.color.channel].topic,
                  channels[plan.topics.depth.channel].topic, plan.max_difference_s, nearest),
      "the topics were recorded at different times or their stamps come from different "
      "clocks; choose others with --topics color=/TOPIC,depth=/TOPIC");
}

/// Decodes frames until one is fit to be judged. Sizes that --camera leaves open are filled in.
Status probe_bag(const bag::Bag& bag, BagPlan& plan, double& first_time_s) {
  constexpr int kTries = 50;
  constexpr std::size_t kAlone = 4000;  // two minutes of one camera before the other starts
  BagPairs pairs = pairs_of(bag, plan);
  pairs.give_up_after(kAlone);
  Error first_error;
  bool usable = false;
  for (int i = 0; i < kTries; ++i) {
    const auto event = pairs.next();
    if (event.kind == BagPairs::Event::Kind::kEnd) break;
    if (i == 0) first_time_s = seconds_of(event.time_ns);
    bool has_depth = false;
    const auto judged = [&]() -> Status {
      if (event.kind == BagPairs::Event::Kind::kBad) return tl::unexpected<Error>(event.error);
      PinholeCamera& camera = plan.cameras.color.camera;
      if (camera.width == 0) {
        BagCameras some = plan.cameras;
        some.color.camera = {8, 8, 1, 1, 0, 0};
        SGS_ASSIGN_OR_RETURN(const auto color,
                             BagDecoder(bag, plan.topics, some).color(event.color));
        camera.width = color.width();
        camera.height = color.height();
      }
      BagDecoder decoder(bag, plan.topics, plan.cameras);
      SGS_ASSIGN_OR_RETURN(const auto seen, decoder.depth(event.depth));
      has_depth = median_of(seen) > 0;
      SGS_RETURN_IF_ERROR(
          check_unit(seen, plan.cameras.unit, bag.channels()[plan.topics.depth.channel].topic));
      RgbdFrame frame;
      SGS_RETURN_IF_ERROR(decoder.read(event, frame));
      if (has_depth && median_of(frame.depth) == 0) {
        return fail(ErrorCode::kInvalidArgument,
                    fmt::format("no depth falls into the colour picture (calibration: {})",
                                plan.cameras.source),
                    "the extrinsics do not fit these cameras; give --extrinsics "
                    "tx,ty,tz,qx,qy,qz,qw (depth to colour)");
      }
      return {};
    }();
    usable = usable || judged;
    if (judged && has_depth) return {};
    if (judged) continue;  // cameras that warm up deliver empty depth
    // Damage passes; what the whole recording has in common does not.
    if (judged.error().code != ErrorCode::kInvalidFormat) return judged;
    if (first_error.message.empty()) first_error = judged.error();
  }
  if (usable) return {};
  if (first_error.message.empty()) return never_together(bag, plan, pairs);
  first_error.message = fmt::format("no frame can be read; the first: {}", first_error.message);
  return tl::unexpected<Error>(std::move(first_error));
}

/// How many pairs there are at most; 0 = not known.
std::int64_t expected_pairs(const bag::Bag& bag, const BagTopics& topics) {
  const auto color = bag.channels()[topics.color.channel].messages;
  const auto depth = bag.channels()[topics.depth.channel].messages;
  return color && depth ? static_cast<std::int64_t>(std::min(*color, *depth)) : 0;
}

/// What an index tells: single views, as is_sparse() means it.
bool few_a_second(const SequenceInfo& info) {
  constexpr double kGap_s = 0.2;
  return info.frames_in_folder > 1 &&
         info.last_time_s - info.first_time_s > kGap_s * static_cast<double>(info.frames_in_folder);
}

Result<Sequence> open_bag_as_sequence(std::unique_ptr<bag::Bag> bag, const fs::path& path,
                                      const OpenOptions& options) {
  BagPlan plan;
  plan.name = fs::is_directory(path) ? folder_name(path) : path.stem().string();
  plan.max_difference_s = options.max_time_difference_s;
  plan.first = options.first;
  plan.last = options.last;
  Sequence sequence;
  SequenceInfo& info = sequence.info;
  info.warnings = bag->warnings();
  SGS_ASSIGN_OR_RETURN(plan.topics, choose_topics(*bag, options.topics));
  SGS_ASSIGN_OR_RETURN(plan.cameras, find_bag_cameras(*bag, plan.topics, options));
  plan.clock = choose_clock(plan.topics, info.warnings);
  SGS_RETURN_IF_ERROR(probe_bag(*bag, plan, info.first_time_s));
  SGS_ASSIGN_OR_RETURN(auto truth,
                       read_bag_truth(*bag, options.truth_topic, plan.topics.color.frame_id));
  info.layout = bag->format();
  info.name = plan.name;
  info.folder = path;
  info.frames_in_folder = expected_pairs(*bag, plan.topics);
  info.frames =
      std::clamp<std::int64_t>(info.frames_in_folder - plan.first, 0, plan.last - plan.first);
  info.last_time_s = info.first_time_s;
  if (bag->first_time_ns() && bag->last_time_ns()) {
    info.last_time_s += 1e-9 * static_cast<double>(*bag->last_time_ns() - *bag->first_time_ns());
  }
  info.sparse = few_a_second(info);
  const bool floats = plan.topics.depth.encoding.find("32FC1") != std::string::npos;
  constexpr double kUnitsForFloats = 5000;
  info.calibration = {
      plan.cameras.color.camera, plan.cameras.color.distortion,
      floats && !options.depth_scale ? kUnitsForFloats : plan.cameras.unit.units_per_metre};
  info.calibration_source = plan.cameras.source;
  SGS_RETURN_IF_ERROR(io::check_calibration(info.calibration, info.calibration_source));
  const PinholeCamera& lens = info.calibration.camera;
  const auto seen = FrameFit(lens, info.calibration.distortion).seen(lens);
  if (auto warning = little_is_seen(seen.get(), info.calibration_source)) {
    info.warnings.push_back(*warning);
  }
  info.truth_rows = truth.size();
  info.color_topic = bag->channels()[plan.topics.color.channel].topic;
  info.depth_topic = bag->channels()[plan.topics.depth.channel].topic;
  info.warnings.insert(info.warnings.end(), plan.cameras.warnings.begin(),
                       plan.cameras.warnings.end());
  for (const std::string& warning : info.warnings) log().warn("{}", warning);
  sequence.frames = std::make_unique<BagSource>(std::move(bag), std::move(plan), std::move(truth));
  if (options.prefetch > 0) {
    sequence.frames =
        std::make_unique<PrefetchingSource>(std::move(sequence.frames), options.prefetch);
  }
  return sequence;
}

}  // namespace

Result<Sequence> open_bag_sequence(const fs::path& path, const OpenOptions& options) {
  SGS_ASSIGN_OR_RETURN(auto bag, bag::open_bag(path));
  auto sequence = open_bag_as_sequence(std::move(bag), path, options);
  if (!sequence && sequence.error().message.find(path.string()) == std::string::npos) {
    Error error = std::move(sequence.error());
    error.message = fmt::format("{}: {}", path.string(), error.message);
    return tl::unexpected<Error>(std::move(error));
  }
  return sequence;
}

Result<BagDescription> describe_bag(const fs::path& path) {
  SGS_ASSIGN_OR_RETURN(const auto bag, bag::open_bag(path));
  return BagDescription{bag->format(), describe_topics(*bag), bag->warnings()};
}

}  // namespace sgs::dataset
