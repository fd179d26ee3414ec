// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/core/log.h"

#include <spdlog/sinks/null_sink.h>

namespace sgs {

spdlog::logger& log() {
  static const auto logger =
      std::make_shared<spdlog::logger>("sgs", std::make_shared<spdlog::sinks::null_sink_mt>());
  return *logger;
}

void set_log_sinks(std::vector<spdlog::sink_ptr> sinks) { log().sinks() = std::move(sinks); }

}  // namespace sgs
