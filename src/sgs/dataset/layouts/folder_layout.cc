// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <optional>

#include "sgs/dataset/frame_list.h"
#include "sgs/io/text.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

/// Puts images in the order that their names mean: of the numbers that they are, times perhaps, or
/// with numbers in them counting as numbers.
void order_by_name(std::vector<fs::path>& files) {
  const auto number = [](const fs::path& file) -> std::optional<double> {
    const std::string stem = file.stem().string();
    if (stem.find_first_not_of("0123456789.") != std::string::npos) return std::nullopt;
    return io::parse_double(stem);
  };
  const bool numbers = std::all_of(files.begin(), files.end(), number);
  std::stable_sort(files.begin(), files.end(), [&](const fs::path& a, const fs::path& b) {
    if (numbers) return *number(a) < *number(b);
    return natural_less(a.filename().string(), b.filename().string());
  });
}

std::vector<fs::path> images_named(const fs::path& folder, const std::string& pattern) {
  const fs::path path = folder / pattern;
  auto files = pattern.find('*') == std::string::npos
                   ? image_files(entry_of(folder, pattern))
                   : files_matching(path.parent_path(), path.filename().string());
  order_by_name(files);
  return files;
}

using Pairs = std::vector<std::pair<fs::path, fs::path>>;

Result<Pairs> pair_by_order(const std::vector<fs::path>& color, const std::vector<fs::path>& depth,
                            const fs::path& toml) {
  if (color.size() != depth.size()) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: {} colour but {} depth images, and they are matched by order",
                            toml.string(), color.size(), depth.size()),
                "remove the extra images or set sequence.match = \"stem\"");
  }
  Pairs pairs;
  for (std::size_t i = 0; i < color.size(); ++i) pairs.emplace_back(color[i], depth[i]);
  return pairs;
}

Pairs pair_by_stem(const std::vector<fs::path>& color, const std::vector<fs::path>& depth) {
  std::map<std::string, fs::path> by_stem;
  for (const fs::path& path : depth) by_stem.emplace(path.stem().string(), path);
  Pairs pairs;
  for (const fs::path& path : color) {
    const auto partner = by_stem.find(path.stem().string());
    if (partner != by_stem.end()) pairs.emplace_back(path, partner->second);
  }
  return pairs;
}

}  // namespace

Result<FrameList> list_folder(const fs::path& folder, const io::SequenceToml& toml) {
  FrameList out;
  out.layout = "folder";
  out.name = folder_name(folder);
  out.folder = folder;
  const fs::path toml_path = folder / "sgs.toml";
  const auto color = images_named(folder, toml.color), depth = images_named(folder, toml.depth);
  if (color.empty() || depth.empty()) {
    return fail(ErrorCode::kNotFound,
                fmt::format("{}: no PNG or JPEG images in '{}'", toml_path.string(),
                            color.empty() ? toml.color : toml.depth),
                "sequence.color and sequence.depth are folders or patterns such as color/*.png");
  }
  Pairs pairs;
  out.paired = toml.match == io::FrameMatching::kStem ? "of equal name" : "in order";
  out.times_source = fmt::format("sequence.fps of {}, {:g} a second", toml_path.string(), toml.fps);
  if (toml.match == io::FrameMatching::kStem) {
    pairs = pair_by_stem(color, depth);
  } else {
    SGS_ASSIGN_OR_RETURN(pairs, pair_by_order(color, depth, toml_path));
  }
  if (pairs.empty()) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: no colour and depth image share a name", toml_path.string()),
                "set sequence.match = \"order\" to match them by sorted order");
  }
  for (const auto& [color_path, depth_path] : pairs) {
    out.frames.push_back({static_cast<double>(out.frames.size()) / toml.fps, color_path, depth_path,
                          toml_path.string(), toml_path.string()});
  }
  out.color_without_depth = color.size() - pairs.size();
  out.depth_without_color = depth.size() - pairs.size();
  if (!toml.trajectory.empty()) {
    take_truth(folder / toml.trajectory, out);
  }
  return out;
}

}  // namespace sgs::dataset
