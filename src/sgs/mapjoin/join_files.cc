// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapjoin/join_files.h"

#include <fmt/format.h>

#include <utility>

#include "sgs/mapjoin/join.h"
#include "sgs/mapjoin/learn_together.h"

namespace sgs::mapjoin {
namespace {

namespace fs = std::filesystem;

/// A map that is still to be joined, and how it is called.
struct Waiting {
  std::string name;
  Part part;
};

fs::path file_of(const fs::path& map) {
  std::error_code unreadable;
  return fs::is_directory(map, unreadable) ? map / mapfile::kFileName : map;
}

bool is_same_file(const fs::path& a, const fs::path& b) {
  std::error_code missing;
  return fs::equivalent(file_of(a), file_of(b), missing) && !missing;
}

Status check_output(const std::vector<fs::path>& inputs, const fs::path& output) {
  std::error_code unreadable;
  if (fs::is_directory(output, unreadable)) {
    return fail(ErrorCode::kInvalidArgument, fmt::format("{} is a folder", output.string()),
                fmt::format("name the file that is to be written: {}",
                            (output / "joined.sgsmap").string()));
  }
  for (const fs::path& input : inputs) {
    if (!is_same_file(input, output)) continue;
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("{} is one of the maps to be joined, which are only read", output.string()),
        "name another file");
  }
  return {};
}

/// Number of the first view of a session; that of all views where it has none.
std::size_t first_view(const Part& part, std::size_t session) {
  std::size_t i = 0;
  while (i < part.views() && part.graph.session[i] != session) ++i;
  return i;
}

/// Whether a session of one map is the same as one of another: what it is called and how long it
/// was may be so by chance, its first picture not.
bool is_same_session(const Part& a, std::size_t i, const Part& b, std::size_t j) {
  const mapfile::MapSession &s = a.sessions[i], &t = b.sessions[j];
  if (s.name != t.name || s.first_s != t.first_s || s.last_s != t.last_s || s.frames != t.frames) {
    return false;
  }
  const std::size_t k = first_view(a, i), l = first_view(b, j);
  if (k == a.views() || l == b.views()) return k == a.views() && l == b.views();
  const alignment::KnownView v = a.view(k), w = b.view(l);
  return v.timestamp_s == w.timestamp_s && v.frame.depth.size() == w.frame.depth.size() &&
         std::equal(v.frame.depth.data(), v.frame.depth.data() + v.frame.depth.size(),
                    w.frame.depth.data());
}

Status check_differ(const Waiting& a, const Waiting& b) {
  for (std::size_t i = 0; i < a.part.sessions.size(); ++i) {
    for (std::size_t j = 0; j < b.part.sessions.size(); ++j) {
      if (!is_same_session(a.part, i, b.part, j)) continue;
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("{} and {} both hold the session {} ({:.3f} to {:.3f} s)", a.name,
                              b.name, a.part.sessions[i].name, a.part.sessions[i].first_s,
                              a.part.sessions[i].last_s),
                  "give each map once, and of maps that were gone on with the last one");
    }
  }
  return {};
}

Result<std::vector<Waiting>> load_all(const std::vector<fs::path>& inputs) {
  std::vector<Waiting> maps;
  for (const fs::path& input : inputs) {
    SGS_ASSIGN_OR_RETURN(Part part, load_part(input));
    Waiting map{input.string(), std::move(part)};
    for (const Waiting& other : maps) SGS_RETURN_IF_ERROR(check_differ(other, map));
    maps.push_back(std::move(map));
  }
  return maps;
}

Status save(const fs::path& path, const Part& part) {
  mapfile::MapContents contents;
  contents.sessions = part.sessions;
  contents.gaussians = part.gaussians;
  contents.views = part.views();
  contents.view = part.view;
  contents.graph = part.graph;
  return mapfile::save_map(path, contents);
}

}  // namespace

Result<JoinedFiles> join_files(const std::vector<fs::path>& inputs, const fs::path& output,
                               int threads) {
  if (inputs.size() < 2) {
    return fail(ErrorCode::kInvalidArgument, "one map alone cannot be joined",
                "give two maps or more");
  }
  SGS_RETURN_IF_ERROR(check_output(inputs, output));
  SGS_ASSIGN_OR_RETURN(std::vector<Waiting> waiting, load_all(inputs));
  Part base = std::move(waiting.front().part);
  std::string base_name = waiting.front().name;
  waiting.erase(waiting.begin());
  ThreadPool pool(threads);
  JoinedFiles out;
  bool progress = true;
  while (!waiting.empty() && std::exchange(progress, false)) {
    out.not_joined.clear();
    for (auto map = waiting.begin(); map != waiting.end();) {
      const Outcome outcome = join(base, map->part, pool);
      const std::string told =
          fmt::format("{} in {}: {}", map->name, base_name, outcome.sentence());
      if (!outcome.joined) {
        out.not_joined.push_back(told);
        ++map;
        continue;
      }
      out.joined.push_back(told);
      base_name += " + " + map->name;
      progress = true;
      map = waiting.erase(map);
    }
  }
  if (!waiting.empty()) return out;
  learn_together(base, pool);
  SGS_RETURN_IF_ERROR(save(output, base));
  return out;
}

}  // namespace sgs::mapjoin
