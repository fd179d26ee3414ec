// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0

// Stands in for the sources in viewer/ in a build without the viewer.

#include "commands.h"
#include "viewer_link.h"

namespace sgs::app {

Result<std::unique_ptr<ViewerLink>> ViewerLink::open(const ViewerRequest& request,
                                                     const run::Input&, const run::InputSpec&,
                                                     const slam::SessionConfig&, bool) {
  if (!request.wanted) return nullptr;
  return fail(ErrorCode::kUnsupported, "this build has no viewer",
              "build it with -DSGS_BUILD_VIEWER=ON");
}

void add_view(CLI::App&, Action&) {}

}  // namespace sgs::app
