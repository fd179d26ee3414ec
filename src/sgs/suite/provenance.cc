// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/suite/provenance.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <regex>
#include <thread>
#include <vector>

#include "sgs/io/atomic_file.h"

namespace sgs::suite {
namespace {

/// The command line of this process, with "sgs" for the program.
std::vector<std::string> own_words() {
  const auto text = io::read_file("/proc/self/cmdline").value_or("");
  std::vector<std::string> words;
  for (std::size_t at = 0; at < text.size(); at += words.back().size() + 1) {
    words.emplace_back(text.c_str() + at);
  }
  if (!words.empty()) words[0] = "sgs";
  return words;
}

}  // namespace

std::string shell_command(std::span<const std::string> words) {
  static const std::regex plain("[A-Za-z0-9_./:=,+@%-]+");
  std::string command;
  for (const std::string& word : words) {
    if (!command.empty()) command += ' ';
    if (std::regex_match(word, plain)) {
      command += word;
    } else {
      command += "'" + std::regex_replace(word, std::regex("'"), R"('\'')") + "'";
    }
  }
  return command;
}

std::string cpu_model(std::string_view cpuinfo) {
  static const std::regex line("(^|\n)model name\\s*:\\s*([^\n]+)");
  std::cmatch match;
  const bool found = std::regex_search(cpuinfo.begin(), cpuinfo.end(), match, line);
  return found ? match[2].str() : "unknown CPU";
}

std::string provenance(std::string_view version) {
  const std::string cpuinfo = io::read_file("/proc/cpuinfo").value_or("");
  return fmt::format("`{}`, sgs {}, {}, {} cores, {:%Y-%m-%d}", shell_command(own_words()), version,
                     cpu_model(cpuinfo), std::thread::hardware_concurrency(),
                     fmt::gmtime(std::time(nullptr)));
}

}  // namespace sgs::suite
