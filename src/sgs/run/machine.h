// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace sgs::run {

/// The processor's name in the text of /proc/cpuinfo; "unknown CPU" where that does not say.
std::string cpu_model(std::string_view cpuinfo);
/// The processor of this machine.
std::string this_cpu();
/// The name of this machine; empty where the system does not say.
std::string host_name();

}  // namespace sgs::run
