// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/suite/data_folder.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <string_view>

#include "sgs/bag/bag.h"
#include "sgs/dataset/open.h"
#include "sgs/suite/provenance.h"

namespace sgs::suite {
namespace {

namespace fs = std::filesystem;

/// A name as it is compared.
std::string comparable(std::string name) {
  for (char& c : name) {
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (c == '-' || c == '.' || c == ' ') c = '_';
  }
  return name;
}

/// The name of an archive without its ending; empty where the file is none.
std::string archive_stem(const std::string& file) {
  constexpr std::array<std::string_view, 7> kEndings = {".tgz", ".tar.gz",  ".tar", ".tar.xz",
                                                        ".zip", ".tar.bz2", ".tbz2"};
  const std::string lower = comparable(file);
  for (const std::string_view ending : kEndings) {
    if (lower.ends_with(comparable(std::string(ending)))) {
      return file.substr(0, file.size() - ending.size());
    }
  }
  return {};
}

/// Something that may be a recording, by the name it goes by.
struct Entry {
  std::string name;  ///< plain, of an archive without its ending
  fs::path path;
};

/// What lies in a folder, down to a depth.
struct Listing {
  std::vector<Entry> folders, archives;  ///< what lies higher comes first, then by name
};

/// Adds what lies in `folder`; what cannot be listed is passed over.
void add_entries(const fs::path& folder, Listing& out) {
  Listing here;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    std::error_code unreadable;
    const std::string name = it->path().filename().string();
    if (it->is_directory(unreadable)) {
      here.folders.push_back({comparable(name), it->path()});
    } else if (const std::string stem = archive_stem(name); !stem.empty()) {
      here.archives.push_back({comparable(stem), it->path()});
    }
  }
  const auto by_path = [](const Entry& a, const Entry& b) { return a.path < b.path; };
  for (const auto& [from, to] :
       {std::pair{&here.folders, &out.folders}, std::pair{&here.archives, &out.archives}}) {
    std::sort(from->begin(), from->end(), by_path);
    to->insert(to->end(), from->begin(), from->end());
  }
}

Listing listing_of(const fs::path& data) {
  Listing out;
  // "." and "a/b/" have names, too.
  std::error_code error;
  const fs::path whole = fs::weakly_canonical(data, error);
  out.folders.push_back({comparable(whole.filename().string()), data});
  add_entries(data, out);
  const std::size_t higher = out.folders.size();
  for (std::size_t i = 1; i < higher; ++i) add_entries(fs::path(out.folders[i].path), out);
  return out;
}

/// Whether a picture lies in a folder or in one below it: lists of pictures, or ground truth alone,
/// are often kept without them.
bool has_pictures(const fs::path& folder, int depth = 1) {
  std::error_code error;
  std::vector<fs::path> below;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    std::error_code unreadable;
    const std::string ending = it->path().extension().string();
    if (ending == ".png" || ending == ".jpg" || ending == ".jpeg") return true;
    if (it->is_directory(unreadable)) below.push_back(it->path());
  }
  return depth > 0 && std::any_of(below.begin(), below.end(), [&](const fs::path& path) {
           return has_pictures(path, depth - 1);
         });
}

bool is_one_of(const std::string& plain_name, const std::vector<std::string>& names) {
  return std::any_of(names.begin(), names.end(),
                     [&](const std::string& name) { return comparable(name) == plain_name; });
}

std::string unpack_command(const fs::path& archive) {
  const std::string folder = archive.parent_path().string();
  const bool zip = comparable(archive.filename().string()).ends_with("_zip");
  const std::vector<std::string> words =
      zip ? std::vector<std::string>{"unzip", archive.string(), "-d", folder}
          : std::vector<std::string>{"tar", "-xf", archive.string(), "-C", folder};
  return shell_command(words);
}

/// Where a sequence lies, or why it cannot be run.
struct Place {
  fs::path folder;
  std::string why_not;
};

Place place_of(const Sequence& sequence, const Benchmark& benchmark, const Listing& listing) {
  std::string why_not;
  const auto object = [&](std::string reason) {
    if (why_not.empty()) why_not = std::move(reason);
  };
  for (const Entry& entry : listing.folders) {
    if (!is_one_of(entry.name, sequence.folders)) continue;
    std::error_code error;
    if (!dataset::looks_like_sequence(entry.path)) {
      object(fmt::format("{} holds no recording", entry.path.string()));
    } else if (!has_pictures(entry.path) && !bag::looks_like_bag(entry.path)) {
      object(fmt::format("{} has no pictures", entry.path.string()));
    } else if (!sequence.needs.empty() && !fs::exists(entry.path / sequence.needs, error)) {
      object(fmt::format("{} has no {}", entry.path.string(), sequence.needs));
    } else {
      return {entry.path, {}};
    }
  }
  for (const auto* names : {&sequence.folders, &benchmark.archives}) {
    for (const Entry& entry : listing.archives) {
      if (!is_one_of(entry.name, *names)) continue;
      return {{}, "it is packed: " + unpack_command(entry.path)};
    }
  }
  object(fmt::format("not there; {} publishes it as {}", benchmark.name, sequence.folders.front()));
  return {{}, why_not};
}

Status check_asked(const fs::path& data, const Suite& suite) {
  if (data.empty() && suite.benchmark) {
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("the suite {} runs recordings of {}", suite.name, suite.benchmark->name),
        "say with --data DIR where they lie");
  }
  if (!data.empty() && !suite.benchmark) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("the suite {} looks for nothing in --data", suite.name),
                "leave it out, or give a suite of a benchmark: tum, replica");
  }
  std::error_code error;
  if (data.empty() || fs::is_directory(data, error)) return {};
  return fail(ErrorCode::kNotFound, fmt::format("--data {}: no such folder", data.string()));
}

}  // namespace

Result<Findings> find_recordings(const fs::path& data, Suite& suite) {
  SGS_RETURN_IF_ERROR(check_asked(data, suite));
  Findings findings;
  if (!suite.benchmark) return findings;
  const Listing listing = listing_of(data);
  std::vector<Sequence> there;
  for (const Sequence& sequence : suite.sequences) {
    if (sequence.folders.empty()) {
      there.push_back(sequence);
      continue;
    }
    const Place place = place_of(sequence, *suite.benchmark, listing);
    if (place.folder.empty()) {
      findings.missing.push_back(fmt::format("{}: {}", sequence.name, place.why_not));
      continue;
    }
    findings.found.push_back(fmt::format("{}: {}", sequence.name, place.folder.string()));
    there.push_back(sequence);
    there.back().input = place.folder.string();
  }
  if (!there.empty()) {
    suite.sequences = std::move(there);
    return findings;
  }
  return fail(ErrorCode::kNotFound,
              fmt::format("--data {}: nothing of {} lies there\n  {}", data.string(),
                          suite.benchmark->name, fmt::join(findings.missing, "\n  ")),
              "give the folder that holds folders of these names");
}

}  // namespace sgs::suite
