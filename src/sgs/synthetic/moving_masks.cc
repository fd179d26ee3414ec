// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/moving_masks.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "sgs/synthetic/crowd.h"
#include "sgs/synthetic/lens_rays.h"
#include "sgs/synthetic/ray_caster.h"
#include "sgs/synthetic/schedule.h"

namespace sgs::synthetic {

namespace {

// More than 3 cm in 1/30 s, more than 3 mm, less.
std::uint8_t value_of(float step_m) {
  constexpr float kFast_m = 0.03f, kSlow_m = 0.003f;
  if (step_m > kFast_m) return 255;
  return step_m > kSlow_m ? 170 : 85;
}

class CastMasks final : public MovingMasks {
 public:
  CastMasks(const SynthOptions& options, std::shared_ptr<const Scene> scene, Trajectory motion,
            const Trajectory& whole_motion)
      : options_(options),
        scene_(std::move(scene)),
        motion_(std::move(motion)),
        sensor_(SensorModel::of_level(options.level, options.seed), options.camera, options.seed),
        pool_(std::max(1, options.threads)),
        schedule_(schedule_of(options, motion_, sensor_)),
        crowd_(options, *scene_, whole_motion, pool_) {
    if (sensor_.model().response.camera)
      lens_.emplace(LensCamera{options.camera, sensor_.model().lens});
  }

  GrayImage mask(std::int64_t index) override {
    SGS_CHECK(index >= 0 && static_cast<std::size_t>(index) < schedule_.frames.size(),
              "no such frame");
    const double t = schedule_.frames[static_cast<std::size_t>(index)].color_s;
    const std::vector<Primitive> movers = crowd_.at(t);
    const std::vector<float> steps = crowd_.steps(t);
    RayRequest request{options_.camera,
                       row_poses(motion_, options_.camera, t, sensor_.model().rolling_shutter_s)};
    if (lens_) request.lens = &*lens_;
    request.movers = movers;
    const RayImage seen = cast_rays(*scene_, request, pool_);
    GrayImage out(seen.width, seen.height);
    const std::size_t still = scene_->primitives.size();
    std::transform(seen.surface.begin(), seen.surface.end(), out.data(), [&](std::uint16_t id) {
      const bool mover = id >= still && id - still < steps.size();
      return mover ? value_of(steps[id - still]) : std::uint8_t{0};
    });
    return out;
  }

 private:
  SynthOptions options_;
  std::shared_ptr<const Scene> scene_;
  Trajectory motion_;
  Sensor sensor_;
  ThreadPool pool_;
  Schedule schedule_;
  Crowd crowd_;
  std::optional<LensRays> lens_;
};

}  // namespace

Result<std::unique_ptr<MovingMasks>> make_moving_masks(const SynthOptions& options) {
  if (options.crowd.empty()) return std::unique_ptr<MovingMasks>();
  ThreadPool pool(std::max(1, options.threads));
  SGS_ASSIGN_OR_RETURN(auto scene, scene_of(options, pool));
  SGS_ASSIGN_OR_RETURN(Trajectory motion, motion_of(options));
  SGS_ASSIGN_OR_RETURN(const Trajectory whole, whole_motion_of(options));
  return std::make_unique<CastMasks>(options, std::move(scene), std::move(motion), whole);
}

}  // namespace sgs::synthetic
