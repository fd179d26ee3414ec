// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/execute.h"

#include <memory>
#include <utility>
#include <vector>

#include "sgs/core/log.h"
#include "sgs/core/memory_reserve.h"
#include "sgs/core/stopwatch.h"
#include "sgs/input/inertial.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/ply.h"
#include "sgs/io/trajectory_io.h"
#include "sgs/run/input_doubts.h"
#include "sgs/run/lasting_map.h"
#include "sgs/run/live_desk.h"
#include "sgs/run/machine.h"
#include "sgs/run/process_memory.h"
#include "sgs/runfolder/journal.h"
#include "sgs/runfolder/map_checkpoints.h"
#include "sgs/runfolder/resume_file.h"
#include "sgs/runfolder/run_config.h"
#include "sgs/runfolder/run_files.h"
#include "sgs/runfolder/timings.h"
#include "sgs/runfolder/version.h"
#include "sgs/stream/address.h"
#include "sgs/tracker/delay_estimator.h"
#include "sgs/upright/upright.h"

namespace sgs::run {
namespace {

/// What the run itself can measure; scores are added later.
eval::Metrics run_metrics(const RunOptions& options, const slam::SessionConfig& config,
                          const slam::Session& session, const RunClock& clock,
                          const StageTimes& times) {
  constexpr std::int64_t kBytesPerGaussian = sizeof(map::Gaussian);
  eval::Metrics m;
  const auto snapshot = session.final_snapshot();
  m.gaussians = snapshot ? static_cast<std::int64_t>(snapshot->gaussians.size()) : 0;
  m.map_bytes = kBytesPerGaussian * *m.gaussians;
  m.keyframes = static_cast<std::int64_t>(session.keyframes().size());
  m.mapping_iterations = session.iterations();
  const auto fed = static_cast<double>(session.records().size() - clock.frames_replayed);
  const double system_s = clock.wall_s - clock.starved_s;
  if (fed > 1 && system_s > 0) m.fps_system = fed / system_s;
  if (fed > 1 && clock.wall_s > 0) m.fps_wall = fed / clock.wall_s;
  if (const auto it = times.stages().find("map/iteration"); it != times.stages().end()) {
    m.map_iteration_ms_p50 = quantile(it->second.values_ms, 0.5);
  }
  if (const auto rss = peak_rss_bytes(); rss > 0) m.peak_rss_bytes = rss;
  if (const auto loops = session.loop_counts()) {
    m.loops_accepted = loops->accepted;
    m.loops_rejected = loops->gated + loops->taken_back;
    m.corrections = loops->corrections;
  }
  if (options.realtime) m.frames_dropped = clock.frames_dropped;
  m.seed = static_cast<std::int64_t>(config.seed);
  m.threads = options.threads;
  m.preset = to_string(config.preset);
  m.tracker = to_string(config.tracker.type);
  m.version = version();
  m.host = host_name();
  m.cpu = this_cpu();
  return m;
}

bool tracking_was_lost(const std::vector<slam::FrameRecord>& frames) {
  std::int64_t lost = 0, all = 0;
  bool last_lost = false;
  for (const slam::FrameRecord& frame : frames) {
    if (frame.bad) continue;
    last_lost = frame.status == tracker::TrackingStatus::kLost;
    lost += last_lost ? 1 : 0;
    ++all;
  }
  return all == 0 || last_lost || 2 * lost > all;
}

/// What keeps a run on the disk while it goes on.
class Keeper {
 public:
  Keeper(const RunFolder& folder, const std::vector<NamedWriter>& opening, slam::Session& session,
         double checkpoint_s, bool live)
      : session_(session),
        journal_(folder.resumed() ? Journal::resume(folder.lock(), opening)
                                  : std::make_unique<Journal>(folder.lock(), opening)) {
    if (checkpoint_s > 0) {
      CheckpointSource source;
      source.map = [&session] { return session.snapshot(); };
      if (!live && session.can_be_saved()) source.state = [&session] { return session.save(); };
      checkpoints_.emplace(folder.lock(), checkpoint_s, std::move(source));
    }
    for (const slam::FrameRecord& record : session.records().all()) add(record);
  }
  void add(const slam::FrameRecord& record) {
    journal_->add(record);
    if (checkpoints_) checkpoints_->add(record, session_.calibration());
  }
  /// Makes a checkpoint of what there is: the run is asked to stop.
  void add_last() {
    if (checkpoints_) checkpoints_->add_last();
  }

 private:
  const slam::Session& session_;
  std::unique_ptr<Journal> journal_;
  std::optional<MapCheckpoints> checkpoints_;
};

/// Keeps what happens, then tells whoever watches.
class KeepingObserver : public RunObserver {
 public:
  /// `keeper` and `desk` are null while nothing new happens.
  KeepingObserver(Keeper* keeper, LiveDesk* desk, const RunFolder& folder, RunObserver& next,
                  std::stop_token stop)
      : keeper_(keeper), desk_(desk), folder_(folder), next_(next), stop_(std::move(stop)) {}

  double before_frame(const std::function<void()>& held) override {
    const auto serve = [this] {
      if (desk_ != nullptr) desk_->serve();
    };
    serve();
    return next_.before_frame([&] {
      held();
      serve();
    });
  }
  void on_status(const LiveStatus& now) override { next_.on_status(now); }
  void on_frame(slam::Session& session, const dataset::FeedItem& item,
                const slam::FrameRecord& record) override {
    if (keeper_ != nullptr) keeper_->add(record);
    next_.on_frame(session, item, record);
  }
  void on_input_event(const std::string& what) override {
    folder_.note_input(what);
    next_.on_input_event(what);
  }
  void on_last_frame() override {
    if (keeper_ != nullptr && stop_.stop_requested()) keeper_->add_last();
    next_.on_last_frame();
  }

 private:
  Keeper* keeper_;
  LiveDesk* desk_;
  const RunFolder& folder_;
  RunObserver& next_;
  std::stop_token stop_;
};

/// Trackers follow a motion; what they are told to do with single views should not surprise.
void warn_of_single_views(const Input& input, const tracker::Tracker& tracker) {
  if (!input.info.sparse || !tracker.needs_video()) return;
  log().warn(
      "the frames of {} are single views, too far apart for a tracker: expect it to be lost. "
      "{} --tracker given{}",
      input.info.name,
      input.info.truth_rows > 0 ? "Their recorded poses are used with"
                                : "Where their poses are known, use",
      input.info.truth_rows > 0 ? "" : " --poses FILE");
}

/// Brings the session to where the run was when its checkpoint was made.
Status resume_session(const ResumePoint& point, Input& input, slam::Session& session,
                      RunFolder& folder, RunObserver& observer, const std::stop_token& stop) {
  if (!point.checkpoint.empty()) {
    {
      SGS_ASSIGN_OR_RETURN(const auto state, load_resume_file(point.checkpoint));
      SGS_RETURN_IF_ERROR(session.restore(state));
    }
    KeepingObserver keeping(nullptr, nullptr, folder, observer, stop);
    SGS_RETURN_IF_ERROR(replay(*input.source, session, keeping, stop));
  }
  log().info("the run goes on at frame {}", session.records().size());
  return folder.mark_resumed(input.calibration.has_value());
}

/// How the run ended.
RunState state_of(const RunResult& result) {
  RunState state;
  const char* why = memory_ran_short() ? "the memory was used up" : "stopped by request";
  if (result.stopped) state = {Stage::kInterrupted, "", 0, why, true};
  if (!result.input) state = {Stage::kInterrupted, "", 0, result.input.error().message, true};
  return state;
}

/// Results, and that they are there. Once more where somebody removed the folder meanwhile.
void write_end(const slam::Session& session, const Run& run,
               const std::vector<mapfile::MapSession>& earlier, RunFolder& folder, int threads) {
  // A camera that was only to find itself in a map, or has not, leaves none.
  const bool leaves_map =
      session.place_search() == nullptr || (run.input.extends_map && session.place_search()->found);
  for (int attempt = 0; attempt < 2; ++attempt) {
    const int made_again = folder.lock()->times_made_again();
    save_run(run, folder);
    if (leaves_map) {
      folder.save(files::kLastingMap, [&](const auto& path) {
        return save_lasting_map(path, session, run, earlier, threads);
      });
    }
    folder.end(run.state.stage, run.frames.size(), run.state.reason);
    if (made_again == folder.lock()->times_made_again()) return;
  }
}

/// Which way is up in the world of the run, from what lies beside its frames and from its map. What
/// is wrong with an accelerometer is told, and no reason to end.
std::optional<Upright> upright_along(const Input& input, const slam::Session& session,
                                     const Trajectory& path) {
  const dataset::ImuRecording imu = read_imu(input);
  std::vector<std::string> warnings = imu.warnings;
  const auto snapshot = session.final_snapshot();
  const auto patches = snapshot ? patches_of(*snapshot) : std::vector<Patch>();
  const auto upright = find_upright(imu, path, patches, warnings);
  for (const std::string& warning : warnings) log().warn("{}", warning);
  if (upright) log().info("{}", upright->sentence());
  return upright;
}

/// What is scored is what was written, to the last bit: evaluating the folder later finds the same
/// numbers.
void read_back(const RunFolder& folder, Run& run) {
  if (auto written = io::load_splats(folder.path() / files::kMap)) {
    run.gaussians = std::move(written->gaussians);
  }
  for (const auto& [name, poses] : {std::pair(files::kTrajectory, &run.trajectory),
                                    std::pair(files::kKeyframes, &run.keyframes)}) {
    if (auto written = io::load_trajectory(folder.path() / name)) {
      *poses = std::move(written->trajectory);
    }
  }
  if (auto text = io::read_file(folder.path() / files::kFrames)) {
    if (auto written = slam::frames_from_csv(*text, files::kFrames)) {
      run.frames = std::move(*written);
    }
  }
}

Result<RunResult> run_in(Input& input, const InputSpec& spec, const RunConfig& asked,
                         const RunOptions& options, RunFolder& folder, RunObserver& observer,
                         const std::stop_token& stop) {
  SGS_CHECK(folder.lock() != nullptr, "a run needs a folder of its own");
  slam::SessionOptions session_options;
  session_options.threads = options.threads;
  session_options.live = options.realtime;
  const PinholeCamera camera = input.source->camera();
  SGS_ASSIGN_OR_RETURN(auto session, slam::Session::create(asked.session, camera, session_options));
  std::vector<mapfile::MapSession> earlier;
  if (!spec.map.empty()) {
    SGS_ASSIGN_OR_RETURN(earlier, give_map(*session, spec, camera, input.calibration.has_value()));
  }
  // What the folder keeps is what runs.
  const RunConfig config{session->config(), asked.refine};
  warn_of_single_views(input, session->tracker());
  Run beginning = beginning_of(input, spec, config);
  if (options.resume) beginning.config_toml = options.resume->config_toml;
  std::vector<NamedWriter> opening = opening_files(beginning);
  if (!options.resume) {
    for (const NamedWriter& file : opening) folder.save(file.name, file.write);
  }
  const bool live = options.realtime || stream::is_stream(spec.input);  // frames come only once
  if (!options.record.empty()) folder.note_recording(options.record);
  if (live) SGS_RETURN_IF_ERROR(folder.mark_live());
  opening.push_back({files::kState, [text = state_text(folder.beginning())](const auto& path) {
                       return io::write_file(path, text);
                     }});
  if (options.resume) {
    SGS_RETURN_IF_ERROR(resume_session(*options.resume, input, *session, folder, observer, stop));
  }
  const std::size_t replayed = session->records().size();
  std::optional<LiveDesk> desk(std::in_place, input, options.realtime, folder, *session, observer);
  if (!options.record.empty()) SGS_RETURN_IF_ERROR(desk->record(options.record));
  std::optional<Keeper> keeper(std::in_place, folder, opening, *session, options.checkpoint_s,
                               live);
  KeepingObserver keeping(&*keeper, &*desk, folder, observer, stop);
  auto clock = play(*input.source, *session, {options.realtime, &desk->recorder(), options.enough},
                    keeping, stop);
  keeper.reset();
  const std::vector<Error> not_recorded = desk->close();
  if (clock) {
    clock->frames_replayed = replayed;
    clock->frames_in += static_cast<std::int64_t>(replayed);
  }
  RunResult result;
  result.recording = desk->recording();
  if (!result.recording.empty()) folder.note_recording(result.recording);
  desk.reset();
  if (!clock) result.input = tl::unexpected(clock.error());
  result.stopped = stop.stop_requested();
  observer.on_map(*session);

  const StageTimes times = session->times();
  Run& run = result.run;
  run = run_of(*session, input, spec, config.refine);
  run.config_toml = beginning.config_toml;
  run.upright = upright_along(input, *session, run.trajectory);
  run.metrics = run_metrics(options, config.session, *session, clock.value_or(RunClock{}), times);
  if (run.upright) run.metrics.upright = to_string(run.upright->by);
  if (clock) run.frames_total = clock->frames_in;
  result.lost = tracking_was_lost(run.frames);
  if (const auto* search = session->place_search(); search != nullptr && !search->found) {
    result.not_found = not_found_sentence(*search, spec.map);
  }
  // At the sensor's rate frames are dropped for want of time, and given poses choose theirs.
  const bool chosen =
      options.realtime || result.stopped || options.enough.stop_requested() || !spec.poses.empty();
  if (!chosen) result.too_few = too_few_frames(run.frames, spec, input.info).value_or("");
  run.state = state_of(result);
  run.metrics.state = run.state.word();
  write_end(*session, run, earlier, folder, options.threads);
  // Only now: the run itself is whole.
  for (const Error& failure : not_recorded) folder.note_failure(failure);
  if (!options.trace.empty()) {
    if (const auto traced = io::write_file(
            options.trace, chrome_trace(times, clock ? clock->events : std::vector<InputEvent>{}));
        !traced) {
      folder.note_failure(traced.error());
    }
  }
  read_back(folder, run);
  return result;
}

}  // namespace

Result<RunResult> execute(Input& input, const InputSpec& spec, const RunConfig& config,
                          const RunOptions& options, RunFolder& folder, RunObserver& observer,
                          const std::stop_token& stop) {
  RunConfig used = config;
  if (input.calibration) {
    // It would see no raw depth; and the delay is known.
    used.session.backend.calibration.online = false;
    auto& delay = used.session.tracker.delay;
    delay = tracker::beside(delay, *input.calibration);
  }
  if (!spec.map.empty()) {
    // The metre is that of the map; and where nothing of it is to change, it stays where it is.
    used.session.backend.calibration.online = false;
    used.session.loops.enabled = used.session.loops.enabled && spec.extends_map;
  }
  auto result = run_in(input, spec, used, options, folder, observer, stop);
  if (!result && !folder.resumed()) folder.end(Stage::kInterrupted, 0, result.error().message);
  return result;
}

}  // namespace sgs::run
