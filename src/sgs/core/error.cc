// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/core/error.h"

#include <exception>
#include <new>
#include <system_error>

namespace sgs {

Error current_error() {
  try {
    throw;
  } catch (const std::bad_alloc&) {
    return {ErrorCode::kInternal, "out of memory", "use fewer or smaller frames"};
  } catch (const std::system_error& error) {
    return {ErrorCode::kIo, error.what(), "is there enough memory, disk space, room for threads?"};
  } catch (const std::exception& error) {
    return {ErrorCode::kInternal, fmt::format("internal error: {}", error.what()),
            "please report it with the command line"};
  } catch (...) {
    return {ErrorCode::kInternal, "internal error", "please report it with the command line"};
  }
}

}  // namespace sgs
