// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "viewer_link.h"

namespace sgs::app {

void ViewerRequest::add_run_options(CLI::App& sub, std::string& input) {
  sub.add_option_function<std::vector<std::string>>(
         "--viewer",
         [this, &input](const std::vector<std::string>& values) {
           wanted = true;
           const std::string value = values.empty() ? std::string() : values.front();
           const bool number =
               !value.empty() &&
               std::all_of(value.begin(), value.end(), [](char c) { return c >= '0' && c <= '9'; });
           if (number) {
             port = value;
           } else if (!value.empty()) {
             if (!input.empty()) throw CLI::ValidationError("--viewer", value + " is no port");
             input = value;  // `sgs run --viewer INPUT`
           }
         },
         "Show the run to browsers at this port (default 8765, 0 = any free one)")
      ->expected(0, 1)
      ->type_name("[PORT]");
  sub.add_option("--viewer-address", address, "Where the viewer listens; 0.0.0.0 = everywhere");
  sub.add_option("--viewer-host", names, "Name by which browsers may call the viewer (repeatable)")
      ->take_all()
      ->allow_extra_args(false);
  sub.add_flag("--viewer-stay", stay, "Keep the viewer after the run until Ctrl-C");
}

void ViewerRequest::add_view_options(CLI::App& sub) {
  sub.add_option("--port", port, "Port (default 8765, 0 = any free one)");
  sub.add_option("--viewer-address", address, "Where to listen; 0.0.0.0 = everywhere");
  sub.add_option("--viewer-host", names, "Name by which browsers may call it (repeatable)")
      ->take_all()
      ->allow_extra_args(false);
}

}  // namespace sgs::app
