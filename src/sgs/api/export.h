// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Marks what libsgs shows to other programs; everything else in it is hidden.
#if defined(_WIN32)
#define SGS_API
#else
#define SGS_API __attribute__((visibility("default")))
#endif
