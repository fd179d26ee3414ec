// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

#include "sgs/core/config.h"
#include "sgs/core/error.h"

namespace sgs::io {

/// Sets the parameters named in a TOML file; nested tables join to dotted keys. Syntax errors,
/// unknown keys (the nearest known one is named), wrong types and values out of range are errors
/// with file and line. The first error ends the reading: keys before it have been set.
Status apply_toml_file(const std::filesystem::path& path, const ParameterList& parameters);

/// The same for TOML text; `source` stands for the file's name in messages.
Status apply_toml_text(std::string_view text, std::string_view source,
                       const ParameterList& parameters);

}  // namespace sgs::io
