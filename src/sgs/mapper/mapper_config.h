// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/core/config.h"

namespace sgs::mapper {

/// Settings of the mapper; the defaults are the `default` preset.
struct MapperConfig {
  double iterations_per_frame = 1.0;  ///< offline budget; fractions accumulate

  void declare(ParameterList& p) {
    p.add("iterations_per_frame", iterations_per_frame,
          "Optimisation steps per input frame in offline mode; fractions accumulate.", "1/frame",
          {0, 1000});
  }
};

/// Settings of the paper's recipe (METHOD section 7).
MapperConfig paper_mapper_config();

}  // namespace sgs::mapper
