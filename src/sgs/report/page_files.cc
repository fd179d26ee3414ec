// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/report/page_files.h"

#include <algorithm>

#include "sgs/core/embedded_file.h"

namespace sgs::report {

/// Written at build time.
std::span<const EmbeddedFile> page_files();

std::string_view page_text(std::string_view name) { return embedded_text(page_files(), name); }

std::string script_html(std::initializer_list<std::string_view> modules) {
  std::string html = "<script type='module'>";
  for (const std::string_view name : modules) html += without_imports(page_text(name));
  return html + "</script>";
}

std::string without_imports(std::string_view module_text) {
  constexpr std::string_view kExport = "export ";
  std::string out;
  bool importing = false;
  while (!module_text.empty()) {
    const std::size_t end = std::min(module_text.find('\n'), module_text.size() - 1) + 1;
    std::string_view line = module_text.substr(0, end);
    module_text.remove_prefix(end);
    if (line.starts_with("/** @import ")) continue;
    importing = importing || line.starts_with("import ");
    if (importing) {
      importing = !line.ends_with(";\n");
      continue;
    }
    if (line.starts_with(kExport)) line.remove_prefix(kExport.size());
    out += line;
  }
  return out;
}

}  // namespace sgs::report
