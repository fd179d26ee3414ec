// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "sgs/dataset/association.h"
#include "sgs/dataset/frame_list.h"
#include "sgs/dataset/pairing.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/text.h"
#include "sgs/io/trajectory_io.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

/// One line of rgb.txt or depth.txt.
struct ListedImage {
  double timestamp_s = 0;
  fs::path path;
  std::string origin;
};

tl::unexpected<Error> bad_line(const fs::path& list, const io::TextLine& line, const char* form) {
  return fail(
      ErrorCode::kInvalidFormat,
      fmt::format("{}:{}: cannot read '{}'", list.string(), line.number, line.text.substr(0, 80)),
      fmt::format("each row must be '{}'", form));
}

/// Sorts by time and drops repeated times, and says so.
void put_in_order(std::vector<ListedImage>& images, const fs::path& list,
                  std::vector<std::string>& warnings) {
  const auto earlier = [](const ListedImage& a, const ListedImage& b) {
    return a.timestamp_s < b.timestamp_s;
  };
  if (!std::is_sorted(images.begin(), images.end(), earlier)) {
    warnings.push_back(fmt::format("{}: rows out of time order were sorted", list.string()));
    std::stable_sort(images.begin(), images.end(), earlier);
  }
  const auto last = std::unique(images.begin(), images.end(), [](const auto& a, const auto& b) {
    return a.timestamp_s == b.timestamp_s;
  });
  if (const auto dropped = images.end() - last; dropped > 0) {
    warnings.push_back(
        fmt::format("{}: {} rows with a repeated time were dropped", list.string(), dropped));
    images.erase(last, images.end());
  }
}

Result<std::vector<ListedImage>> read_list(const fs::path& list,
                                           std::vector<std::string>& warnings) {
  SGS_ASSIGN_OR_RETURN(const std::string content, io::read_file(list));
  std::vector<ListedImage> images;
  for (const io::TextLine& line : io::content_lines(content)) {
    const auto fields = io::split_fields(line.text, ",");
    // A line of commas has no fields at all.
    const auto time = fields.empty() ? std::nullopt : io::parse_double(fields[0]);
    if (fields.size() < 2 || !time || !std::isfinite(*time)) {
      return bad_line(list, line, "timestamp filename");
    }
    images.push_back(
        {*time, list.parent_path() / fields[1], fmt::format("{}:{}", list.string(), line.number)});
  }
  if (images.empty()) {
    return fail(ErrorCode::kInvalidFormat, fmt::format("{}: lists no images", list.string()));
  }
  put_in_order(images, list, warnings);
  return images;
}

std::vector<double> times_of(const std::vector<ListedImage>& images) {
  std::vector<double> times;
  for (const ListedImage& image : images) times.push_back(image.timestamp_s);
  return times;
}

Status pair_lists(const fs::path& folder, double max_difference_s, FrameList& out) {
  SGS_ASSIGN_OR_RETURN(const auto color, read_list(folder / "rgb.txt", out.warnings));
  SGS_ASSIGN_OR_RETURN(const auto depth, read_list(folder / "depth.txt", out.warnings));
  const auto pairs = associate(times_of(color), times_of(depth), max_difference_s);
  if (pairs.empty()) {
    return fail(
        ErrorCode::kInvalidFormat,
        fmt::format("{}: no colour image has a depth image within {} s: colour covers "
                    "{:.6f} .. {:.6f} s, depth {:.6f} .. {:.6f} s",
                    folder.string(), max_difference_s, color.front().timestamp_s,
                    color.back().timestamp_s, depth.front().timestamp_s, depth.back().timestamp_s),
        "rgb.txt and depth.txt must use the same clock");
  }
  for (const auto& [i, j] : pairs) {
    FrameEntry& frame = out.frames.emplace_back(FrameEntry{
        color[i].timestamp_s, color[i].path, depth[j].path, color[i].origin, depth[j].origin});
    frame.depth_delay_s = depth[j].timestamp_s - color[i].timestamp_s;
  }
  out.color_without_depth = color.size() - pairs.size();
  out.depth_without_color = depth.size() - pairs.size();
  return {};
}

/// The calibration that ETH3D's SLAM benchmark puts into each folder: "fx fy cx cy" of images
/// without distortion, depth in 1/5000 m.
Result<std::optional<LayoutCalibration>> eth3d_calibration(const fs::path& path) {
  constexpr double kDepthScale = 5000;
  std::error_code error;
  if (!fs::exists(path, error)) return std::optional<LayoutCalibration>{};
  SGS_ASSIGN_OR_RETURN(const std::string content, io::read_file(path));
  const auto numbers = io::parse_doubles(content);
  if (!numbers || numbers->size() != 4) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: not the calibration of an ETH3D recording", path.string()),
                "it must hold four numbers: fx fy cx cy; or write a camera.txt");
  }
  const auto& n = *numbers;
  return std::optional(
      LayoutCalibration{{{0, 0, n[0], n[1], n[2], n[3]}, {}, kDepthScale}, path.string()});
}

}  // namespace

// associate.py writes colour first; some tools write depth first, which the folder's name gives
// away.
Status read_associations(const fs::path& list, FrameList& out) {
  SGS_ASSIGN_OR_RETURN(const std::string content, io::read_file(list));
  for (const io::TextLine& line : io::content_lines(content)) {
    auto f = io::split_fields(line.text, ",");
    const auto first = f.size() == 4 ? io::parse_double(f[0]) : std::nullopt;
    const auto second = f.size() == 4 ? io::parse_double(f[2]) : std::nullopt;
    if (!first || !second || !std::isfinite(*first) || !std::isfinite(*second)) {
      return bad_line(list, line, "timestamp color timestamp depth");
    }
    const bool swapped = f[1].starts_with("depth") && !f[3].starts_with("depth");
    const std::string origin = fmt::format("{}:{}", list.string(), line.number);
    FrameEntry& frame = out.frames.emplace_back(
        FrameEntry{swapped ? *second : *first, list.parent_path() / f[swapped ? 3 : 1],
                   list.parent_path() / f[swapped ? 1 : 3], origin, origin});
    frame.depth_delay_s = swapped ? *first - *second : *second - *first;
  }
  if (out.frames.empty()) {
    return fail(ErrorCode::kInvalidFormat, fmt::format("{}: lists no images", list.string()));
  }
  const auto earlier = [](const FrameEntry& a, const FrameEntry& b) {
    return a.timestamp_s < b.timestamp_s;
  };
  if (!std::is_sorted(out.frames.begin(), out.frames.end(), earlier)) {
    out.warnings.push_back(fmt::format("{}: rows out of time order were sorted", list.string()));
    std::stable_sort(out.frames.begin(), out.frames.end(), earlier);
  }
  const auto last = std::unique(
      out.frames.begin(), out.frames.end(),
      [](const FrameEntry& a, const FrameEntry& b) { return a.timestamp_s == b.timestamp_s; });
  if (const auto dropped = out.frames.end() - last; dropped > 0) {
    out.warnings.push_back(
        fmt::format("{}: {} rows with a repeated time were dropped", list.string(), dropped));
    out.frames.erase(last, out.frames.end());
  }
  return {};
}

bool looks_like_tum(const fs::path& folder) {
  return (fs::exists(folder / "rgb.txt") && fs::exists(folder / "depth.txt")) ||
         fs::exists(folder / "associations.txt");
}

Result<FrameList> list_tum(const fs::path& folder, double max_time_difference_s) {
  FrameList out;
  out.layout = "tum";
  out.name = folder_name(folder);
  out.folder = folder;
  const bool lists = fs::exists(folder / "rgb.txt") && fs::exists(folder / "depth.txt");
  SGS_RETURN_IF_ERROR(lists ? pair_lists(folder, max_time_difference_s, out)
                            : read_associations(folder / "associations.txt", out));
  drop_implausible_delays(out);
  SGS_ASSIGN_OR_RETURN(out.calibration, eth3d_calibration(folder / "calibration.txt"));
  if (fs::exists(folder / "groundtruth.txt")) {
    SGS_ASSIGN_OR_RETURN(auto truth, io::load_trajectory(folder / "groundtruth.txt"));
    out.truth = std::move(truth.trajectory);
    if (!truth.warning.empty()) out.warnings.push_back(truth.warning);
  }
  return out;
}

}  // namespace sgs::dataset
