// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Included by sources only.

#include <toml++/toml.h>

#include <string_view>

#include "sgs/core/config.h"
#include "sgs/core/error.h"

namespace sgs::io {

/// Parses TOML; a syntax error becomes an Error with file and line.
Result<toml::table> parse_toml(std::string_view text, std::string_view source);

/// Sets every scalar below `table` in `parameters`; see apply_toml_text().
Status apply_toml_table(const toml::table& table, std::string_view source,
                        const ParameterList& parameters);

/// "file:line" of a node.
std::string toml_place(const toml::node& node, std::string_view source);

}  // namespace sgs::io
