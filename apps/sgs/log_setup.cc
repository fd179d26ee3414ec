// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "log_setup.h"

#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_sinks.h>

#include "sgs/core/log.h"

namespace sgs::app {

void setup_logging(const std::filesystem::path& file, bool quiet) {
  std::vector<spdlog::sink_ptr> sinks;
  if (!file.empty()) {
    sinks.push_back(std::make_shared<spdlog::sinks::basic_file_sink_mt>(file.string()));
    sinks.back()->set_pattern("%Y-%m-%d %H:%M:%S.%e %l %v");
  }
  if (!quiet) {
    sinks.push_back(std::make_shared<spdlog::sinks::stderr_sink_mt>());
    sinks.back()->set_level(spdlog::level::warn);
    sinks.back()->set_pattern("sgs: %l: %v");
  }
  set_log_sinks(std::move(sinks));
  log().flush_on(spdlog::level::warn);
  // A log that cannot be written (full disk) must not end the run.
  log().set_error_handler([](const std::string&) {});
}

}  // namespace sgs::app
