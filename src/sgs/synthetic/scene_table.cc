// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/scene_table.h"

#include <algorithm>
#include <numeric>

namespace sgs::synthetic {

namespace {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t substitute = diagonal + (a[i] != b[j] ? 1 : 0);
      diagonal = row[j + 1];
      row[j + 1] = std::min({substitute, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

std::string nearest_first(std::vector<std::string> names, const std::string& wanted) {
  std::stable_sort(names.begin(), names.end(), [&](const std::string& a, const std::string& b) {
    return edit_distance(a, wanted) < edit_distance(b, wanted);
  });
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

const std::vector<SceneInfo>& scene_names() {
  static const std::vector<SceneInfo> scenes = {
      {"nostructure_texture_near", "a floor of posters seen from 1 m", 600, true},
      {"nostructure_texture_far", "a floor of posters seen from 2 m", 450, true},
      {"structure_notexture_near", "a zig-zag of plain panels at 1.3 m", 600, false},
      {"structure_notexture_far", "a zig-zag of plain panels at 2.3 m", 600, false},
      {"structure_texture_near", "a zig-zag of posters at 1.3 m", 600, true},
      {"structure_texture_far", "a zig-zag of posters at 2.3 m", 600, true},
      {"room_desk", "a desk with clutter in a room", 600, true},
      {"office", "a loop around desks with a partition wall in an office", 1200, true},
      {"corridor", "a long corridor of constant cross-section", 600, true},
      {"fold", "two textured planes that meet", 450, true},
      {"dual", "a textured floor with a plain stretch that fills the view for 3 s", 600, true},
      {"room", "a room with furniture and clutter along its walls", 600, true},
      {"flat", "three rooms and a corridor, 60 m by hand, back into the first two", 3600, true},
      {"twin_rooms", "two rooms that look the same, and a corridor between", 2000, true},
      {"ring", "a corridor around a block, its doors alike, walked 1.4 times", 2400, true},
      {"nostructure_notexture", "a plain floor: nothing to see at all", 300, false},
  };
  return scenes;
}

Result<SceneInfo> find_scene(const std::string& name) {
  std::vector<std::string> names;
  for (const SceneInfo& info : scene_names()) {
    if (info.name == name) return info;
    names.push_back(info.name);
  }
  return fail(ErrorCode::kInvalidArgument, fmt::format("no synthetic scene is called '{}'", name),
              "known scenes, the nearest first: " + nearest_first(names, name));
}

Status check_level(const std::string& level) {
  const std::vector<std::string> known = {"clean", "kinect", "hard", "varied", "real"};
  if (std::find(known.begin(), known.end(), level) != known.end()) return {};
  return fail(ErrorCode::kInvalidArgument, fmt::format("no sensor level is called '{}'", level),
              "known levels, the nearest first: " + nearest_first(known, level));
}

const std::vector<SceneOption>& scene_options() {
  static const std::vector<SceneOption> options = {
      {"walkers20", "somebody walks through, about 20 % of the view in the mean"},
      {"walkers40", "two walk through, 40 %"},
      {"walkers60", "three walk through, 60 %"},
      {"follower", "somebody stays before the camera"},
      {"box", "somebody pushes a box and leaves it there"},
      {"plain", "their clothes have no pattern"},
      {"still", "the camera stands"},
      {"turning", "the camera stands and turns to and fro"},
  };
  return options;
}

namespace {

Status apply_option(const std::string& name, SynthOptions& out) {
  constexpr std::string_view kWalkers = "walkers";
  if (name.starts_with(kWalkers)) {
    for (const int percent : {20, 40, 60})
      if (name == fmt::format("{}{}", kWalkers, percent)) {
        out.crowd.view_percent = percent;
        return {};
      }
  }
  if (name == "follower") return out.crowd.follower = true, Status();
  if (name == "box") return out.crowd.box = true, Status();
  if (name == "plain") return out.crowd.plain = true, Status();
  if (name == "still") return out.motion = CameraMotion::kStill, Status();
  if (name == "turning") return out.motion = CameraMotion::kTurning, Status();
  std::vector<std::string> names;
  for (const SceneOption& option : scene_options()) names.push_back(option.name);
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("no option of a synthetic scene is called '{}'", name),
              "known options, the nearest first: " + nearest_first(names, name));
}

}  // namespace

std::string scene_text(const SynthOptions& options) {
  std::string text = options.scene;
  const CrowdOptions& c = options.crowd;
  if (c.view_percent > 0) text += fmt::format("+walkers{}", c.view_percent);
  if (c.follower) text += "+follower";
  if (c.box) text += "+box";
  if (c.plain) text += "+plain";
  if (options.motion == CameraMotion::kStill) text += "+still";
  if (options.motion == CameraMotion::kTurning) text += "+turning";
  return text;
}

Result<SynthOptions> parse_synth_spec(std::string_view spec) {
  if (!is_synth_spec(spec))
    return fail(ErrorCode::kInvalidArgument, fmt::format("'{}' names no synthetic input", spec),
                "write synth:NAME or synth:NAME:LEVEL, or synth:NAME+OPTION:LEVEL");
  spec.remove_prefix(6);
  SynthOptions options;
  const std::size_t colon = spec.find(':');
  const std::string_view scene = spec.substr(0, colon);
  std::size_t plus = scene.find('+');
  options.scene = scene.substr(0, plus);
  if (colon != std::string_view::npos) options.level = spec.substr(colon + 1);
  if (auto info = find_scene(options.scene); !info) return tl::unexpected<Error>(info.error());
  SGS_RETURN_IF_ERROR(check_level(options.level));
  while (plus != std::string_view::npos) {
    const std::size_t next = scene.find('+', plus + 1);
    SGS_RETURN_IF_ERROR(
        apply_option(std::string(scene.substr(plus + 1, next - plus - 1)), options));
    plus = next;
  }
  return options;
}

}  // namespace sgs::synthetic
