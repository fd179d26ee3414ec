// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "sgs/viewer/server.h"
#include "viewer_link.h"

namespace sgs::app {

/// Starts a server as the command line asks for and prints its address to stderr.
Result<std::unique_ptr<viewer::Server>> start_viewer(const ViewerRequest& request,
                                                     const viewer::RunInfo& info);

}  // namespace sgs::app
