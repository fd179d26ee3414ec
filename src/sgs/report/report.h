// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "sgs/core/error.h"
#include "sgs/report/report_data.h"

namespace sgs::report {

/// The whole page as one HTML document without any outside address.
std::string report_html(const ReportData& data);
/// Writes report_html() atomically.
Status save_report(const std::filesystem::path& path, const ReportData& data);

}  // namespace sgs::report
