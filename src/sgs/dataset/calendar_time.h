// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

namespace sgs::dataset {

/// Seconds of a time that is written as people do: "2024-05-01T12:00:00.033", "2024-05-01
/// 12:00:00", "20240501_120000_033" count since 1970 (a time zone is left out of account),
/// "12:00:00.033" since midnight. The digits behind the seconds are their fraction. Empty if
/// anything else is there.
std::optional<double> calendar_seconds(std::string_view text);

}  // namespace sgs::dataset
