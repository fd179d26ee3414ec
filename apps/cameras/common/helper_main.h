// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <string>

#include "sgs/capture/camera_driver.h"

namespace sgs::cameras {

/// The main function of a program that reads cameras of a family: command line, frames to standard
/// output, words for people to standard error, lines from standard input (docs/cameras.md). What
/// libraries print to standard output goes to standard error. Returns the exit code: 0 done, 1
/// something went wrong, 2 the command line makes no sense. `own`: adds options of this family.
using OwnOptions = std::function<void(CLI::App&)>;
int helper_main(int argc, char** argv, const std::string& what,
                std::unique_ptr<capture::CameraDriver> driver, const OwnOptions& own = {});

}  // namespace sgs::cameras
