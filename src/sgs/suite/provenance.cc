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
#include "sgs/run/machine.h"

namespace sgs::suite {

std::vector<std::string> own_words() {
  const auto text = io::read_file("/proc/self/cmdline").value_or("");
  std::vector<std::string> words;
  for (std::size_t at = 0; at < text.size(); at += words.back().size() + 1) {
    words.emplace_back(text.c_str() + at);
  }
  return words;
}

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

std::string provenance(std::string_view version) {
  std::vector<std::string> words = own_words();
  if (!words.empty()) words[0] = "sgs";
  return fmt::format("`{}`, sgs {}, {}, {} cores, {:%Y-%m-%d}", shell_command(words), version,
                     run::this_cpu(), std::thread::hardware_concurrency(),
                     fmt::gmtime(std::time(nullptr)));
}

}  // namespace sgs::suite
