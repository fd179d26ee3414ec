// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/api/error.h"

namespace sgs::api {

Error::Error(ErrorCode code, const std::string& message, const std::string& remedy)
    : std::runtime_error(remedy.empty() ? message : message + " (" + remedy + ")"),
      code_(code),
      message_(message),
      remedy_(remedy) {}

Error::~Error() = default;

}  // namespace sgs::api
