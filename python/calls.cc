// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <pybind11/functional.h>
#include <pybind11/stl.h>

#include "bindings.h"
#include "settings.h"
#include "sgs/api/evaluate.h"
#include "sgs/api/library.h"
#include "sgs/api/run.h"
#include "waiting.h"

namespace sgs::python {
namespace {

/// Scores by their keys; None where one was not measured.
py::dict scores_dict(const api::Metrics& metrics) {
  py::dict scores;
  for (const api::Metric& metric : metrics) {
    const auto as_object = [](const auto& value) -> py::object {
      if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::monostate>) {
        return py::none();
      } else {
        return py::cast(value);
      }
    };
    scores[py::str(metric.key)] = std::visit(as_object, metric.value);
  }
  return scores;
}

/// A trajectory, or the path of one.
api::Trajectory trajectory_from(const py::object& given) {
  if (py::isinstance<api::Trajectory>(given)) return given.cast<api::Trajectory>();
  const auto path = py::module_::import("os").attr("fspath")(given).cast<std::string>();
  return api::Trajectory::load(path);
}

py::dict evaluate(const py::object& truth, const py::object& estimate,
                  const std::string& association) {
  return scores_dict(api::evaluate(trajectory_from(estimate), trajectory_from(truth), association));
}

py::dict evaluate_run(const py::object& folder, const std::string& association, bool pictures,
                      const std::string& lpips_weights, int threads) {
  const auto path = py::module_::import("os").attr("fspath")(folder).cast<std::string>();
  api::Stop stop;
  return scores_dict(interruptible(
      [&] {
        return api::evaluate_run(path, {association, pictures, lpips_weights, threads}, stop);
      },
      [&] { stop.request(); }));
}

/// Calls Python's `progress` from the thread that works; what it raises stops the run and comes out
/// of run().
class Teller {
 public:
  Teller(const py::object& progress, const api::Stop& stop) : progress_(progress), stop_(stop) {}
  void operator()(std::int64_t frames) {
    if (progress_.is_none() || raised_) return;
    const py::gil_scoped_acquire hold_python;
    try {
      progress_(frames);
    } catch (py::error_already_set& error) {
      raised_ = std::make_unique<py::error_already_set>(error);
      stop_.request();
    }
  }
  void raise_again() {
    if (raised_) throw py::error_already_set(*raised_);
  }

 private:
  py::object progress_;
  api::Stop stop_;
  std::unique_ptr<py::error_already_set> raised_;
};

api::RunSummary run(const py::object& input, const api::Config* config, const py::object& output,
                    int threads, bool realtime, bool pictures, const std::string& lpips_weights,
                    const std::string& record, const py::object& progress,
                    const py::kwargs& options) {
  const py::object fspath = py::module_::import("os").attr("fspath");
  const auto path = fspath(input).cast<std::string>();
  api::RunOptions run_options;
  if (!output.is_none()) run_options.output = fspath(output).cast<std::string>();
  run_options.threads = threads;
  run_options.realtime = realtime;
  run_options.pictures = pictures;
  run_options.lpips_weights = lpips_weights;
  run_options.record = record;
  const api::Settings settings = settings_from(options);
  const api::Config used = config != nullptr ? *config : api::Config();
  api::Stop stop;
  Teller teller(progress, stop);
  auto summary = interruptible(
      [&] {
        return api::run(
            path, settings, used, run_options, [&](std::int64_t frames) { teller(frames); }, stop);
      },
      [&] { stop.request(); });
  teller.raise_again();
  return summary;
}

}  // namespace

void add_calls(py::module_& module) {
  using Summary = api::RunSummary;
  py::class_<Summary>(module, "RunSummary")
      .def_readonly("folder", &Summary::folder)
      .def_readonly("frames", &Summary::frames)
      .def_readonly("lost", &Summary::lost)
      .def_property_readonly("metrics",
                             [](const Summary& summary) { return scores_dict(summary.metrics); });
  module.def("run", &run, py::arg("input"), py::arg("config") = py::none(), py::kw_only(),
             py::arg("output") = py::none(), py::arg("threads") = 2, py::arg("realtime") = false,
             py::arg("pictures") = true, py::arg("lpips_weights") = "", py::arg("record") = "",
             py::arg("progress") = py::none());
  module.def("evaluate", &evaluate, py::arg("truth"), py::arg("estimate"),
             py::arg("association") = "interpolate");
  module.def("evaluate_run", &evaluate_run, py::arg("folder"), py::kw_only(),
             py::arg("association") = "interpolate", py::arg("pictures") = true,
             py::arg("lpips_weights") = "", py::arg("threads") = 2);
  module.def("log_to_stderr", &api::log_to_stderr, py::arg("level") = "warning");
  module.attr("__version__") = api::version();
}

}  // namespace sgs::python
