// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/export/convert.h"

#include <algorithm>

#include "sgs/core/log.h"
#include "sgs/dataset/feed_item.h"

namespace sgs::run {
namespace {

constexpr double kLargestRaw = 65534;  // 65535 means "no measurement"

std::int64_t pixels_beyond(const DepthImage& depth, double limit_m) {
  return std::count_if(depth.data(), depth.data() + depth.size(),
                       [&](float z) { return static_cast<double>(z) > limit_m; });
}

}  // namespace

dataset::TumSequenceWriter::Options recording_options(const Input& input) {
  dataset::TumSequenceWriter::Options options;
  options.name = input.info.name;
  const double stored = input.info.calibration.depth_scale;
  if (stored > 0 && !input.calibration) options.depth_scale = stored;
  return options;
}

Result<Conversion> convert(Input& input, const std::filesystem::path& folder, bool jpeg_color,
                           const std::function<void()>& step, const std::stop_token& stop) {
  dataset::FrameSource& source = *input.source;
  auto options = recording_options(input);
  options.jpeg_color = jpeg_color;
  Conversion result;
  result.farthest_m = kLargestRaw / options.depth_scale;
  SGS_ASSIGN_OR_RETURN(
      auto writer, dataset::TumSequenceWriter::create(folder, source.camera(), std::move(options)));
  const std::stop_callback wake(stop, [&] { source.stop(); });
  std::string first_problem;
  while (!stop.stop_requested()) {
    const auto item = dataset::read_item(source);
    if (!item) break;
    if (item->event) {
      log().warn("input: {}", item->bad_reason);
      continue;
    }
    if (item->frame) {
      SGS_RETURN_IF_ERROR(writer.add(*item->frame));
      result.pixels_far += pixels_beyond(item->frame->depth, result.farthest_m);
    } else {
      ++result.bad;
      if (first_problem.empty()) first_problem = item->bad_reason;
      log().warn("frame {} left out: {}", item->index, item->bad_reason);
    }
    if (step) step();
  }
  result.stopped = stop.stop_requested();
  result.frames = static_cast<std::int64_t>(writer.frames());
  if (result.frames == 0 && !result.stopped) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: none of {} frames can be read; the first: {}", input.info.name,
                            result.bad, first_problem));
  }
  // Denser than the frames' own poses, which stand there as long as frames still come.
  if (!source.ground_truth().empty()) {
    SGS_RETURN_IF_ERROR(writer.write_ground_truth(source.ground_truth()));
  }
  return result;
}

}  // namespace sgs::run
