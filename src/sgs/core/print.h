// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <string>
#include <string_view>
#include <utility>

#include "sgs/core/format.h"

namespace sgs {

// A terminal that is gone or a full disk behind a stream is no reason to throw away what is being
// computed: unlike fmt::print, these never throw because of it.

/// Remembers errno as the reason why standard output failed, unless there is an earlier one.
void note_output_error();
/// The first reason why standard output failed (errno), 0 if it did not.
int output_error();
/// Writes `text` to standard output; a failure is remembered.
void write_output(std::string_view text);

/// Results for standard output.
template <class... Args>
void print(fmt::format_string<Args...> format, Args&&... args) {
  write_output(fmt::format(format, std::forward<Args>(args)...));
}

/// Messages and progress for standard error; lost where they cannot be written.
template <class... Args>
void say(fmt::format_string<Args...> format, Args&&... args) {
  const std::string text = fmt::format(format, std::forward<Args>(args)...);
  std::fwrite(text.data(), 1, text.size(), stderr);
}

}  // namespace sgs
