// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "finished_run.h"

#include <fmt/format.h>

#include <algorithm>

#include "frame_table.h"
#include "run_request.h"
#include "sgs/core/log.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/image_io.h"
#include "sgs/io/ply.h"
#include "sgs/io/trajectory_io.h"

namespace sgs::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPictureList = "pictures.csv";

fs::path picture_name(std::int64_t index, const char* what) {
  return fmt::format("{:06}_{}.png", index, what);
}

}  // namespace

Result<LoadedRun> load_finished_run(const std::string& folder) {
  LoadedRun loaded;
  FinishedRun& run = loaded.run;
  SGS_ASSIGN_OR_RETURN(auto saved, load_saved_run(folder));
  run.input = saved.input;
  run.config = saved.config;
  const fs::path path = folder;
  SGS_ASSIGN_OR_RETURN(auto trajectory, io::load_trajectory(path / "trajectory.txt"));
  run.trajectory = std::move(trajectory.trajectory);
  SGS_ASSIGN_OR_RETURN(auto truth, io::load_trajectory(path / "groundtruth.txt"));
  run.truth = std::move(truth.trajectory);
  SGS_ASSIGN_OR_RETURN(run.gaussians, io::load_splats(path / "map.ply"));
  SGS_ASSIGN_OR_RETURN(run.frames_csv, io::read_file(path / "frames.csv"));
  SGS_ASSIGN_OR_RETURN(run.config_toml, io::read_file(path / "config.toml"));
  // What only draws something may be missing.
  if (auto keyframes = io::load_trajectory(path / "keyframes.txt")) {
    run.keyframes = std::move(keyframes->trajectory);
  }
  if (auto timings = io::read_file(path / "timings.json")) run.timings_json = *timings;
  // What only the run itself could measure (speed, memory) is kept where it is known.
  if (std::error_code error; fs::exists(path / "metrics.json", error)) {
    SGS_ASSIGN_OR_RETURN(loaded.metrics, eval::load_metrics(path / "metrics.json"));
  }
  loaded.metrics.seed = static_cast<std::int64_t>(run.config.seed);
  loaded.metrics.preset = to_string(run.config.preset);
  loaded.metrics.tracker = to_string(run.config.tracker.type);
  run.name = fs::path(run.input.input).filename().string();
  run.frames = std::count(run.frames_csv.begin(), run.frames_csv.end(), '\n') - 1;
  run.frames = std::max(run.frames, loaded.metrics.frames.value_or(0));
  return loaded;
}

void save_pictures(const std::vector<eval::FramePictures>& pictures, RunFolder& folder) {
  std::string list = "index,heldout,psnr_full_db\n";
  for (const eval::FramePictures& p : pictures) {
    const auto save = [&](const char* what, const ColorImage& image) {
      folder.save("renders" / picture_name(p.index, what),
                  [&](const fs::path& path) { return io::save_color(path, image); });
    };
    save("truth", p.truth);
    save("render", p.rendering);
    save("error", p.error);
    list += fmt::format("{},{:d},{:.6g}\n", p.index, p.heldout, p.psnr_full_db);
  }
  if (!pictures.empty()) folder.save_text(fs::path("renders") / kPictureList, list);
}

std::vector<eval::FramePictures> load_pictures(const fs::path& folder) {
  std::vector<eval::FramePictures> pictures;
  const auto text = io::read_file(folder / "renders" / kPictureList);
  if (!text) return pictures;
  const auto table = FrameTable::parse(*text, kPictureList);
  if (!table) return pictures;
  const auto indices = table->numbers("index"), heldout = table->numbers("heldout");
  const auto psnr = table->numbers("psnr_full_db");
  for (std::size_t i = 0; i < table->rows(); ++i) {
    const auto index = static_cast<std::int64_t>(indices[i]);
    const auto load = [&](const char* what) {
      return io::load_color(folder / "renders" / picture_name(index, what));
    };
    auto truth = load("truth"), rendering = load("render"), error = load("error");
    if (!truth || !rendering || !error) {
      log().warn("a picture of frame {} is missing in {}", index, folder.string());
      continue;
    }
    pictures.push_back({index, heldout[i] == 1, psnr[i], std::move(*truth), std::move(*rendering),
                        std::move(*error)});
  }
  return pictures;
}

}  // namespace sgs::app
