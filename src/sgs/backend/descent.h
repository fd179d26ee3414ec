// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/backend/bundle.h"

namespace sgs::backend {

/// Gauss-Newton steps at a level, until the cost falls by no more than a small part of what one
/// unknown's standard deviation is worth; `noise` follows the residuals. False when they lead
/// nowhere.
bool descend(Bundle& bundle, int level, int steps, BundleNoise& noise);

}  // namespace sgs::backend
