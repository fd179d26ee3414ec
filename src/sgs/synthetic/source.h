// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sgs/camera/pinhole.h"
#include "sgs/core/error.h"
#include "sgs/core/image.h"
#include "sgs/core/thread_pool.h"
#include "sgs/dataset/frame_source.h"
#include "sgs/geometry/trajectory.h"

namespace sgs::synthetic {

/// Who moves through a scene (docs/datasets.md). Nobody by default.
struct CrowdOptions {
  int view_percent = 0;   ///< of the view that walkers take in the mean, about; 0 = no walkers
  bool plain = false;     ///< clothes of one colour, instead of patterns
  bool follower = false;  ///< somebody stays before the camera, wherever it goes
  bool box = false;       ///< somebody pushes a box and leaves it there
  bool empty() const { return view_percent == 0 && !follower && !box; }
};

/// How the camera moves in a scene.
enum class CameraMotion {
  kAsGiven,  ///< along the trajectory or as the scene has it
  kStill,    ///< stands where it is in the middle of that
  kTurning,  ///< turns to and fro there, by 35 degrees
};

/// What to render. Everything random (textures, clutter, hand motion, noise) follows from `seed`.
struct SynthOptions {
  std::string scene;             ///< one of scene_names()
  std::string level = "kinect";  ///< sensor: clean, kinect, hard, varied or real
  std::uint64_t seed = 1;
  CrowdOptions crowd;
  CameraMotion motion = CameraMotion::kAsGiven;
  /// Camera motion in a world with z up and the floor at z = 0 (e.g. a TUM ground-truth file); the
  /// scene is laid out around it. Empty = the scene's own hand-held motion.
  std::optional<Trajectory> trajectory;
  int frames = 0;   ///< upper limit on the number of frames; 0 = the scene's or trajectory's length
  int threads = 1;  ///< threads that render, >= 1; the output does not depend on it
  PinholeCamera camera{640, 480, 535.4, 539.2, 320.1, 247.6};
  double rate_hz = 30;
  /// Frames as a recorder stores them: behind the lens, if the level has one (see synth_lens()).
  bool as_recorded = false;
};

/// One scene that the generator knows.
struct SceneInfo {
  std::string name;
  std::string description;
  int default_frames = 0;  ///< length of the built-in motion, at 30 Hz
  bool textured = true;    ///< false where most of a view is plain
};

/// All scenes, in the order of the benchmark suite.
const std::vector<SceneInfo>& scene_names();

/// What may follow a scene's name in an input, each after a `+`, and what it does.
struct SceneOption {
  std::string name, description;
};
const std::vector<SceneOption>& scene_options();

/// Reads an input of the form `synth:NAME[+OPTION...][:LEVEL]` into options that are otherwise
/// default. An unknown name, option or level is an error that lists the known ones, the nearest
/// first.
Result<SynthOptions> parse_synth_spec(std::string_view spec);

/// Scene and options as they are written in an input: NAME[+OPTION...].
std::string scene_text(const SynthOptions& options);

/// True for inputs that parse_synth_spec() is meant for.
inline bool is_synth_spec(std::string_view input) { return input.starts_with("synth:"); }

/// Surfaces, materials and lights. Immutable after construction and thread-safe.
class Scene;

/// The scene that make_synthetic_source() renders for the same options. Thread-safe.
Result<std::shared_ptr<const Scene>> make_scene(const SynthOptions& options);

/// The camera poses of the built-in hand-held motion of `options.scene` at 200 Hz, from a little
/// before the first frame to a little after the last one.
Result<Trajectory> handheld_trajectory(const SynthOptions& options);

/// What an ideal camera sees: a global shutter of no duration, no noise, no range limit.
struct ExactView {
  ColorImage color;
  DepthImage depth;  ///< metres along the optical axis, 0 where nothing is hit
  Image<Eigen::Vector3f>
      normals;  ///< unit, camera frame, facing the camera; 0 where nothing is hit
};

/// Renders the scene from any pose.
ExactView render_exact(const Scene& scene, const PinholeCamera& camera, const SE3& T_world_camera,
                       ThreadPool& pool);

/// The lens distortion of the level's camera: none but for the level `real`, where the seed
/// decides.
Distortion synth_lens(const SynthOptions& options);

/// A rendered sequence. Frames are exactly what writing them to disk (8-bit colour, 16-bit depth at
/// 5000 units per metre) and reading them back would give; those with a lens are written
/// `as_recorded` with synth_lens(), and read without its distortion. `frame.truth_T_world_camera`
/// is the pose at the middle of the colour exposure (of the middle row, with a rolling shutter),
/// and ground_truth() holds it for all frames, at their stamps. Frames that a level loses are not
/// part of the sequence: time jumps there, the index does not. Same options, same bits, for any
/// `threads`.
Result<std::unique_ptr<dataset::FrameSource>> make_synthetic_source(const SynthOptions& options);

}  // namespace sgs::synthetic
