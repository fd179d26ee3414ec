// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/api/map.h"

#include <pybind11/stl.h>

#include "arrays.h"
#include "bindings.h"

namespace sgs::python {
namespace {

/// A property that looks into the map.
auto view_property(api::ArrayView (api::Map::*view)() const) {
  return [view](const py::object& self) {
    return read_only_view((self.cast<const api::Map&>().*view)(), self);
  };
}

/// A property that is computed from a view.
template <class Function>
auto computed_property(api::ArrayView (api::Map::*view)() const, Function function) {
  return [view, function](const api::Map& map) {
    const api::ArrayView from = (map.*view)();
    std::vector<float> values;
    values.reserve(from.rows * from.columns);
    for (std::size_t i = 0; i < from.rows; ++i) {
      for (std::size_t k = 0; k < from.columns; ++k) values.push_back(function(from.row(i)[k]));
    }
    std::vector<py::ssize_t> shape = {static_cast<py::ssize_t>(from.rows)};
    if (from.columns > 1) shape.push_back(static_cast<py::ssize_t>(from.columns));
    return owning_array(std::move(values), shape);
  };
}

/// A picture as Python holds it.
struct Picture {
  py::array color, depth, alpha;
};

Picture render(const api::Map& map, const api::Camera& camera, const py::object& pose,
               int threads) {
  const api::Pose T = pose_from(pose);
  api::Rendering rendering;
  {
    const py::gil_scoped_release free_python;
    rendering = map.render(camera, T, threads);
  }
  const py::ssize_t height = rendering.height, width = rendering.width;
  return {owning_array(std::move(rendering.color), {height, width, 3}),
          owning_array(std::move(rendering.depth), {height, width}),
          owning_array(std::move(rendering.alpha), {height, width})};
}

}  // namespace

void add_map(py::module_& module) {
  py::class_<Picture>(module, "Rendering")
      .def_readonly("color", &Picture::color)
      .def_readonly("depth", &Picture::depth)
      .def_readonly("alpha", &Picture::alpha)
      .def("__iter__",
           [](const Picture& p) { return py::iter(py::make_tuple(p.color, p.depth, p.alpha)); });

  py::class_<api::Map>(module, "Map")
      .def_static("load", &api::Map::load, py::arg("path"),
                  py::call_guard<py::gil_scoped_release>())
      .def("save", &api::Map::save, py::arg("path"), py::call_guard<py::gil_scoped_release>())
      .def("__len__", &api::Map::size)
      .def_property_readonly("positions", view_property(&api::Map::positions))
      .def_property_readonly("log_scales", view_property(&api::Map::log_scales))
      .def_property_readonly("quats_wxyz", view_property(&api::Map::rotations))
      .def_property_readonly("opacity_logits", view_property(&api::Map::opacity_logits))
      .def_property_readonly("colors", view_property(&api::Map::colors))
      .def_property_readonly(
          "scales", computed_property(&api::Map::log_scales, [](float x) { return std::exp(x); }))
      .def_property_readonly("opacities",
                             computed_property(&api::Map::opacity_logits,
                                               [](float x) { return 1 / (1 + std::exp(-x)); }))
      .def_property_readonly("keyframe_poses",
                             [](const api::Map& map) { return poses_array(map.keyframe_poses()); })
      .def_property_readonly("keyframe_frames", &api::Map::keyframe_frames)
      .def("render", &render, py::arg("camera"), py::arg("T_world_camera"), py::arg("threads") = 2);
}

}  // namespace sgs::python
