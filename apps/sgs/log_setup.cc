// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "log_setup.h"

#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/stdout_sinks.h>

#include <mutex>
#include <system_error>
#include <utility>

#include "sgs/core/log.h"
#include "sgs/io/append_file.h"

namespace sgs::app {
namespace {

/// A file that comes back with all it held where the folder is removed during the run. A log that
/// cannot be written (full disk) must not end the run.
class LogFile : public spdlog::sinks::base_sink<std::mutex> {
 public:
  explicit LogFile(io::AppendFile file) : file_(std::move(file)) {}

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    spdlog::memory_buf_t line;
    formatter_->format(message, line);
    file_.hold({line.data(), line.size()});
    flush_();
  }
  void flush_() override {
    (void)file_.restore();
    (void)file_.append({});
  }

 private:
  io::AppendFile file_;
};

}  // namespace

void setup_logging(const std::filesystem::path& file, bool quiet, LogStart start) {
  std::vector<spdlog::sink_ptr> sinks;
  if (!file.empty()) {
    std::error_code missing;
    const auto size = std::filesystem::file_size(file, missing);
    const bool append = start == LogStart::kAppend && !missing;
    sinks.push_back(std::make_shared<LogFile>(io::AppendFile(file, append ? size : 0)));
    sinks.back()->set_pattern("%Y-%m-%d %H:%M:%S.%e %l %v");
  }
  if (!quiet) {
    sinks.push_back(std::make_shared<spdlog::sinks::stderr_sink_mt>());
    sinks.back()->set_level(spdlog::level::warn);
    sinks.back()->set_pattern("sgs: %l: %v");
  }
  set_log_sinks(std::move(sinks));
  log().flush_on(spdlog::level::warn);
  log().set_error_handler([](const std::string&) {});
}

}  // namespace sgs::app
