// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/viewer/embedded_files.h"

namespace sgs::viewer {

// Tables written at build time: the built page (empty where it was not built), and one that shows
// the state as text, so that a build without npm still has something to look at.
std::span<const EmbeddedFile> page_files();
std::span<const EmbeddedFile> placeholder_files();

std::span<const EmbeddedFile> embedded_files() {
  const auto page = page_files();
  return page.empty() ? placeholder_files() : page;
}

}  // namespace sgs::viewer
