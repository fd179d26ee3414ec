// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include "arrays.h"
#include "bindings.h"
#include "sgs/api/types.h"

namespace sgs::python {
namespace {

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

api::Trajectory make_trajectory(const Doubles& times, const Doubles& poses) {
  if (times.ndim() != 1 || poses.ndim() != 3 || poses.shape(1) != 4 || poses.shape(2) != 4 ||
      poses.shape(0) != times.shape(0)) {
    throw py::value_error("a trajectory has N times and poses of the shape (N, 4, 4)");
  }
  api::Trajectory trajectory;
  trajectory.times.assign(times.data(), times.data() + times.size());
  for (py::ssize_t i = 0; i < poses.shape(0); ++i) {
    api::Pose pose;
    std::copy_n(poses.data(i), pose.size(), pose.begin());
    trajectory.poses.push_back(pose);
  }
  return trajectory;
}

const char* lens_name(const api::Camera& c) {
  return c.lens == api::Lens::kFisheye ? "fisheye" : "brown";
}

api::Lens lens_named(const std::string& name) {
  if (name == "fisheye") return api::Lens::kFisheye;
  if (name == "brown") return api::Lens::kBrown;
  throw py::value_error("lens is 'brown' or 'fisheye', not '" + name + "'");
}

std::string camera_text(const api::Camera& c) {
  return py::str("Camera({}, {}, fx={}, fy={}, cx={}, cy={}, distortion={}, lens='{}')")
      .format(c.width, c.height, c.fx, c.fy, c.cx, c.cy, c.distortion, lens_name(c))
      .cast<std::string>();
}

}  // namespace

void add_values(py::module_& module) {
  py::class_<api::Camera>(module, "Camera")
      .def(py::init([](int width, int height, double fx, double fy, double cx, double cy,
                       std::vector<double> distortion, const std::string& lens) {
             return api::Camera{width,           height, fx, fy, cx, cy, std::move(distortion),
                                lens_named(lens)};
           }),
           py::arg("width"), py::arg("height"), py::arg("fx"), py::arg("fy"), py::arg("cx"),
           py::arg("cy"), py::arg("distortion") = std::vector<double>{}, py::arg("lens") = "brown")
      .def_readonly("width", &api::Camera::width)
      .def_readonly("height", &api::Camera::height)
      .def_readonly("fx", &api::Camera::fx)
      .def_readonly("fy", &api::Camera::fy)
      .def_readonly("cx", &api::Camera::cx)
      .def_readonly("cy", &api::Camera::cy)
      .def_readonly("distortion", &api::Camera::distortion)
      .def_property_readonly("lens", &lens_name)
      .def("__repr__", camera_text);

  py::class_<api::Trajectory>(module, "Trajectory")
      .def(py::init(&make_trajectory), py::arg("times"), py::arg("poses"))
      .def_static("load", &api::Trajectory::load, py::arg("path"),
                  py::call_guard<py::gil_scoped_release>())
      .def("save", &api::Trajectory::save, py::arg("path"),
           py::call_guard<py::gil_scoped_release>())
      .def("__len__", &api::Trajectory::size)
      .def_property_readonly("times",
                             [](const api::Trajectory& t) {
                               return py::array_t<double>(static_cast<py::ssize_t>(t.size()),
                                                          t.times.data());
                             })
      .def_property_readonly("poses",
                             [](const api::Trajectory& t) { return poses_array(t.poses); });
}

}  // namespace sgs::python
