// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "sgs/synthetic/scene.h"
#include "sgs/synthetic/source.h"

namespace sgs::synthetic {

/// The entry of scene_names() with this name, or an error that lists the names.
Result<SceneInfo> find_scene(const std::string& name);
/// An error that lists the known levels unless `level` is one.
Status check_level(const std::string& level);

/// Lays the scene out around the trajectory.
std::shared_ptr<const Scene> build_scene(const SceneInfo& info, const Trajectory& trajectory,
                                         const PinholeCamera& camera, std::uint64_t seed,
                                         ThreadPool& pool);

}  // namespace sgs::synthetic
