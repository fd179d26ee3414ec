// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/api/evaluate.h"
#include "sgs/eval/metrics.h"

namespace sgs::api::internal {

/// Every score, or those of one group.
Metrics to_api(const eval::Metrics& metrics, std::string_view group = {});

}  // namespace sgs::api::internal
