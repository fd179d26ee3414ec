// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace sgs::io {

/// What a file is that is not what its name says.
struct ForeignContent {
  std::string what;    ///< "a web page"
  std::string remedy;  ///< what to do then
};

/// Recognises by its first bytes what often lies in the place of a picture or a recording: nothing
/// at all, a pointer of Git LFS, a web page, an archive, a picture of another kind. Empty where it
/// is none of these. `path` is for the remedy; may be empty.
std::optional<ForeignContent> foreign_content(std::string_view bytes,
                                              const std::filesystem::path& path = {});

}  // namespace sgs::io
