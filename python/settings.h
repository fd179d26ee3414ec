// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "sgs/api/types.h"

namespace sgs::python {

namespace py = pybind11;

/// A Python value as the text of a setting: numbers, words, booleans, and lists of them.
std::string setting_text(const py::object& value);
/// Keyword arguments as settings; those that are None are left out.
api::Settings settings_from(const py::kwargs& options);

}  // namespace sgs::python
