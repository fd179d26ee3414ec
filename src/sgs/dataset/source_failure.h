// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <utility>

#include "sgs/core/error.h"

namespace sgs::dataset {

/// Thrown by FrameSource::next() where the frames end before their time, through no fault of the
/// program: a camera that went away. What there is of the run is to be kept.
class SourceFailure : public std::runtime_error {
 public:
  explicit SourceFailure(Error error)
      : std::runtime_error(error.message), error_(std::move(error)) {}
  const Error& error() const { return error_; }

 private:
  Error error_;
};

}  // namespace sgs::dataset
