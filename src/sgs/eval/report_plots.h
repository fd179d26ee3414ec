// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sgs/eval/report.h"

namespace sgs::eval {

/// Sections of the report, each as HTML; "" when the data has nothing for it.
std::string trajectory_section(const ReportData& data);
std::string tracking_section(const ReportData& data);
std::string degeneracy_section(const ReportData& data);
std::string timing_section(const ReportData& data);

/// A titled box of the page.
std::string section_html(const std::string& title, const std::string& lead,
                         const std::string& content);

}  // namespace sgs::eval
