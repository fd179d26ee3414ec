// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "sgs/runfolder/version.h"

namespace sgs::app {

/// The commit that was built, "+" after it where files differed; "" where that is unknown. Written
/// by cmake/SgsCommit.cmake.
extern const std::string_view kCommit;

/// "0.1.0 (7611fe7)".
inline std::string version_and_commit() {
  const std::string version = run::version();
  return kCommit.empty() ? version : version + " (" + std::string(kCommit) + ")";
}

}  // namespace sgs::app
