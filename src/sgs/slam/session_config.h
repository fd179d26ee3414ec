// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

#include "sgs/backend/backend_config.h"
#include "sgs/camera/heldout.h"
#include "sgs/core/config.h"
#include "sgs/history/history_config.h"
#include "sgs/loops/loop_config.h"
#include "sgs/mapper/mapper_config.h"
#include "sgs/tracker/tracker_config.h"

namespace sgs::tracker {
class Tracker;  // tracker/tracker.h
}

namespace sgs::slam {

/// Where the values of a configuration start from: ours, the paper as we read it, or ours for
/// recordings where nobody waits (offline only; docs/refine.md).
enum class Preset { kDefault, kPaper, kQuality };

constexpr auto enum_names(Preset) {
  using enum Preset;
  return std::to_array<EnumName<Preset>>(
      {{kDefault, "default"}, {kPaper, "paper"}, {kQuality, "quality"}});
}

/// Everything that decides what a run computes. Same input, config and seed: same bits.
struct SessionConfig {
  Preset preset = Preset::kDefault;
  std::uint64_t seed = 0;
  int keyframe_interval = 8;
  int heldout_interval = kHeldoutInterval;
  int snapshot_lag = 2;
  int snapshot_interval = 10;
  int max_gap_frames = 30;
  tracker::TrackerConfig tracker;
  mapper::MapperConfig mapper;
  backend::BackendConfig backend;
  loops::LoopConfig loops;
  history::HistoryConfig history;

  void declare(ParameterList& p) {
    {
      const auto group = p.group("slam");
      p.add("preset", preset,
            "Preset that the values started from; to change it here changes none of them.");
      p.add("seed", seed, "Seed of every random choice.");
      p.add("keyframe_interval", keyframe_interval,
            "A mapping keyframe at least every so many frames.", "frames", {1, 1000});
      p.add("heldout_interval", heldout_interval,
            "Every n-th frame is kept from the mapper for evaluation; 0 uses all frames.", "frames",
            {0, 1000});
      p.add("snapshot_lag", snapshot_lag,
            "Frame t is tracked against the map that the budget of frame t - k left behind, so "
            "that tracking and mapping overlap and nothing depends on timing.",
            "frames", {1, 100});
      p.add("snapshot_interval", snapshot_interval,
            "A new map snapshot at least every so many frames (keyframes always make one).",
            "frames", {1, 1000});
      p.add("max_gap_frames", max_gap_frames,
            "With given poses a frame that comes after a gap counts for mapping as the frames of a "
            "video that would have filled it, up to so many.",
            "frames", {1, 10000});
      p.for_users({"preset", "seed", "keyframe_interval", "heldout_interval", "snapshot_lag",
                   "max_gap_frames"});
    }
    p.add_group("tracker", tracker);
    p.add_group("mapper", mapper);
    p.add_group("backend", backend);
    p.add_group("loops", loops);
    p.add_group("history", history);
  }
};

SessionConfig make_session_config(Preset preset);
/// The preset of that name; an unknown name is an error that lists them.
Result<SessionConfig> make_session_config(std::string_view preset);

/// Every value as a session with this tracker uses it: those of `config`, but for what the tracker
/// has no use for or cannot do with. Once more changes nothing.
SessionConfig effective(SessionConfig config, const tracker::Tracker& tracker);

}  // namespace sgs::slam
