// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/core/embedded_file.h"

#include <algorithm>
#include <string>

#include "sgs/core/error.h"

namespace sgs {

const EmbeddedFile* find_embedded(std::span<const EmbeddedFile> files, std::string_view path) {
  const auto found = std::find_if(files.begin(), files.end(),
                                  [&](const EmbeddedFile& file) { return file.path == path; });
  return found == files.end() ? nullptr : &*found;
}

std::string_view embedded_text(std::span<const EmbeddedFile> files, std::string_view path) {
  const EmbeddedFile* file = find_embedded(files, path);
  SGS_CHECK(file != nullptr, "no embedded file " + std::string(path));
  std::string_view text = file->bytes;
  std::size_t head = 0;
  for (int line = 0; line < 2; ++line) {
    const std::size_t end = text.find('\n', head);
    if (end == std::string_view::npos) return text;
    if (text.substr(head, end - head).find("SPDX-") == std::string_view::npos) return text;
    head = end + 1;
  }
  return text.substr(head - 1);
}

}  // namespace sgs
