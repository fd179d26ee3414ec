// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sgs/report/drawings.h"

namespace sgs::report {

/// The rotatable 3-D view as a figure: paths of the runs, ground truth, points of the first map,
/// keyframes, and the time slider of the page. "" without any path. Long paths are thinned.
std::string scene_html(Runs runs);

}  // namespace sgs::report
