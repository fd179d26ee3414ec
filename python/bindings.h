// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

namespace sgs::python {

namespace py = pybind11;

// Each adds a part of the library to the module, in this order.
void add_errors(py::module_& module);
void add_values(py::module_& module);  ///< cameras, trajectories
void add_config(py::module_& module);
void add_map(py::module_& module);
void add_recording(py::module_& module);
void add_session(py::module_& module);
void add_calls(py::module_& module);  ///< run, evaluate, ...

}  // namespace sgs::python
