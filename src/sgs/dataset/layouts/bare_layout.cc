// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "sgs/dataset/frame_list.h"
#include "sgs/dataset/pairing.h"
#include "sgs/dataset/time_unit.h"
#include "sgs/io/text.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

constexpr double kBareFps = 30;
constexpr double kMaxPairDifference_s = 0.02;

/// The first folder of these names that has images.
template <std::size_t N>
fs::path folder_with_images(const fs::path& folder, const std::array<const char*, N>& names) {
  for (const char* name : names) {
    const fs::path candidate = entry_of(folder, name);
    if (!image_files(candidate).empty()) return candidate;
  }
  return {};
}

fs::path bare_color(const fs::path& folder) {
  constexpr std::array kNames = {"color",      "colour",    "rgb",         "image",
                                 "images",     "img",       "colors",      "color_images",
                                 "rgb_images", "rgb_image", "color_image", "cam0/data"};
  return folder_with_images(folder, kNames);
}
fs::path bare_depth(const fs::path& folder) {
  constexpr std::array kNames = {"depth",       "depths",        "depth_images",
                                 "depth_image", "aligned_depth", "depth_aligned",
                                 "depth_maps",  "depth_map",     "depth0/data"};
  return folder_with_images(folder, kNames);
}

/// The number that is all of a file's name.
std::optional<double> number_named(const std::string& stem) {
  if (stem.find_first_not_of("0123456789.") != std::string::npos) return std::nullopt;
  return io::parse_double(stem);
}

/// Names that are times: all of both folders, of one unit, and finer than numbers of frames.
std::optional<TimeUnit> named_by_time(const TimedFiles& color, std::size_t color_files,
                                      const TimedFiles& depth, std::size_t depth_files) {
  const bool all = color.files.size() == color_files && depth.files.size() == depth_files;
  if (!all || color_files < 3) return std::nullopt;
  const auto fraction = [](const fs::path& file) {
    return file.stem().string().find('.') != std::string::npos;
  };
  const bool whole = std::none_of(color.files.begin(), color.files.end(), fraction);
  const TimeUnit unit = unit_of_times(color.times_s, whole);
  const bool seconds = unit.name.empty() && !whole && median_step(color.times_s) < 1;
  return unit.known && (seconds || !unit.name.empty()) ? std::optional(unit) : std::nullopt;
}

void in_seconds(TimedFiles& files, const TimeUnit& unit) {
  for (double& time : files.times_s) time /= unit.per_second;
}

}  // namespace

bool looks_like_bare(const fs::path& folder) {
  return !bare_color(folder).empty() && !bare_depth(folder).empty();
}

// Two folders of images and nothing else: how an exporter leaves them. Names are times, numbers, or
// give the order.
Result<FrameList> list_bare(const fs::path& folder) {
  FrameList out;
  out.layout = "two folders";
  out.name = folder_name(folder);
  out.folder = folder;
  const auto color = image_files(bare_color(folder)), depth = image_files(bare_depth(folder));
  auto timed_color = files_by_time(color, number_named);
  auto timed_depth = files_by_time(depth, number_named);
  if (const auto unit = named_by_time(timed_color, color.size(), timed_depth, depth.size())) {
    in_seconds(timed_color, *unit);
    in_seconds(timed_depth, *unit);
    pair_by_time(timed_color, timed_depth, kMaxPairDifference_s, out);
  } else {
    pair_by_number(by_number(color), by_number(depth), kBareFps, out);
    out.warnings.push_back(fmt::format(
        "{}: nothing says how many images a second there are; {:g} are taken, which is a guess; "
        "sequence.fps of an sgs.toml says it",
        folder.string(), kBareFps));
  }
  out.missing_calibration = fmt::format(
      "give --camera fx,fy,cx,cy and --depth-scale S (raw units per metre: 1000 for millimetres); "
      "or write a camera.txt with one line 'fx fy cx cy width height depth_scale' into {}",
      folder.string());
  SGS_RETURN_IF_ERROR(require_frames(
      out, "colour and depth images whose names are equal numbers, or times within 0.02 s"));
  return out;
}

}  // namespace sgs::dataset
