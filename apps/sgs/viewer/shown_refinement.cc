// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "viewer/shown_refinement.h"

#include <fmt/format.h>

#include <functional>
#include <stop_token>

#include "interrupt.h"
#include "sgs/core/print.h"
#include "sgs/report/save_scores.h"
#include "sgs/run/refine.h"
#include "sgs/run/score.h"

namespace sgs::app {
namespace {

/// Shows refinement on the page; asked for once more there, it ends.
class ShownRefinement : public run::RunObserver {
 public:
  ShownRefinement(std::int64_t frames_total, const viewer::FrameUpdate& last,
                  std::uint64_t& map_version, viewer::Server& server)
      : frames_total_(frames_total), last_(last), map_version_(map_version), server_(server) {}

  void on_frames_read(std::int64_t frames) override {
    constexpr std::int64_t kTold = 25;
    end_if_asked();
    if (frames % kTold == 1) {
      server_.set_refinement(
          {true, 0, fmt::format("reading, {} of {} frames", frames, frames_total_)});
    }
  }
  void on_evaluation(const refine::Evaluation& now) override {
    end_if_asked();
    server_.set_refinement({true, now.share,
                            fmt::format("{:.2f} dB {}, {} Gaussians", now.psnr_db,
                                        now.heldout ? "held out" : "in training", now.gaussians)});
  }
  void on_better_map(const map::SplatMap& map) override {
    viewer::FrameUpdate update = last_;
    update.map = run::as_snapshot(map, ++map_version_);
    update.finished = true;
    server_.post(std::move(update));
  }
  std::stop_token stop() const { return enough_.get_token(); }

 private:
  void end_if_asked() {
    if (server_.control().take_refinement()) enough_.request_stop();
  }

  std::int64_t frames_total_;
  const viewer::FrameUpdate& last_;
  std::uint64_t& map_version_;
  viewer::Server& server_;
  std::stop_source enough_;
  std::stop_callback<std::function<void()>> interrupt_{stop_token(),
                                                       [this] { enough_.request_stop(); }};
};

Result<std::filesystem::path> refine(const run::Run& run, const std::filesystem::path& folder,
                                     ShownRefinement& observer, viewer::Server& server) {
  constexpr double kSeconds = 180;
  SGS_ASSIGN_OR_RETURN(auto out, run::RunFolder::create(run::refined_folder_of(folder)));
  run::RefineOptions options;
  options.budget.seconds = kSeconds;
  auto refined = run::refine_run(run, options, out, observer, observer.stop());
  if (!refined) {
    out.end(run::Stage::kInterrupted, 0, refined.error().message);
    return tl::unexpected(refined.error());
  }
  run::save_refine_parameters(folder.string(), options, out);
  report::save_scores(refined->run, run::score_trajectory(refined->run, {}), out);
  const refine::Refined& r = refined->refined;
  server.set_refinement({false, 1,
                         fmt::format("{:.2f} dB, before {:.2f}: {}", r.best.psnr_db,
                                     r.start.psnr_db, out.path().filename().string())});
  say("refined: {}\n", out.path().string());
  return out.path();
}

}  // namespace

Result<std::filesystem::path> refine_shown(const run::Run& run, const std::filesystem::path& folder,
                                           const viewer::FrameUpdate& last,
                                           std::uint64_t& map_version, viewer::Server& server) {
  ShownRefinement observer(run.frames_total, last, map_version, server);
  auto refined = refine(run, folder, observer, server);
  if (!refined) server.set_refinement({false, 0, refined.error().text()});
  return refined;
}

}  // namespace sgs::app
