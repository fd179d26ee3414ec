// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/api/session.h"

#include <pybind11/stl.h>

#include "arrays.h"
#include "bindings.h"

namespace sgs::python {
namespace {

const char* status_word(const api::FrameResult& result) {
  switch (result.status) {
    case api::TrackingStatus::kOk:
      return "ok";
    case api::TrackingStatus::kDegenerate:
      return "degenerate";
    case api::TrackingStatus::kLost:
      break;
  }
  return "lost";
}

py::array axes_array(const api::Spectrum& spectrum) {
  return py::array_t<double>(std::vector<py::ssize_t>{6, 6}, spectrum.axes.front().data());
}

api::FrameResult feed_images(api::Session& session, const py::object& color,
                             const py::object& depth, double time, const py::object& depth_scale,
                             const std::string& color_order) {
  const api::ColorView color_seen = color_view(color, color_order);
  const api::DepthView depth_seen = depth_view(depth, depth_scale);
  const py::gil_scoped_release free_python;
  return session.feed(color_seen, depth_seen, time);
}

std::unique_ptr<api::Session> make_session(const api::Camera& camera, const api::Config* config,
                                           int threads, bool live,
                                           const py::object& T_world_first) {
  api::SessionOptions options;
  options.threads = threads;
  options.live = live;
  if (!T_world_first.is_none()) options.T_world_first = pose_from(T_world_first);
  return std::make_unique<api::Session>(camera, config != nullptr ? *config : api::Config(),
                                        options);
}

void add_results(py::module_& module) {
  py::class_<api::WeakDirection>(module, "WeakDirection")
      .def_property_readonly("twist", [](const api::WeakDirection& w) { return six(w.twist); })
      .def_readonly("weight", &api::WeakDirection::weight)
      .def_readonly("snr", &api::WeakDirection::snr);

  py::class_<api::Spectrum>(module, "Spectrum")
      .def_property_readonly("eigenvalues",
                             [](const api::Spectrum& s) { return six(s.eigenvalues); })
      .def_property_readonly("axes", &axes_array)
      .def_property_readonly("snr", [](const api::Spectrum& s) { return six(s.snr); })
      .def_property_readonly("weights", [](const api::Spectrum& s) { return six(s.weights); });

  using R = api::FrameResult;
  py::class_<R>(module, "FrameResult")
      .def_readonly("index", &R::index)
      .def_readonly("time", &R::timestamp_s)
      .def_property_readonly("status", &status_word)
      .def_readonly("lost_reason", &R::lost_reason)
      .def_property_readonly("T_world_camera",
                             [](const R& result) { return pose_array(result.T_world_camera); })
      .def_readonly("spectrum", &R::spectrum)
      .def("weak_directions", &R::weak_directions, py::arg("threshold") = 0.5)
      .def_readonly("prior_active", &R::prior_active)
      .def_readonly("mapping_keyframe", &R::mapping_keyframe)
      .def_readonly("heldout", &R::heldout)
      .def_readonly("inliers", &R::inliers)
      .def_readonly("visual_inliers", &R::visual_inliers)
      .def_readonly("overlap", &R::overlap)
      .def_readonly("gaussians", &R::gaussians)
      .def_readonly("loops", &R::loops)
      .def_readonly("correction_m", &R::correction_m)
      .def_readonly("track_ms", &R::track_ms);
}

}  // namespace

void add_session(py::module_& module) {
  add_results(module);
  using S = api::Session;
  // None of these touches Python while it works.
  const py::call_guard<py::gil_scoped_release> free_python;
  py::class_<S>(module, "Session")
      .def(py::init(&make_session), py::arg("camera"), py::arg("config") = py::none(),
           py::kw_only(), py::arg("threads") = 2, py::arg("live") = false,
           py::arg("T_world_first") = py::none())
      .def("feed", &feed_images, py::arg("color"), py::arg("depth"), py::arg("time"), py::kw_only(),
           py::arg("depth_scale") = py::none(), py::arg("color_order") = "rgb")
      .def("feed", py::overload_cast<const api::Frame&>(&S::feed), py::arg("frame"), free_python)
      .def("finish", &S::finish, free_python)
      .def("__enter__", [](const py::object& self) { return self; })
      .def("__exit__",
           [](S& session, const py::args&) {
             const py::gil_scoped_release release;
             session.finish();
           })
      .def_property_readonly("finished", py::cpp_function(&S::finished, free_python))
      .def_property_readonly("camera", &S::camera)
      .def("frames", &S::frames, free_python)
      .def("trajectory", &S::trajectory, free_python)
      .def("online_trajectory", &S::online_trajectory, free_python)
      .def("snapshot", &S::map, free_python)
      .def(
          "save",
          [](const S& session, const py::object& folder, const api::Recording* recording) {
            const auto path = py::module_::import("os").attr("fspath")(folder).cast<std::string>();
            const py::gil_scoped_release release;
            session.save(path, recording);
          },
          py::arg("folder"), py::arg("recording") = py::none());
}

}  // namespace sgs::python
