// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/tracker_config.h"

namespace sgs::tracker {

void TrackerConfig::declare(ParameterList& p) {
  p.add("type", type,
        "Tracker: geometry and pictures jointly, the paper's, registration of depth alone, "
        "features alone, constant velocity, poses that are given, or alignment to the map as it "
        "would look.");
  p.add("fusion", fusion,
        "How `spectral` joins geometry and vision: geometry removed from its unseen axes, or plain "
        "sum.");
  p.renamed_word("fusion", "prior", "tracker.type = \"paper\"");
  p.for_users({"type", "fusion"});
  p.add_group("points", points);
  p.add_group("search", search);
  p.add_group("factor", factor);
  p.add_group("solver", solver);
  p.add_group("motion", motion);
  p.add_group("keyframe", keyframe);
  p.add_group("movers", movers);
  p.add_group("loss", loss);
  p.add_group("target", target);
  p.add_group("degeneracy", degeneracy);
  p.add_group("photometric", photometric);
  p.add_group("spectral", alignment);
  p.add_group("spectral", visual_keyframes);
  p.add_group("spectral", relocalisation);
  p.add_group("readout", readout);
  p.add_group("delay", delay);
  p.add_group("orb", orb);
  p.add_group("visual_pose", visual_pose);
  p.add_group("prior", prior);
  p.add_group("orb_tracking", orb_tracking);
  p.add_group("given", given);
  p.add_group("render", rendering);
}

TrackerConfig paper_tracker_config() {
  TrackerConfig c;
  c.type = TrackerType::kPaper;
  c.points.method = registration::SamplingMethod::kNeighbours;
  c.points.step_px = 5;
  c.points.min_depth_m = 0.01;
  c.points.max_depth_m = 3.0;
  c.search.method = registration::SearchMethod::kNearest;
  c.search.min_normal_cosine = -1;
  c.search.keep_matches_m = 0;
  c.factor.type = registration::FactorType::kGicp;
  c.factor.huber = 1.345;
  c.factor.reject = 1e9;
  c.solver = {.method = registration::SolverMethod::kLevenbergMarquardt,
              .max_iterations = 64,
              .damping = 1e-3,
              .max_step_rad = 0.1,
              .max_step_m = 0.03,
              .stop_rad = 2e-3,
              .stop_m = 5e-4};
  c.degeneracy.planarity_alone = true;
  c.motion.start = MotionStart::kPrevious;
  c.keyframe.clear_view = false;
  c.target.source = alignment::TargetSource::kOptimised;
  c.target.step_px = c.points.step_px;
  return c;
}

namespace {

alignment::GeometryConfig geometry_config(const TrackerConfig& all) {
  return {all.points, all.search, all.factor, all.target, all.keyframe, all.movers};
}

}  // namespace

alignment::AlignerConfig aligner_config(const TrackerConfig& all) {
  return {all.fusion,
          all.alignment,
          all.solver,
          all.degeneracy,
          all.loss,
          geometry_config(all),
          {all.photometric, all.visual_keyframes}};
}

RelocaliserConfig::RelocaliserConfig(const TrackerConfig& all)
    : memory(all.relocalisation), orb(all.orb), pose(all.visual_pose) {}

SpectralConfig::SpectralConfig(const TrackerConfig& all)
    : aligner(aligner_config(all)),
      motion(all.motion),
      readout(all.readout),
      delay(all.delay),
      relocaliser(all) {}

GicpConfig::GicpConfig(const TrackerConfig& all)
    : solver(all.solver),
      degeneracy(all.degeneracy),
      motion(all.motion),
      loss(all.loss),
      geometry(geometry_config(all)) {}

PaperConfig::PaperConfig(const TrackerConfig& all)
    : registration(all), prior(all.prior), orb(all.orb), visual_pose(all.visual_pose) {}

OrbTrackerConfig::OrbTrackerConfig(const TrackerConfig& all)
    : motion(all.motion), orb(all.orb), visual_pose(all.visual_pose), tracking(all.orb_tracking) {}

RenderTrackerConfig::RenderTrackerConfig(const TrackerConfig& all)
    : aligner(aligner_config(all)), motion(all.motion), rendering(all.rendering) {}

}  // namespace sgs::tracker
