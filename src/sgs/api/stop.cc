// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/api/stop.h"

#include "sgs/api/internal/stop_token.h"

namespace sgs::api {

struct Stop::Impl {
  std::stop_source source;
};

Stop::Stop() : impl_(std::make_shared<Impl>()) {}
Stop::Stop(const Stop&) = default;
Stop& Stop::operator=(const Stop&) = default;
Stop::~Stop() = default;

void Stop::request() { impl_->source.request_stop(); }
bool Stop::requested() const { return impl_->source.stop_requested(); }

std::stop_token internal::StopAccess::token(const Stop& stop) {
  return stop.impl_->source.get_token();
}

}  // namespace sgs::api
