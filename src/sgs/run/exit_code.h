// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace sgs::run {

/// Exit codes of the program (docs/quickstart.md).
enum ExitCode : int {
  kExitDone = 0,
  kExitFailed = 1,  ///< something went wrong while running
  kExitUsage = 2,   ///< the command line or a config value makes no sense
  /// Finished, but tracking was lost at the end or for most of the run, or hardly any frame was
  /// used; a calibration that its own recording does not stand by.
  kExitLost = 3,
  kExitInterrupted = 130,
};

}  // namespace sgs::run
