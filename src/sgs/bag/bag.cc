// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/bag/bag.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <system_error>

#include "sgs/bag/byte_file.h"
#include "sgs/bag/chunked_bag.h"
#include "sgs/core/text.h"
#include "sgs/io/archive.h"
#include "sgs/io/text.h"

namespace sgs::bag {
namespace fs = std::filesystem;
namespace {

constexpr const char* kRosbag2Metadata = "metadata.yaml";
constexpr const char* kImageType = "sensor_msgs/Image";

/// What metadata.yaml of rosbag2 says.
struct Rosbag2Metadata {
  std::vector<std::string> files;
};

Result<Rosbag2Metadata> read_metadata(const fs::path& path) {
  constexpr std::uint64_t kLargestMetadata_bytes = 16 << 20;
  SGS_ASSIGN_OR_RETURN(ByteFile file, ByteFile::open(path));
  SGS_ASSIGN_OR_RETURN(const auto text,
                       file.view(0, std::min(file.size(), kLargestMetadata_bytes)));
  Rosbag2Metadata metadata;
  try {
    const YAML::Node info = YAML::Load(std::string(text))["rosbag2_bagfile_information"];
    for (const YAML::Node& name : info["relative_file_paths"]) {
      metadata.files.push_back(name.as<std::string>());
    }
  } catch (const YAML::Exception& e) {
    return fail(ErrorCode::kInvalidFormat, fmt::format("{}: {}", path.string(), e.what()),
                "`ros2 bag reindex FOLDER` writes it again; or give one of the files");
  }
  if (metadata.files.empty()) {
    return fail(ErrorCode::kInvalidFormat, fmt::format("{}: names no file", path.string()),
                "`ros2 bag reindex FOLDER` writes it again; or give one of the files");
  }
  return metadata;
}

/// Other programs have a metadata.yaml, too.
bool is_rosbag2_folder(const fs::path& folder) {
  constexpr std::uint64_t kBeginning_bytes = 4096;
  std::error_code error;
  if (!fs::exists(folder / kRosbag2Metadata, error)) return false;
  auto file = ByteFile::open(folder / kRosbag2Metadata);
  const auto text = file ? file->view(0, std::min(file->size(), kBeginning_bytes))
                         : Result<std::string_view>(tl::unexpected(file.error()));
  return text && text->find("rosbag2_bagfile_information") != std::string_view::npos;
}

/// What a file's name says it is: ".bag", ".mcap", ".db3", ".mkv", or nothing of these.
std::string kind_of(const fs::path& path) {
  std::string name = io::lower_case(path.filename().string());
  // A recorder that did not come to its end leaves this.
  if (name.ends_with(".bag.active")) name.resize(name.size() - std::string_view(".active").size());
  const std::string extension = fs::path(name).extension().string();
  const bool known =
      extension == ".mcap" || extension == ".db3" || extension == ".bag" || extension == ".mkv";
  return known ? extension : "";
}

/// What a file's first bytes say it is; empty where they say nothing.
std::string kind_by_content(const fs::path& path) {
  using namespace std::string_view_literals;
  constexpr std::pair<std::string_view, const char*> kBeginnings[] = {
      {"#ROSBAG", ".bag"}, {"\x89MCAP0", ".mcap"}, {"SQLite format 3\0"sv, ".db3"}};
  constexpr std::uint64_t kBeginning_bytes = 16;
  auto file = ByteFile::open(path);
  if (!file) return "";
  const auto text = file->view(0, std::min(file->size(), kBeginning_bytes));
  for (const auto& [begins, kind] : kBeginnings) {
    if (text && text->starts_with(begins)) return kind;
  }
  return is_kinect_recording(path) ? ".mkv" : "";
}

/// Whether a file of a folder is a recording. Videos may lie beside those.
bool is_recording(const fs::path& path) {
  const std::string kind = kind_of(path);
  return kind == ".mkv" ? is_kinect_recording(path) : !kind.empty();
}

Result<std::unique_ptr<Bag>> open_bag_file(const fs::path& path) {
  const std::string named = kind_of(path), found = kind_by_content(path);
  const std::string& kind = found.empty() ? named : found;
  if (kind == ".mcap") return open_mcap(path);
  if (kind == ".db3") return open_db3(path);
  if (kind == ".bag") return open_rosbag1(path);
  if (kind == ".mkv") return open_kinect(path);
  if (const auto unpacking = io::unpacking_of(path)) {
    return io::packed_as_a_whole(path, *unpacking);
  }
  return fail(ErrorCode::kUnsupported,
              fmt::format("{}: not .bag, .mcap, .db3 or .mkv", path.string()),
              "is it a recording of ROS? Then give it the ending that says of which kind");
}

Result<std::unique_ptr<Bag>> open_rosbag2_folder(const fs::path& folder) {
  SGS_ASSIGN_OR_RETURN(const auto metadata, read_metadata(folder / kRosbag2Metadata));
  std::vector<std::unique_ptr<Bag>> parts;
  for (const std::string& name : metadata.files) {
    // Old versions wrote the folder's name before the file's.
    fs::path path = folder / name;
    std::error_code error;
    if (!fs::exists(path, error)) path = folder / fs::path(name).filename();
    // Unpacked by hand, the file keeps its place in the list.
    const fs::path unpacked = fs::path(path).replace_extension();
    const bool packed = path.extension() == ".zstd" || path.extension() == ".zst";
    if (packed && fs::exists(unpacked, error)) path = unpacked;
    SGS_ASSIGN_OR_RETURN(auto part, open_bag_file(path));
    parts.push_back(std::move(part));
  }
  return join_bags(std::move(parts));
}

/// A file of a recording.
struct Part {
  fs::path path;
  std::unique_ptr<Bag> bag;
};

std::string file_name(const Part& part) { return part.path.filename().string(); }

bool share_a_topic(const Bag& a, const Bag& b) {
  return std::any_of(a.channels().begin(), a.channels().end(), [&](const Channel& of_a) {
    return of_a.type == kImageType &&
           std::any_of(b.channels().begin(), b.channels().end(), [&](const Channel& of_b) {
             return of_a.topic == of_b.topic && of_b.messages != 0;
           });
  });
}

/// Puts the parts in order, says what lies between them, and refuses what is not one recording.
Status put_in_order(std::vector<Part>& parts, std::vector<std::string>& warnings) {
  constexpr double kLongGap_s = 60;
  const bool timed = std::all_of(parts.begin(), parts.end(), [](const Part& part) {
    return part.bag->first_time_ns() && part.bag->last_time_ns();
  });
  std::stable_sort(parts.begin(), parts.end(), [&](const Part& a, const Part& b) {
    if (timed) return *a.bag->first_time_ns() < *b.bag->first_time_ns();
    return strverscmp(a.path.filename().c_str(), b.path.filename().c_str()) < 0;
  });
  for (std::size_t i = 1; timed && i < parts.size(); ++i) {
    const Part &a = parts[i - 1], &b = parts[i];
    const double gap_s =
        1e-9 * static_cast<double>(*b.bag->first_time_ns() - *a.bag->last_time_ns());
    const double shorter_s =
        1e-9 * static_cast<double>(std::min(*a.bag->last_time_ns() - *a.bag->first_time_ns(),
                                            *b.bag->last_time_ns() - *b.bag->first_time_ns()));
    if (gap_s < -shorter_s / 2 && share_a_topic(*a.bag, *b.bag)) {
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("{} and {} cover the same time with the same topics, so they are not "
                              "parts of one recording",
                              a.path.string(), b.path.string()),
                  fmt::format("give one of them, for example {}", io::shell_quoted(a.path)));
    }
    if (gap_s > kLongGap_s) {
      warnings.push_back(fmt::format(
          "{:.0f} s lie between the end of {} and the beginning of {}, which are read as one "
          "recording; if they are two, give one at a time",
          gap_s, file_name(a), file_name(b)));
    }
  }
  return {};
}

Status check_kinds(const std::vector<fs::path>& files) {
  for (const fs::path& file : files) {
    if (kind_of(file) == kind_of(files.front())) continue;
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{} and {} are recordings of different kinds, so it is not clear "
                            "whether they are one",
                            files.front().string(), file.string()),
                "give the files that belong together, one after the other, or one of them");
  }
  return {};
}

Result<std::unique_ptr<Bag>> joined(std::vector<Part> parts, std::vector<std::string> warnings) {
  SGS_RETURN_IF_ERROR(put_in_order(parts, warnings));
  if (parts.size() > 1) {
    std::string names;
    for (const Part& part : parts) names += (names.empty() ? "" : ", ") + file_name(part);
    warnings.insert(warnings.begin(), fmt::format("read as one recording: {}", names));
  }
  std::vector<std::unique_ptr<Bag>> bags;
  for (Part& part : parts) bags.push_back(std::move(part.bag));
  return join_bags(std::move(bags), std::move(warnings));
}

/// Files of one recording. What cannot be read costs itself, as the last file of a recorder that
/// was switched off; what is not there is an error.
Result<std::unique_ptr<Bag>> open_parts(const std::vector<fs::path>& files,
                                        std::vector<std::string> warnings) {
  std::vector<Part> parts;
  std::optional<Error> first_error;
  for (const fs::path& file : files) {
    auto bag = open_bag_file(file);
    if (bag) {
      parts.push_back({file, std::move(*bag)});
      continue;
    }
    if (bag.error().code == ErrorCode::kNotFound) return bag;
    warnings.push_back(fmt::format("left out: {}", bag.error().text()));
    if (!first_error) first_error = std::move(bag.error());
  }
  if (parts.empty()) return tl::unexpected<Error>(std::move(*first_error));
  return joined(std::move(parts), std::move(warnings));
}

/// Packed recordings of a folder that were not unpacked.
std::vector<std::string> still_packed(const fs::path& folder) {
  std::vector<std::string> commands;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const auto unpacking = io::unpacking_of(it->path());
    if (!unpacking || kind_of(unpacking->unpacked).empty()) continue;
    if (!fs::exists(unpacking->unpacked, error)) commands.push_back(unpacking->command);
  }
  std::sort(commands.begin(), commands.end());
  return commands;
}

/// A folder of files without a list of them, or with one that is of no use, and `why`.
Result<std::unique_ptr<Bag>> open_bag_folder(const fs::path& folder, const std::string& why) {
  const auto files = bag_files(folder);
  if (files.empty()) {
    return fail(ErrorCode::kNotFound, fmt::format("{}: no recordings in it", folder.string()),
                "give a folder with .bag, .mcap, .db3 or .mkv files");
  }
  SGS_RETURN_IF_ERROR(check_kinds(files));
  std::vector<std::string> warnings;
  if (!why.empty()) warnings.push_back(why);
  if (const auto commands = still_packed(folder); !commands.empty()) {
    warnings.push_back(fmt::format("packed parts are left out; unpack them first: `{}`",
                                   fmt::join(commands, " && ")));
  }
  return open_parts(files, std::move(warnings));
}

}  // namespace

std::size_t Bag::channel_of(const std::string& name, const std::string& type, Encoding encoding) {
  const std::string topic = printable(name);
  std::string plain = printable(type);
  if (const auto at = plain.find("/msg/"); at != std::string::npos) plain.erase(at, 4);
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    const Channel& c = channels_[i];
    if (c.topic == topic && c.type == plain && c.encoding == encoding) return i;
  }
  channels_.push_back({topic, plain, encoding, std::nullopt});
  return channels_.size() - 1;
}

bool looks_like_bag(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) return is_rosbag2_folder(path);
  const auto unpacking = io::unpacking_of(path);
  return !kind_of(unpacking ? unpacking->unpacked : path).empty() || !kind_by_content(path).empty();
}

std::vector<fs::path> bag_files(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const bool hidden = it->path().filename().string().starts_with('.');
    const bool file = it->exists(error) && !it->is_directory(error);
    if (!hidden && file && is_recording(it->path())) files.push_back(it->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// The recordings in a folder of which metadata.yaml says nothing: the recorder did not finish it.
static std::vector<std::string> unlisted(const fs::path& folder) {
  std::vector<std::string> names;
  const auto metadata = read_metadata(folder / kRosbag2Metadata);
  if (!metadata) return names;
  const auto listed = [&](const std::string& name) {
    return std::any_of(metadata->files.begin(), metadata->files.end(), [&](const fs::path& file) {
      return file.filename() == name || file.stem() == name;  // unpacked by hand
    });
  };
  for (const fs::path& file : bag_files(folder)) {
    if (!listed(file.filename().string())) names.push_back(file.filename().string());
  }
  return names;
}

Result<std::unique_ptr<Bag>> open_bag(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return open_bag_file(path);
  if (!is_rosbag2_folder(path)) return open_bag_folder(path, {});
  if (const auto names = unlisted(path); !names.empty()) {
    auto all = open_bag_folder(path, fmt::format("{} does not name {}, read as well",
                                                 kRosbag2Metadata, fmt::join(names, ", ")));
    if (all) return all;
  }
  auto listed = open_rosbag2_folder(path);
  // A list that the recorder did not finish is no reason to leave the files.
  const bool other = !listed && listed.error().code != ErrorCode::kUnsupported;
  if (!other || bag_files(path).empty()) return listed;
  auto found = open_bag_folder(
      path, fmt::format("not read as {} says: {}", kRosbag2Metadata, listed.error().text()));
  return found ? std::move(found) : std::move(listed);
}

Result<std::unique_ptr<Bag>> open_bags(const std::vector<fs::path>& paths) {
  SGS_CHECK(!paths.empty(), "a recording has files");
  if (paths.size() == 1) return open_bag(paths.front());
  std::vector<fs::path> files;
  for (const fs::path& path : paths) {
    const auto inside = bag_files(path);
    if (inside.empty()) files.push_back(path);
    files.insert(files.end(), inside.begin(), inside.end());
  }
  SGS_RETURN_IF_ERROR(check_kinds(files));
  return open_parts(files, {});
}

}  // namespace sgs::bag
