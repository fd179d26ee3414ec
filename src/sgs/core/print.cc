// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/core/print.h"

#include <atomic>
#include <cerrno>

namespace sgs {
namespace {

std::atomic<int> first_output_error{0};

}  // namespace

void note_output_error() {
  int none = 0;
  first_output_error.compare_exchange_strong(none, errno);
}

int output_error() { return first_output_error; }

void write_output(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) note_output_error();
}

}  // namespace sgs
