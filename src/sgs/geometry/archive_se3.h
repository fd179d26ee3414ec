// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/core/archive.h"
#include "sgs/geometry/se3.h"

namespace sgs {

/// Poses as fields of an archive.
template <class Archive>
void archive_fields(Archive& a, SE3& T) {
  a(T.R, T.t);
}

}  // namespace sgs
