// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/bag/bag.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <system_error>

#include "sgs/bag/byte_file.h"
#include "sgs/bag/chunked_bag.h"
#include "sgs/core/text.h"

namespace sgs::bag {
namespace fs = std::filesystem;
namespace {

constexpr const char* kRosbag2Metadata = "metadata.yaml";

/// What metadata.yaml of rosbag2 says.
struct Rosbag2Metadata {
  std::vector<std::string> files;
  std::string compression_mode;
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
    metadata.compression_mode = info["compression_mode"].as<std::string>("");
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

Result<std::unique_ptr<Bag>> open_bag_file(const fs::path& path) {
  const std::string extension = path.extension().string();
  if (extension == ".mcap") return open_mcap(path);
  if (extension == ".db3") return open_db3(path);
  if (extension == ".bag") return open_rosbag1(path);
  if (extension == ".zstd" || extension == ".zst") {
    return fail(ErrorCode::kUnsupported, fmt::format("{}: packed as a whole", path.string()),
                fmt::format("unpack it first: zstd -d {}", path.string()));
  }
  return fail(ErrorCode::kUnsupported, fmt::format("{}: not .bag, .mcap or .db3", path.string()));
}

Result<std::unique_ptr<Bag>> open_rosbag2_folder(const fs::path& folder) {
  SGS_ASSIGN_OR_RETURN(const auto metadata, read_metadata(folder / kRosbag2Metadata));
  if (metadata.compression_mode == "MESSAGE" || metadata.compression_mode == "message") {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{}: every message is packed by itself", folder.string()),
                "unpack it first with ros2 bag convert, storage_id mcap");
  }
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
  const std::string extension = path.extension().string();
  return extension == ".bag" || extension == ".mcap" || extension == ".db3" ||
         path.string().ends_with(".db3.zstd") || path.string().ends_with(".bag.active");
}

Result<std::unique_ptr<Bag>> open_bag(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) return open_rosbag2_folder(path);
  if (path.string().ends_with(".bag.active")) return open_rosbag1(path);
  return open_bag_file(path);
}

}  // namespace sgs::bag
