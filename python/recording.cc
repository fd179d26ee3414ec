// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/api/recording.h"

#include <pybind11/stl.h>

#include "arrays.h"
#include "bindings.h"
#include "settings.h"
#include "waiting.h"

namespace sgs::python {
namespace {

std::shared_ptr<api::Recording> open(const py::object& input, const py::kwargs& options) {
  const auto path = py::module_::import("os").attr("fspath")(input).cast<std::string>();
  return interruptible(
      [path, settings = settings_from(options)] {
        return std::make_shared<api::Recording>(api::Recording::open(path, settings));
      },
      {});
}

api::Frame next_frame(api::Recording& recording) {
  const auto frame = interruptible([&] { return recording.next(); }, [&] { recording.stop(); });
  if (!frame) throw py::stop_iteration();
  return *frame;
}

py::array color_array(const py::object& self) {
  const auto& frame = self.cast<const api::Frame&>();
  const py::ssize_t height = frame.height(), width = frame.width();
  return read_only_view(py::dtype::of<std::uint8_t>(), {height, width, 3}, {3 * width, 3, 1},
                        frame.color(), self);
}

py::array depth_array(const py::object& self) {
  const auto& frame = self.cast<const api::Frame&>();
  const py::ssize_t height = frame.height(), width = frame.width();
  constexpr auto kBytes = static_cast<py::ssize_t>(sizeof(float));
  return read_only_view(py::dtype::of<float>(), {height, width}, {kBytes * width, kBytes},
                        frame.depth(), self);
}

py::object truth_array(const api::Frame& frame) {
  const auto truth = frame.truth();
  return truth ? py::object(pose_array(*truth)) : py::none();
}

}  // namespace

void add_recording(py::module_& module) {
  py::class_<api::Frame>(module, "Frame")
      .def_property_readonly("index", &api::Frame::index)
      .def_property_readonly("time", &api::Frame::timestamp_s)
      .def_property_readonly("camera", &api::Frame::camera)
      .def_property_readonly("color", &color_array)
      .def_property_readonly("depth", &depth_array)
      .def_property_readonly("truth", &truth_array);

  py::class_<api::BadFrame>(module, "BadFrame")
      .def_readonly("index", &api::BadFrame::index)
      .def_readonly("time", &api::BadFrame::timestamp_s)
      .def_readonly("reason", &api::BadFrame::reason);

  py::class_<api::Recording, std::shared_ptr<api::Recording>>(module, "Recording")
      .def("__iter__", [](const py::object& self) { return self; })
      .def("__next__", &next_frame)
      .def("stop", &api::Recording::stop)
      .def_property_readonly("name", &api::Recording::name)
      .def_property_readonly("layout", &api::Recording::layout)
      .def_property_readonly("calibration_source", &api::Recording::calibration_source)
      .def_property_readonly("camera", &api::Recording::camera)
      .def_property_readonly("size", &api::Recording::size)
      .def_property_readonly("ground_truth", &api::Recording::ground_truth)
      .def_property_readonly("warnings", &api::Recording::warnings)
      .def_property_readonly("bad_frames", &api::Recording::bad_frames);

  module.def("open", &open, py::arg("input"));
}

}  // namespace sgs::python
