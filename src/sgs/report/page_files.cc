// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/report/page_files.h"

#include "sgs/core/embedded_file.h"

namespace sgs::report {

/// Written at build time.
std::span<const EmbeddedFile> page_files();

std::string_view page_text(std::string_view name) { return embedded_text(page_files(), name); }

}  // namespace sgs::report
