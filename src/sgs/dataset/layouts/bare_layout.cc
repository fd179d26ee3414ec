// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>

#include "sgs/dataset/calendar_time.h"
#include "sgs/dataset/frame_list.h"
#include "sgs/dataset/pairing.h"
#include "sgs/dataset/time_unit.h"
#include "sgs/io/text.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

constexpr double kBareFps = 30;
constexpr double kMaxPairDifference_s = 0.02;

/// The first folder of these names that has images, or the folder of its own name within it, as
/// archives have one that are unpacked beside each other.
template <std::size_t N>
fs::path folder_with_images(const fs::path& folder, const std::array<const char*, N>& names) {
  for (const char* name : names) {
    const fs::path candidate = entry_of(folder, name);
    for (const fs::path& tried : {candidate, candidate / candidate.filename()}) {
      if (!image_files(tried).empty()) return tried;
    }
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
  // What is aligned to colour comes first.
  constexpr std::array kNames = {"aligned_depth",    "depth_aligned", "aligned_depth_to_color",
                                 "depth_registered", "depth",         "depths",
                                 "depth_images",     "depth_image",   "depth_maps",
                                 "depth_map",        "depth0/data"};
  return folder_with_images(folder, kNames);
}

bool only_of(std::string_view text, std::string_view characters) {
  return !text.empty() && text.find_first_not_of(characters) == std::string_view::npos;
}

/// The time that a file is named by: a number, behind a word perhaps ("rgb_12.033"); a long one
/// behind a count ("frame_7_1700000000033"); seconds and what is below them
/// ("1700000000_033000000"); or a date.
std::optional<double> time_named(const std::string& stem) {
  constexpr std::string_view kDigits = "0123456789", kNumber = "0123456789.";
  constexpr std::size_t kTimeDigits = 10;  // of seconds since 1970: more than counts have
  if (only_of(stem, kNumber)) return io::parse_double(stem);
  if (const auto time_s = calendar_seconds(stem)) return time_s;
  const auto at = stem.find_last_of("_-");
  if (at == std::string::npos) return std::nullopt;
  const std::string_view front = std::string_view(stem).substr(0, at);
  const std::string_view last = std::string_view(stem).substr(at + 1);
  const std::string_view before = front.substr(front.find_last_of("_-") + 1);  // npos + 1 == 0
  const bool below = last.size() == 3 || last.size() == 6 || last.size() == 9;
  if (below && only_of(last, kDigits) && only_of(before, kDigits) && before.size() >= kTimeDigits) {
    return io::parse_double(fmt::format("{}.{}", before, last));
  }
  if (!only_of(last, kNumber)) return std::nullopt;
  const bool word = front.find_first_of(kDigits) == std::string_view::npos;
  const std::size_t whole_digits = std::min(last.find('.'), last.size());
  const bool time = (word && whole_digits < last.size()) || whole_digits >= kTimeDigits;
  return time ? io::parse_double(last) : std::nullopt;
}

/// Names that are times: all of both folders, of one unit, and finer than numbers of frames.
std::optional<TimeUnit> named_by_time(const TimedFiles& color, std::size_t color_files,
                                      const TimedFiles& depth, std::size_t depth_files) {
  const bool all = color.files.size() == color_files && depth.files.size() == depth_files;
  if (!all || color_files < 3) return std::nullopt;
  const bool whole = std::all_of(color.times_s.begin(), color.times_s.end(),
                                 [](double time) { return time == std::floor(time); });
  const TimeUnit unit = unit_of_times(color.times_s, whole);
  const bool seconds = unit.name.empty() && !whole && median_step(color.times_s) < 1;
  return unit.known && (seconds || !unit.name.empty()) ? std::optional(unit) : std::nullopt;
}

void in_seconds(TimedFiles& files, const TimeUnit& unit) {
  for (double& time : files.times_s) time /= unit.per_second;
}

/// Whether names end in numbers of which each is there once; a few other files may lie beside them.
bool are_told_apart_by_number(const std::vector<fs::path>& files) {
  const auto numbered =
      static_cast<std::size_t>(std::count_if(files.begin(), files.end(), [](const fs::path& f) {
        return trailing_number(f).has_value();
      }));
  return 2 * numbered > files.size() && by_number(files).size() == numbered;
}

/// Pairs of equal number; where the numbers do not tell the files of a folder apart, in the order
/// of their names, if there are equally many.
void pair_by_names(std::vector<fs::path> color, std::vector<fs::path> depth, FrameList& out) {
  if (are_told_apart_by_number(color) && are_told_apart_by_number(depth)) {
    return pair_by_number(by_number(color), by_number(depth), kBareFps, out);
  }
  out.color_without_depth = color.size();
  out.depth_without_color = depth.size();
  if (color.size() != depth.size()) return;
  std::map<long, fs::path> first, second;
  for (auto [files, numbered] : {std::pair{&color, &first}, std::pair{&depth, &second}}) {
    std::stable_sort(files->begin(), files->end(), [](const fs::path& a, const fs::path& b) {
      return natural_less(a.filename().string(), b.filename().string());
    });
    for (const fs::path& file : *files)
      numbered->emplace(static_cast<long>(numbered->size()), file);
  }
  pair_by_number(first, second, kBareFps, out);
  out.paired = "in order";
  out.times_source = fmt::format("the order of the files, {:g} a second", kBareFps);
  out.warnings.push_back(fmt::format(
      "{}: the names do not end in a number for each image, so colour and depth are paired in the "
      "order of their names, {} with {} first",
      out.folder.string(), color.front().filename().string(), depth.front().filename().string()));
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
  auto timed_color = files_by_time(color, time_named);
  auto timed_depth = files_by_time(depth, time_named);
  if (const auto unit = named_by_time(timed_color, color.size(), timed_depth, depth.size())) {
    in_seconds(timed_color, *unit);
    in_seconds(timed_depth, *unit);
    pair_by_time(timed_color, timed_depth, kMaxPairDifference_s, out);
  } else {
    pair_by_names(color, depth, out);
    out.warnings.push_back(fmt::format(
        "{}: nothing says how many images a second there are; {:g} are taken, which is a guess; "
        "sequence.fps of an sgs.toml says it",
        folder.string(), kBareFps));
  }
  out.missing_calibration = fmt::format(
      "give --camera fx,fy,cx,cy, or --camera FILE with a calibration, and --depth-scale S (raw "
      "units per metre: 1000 for millimetres); or write a camera.txt with one line 'fx fy cx cy "
      "width height depth_scale' into {}",
      folder.string());
  SGS_RETURN_IF_ERROR(require_frames(
      out, "colour and depth images whose names are equal numbers, or times within 0.02 s"));
  return out;
}

}  // namespace sgs::dataset
