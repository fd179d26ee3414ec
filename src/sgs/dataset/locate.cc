// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/locate.h"

#include <algorithm>
#include <array>
#include <map>

#include "sgs/bag/bag.h"
#include "sgs/dataset/sens_source.h"
#include "sgs/io/archive.h"
#include "sgs/io/text.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

/// How a layout is known and read.
struct Layout {
  bool (*looks_like)(const fs::path& folder);
  Result<FrameList> (*list)(const fs::path& folder);
};

/// In the order in which they are tried: the surest marks first. TUM and Replica need more to be
/// told and come apart.
constexpr std::array kLayouts = {
    Layout{looks_like_icl, list_icl},
    Layout{looks_like_polycam, list_polycam},
    Layout{looks_like_transforms, list_transforms},
    Layout{looks_like_scannet, list_scannet},
    Layout{looks_like_seven_scenes, list_seven_scenes},
    Layout{looks_like_arkit_scenes, list_arkit_scenes},
    Layout{looks_like_sun3d, list_sun3d},
    Layout{looks_like_open3d, list_open3d},
};

constexpr Layout kReplica = {looks_like_replica, list_replica},
                 kBare = {looks_like_bare, list_bare};

Result<io::SequenceToml> toml_of(const fs::path& folder) {
  const fs::path path = entry_of(folder, "sgs.toml");
  if (!fs::exists(path)) return io::SequenceToml{};
  return io::load_sequence_toml(path);
}

/// Whether a folder has the marks of a layout.
bool has_layout(const fs::path& folder) {
  const auto toml = toml_of(folder);
  if (!toml || !toml->color.empty()) return true;
  return looks_like_tum(folder) || kReplica.looks_like(folder) || kBare.looks_like(folder) ||
         std::any_of(kLayouts.begin(), kLayouts.end(),
                     [&](const Layout& layout) { return layout.looks_like(folder); });
}

/// Folders and files of a folder, without what systems leave behind, by name.
std::vector<fs::path> content_of(const fs::path& folder) {
  std::vector<fs::path> content;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (!is_left_behind(it->path())) content.push_back(it->path());
  }
  std::sort(content.begin(), content.end());
  return content;
}

/// Whether a folder is a recording of messages, and no layout of images.
bool is_bag_folder(const fs::path& folder) {
  return bag::looks_like_bag(folder) || (!has_layout(folder) && !bag::bag_files(folder).empty());
}

/// The endings of a folder's files, the most frequent first.
std::string endings_of(const fs::path& folder) {
  std::map<std::string, std::size_t> counts;
  std::error_code error;
  for (const fs::path& file : content_of(folder)) {
    if (!fs::is_directory(file, error)) ++counts[file.extension().string()];
  }
  std::vector<std::pair<std::size_t, std::string>> sorted;
  for (const auto& [ending, count] : counts) sorted.emplace_back(count, ending);
  std::sort(sorted.rbegin(), sorted.rend());
  return sorted.empty() ? "" : sorted.front().second;
}

/// What makes a folder of images readable that is no layout.
std::string how_to_describe(const fs::path& folder) {
  constexpr std::size_t kMost = 6;
  std::vector<std::string> images, others;
  std::error_code error;
  for (const fs::path& path : content_of(folder)) {
    if (!fs::is_directory(path, error)) continue;
    const std::string name = path.filename().string(), ending = endings_of(path);
    if (!image_files(path).empty()) {
      images.push_back(name);
    } else if (!ending.empty()) {
      others.push_back(fmt::format("{} holds {} files", name, ending));
    }
  }
  if (!images.empty() && !others.empty() && images.size() + others.size() <= kMost) {
    return fmt::format(
        "{}, which are not read: write them as PNG (depth in 16 bits), then an "
        "sgs.toml that names the folders",
        fmt::join(others, ", "));
  }
  constexpr const char* kForm =
      "put an sgs.toml there with [sequence] color = \"{}\", depth = \"{}\", match = \"order\", "
      "fps = 30{}";
  if (images.size() >= 2 && images.size() <= kMost) {
    const auto depth = std::find_if(images.begin(), images.end(), [](const std::string& name) {
      return io::lower_case(name).find("dep") != std::string::npos;
    });
    const std::size_t of_depth = depth == images.end() ? 1 : depth - images.begin();
    return fmt::format(fmt::runtime(kForm), images[of_depth == 0 ? 1 : 0], images[of_depth],
                       " (whichever of the folders hold them)");
  }
  if (!image_files(folder).empty()) {
    return fmt::format(fmt::runtime(kForm), "*color*", "*depth*",
                       " (patterns that tell the files apart)");
  }
  return "give the folder that holds one of these; an sgs.toml describes any folder of images";
}

/// Folders of a folder that hold nothing, where colour or depth is missing.
std::vector<std::string> empty_folders(const fs::path& folder) {
  std::vector<std::string> names;
  std::size_t with_images = 0;
  std::error_code error;
  for (const fs::path& path : content_of(folder)) {
    if (!fs::is_directory(path, error)) continue;
    if (content_of(path).empty()) names.push_back(path.filename().string());
    with_images += image_files(path).empty() ? 0 : 1;
  }
  return with_images < 2 ? names : std::vector<std::string>{};
}

tl::unexpected<Error> no_sequence(const fs::path& folder) {
  if (const auto packed = packed_in(folder)) return tl::unexpected<Error>(*packed);
  if (const auto empty = empty_folders(folder); !empty.empty()) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: no known sequence layout, and nothing lies in {}", folder.string(),
                            fmt::join(empty, ", ")),
                "copy or record these images again: colour and depth are both needed");
  }
  return fail(ErrorCode::kInvalidFormat,
              fmt::format("{}: no known sequence layout; looked for rgb.txt with depth.txt, or "
                          "associations.txt (TUM), results/frame*.jpg with results/depth*.png, "
                          "or images/ with depth_images/ (Replica, NICE-SLAM), color/ (rgb/, "
                          "image/) with depth/, sgs.toml with sequence.color and sequence.depth, "
                          "what marks ScanNet, 7-Scenes, Open3D, SUN3D, ICL-NUIM, nerfstudio, "
                          "Polycam and ARKitScenes, and .bag, .mcap, .db3 or .mkv files",
                          folder.string()),
              how_to_describe(folder));
}

/// The recordings that lie in a folder.
std::vector<fs::path> recordings_in(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code error;
  for (const fs::path& path : content_of(folder)) {
    const bool recording =
        fs::is_directory(path, error) ? has_layout(path) || is_bag_folder(path) : is_sens(path);
    if (recording) found.push_back(path);
  }
  return found;
}

/// The only recording below a folder that is none itself, at most two folders deep: archives often
/// hold one folder more than was packed.
Result<fs::path> only_below(const fs::path& folder) {
  std::error_code error;
  auto found = recordings_in(folder);
  if (found.empty()) {
    for (const fs::path& path : content_of(folder)) {
      if (!fs::is_directory(path, error)) continue;
      const auto deeper = recordings_in(path);
      found.insert(found.end(), deeper.begin(), deeper.end());
    }
  }
  if (found.size() == 1) return found.front();
  if (found.size() > 1) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: holds {} scenes", folder.string(), found.size()),
                fmt::format("give one of them, for example {}", io::shell_quoted(found.front())));
  }
  return no_sequence(folder);
}

}  // namespace

Result<FrameList> list_frames(const fs::path& folder, const OpenOptions& options) {
  SGS_ASSIGN_OR_RETURN(const io::SequenceToml toml, toml_of(folder));
  const auto list = [&]() -> Result<FrameList> {
    if (!toml.color.empty()) return list_folder(folder, toml);
    for (const Layout& layout : kLayouts) {
      if (layout.looks_like(folder)) return layout.list(folder);
    }
    if (looks_like_tum(folder)) return list_tum(folder, options.max_time_difference_s);
    return kReplica.looks_like(folder) ? list_replica(folder) : list_bare(folder);
  };
  SGS_ASSIGN_OR_RETURN(FrameList frames, list());
  if (!toml.name.empty()) frames.name = toml.name;
  if (const auto bags = bag::bag_files(folder); !bags.empty()) {
    frames.warnings.push_back(
        fmt::format("{}: its images are read, not {}, which lies beside them; give this file to "
                    "read it",
                    folder.string(), bags.front().filename().string()));
  }
  return frames;
}

bool looks_like_sequence(const fs::path& folder) {
  try {
    return fs::exists(folder / "sgs.toml") || has_layout(folder) || bag::looks_like_bag(folder);
  } catch (const fs::filesystem_error&) {
    return false;
  }
}

bool lies_beside_recording(const fs::path& file) {
  const std::string name = file.filename().string();
  if (name.empty() || name == "." || name == "..") return false;
  return is_left_behind(file) || name == "metadata.yaml" || name.ends_with("-wal") ||
         name.ends_with("-shm") || name.ends_with("-journal");
}

Result<Location> locate_recording(const fs::path& input) {
  std::error_code error;
  if (!fs::exists(input, error)) {
    return fail(ErrorCode::kNotFound, fmt::format("{}: no such file or folder", input.string()),
                "give the folder of an RGB-D sequence, a bag, or synth:NAME");
  }
  if (!fs::is_directory(input, error)) {
    const fs::path folder = fs::absolute(input, error).parent_path();
    const bool list = input.filename() == "metadata.yaml" && bag::looks_like_bag(folder);
    return list ? Location{folder, true} : Location{input, bag::looks_like_bag(input)};
  }
  if (is_bag_folder(input)) return Location{input, true};
  if (has_layout(input)) return Location{input, false};
  SGS_ASSIGN_OR_RETURN(const fs::path below, only_below(input));
  const bool folder = fs::is_directory(below, error);
  return Location{below, folder && is_bag_folder(below)};
}

std::optional<Error> packed_in(const fs::path& folder) {
  std::vector<std::pair<fs::path, io::Unpacking>> packed;
  bool others = false;
  std::error_code error;
  for (const fs::path& file : content_of(folder)) {
    const auto unpacking = io::unpacking_of(file);
    const bool done = unpacking && fs::exists(unpacking->unpacked, error);
    if (unpacking && !done) packed.emplace_back(file, *unpacking);
    others = others || fs::is_directory(file, error) || (!unpacking && bag::looks_like_bag(file));
  }
  if (packed.empty()) return std::nullopt;
  const auto& [first, unpacking] = packed.front();
  if (packed.size() == 1 && !others) return io::packed_as_a_whole(first, unpacking).value();
  std::string names, commands;
  for (const auto& [file, how] : packed) {
    names += (names.empty() ? "" : ", ") + file.filename().string();
    commands += (commands.empty() ? "" : " && ") + how.command;
  }
  return Error{
      ErrorCode::kUnsupported,
      fmt::format("{}: {} {} packed as a whole", folder.string(), names,
                  packed.size() == 1 ? "is" : "are"),
      fmt::format("unpack it first: `{}`, then give {}", commands, io::shell_quoted(folder))};
}

}  // namespace sgs::dataset
