// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "bindings.h"
#include "sgs/api/error.h"

namespace sgs::python {
namespace {

const char* word_of(api::ErrorCode code) {
  switch (code) {
    case api::ErrorCode::kNotFound:
      return "not found";
    case api::ErrorCode::kInvalidFormat:
      return "invalid format";
    case api::ErrorCode::kInvalidArgument:
      return "invalid argument";
    case api::ErrorCode::kUnknownKey:
      return "unknown key";
    case api::ErrorCode::kIo:
      return "io";
    case api::ErrorCode::kUnsupported:
      return "unsupported";
    case api::ErrorCode::kBusy:
      return "busy";
    case api::ErrorCode::kInterrupted:
      return "interrupted";
    case api::ErrorCode::kInternal:
      break;
  }
  return "internal";
}

/// The exceptions are Python's own classes (sgs/errors.py), so that they can be ValueErrors, too.
void raise_in_python(const api::Error& error) {
  const py::object made = py::module_::import("sgs.errors")
                              .attr("make")(word_of(error.code()), error.message(), error.remedy());
  PyErr_SetObject(py::type::handle_of(made).ptr(), made.ptr());
}

}  // namespace

void add_errors(py::module_&) {
  py::register_local_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const api::Error& error) {
      raise_in_python(error);
    }
  });
}

}  // namespace sgs::python
