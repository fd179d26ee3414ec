// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/bags/bag_plan.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "sgs/bag/messages.h"
#include "sgs/bag/pictures.h"
#include "sgs/dataset/bags/bag_decoder.h"
#include "sgs/dataset/bags/bag_time.h"
#include "sgs/dataset/frame_fit.h"
#include "sgs/dataset/frame_list.h"
#include "sgs/io/calibration_io.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

/// What a depth camera for rooms can measure; outside, the unit is another one.
constexpr double kNearestMedian_m = 0.05, kFarthestMedian_m = 20;

Status check_unit(const DepthImage& depth, const bag::DepthUnit& unit, const std::string& topic) {
  const double median = median_depth_m(depth);
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
      "the stamps come from different clocks, or the topics were recorded at different times; "
      "`--stamps received` takes the recorder's times for both, --topics "
      "color=/TOPIC,depth=/TOPIC chooses others");
}

/// The size of most pictures among the first ones; 0 x 0 where none can be decoded.
template <class Decode>
ImageSize usual_size(const bag::Bag& bag, std::size_t channel, std::size_t looked, Decode decode) {
  const auto cursor = bag.read({channel});
  std::vector<std::pair<ImageSize, std::size_t>> sizes;
  for (std::size_t i = 0; i < looked; ++i) {
    const auto message = cursor->next();
    if (message && !*message) break;
    if (!message) continue;
    const auto image = decode(**message);
    if (!image) continue;
    const ImageSize size{image->width(), image->height()};
    const auto known = std::find_if(sizes.begin(), sizes.end(),
                                    [&](const auto& counted) { return counted.first == size; });
    if (known != sizes.end()) {
      ++known->second;
    } else {
      sizes.emplace_back(size, 1);
    }
  }
  const auto most = std::max_element(
      sizes.begin(), sizes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == sizes.end() ? ImageSize{} : most->first;
}

/// Fills in the sizes of packed pictures, of which the messages say nothing.
void find_sizes(const bag::Bag& bag, BagTopics& topics) {
  constexpr std::size_t kLooked = 3;
  const BagPictures pictures(bag, topics, {});
  const auto fill = [&](ImageTopic& images, auto decode) {
    if (images.width != 0) return;
    const ImageSize size = usual_size(bag, images.channel, kLooked, decode);
    images.width = size.width;
    images.height = size.height;
  };
  fill(topics.color, [&](const bag::Message& m) { return pictures.color(m); });
  fill(topics.depth, [&](const bag::Message& m) { return pictures.depth(m); });
}

/// Names what messages of images say of their bytes and what is not so. Where the order of bytes
/// that depth is marked with makes noise of it, the other one is taken.
void check_bytes(const bag::Bag& bag, const BagTopics& topics, BagCameras& cameras) {
  for (const ImageTopic* images : {&topics.color, &topics.depth}) {
    if (images->compressed) continue;
    const bag::Channel& about = bag.channels()[images->channel];
    const auto message = first_readable(bag, images->channel, [&](const bag::Message& m) {
      return bag::read_image(m, about.encoding).has_value();
    });
    if (!message) continue;
    const auto image = bag::read_image(*message, about.encoding);
    if (image && bag::row_length_contradicts(*image)) {
      cameras.warnings.push_back(fmt::format(
          "{}: step says rows of {} bytes, the data have {} for each; rows without gaps are taken",
          about.topic, image->step, image->data.size() / image->height));
    }
    if (!image || images != &topics.depth || !bag::byte_order_contradicts(*image)) continue;
    cameras.unit.other_byte_order = true;
    cameras.warnings.push_back(fmt::format(
        "{}: is_bigendian is {}, but depth is smooth only the other way round, which is taken",
        about.topic, image->big_endian ? 1 : 0));
  }
}

/// Judges one pair; `has_depth` says whether it can be judged at all.
Status judge(const bag::Bag& bag, BagPlan& plan, BagDecoder& decoder, const BagPairs::Event& pair,
             bool& has_depth) {
  SGS_ASSIGN_OR_RETURN(const auto seen, decoder.pictures().depth(pair.depth));
  has_depth = median_depth_m(seen) > 0;
  SGS_RETURN_IF_ERROR(
      check_unit(seen, plan.cameras.unit, bag.channels()[plan.topics.depth.channel].topic));
  RgbdFrame frame;
  SGS_RETURN_IF_ERROR(decoder.read(pair, frame));
  if (!has_depth) return {};
  plan.median_depth_m = median_depth_m(frame.depth);
  if (plan.median_depth_m == 0) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("no depth falls into the colour picture (calibration: {}; {})",
                            plan.cameras.color_source, plan.cameras.relation_source),
                "the extrinsics do not fit these cameras; give --extrinsics "
                "tx,ty,tz,qx,qy,qz,qw (depth to colour)");
  }
  return {};
}

/// Decodes frames until one is fit to be judged.
Status probe_bag(const bag::Bag& bag, BagPlan& plan) {
  constexpr int kTries = 50;
  constexpr std::size_t kAlone = 4000;  // two minutes of one camera before the other starts
  BagPairs pairs = pairs_of(bag, plan);
  pairs.give_up_after(kAlone);
  BagDecoder decoder(bag, plan.topics, plan.cameras);
  Error first_error;
  bool usable = false;
  for (int i = 0; i < kTries; ++i) {
    const auto event = pairs.next();
    if (event.kind == BagPairs::Event::Kind::kEnd) break;
    if (event.kind == BagPairs::Event::Kind::kBack) continue;
    if (i == 0) plan.first_time_s = seconds_of(event.time_ns);
    bool has_depth = false;
    const Status judged = event.kind == BagPairs::Event::Kind::kBad
                              ? Status(tl::unexpected<Error>(event.error))
                              : judge(bag, plan, decoder, event, has_depth);
    usable = usable || judged;
    if (judged && has_depth) return {};
    if (judged) continue;  // cameras that warm up deliver empty depth
    // A unit or extrinsics that cannot be right are so for all; one picture may be damaged or odd.
    if (judged.error().code == ErrorCode::kInvalidArgument) return judged;
    if (first_error.message.empty()) first_error = judged.error();
  }
  if (usable) return {};
  if (first_error.message.empty()) return never_together(bag, plan, pairs);
  first_error.message = fmt::format("no frame can be read; the first: {}", first_error.message);
  return tl::unexpected<Error>(std::move(first_error));
}

}  // namespace

BagPairs pairs_of(const bag::Bag& bag, const BagPlan& plan) {
  return {bag, plan.topics.color.channel, plan.topics.depth.channel, plan.clock.clock,
          plan.max_difference_s};
}

Result<BagPlan> plan_bag(const bag::Bag& bag, const fs::path& path, const OpenOptions& options) {
  BagPlan plan;
  plan.name = fs::is_directory(path) ? folder_name(path) : path.stem().string();
  plan.max_difference_s = options.max_time_difference_s;
  plan.first = options.first;
  plan.last = options.last;
  SGS_ASSIGN_OR_RETURN(plan.topics, choose_topics(bag, options.topics));
  find_sizes(bag, plan.topics);
  SGS_ASSIGN_OR_RETURN(plan.cameras, find_bag_cameras(bag, plan.topics, options));
  const auto color_size = [&](const bag::Message& m) {
    return BagPictures(bag, plan.topics, {}).color(m);
  };
  PinholeCamera& camera = plan.cameras.color.camera;
  if (camera.width == 0) {
    constexpr std::size_t kLooked = 20;
    const ImageSize size = usual_size(bag, plan.topics.color.channel, kLooked, color_size);
    camera.width = size.width;
    camera.height = size.height;
  }
  const Calibration whole{camera, plan.cameras.color.distortion, 1};
  SGS_RETURN_IF_ERROR(io::check_calibration(whole, plan.cameras.color_source));
  check_bytes(bag, plan.topics, plan.cameras);
  SGS_ASSIGN_OR_RETURN(plan.clock, choose_clock(bag, plan.topics, options.stamps));
  SGS_RETURN_IF_ERROR(probe_bag(bag, plan));
  return plan;
}

}  // namespace sgs::dataset
