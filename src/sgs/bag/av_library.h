// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

extern "C" {
#include <libavformat/avformat.h>
}

#include "sgs/core/error.h"

namespace sgs::bag {

/// Every function of libavformat and of the libraries below it that is called.
#define SGS_AV_FUNCTIONS(X) \
  X(av_dict_get)            \
  X(av_find_input_format)   \
  X(av_log_set_level)       \
  X(av_packet_alloc)        \
  X(av_packet_free)         \
  X(av_packet_unref)        \
  X(av_read_frame)          \
  X(av_rescale_q)           \
  X(av_strerror)            \
  X(avformat_close_input)   \
  X(avformat_open_input)

/// FFmpeg's reader of containers, opened when the first file needs it: it brings over a hundred
/// libraries, which no other start of a program should have to load (as for videos, apps/video).
struct AvLibrary {
#define SGS_AV_MEMBER(name) decltype(&::name) name = nullptr;
  SGS_AV_FUNCTIONS(SGS_AV_MEMBER)
#undef SGS_AV_MEMBER
};

/// The library of the version whose headers this was compiled with; it stays open. Errors
/// (kNotFound): it is not installed, or lacks a function. Thread-safe.
Result<const AvLibrary*> av_library();

}  // namespace sgs::bag
