// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/live_desk.h"

#include <fmt/format.h>

#include <chrono>
#include <utility>

#include "sgs/core/log.h"
#include "sgs/core/low_priority.h"
#include "sgs/export/convert.h"
#include "sgs/input/inertial.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/ply.h"
#include "sgs/io/trajectory_io.h"
#include "sgs/runfolder/run_files.h"

namespace sgs::run {
namespace fs = std::filesystem;
namespace {

FrameRecorder::Options recorder_options(const Input& input, bool drops) {
  constexpr std::size_t kUntilDropped = 60, kUntilWaited = 16;  // frames, 2 MB each
  FrameRecorder::Options options;
  options.camera = input.source->camera();
  options.writer = recording_options(input);
  options.wait = !drops;
  options.queue = drops ? kUntilDropped : kUntilWaited;
  return options;
}

SaveNote save_to(const fs::path& folder, const map::Snapshot& map, const Trajectory& path) {
  const auto write = [&]() -> Status {
    SGS_RETURN_IF_ERROR(io::make_folder(folder));
    SGS_RETURN_IF_ERROR(io::save_trajectory(folder / files::kTrajectory, path));
    return io::save_splats(folder / files::kMap, map.gaussians);
  };
  Status written;
  try {
    written = write();
  } catch (...) {
    written = tl::unexpected(current_error());
  }
  if (!written) {
    log().warn("what there is cannot be saved: {}", written.error().text());
    return {false, folder, "not saved: " + written.error().message};
  }
  auto text = fmt::format("saved {} Gaussians and {} poses", map.gaussians.size(), path.size());
  log().info("{} to {}", text, folder.string());
  return {true, folder, std::move(text)};
}

}  // namespace

LiveDesk::LiveDesk(const Input& input, bool drops, const RunFolder& folder, slam::Session& session,
                   RunObserver& observer)
    : input_(input),
      folder_(folder),
      session_(session),
      observer_(observer),
      recorder_(recorder_options(input, drops)) {}

Status LiveDesk::record(const fs::path& folder) {
  SGS_RETURN_IF_ERROR(recorder_.start(folder));
  recordings_.push_back(folder);
  return {};
}

void LiveDesk::serve() {
  if (const auto wanted = observer_.take_recording()) {
    if (!*wanted && recorder_.status().on) {
      recorder_.stop();
      keep_samples();
    } else if (*wanted && !recorder_.status().on) {
      if (const Status begun = record(free_folder()); !begun) {
        log().warn("recording: {}", begun.error().text());
      }
    }
  }
  save_wanted_ = observer_.take_save() || save_wanted_;
  if (!save_wanted_) return;
  // One at a time; what is asked for meanwhile comes after it.
  if (saving_.valid() && saving_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
    return;
  }
  save_wanted_ = false;
  save();
}

void LiveDesk::save() {
  auto map = session_.snapshot();
  if (!map) return observer_.on_saved({false, {}, "not saved: there is no map yet"});
  const fs::path folder = folder_.path() / files::kSaved;
  saving_ = std::async(std::launch::async,
                       [this, folder, map = std::move(map), path = session_.trajectory_so_far()] {
                         constexpr int kNice = 5;
                         lower_thread_priority(kNice);
                         observer_.on_saved(save_to(folder, *map, path));
                       });
}

std::vector<Error> LiveDesk::close() {
  if (saving_.valid()) saving_.wait();
  if (recorder_.status().on) {
    recorder_.stop();
    keep_samples();
  }
  std::vector<Error> failures;
  if (const Status failure = recorder_.failure(); !failure) failures.push_back(failure.error());
  return failures;
}

fs::path LiveDesk::recording() const {
  return recordings_.empty() ? fs::path() : recordings_.back();
}

// What an inertial unit has measured until now.
void LiveDesk::keep_samples() {
  if (const Status kept = keep_imu(input_, recordings_.back()); !kept) {
    log().warn("{}", kept.error().text());
  }
}

fs::path LiveDesk::free_folder() const {
  std::error_code error;
  for (int number = 1;; ++number) {
    const auto name = number == 1 ? std::string(files::kRecording)
                                  : fmt::format("{}-{}", files::kRecording, number);
    if (!fs::exists(folder_.path() / name, error)) return folder_.path() / name;
  }
}

}  // namespace sgs::run
