// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/core/config.h"

namespace sgs::history {

/// How much is remembered of the frames that came.
struct HistoryConfig {
  int memory_mb = 300;

  void declare(ParameterList& p) {
    p.add("memory_mb", memory_mb,
          "Memory for the frames that are remembered, by whomever, and the mapper's training views "
          "of them; beyond it the oldest go to disk (the folder TMPDIR names, else /var/tmp). What "
          "is computed stays the same to the bit.",
          "MiB", {1, 1e6});
    p.for_users({"memory_mb"});
  }
};

}  // namespace sgs::history
