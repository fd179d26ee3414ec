// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "viewer/replay.h"

#include <filesystem>

#include "frame_table.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/ply.h"
#include "sgs/io/trajectory_io.h"
#include "version.h"

namespace sgs::app {
namespace {

namespace fs = std::filesystem;

map::SnapshotPtr as_snapshot(std::vector<map::Gaussian> gaussians) {
  auto snapshot = std::make_shared<map::Snapshot>();
  snapshot->version = 1;
  snapshot->anchors.resize(gaussians.size());
  for (std::size_t i = 0; i < gaussians.size(); ++i) {
    snapshot->anchors[i].id = static_cast<std::uint32_t>(i);
  }
  snapshot->gaussians = std::move(gaussians);
  return snapshot;
}

tracker::TrackingStatus parse_status(const std::string& text) {
  using tracker::TrackingStatus;
  for (const auto status : {TrackingStatus::kOk, TrackingStatus::kDegenerate}) {
    if (text == tracker::to_string(status)) return status;
  }
  return TrackingStatus::kLost;
}

/// frames.csv as records; columns that are missing stay at their defaults.
std::vector<slam::FrameRecord> records_of(const FrameTable& table) {
  std::vector<slam::FrameRecord> records(table.rows());
  const auto each = [&](const std::string& name, auto&& set) {
    const auto values = table.numbers(name);
    for (std::size_t i = 0; i < records.size(); ++i) {
      if (std::isfinite(values[i])) set(records[i], values[i]);
    }
  };
  using R = slam::FrameRecord;
  each("index", [](R& r, double v) { r.index = static_cast<std::int64_t>(v); });
  each("timestamp_s", [](R& r, double v) { r.timestamp_s = v; });
  each("mapping_keyframe", [](R& r, double v) { r.mapping_keyframe = v != 0; });
  each("track_ms", [](R& r, double v) { r.track_ms = v; });
  each("gaussians", [](R& r, double v) { r.gaussians = static_cast<std::int64_t>(v); });
  each("mapping_iterations", [](R& r, double v) { r.iterations = static_cast<std::int64_t>(v); });
  each("inliers", [](R& r, double v) { r.diagnostics.inliers = static_cast<int>(v); });
  each("visual_inliers",
       [](R& r, double v) { r.diagnostics.visual_inliers = static_cast<int>(v); });
  each("overlap", [](R& r, double v) { r.diagnostics.overlap = v; });
  each("condition_number", [](R& r, double v) { r.diagnostics.condition_number = v; });
  each("planarity", [](R& r, double v) { r.diagnostics.planarity = v; });
  each("prior_active", [](R& r, double v) { r.diagnostics.prior_active = v != 0; });
  each("degenerate_mask",
       [](R& r, double v) { r.diagnostics.degenerate_mask = static_cast<unsigned>(v); });
  for (std::size_t k = 0; k < 6; ++k) {
    const auto column = [k](const char* name) { return fmt::format("{}_{}", name, k); };
    each(column("eigenvalue"), [k](R& r, double v) { r.diagnostics.eigenvalues[k] = v; });
    each(column("snr"), [k](R& r, double v) { r.diagnostics.snr[k] = v; });
    each(column("weight"), [k](R& r, double v) { r.diagnostics.weights[k] = v; });
  }
  const auto status = table.texts("status"), prior = table.texts("prior_source");
  for (std::size_t i = 0; i < records.size(); ++i) {
    records[i].bad = status[i] == "bad";
    records[i].status = parse_status(status[i]);
    const auto source = from_string<tracker::PriorSource>("prior source", prior[i]);
    if (source) records[i].diagnostics.prior_source = *source;
  }
  return records;
}

/// The axes of observability, frame by frame; empty where the tracker did not hand them out.
std::vector<std::optional<Matrix6d>> axes_of(const FrameTable& table) {
  std::vector<std::optional<Matrix6d>> axes(table.rows(), Matrix6d::Zero());
  for (int k = 0; k < 36; ++k) {
    const auto values = table.numbers(fmt::format("axis_{}_{}", k / 6, k % 6));
    for (std::size_t i = 0; i < axes.size(); ++i) {
      if (!std::isfinite(values[i])) axes[i].reset();
      if (axes[i]) axes[i]->data()[k] = values[i];
    }
  }
  return axes;
}

/// The ground truth moved so that its first pose is the estimate's.
void add_truth(const Trajectory& truth, std::vector<viewer::FrameUpdate>& updates) {
  constexpr double kMaxGap_s = 0.1;
  std::optional<SE3> T_world_truth;
  for (viewer::FrameUpdate& update : updates) {
    const auto pose = truth.at(update.record.timestamp_s, kMaxGap_s);
    if (!pose) continue;
    if (!T_world_truth) T_world_truth = update.T_world_camera * pose->inverse();
    update.truth = *T_world_truth * *pose;
  }
}

}  // namespace

Result<Replay> load_replay(const std::string& folder) {
  const fs::path path = folder;
  SGS_ASSIGN_OR_RETURN(const auto saved, load_saved_run(folder));
  SGS_ASSIGN_OR_RETURN(const auto csv, io::read_file(path / "frames.csv"));
  SGS_ASSIGN_OR_RETURN(const auto table, FrameTable::parse(csv, (path / "frames.csv").string()));
  SGS_ASSIGN_OR_RETURN(const auto trajectory, io::load_trajectory(path / "trajectory.txt"));
  SGS_ASSIGN_OR_RETURN(auto gaussians, io::load_splats(path / "map.ply"));
  Replay replay;
  replay.input = saved.input;
  replay.map = as_snapshot(std::move(gaussians));
  replay.info.version = kVersion;
  replay.info.input = fs::path(saved.input.input).filename().string();
  replay.info.preset = to_string(saved.config.preset);
  replay.info.tracker = to_string(saved.config.tracker.type);
  replay.info.live = false;
  replay.info.frames_total = static_cast<std::int64_t>(table.rows());
  auto records = records_of(table);
  const auto axes = axes_of(table);
  for (std::size_t i = 0; i < records.size(); ++i) {
    slam::FrameRecord& record = records[i];
    const auto pose = trajectory.trajectory.at(record.timestamp_s, 0);
    if (record.bad || !pose) continue;
    viewer::FrameUpdate update;
    update.record = std::move(record);
    update.T_world_camera = *pose;
    update.axes = axes[i];
    update.map = replay.map;
    replay.updates.push_back(std::move(update));
  }
  if (replay.updates.empty()) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: no frame of frames.csv has a pose in trajectory.txt", folder),
                "is it the folder of a finished run?");
  }
  std::error_code error;
  if (fs::exists(path / "groundtruth.txt", error)) {
    SGS_ASSIGN_OR_RETURN(const auto truth, io::load_trajectory(path / "groundtruth.txt"));
    add_truth(truth.trajectory, replay.updates);
  }
  if (fs::exists(path / "metrics.json", error)) {
    SGS_ASSIGN_OR_RETURN(replay.metrics_json, io::read_file(path / "metrics.json"));
  }
  return replay;
}

}  // namespace sgs::app
