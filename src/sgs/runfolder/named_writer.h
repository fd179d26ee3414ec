// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "sgs/core/error.h"

namespace sgs::run {

/// A file of a run folder by its name there, and how to write it.
struct NamedWriter {
  std::string name;
  std::function<Status(const std::filesystem::path& path)> write;
};

}  // namespace sgs::run
