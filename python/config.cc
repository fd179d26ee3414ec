// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/api/config.h"

#include <pybind11/stl.h>

#include "bindings.h"
#include "settings.h"

namespace sgs::python {
namespace {

bool has_key(const api::Config& config, const std::string& key) {
  const auto keys = config.keys();
  return std::find(keys.begin(), keys.end(), key) != keys.end();
}

}  // namespace

void add_config(py::module_& module) {
  py::class_<api::ParameterInfo>(module, "ParameterInfo")
      .def_readonly("key", &api::ParameterInfo::key)
      .def_readonly("meaning", &api::ParameterInfo::meaning)
      .def_readonly("unit", &api::ParameterInfo::unit)
      .def_readonly("min", &api::ParameterInfo::min)
      .def_readonly("max", &api::ParameterInfo::max)
      .def_readonly("choices", &api::ParameterInfo::choices);

  py::class_<api::Config>(module, "Config")
      .def(py::init<const std::string&>(), py::arg("preset") = "default")
      .def_static(
          "preset", [](const std::string& name) { return api::Config(name); }, py::arg("name"))
      .def_static("load", &api::Config::load, py::arg("path"))
      .def("__getitem__", &api::Config::get, py::arg("key"))
      .def(
          "__setitem__",
          [](api::Config& config, const std::string& key, const py::object& value) {
            config.set(key, setting_text(value));
          },
          py::arg("key"), py::arg("value"))
      .def("__contains__", &has_key, py::arg("key"))
      .def("__len__", [](const api::Config& config) { return config.keys().size(); })
      .def("__iter__", [](const api::Config& config) { return py::iter(py::cast(config.keys())); })
      .def("keys", &api::Config::keys)
      .def("info", &api::Config::info, py::arg("key"))
      .def("copy", [](const api::Config& config) { return config; })
      .def("to_toml", &api::Config::to_toml);
}

}  // namespace sgs::python
