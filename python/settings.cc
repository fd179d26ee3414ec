// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "settings.h"

namespace sgs::python {

std::string setting_text(const py::object& value) {
  // numpy's numbers are none of Python's.
  if (py::hasattr(value, "item") && py::hasattr(value, "ndim")) {
    if (value.attr("ndim").cast<int>() == 0) return setting_text(value.attr("item")());
  }
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value)) {
    std::string text;
    for (const py::handle entry : value) {
      text += (text.empty() ? "" : ",") + setting_text(py::reinterpret_borrow<py::object>(entry));
    }
    return text;
  }
  return py::str(value).cast<std::string>();
}

api::Settings settings_from(const py::kwargs& options) {
  api::Settings settings;
  for (const auto& [name, value] : options) {
    if (value.is_none()) continue;
    settings.emplace_back(name.cast<std::string>(),
                          setting_text(py::reinterpret_borrow<py::object>(value)));
  }
  return settings;
}

}  // namespace sgs::python
