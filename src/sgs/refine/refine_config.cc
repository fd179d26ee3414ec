// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/refine/refine_config.h"

#include "sgs/map/harmonics.h"

namespace sgs::refine {
namespace {

/// Names of before the mapper's groups were used.
void declare_former(ParameterList& p) {
  for (const char* rate : {"rate_mean_m", "rate_log_scale", "rate_rotation", "rate_opacity",
                           "rate_color", "beta2", "max_axis_ratio", "max_flatness"}) {
    p.renamed(rate, std::string("optimizer.") + rate);
  }
  for (const char* weight : {"color_weight", "color_knee", "depth_weight", "dssim_weight"}) {
    p.renamed(weight, std::string("objective.") + weight);
  }
  for (const char* name : {"exposure", "exposure_prior", "pose_share"}) {
    p.renamed(name, std::string("keyframes.") + name);
  }
  p.renamed("poses", "keyframes.pose");
  for (const char* name : {"interval", "from", "until"}) {
    p.renamed(std::string("densify_") + name, std::string("densify.") + name);
  }
  for (const char* name : {"split_share", "prune_opacity"}) {
    p.renamed(name, std::string("densify.") + name);
  }
  p.removed("pose_prior", "keyframes.pose_prior_rotation and pose_prior_translation say it");
  p.removed("half_resolution_until", "it was off, and nothing measured spoke for it");
  p.removed("opacity_decay", "it was off, and nothing measured spoke for it");
  p.removed("harmonics_decay", "a bound holds the coefficients, which costs less (decision 45)");
  p.removed("split_size_power", "it is the square root");
}

}  // namespace

void RefineConfig::declare(ParameterList& p) {
  p.add("steps_per_frame", steps_per_frame,
        "A run ends by refining its map, with so many steps for each of its frames; 0 = it does "
        "not.",
        "steps", {0, 1e6});
  p.add("least_steps", least_steps,
        "But not with fewer than these: a short recording has few frames to learn from, each of "
        "them as rich as any.",
        "steps", {1, 1e9});
  p.add("memory_mb", memory_mb,
        "Memory for the pictures; of a longer recording the sharpest of each n frames are used.",
        "MiB", {16, 1e6});
  p.add("rolling_shutter", rolling_shutter,
        "Learn from pictures as the camera's rolling shutter took them, with the readout time that "
        "the run has learned, and judge them so: a sharper map, whose pictures by a global shutter "
        "are less like the recording's.");
  p.add("checks", checks, "How often the held-out frames are looked at.", "", {1, 1000});
  p.add("patience", patience, "Checks without anything better after which it ends; 0 = never.", "",
        {0, 1000});
  p.add("max_gaussians", max_gaussians,
        "The map grows to so many Gaussians; a larger one does not grow.", "", {1, 1e8});
  p.add("hole_views", hole_views,
        "In so many views, spread evenly, holes of the map are filled first.", "", {0, 10000});
  p.add("harmonics", harmonics,
        "Degree of the spherical harmonics by which colours depend on where they are seen from; "
        "0 = they do not.",
        "", {0, map::kMaxHarmonicDegree});
  p.add("rate_harmonics", rate_harmonics,
        "Adam rate of the harmonics' coefficients, in units of that of the colours.", "", {0, 10});
  p.add("rate_end", rate_end, "Share of all rates that is left at the end.", "", {1e-4, 1});
  p.add("warmup_steps", warmup_steps,
        "Over so many steps, or a tenth of the budget, rates rise from zero; 0 = at once.", "steps",
        {0, 1000000});
  p.add("least_sigma_px", least_sigma_px,
        "No axis gets thinner than this in the nearest view that saw it, so that the map looks "
        "right from nearer and farther, too.",
        "px", {0, 10});
  p.add_group("optimizer", optimizer);
  p.add_group("objective", objective);
  p.add_group("keyframes", keyframes);
  p.add_group("densify", densify);
  p.for_users({"steps_per_frame", "least_steps", "memory_mb", "rolling_shutter", "checks",
               "patience", "max_gaussians", "harmonics", "objective.dssim_weight"});
  declare_former(p);
}

}  // namespace sgs::refine
