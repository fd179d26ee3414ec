// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "sgs/alignment/alignment_config.h"
#include "sgs/alignment/known_view.h"
#include "sgs/core/thread_pool.h"
#include "sgs/loops/loop_config.h"

namespace sgs::loops {

/// Views with poses that were estimated together.
struct PosedViews {
  std::size_t count = 0;
  /// Asked for more than once, from any thread of the pool.
  std::function<alignment::KnownView(std::size_t)> view;
};

/// Poses of views (T_world_camera) with which what each of them shows lies where its neighbours
/// show it. Every view is aligned to those nearest to it as the tracker would align it, and a pose
/// graph is solved of what that says and of the poses that there are, to a hundredth of the
/// distance at which the views see surfaces. A camera that is tracked against several views at once
/// is thrown to and fro where they disagree, however true each of them is (docs/decisions/0068).
/// The same bits for any number of threads.
std::vector<SE3> agreeing_poses(const PosedViews& views, const LoopConfig& config,
                                const alignment::AlignerConfig& aligner, ThreadPool& pool);

}  // namespace sgs::loops
