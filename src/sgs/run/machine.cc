// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/machine.h"

#include <unistd.h>

#include <array>
#include <regex>

#include "sgs/io/atomic_file.h"

namespace sgs::run {

std::string cpu_model(std::string_view cpuinfo) {
  static const std::regex line("(^|\n)model name\\s*:\\s*([^\n]+)");
  std::cmatch match;
  const bool found = std::regex_search(cpuinfo.begin(), cpuinfo.end(), match, line);
  return found ? match[2].str() : "unknown CPU";
}

std::string this_cpu() { return cpu_model(io::read_file("/proc/cpuinfo").value_or("")); }

std::string host_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

}  // namespace sgs::run
