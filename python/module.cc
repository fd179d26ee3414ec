// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "bindings.h"

PYBIND11_MODULE(_sgs, module) {
  module.doc() = "What the package sgs is made of; import sgs instead.";
  sgs::python::add_errors(module);
  sgs::python::add_values(module);
  sgs::python::add_config(module);
  sgs::python::add_map(module);
  sgs::python::add_recording(module);
  sgs::python::add_session(module);
  sgs::python::add_calls(module);
}
