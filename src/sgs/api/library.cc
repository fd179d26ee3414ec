// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/api/library.h"

#include <spdlog/sinks/stdout_sinks.h>

#include "sgs/api/error.h"
#include "sgs/core/log.h"
#include "sgs/runfolder/version.h"

namespace sgs::api {
namespace {

spdlog::level::level_enum level_named(const std::string& word) {
  for (const auto level : {spdlog::level::info, spdlog::level::warn, spdlog::level::err}) {
    if (spdlog::level::to_string_view(level) == spdlog::string_view_t(word)) return level;
  }
  throw Error(ErrorCode::kInvalidArgument, "unknown log level '" + word + "'",
              "choose info, warning, error or off");
}

}  // namespace

std::string version() { return sgs::run::version(); }

void log_to_stderr(const std::string& level) {
  if (level == "off") return set_log_sinks({});
  auto sink = std::make_shared<spdlog::sinks::stderr_sink_mt>();
  sink->set_level(level_named(level));
  sink->set_pattern("sgs: %l: %v");
  set_log_sinks({std::move(sink)});
}

}  // namespace sgs::api
