// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Instruction sets that are not worth compiling for: vectors of unknown length cannot be members
// of structures, and the two x86 sets add nothing over their neighbours here. To be included
// before any Highway header.
#define HWY_DISABLED_TARGETS \
  (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_AVX3_DL | HWY_SSSE3)
