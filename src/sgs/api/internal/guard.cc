// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/api/internal/guard.h"

namespace sgs::api::internal {
namespace {

ErrorCode api_code(sgs::ErrorCode code) {
  switch (code) {
    case sgs::ErrorCode::kNotFound:
      return ErrorCode::kNotFound;
    case sgs::ErrorCode::kInvalidFormat:
      return ErrorCode::kInvalidFormat;
    case sgs::ErrorCode::kInvalidArgument:
      return ErrorCode::kInvalidArgument;
    case sgs::ErrorCode::kIo:
      return ErrorCode::kIo;
    case sgs::ErrorCode::kUnsupported:
      return ErrorCode::kUnsupported;
    case sgs::ErrorCode::kInterrupted:
      return ErrorCode::kInterrupted;
    case sgs::ErrorCode::kInternal:
      break;
  }
  return ErrorCode::kInternal;
}

}  // namespace

void raise(const sgs::Error& error) {
  throw Error(api_code(error.code), error.message, error.remedy);
}

void check_threads(int threads) {
  constexpr int kMost = 256;
  if (threads >= 1 && threads <= kMost) return;
  throw Error(ErrorCode::kInvalidArgument, fmt::format("{} threads cannot be", threads),
              fmt::format("give 1 to {}", kMost));
}

}  // namespace sgs::api::internal
