// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/frame_list.h"

#include <algorithm>
#include <cctype>
#include <system_error>

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

template <class Predicate>
std::vector<fs::path> files_where(const fs::path& folder, Predicate wanted) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (!it->is_directory(error) && wanted(it->path())) files.push_back(it->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

std::vector<fs::path> files_matching(const fs::path& folder, const std::string& pattern) {
  const auto star = pattern.find('*');
  const std::string head = pattern.substr(0, star);
  const std::string tail = star == std::string::npos ? "" : pattern.substr(star + 1);
  return files_where(folder, [&](const fs::path& path) {
    const std::string name = path.filename().string();
    if (star == std::string::npos) return name == pattern;
    return name.size() >= head.size() + tail.size() && name.starts_with(head) &&
           name.ends_with(tail);
  });
}

std::vector<fs::path> image_files(const fs::path& folder) {
  return files_where(folder, [](const fs::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension == ".png" || extension == ".jpg" || extension == ".jpeg";
  });
}

std::string folder_name(const fs::path& folder) {
  std::error_code error;
  fs::path path = fs::absolute(folder, error).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  return path.filename().string();
}

}  // namespace sgs::dataset
