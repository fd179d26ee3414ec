// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/frame_list.h"

#include <algorithm>
#include <charconv>
#include <string_view>
#include <system_error>

#include "sgs/io/text.h"
#include "sgs/io/trajectory_io.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

template <class Predicate>
std::vector<fs::path> files_where(const fs::path& folder, Predicate wanted) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (is_left_behind(it->path()) || it->is_directory(error)) continue;
    if (wanted(it->path())) files.push_back(it->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Whether a name is the pattern with anything in the place of each '*'.
bool name_matches(std::string_view name, std::string_view pattern) {
  const auto star = pattern.find('*');
  if (star == std::string_view::npos) return name == pattern;
  if (!name.starts_with(pattern.substr(0, star))) return false;
  name.remove_prefix(star);
  pattern.remove_prefix(star + 1);
  // What stands between two stars is taken where it comes first.
  for (auto next = pattern.find('*'); next != std::string_view::npos; next = pattern.find('*')) {
    const auto at = name.find(pattern.substr(0, next));
    if (at == std::string_view::npos) return false;
    name.remove_prefix(at + next);
    pattern.remove_prefix(next + 1);
  }
  return name.ends_with(pattern);
}

}  // namespace

fs::path entry_of(const fs::path& folder, const fs::path& name) {
  // Folders with more in them hold the images themselves: they are not searched for each name.
  constexpr int kMostEntries = 2000;
  std::error_code error;
  if (fs::exists(folder / name, error)) return folder / name;
  fs::path found = folder;
  for (const fs::path& part : name) {
    fs::path next = found / part;
    if (!fs::exists(next, error)) {
      const std::string wanted = io::lower_case(part.string());
      std::vector<fs::path> alike;
      int entries = 0;
      for (fs::directory_iterator it(found, error), end; !error && it != end; it.increment(error)) {
        const bool same = io::lower_case(it->path().filename().string()) == wanted;
        if (same) alike.push_back(it->path());
        if (++entries > kMostEntries) break;
      }
      if (alike.empty()) return folder / name;
      next = *std::min_element(alike.begin(), alike.end());
    }
    found = std::move(next);
  }
  return found;
}

bool is_left_behind(const fs::path& file) {
  const std::string name = io::lower_case(file.filename().string());
  return name.starts_with('.') || name == "thumbs.db" || name == "desktop.ini" ||
         name == "__macosx" || name == "@eadir";
}

void truth_or_warning(const Status& status, FrameList& list) {
  if (status) return;
  list.truth = {};
  list.warnings.push_back(fmt::format("no ground truth: {}", status.error().text()));
}

void take_truth(const fs::path& file, FrameList& list) {
  auto truth = io::load_trajectory(file);
  if (!truth) return truth_or_warning(tl::unexpected(truth.error()), list);
  list.truth = std::move(truth->trajectory);
  if (!truth->warning.empty()) list.warnings.push_back(truth->warning);
}

std::vector<fs::path> files_matching(const fs::path& folder, const std::string& pattern) {
  return files_where(folder, [&](const fs::path& path) {
    return name_matches(path.filename().string(), pattern);
  });
}

std::vector<fs::path> image_files(const fs::path& folder) {
  return files_where(folder, [](const fs::path& path) {
    const std::string extension = io::lower_case(path.extension().string());
    return extension == ".png" || extension == ".jpg" || extension == ".jpeg";
  });
}

bool natural_less(const std::string& a, const std::string& b) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!is_digit(a[i]) || !is_digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
      continue;
    }
    const auto number = [&](const std::string& text, std::size_t& at) {
      at = std::min(text.find_first_not_of('0', at), text.size());
      const std::size_t first = at;
      while (at < text.size() && is_digit(text[at])) ++at;
      return std::string_view(text).substr(first, at - first);
    };
    const auto x = number(a, i), y = number(b, j);
    if (x.size() != y.size()) return x.size() < y.size();
    if (x != y) return x < y;
  }
  if ((i == a.size()) != (j == b.size())) return i == a.size();
  return a < b;  // names that differ in leading zeros only
}

PinholeCamera typical_camera(const std::vector<FrameEntry>& frames) {
  SGS_CHECK(!frames.empty(), "no frames, no camera");
  const auto median = [&](auto PinholeCamera::*member) {
    auto values = std::vector<std::decay_t<decltype(std::declval<PinholeCamera>().*member)>>();
    for (const FrameEntry& frame : frames) values.push_back(frame.camera.value().*member);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  };
  using C = PinholeCamera;
  return {median(&C::width), median(&C::height), median(&C::fx),
          median(&C::fy),    median(&C::cx),     median(&C::cy)};
}

std::optional<long> trailing_number(const fs::path& file) {
  const std::string stem = file.stem().string();
  const auto digits = stem.find_last_not_of("0123456789") + 1;  // npos + 1 == 0
  long number = 0;
  const char* end = stem.data() + stem.size();
  if (std::from_chars(stem.data() + digits, end, number).ec != std::errc{}) return std::nullopt;
  return number;
}

std::map<long, fs::path> by_number(const std::vector<fs::path>& files) {
  std::map<long, fs::path> numbered;
  for (const fs::path& file : files) {
    if (const auto number = trailing_number(file)) numbered.emplace(*number, file);
  }
  return numbered;
}

std::string folder_name(const fs::path& folder) {
  std::error_code error;
  fs::path path = fs::absolute(folder, error).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  return path.filename().string();
}

}  // namespace sgs::dataset
