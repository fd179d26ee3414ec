// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace sgs::viewer {

/// A file that is part of the executable.
struct EmbeddedFile {
  std::string_view path;          ///< "index.html", "assets/app-1a2b.js": no leading slash
  std::string_view content_type;  ///< for the header of that name
  std::string_view bytes;
};

/// The page's files as built from web/ (written by cmake/SgsEmbed.cmake), or, where the page could
/// not be built, a single page that says how to get it.
std::span<const EmbeddedFile> embedded_files();

/// What SgsEmbed.cmake generated; empty without a page.
std::span<const EmbeddedFile> generated_files();

}  // namespace sgs::viewer
