// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "sgs/core/embedded_file.h"

namespace sgs::viewer {

/// The page's files as built from web/, or, where the page could not be built, a single page that
/// says how to get it (placeholder/).
std::span<const EmbeddedFile> embedded_files();

}  // namespace sgs::viewer
