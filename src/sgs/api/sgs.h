// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

/// All of libsgs.
#include "sgs/api/config.h"
#include "sgs/api/error.h"
#include "sgs/api/evaluate.h"
#include "sgs/api/frame_result.h"
#include "sgs/api/library.h"
#include "sgs/api/map.h"
#include "sgs/api/recording.h"
#include "sgs/api/run.h"
#include "sgs/api/session.h"
#include "sgs/api/stop.h"
#include "sgs/api/types.h"
