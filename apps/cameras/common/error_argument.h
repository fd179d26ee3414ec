// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <type_traits>

#include "sgs/core/error.h"

namespace sgs::cameras {

/// Calls a function of a library whose last parameter is where it puts an error. `taken(error)`
/// makes an Error of it, and releases it.
template <class LibraryError, class Taken, class Function, class... Arguments>
auto call_with_error(const Taken& taken, Function function, Arguments... arguments)
    -> Result<decltype(function(arguments..., static_cast<LibraryError**>(nullptr)))> {
  LibraryError* error = nullptr;
  if constexpr (std::is_void_v<decltype(function(arguments..., &error))>) {
    function(arguments..., &error);
    if (error != nullptr) return tl::unexpected<Error>(taken(error));
    return {};
  } else {
    auto result = function(arguments..., &error);
    if (error != nullptr) return tl::unexpected<Error>(taken(error));
    return result;
  }
}

}  // namespace sgs::cameras
