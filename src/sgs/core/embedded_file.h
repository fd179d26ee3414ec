// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace sgs {

/// A file that is part of the program; cmake/SgsEmbed.cmake writes tables of them.
struct EmbeddedFile {
  std::string_view path;   ///< "index.html", "assets/app-1a2b.js": no leading slash
  std::string_view bytes;  ///< as they are in the file
};

/// The row with that path, or null.
const EmbeddedFile* find_embedded(std::span<const EmbeddedFile> files, std::string_view path);

/// The text of a file that is known to be there, from the end of the two lines that name the
/// licence if it starts with them. Throws where there is no such file.
std::string_view embedded_text(std::span<const EmbeddedFile> files, std::string_view path);

}  // namespace sgs
