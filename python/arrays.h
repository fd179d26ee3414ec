// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/numpy.h>

#include <string>
#include <vector>

#include "sgs/api/session.h"
#include "sgs/api/types.h"

namespace sgs::python {

namespace py = pybind11;

/// What a numpy array shows as an image. Wrong types are a TypeError; shapes and orders that cannot
/// be read without a copy are an InvalidArgument that names the call which makes one.
api::ColorView color_view(const py::object& image, const std::string& order);
/// `scale` may be None for metres.
api::DepthView depth_view(const py::object& image, const py::object& scale);

/// A pose from anything that numpy makes a 4x4 array of; and back.
api::Pose pose_from(const py::object& pose);
py::array pose_array(const api::Pose& pose);
/// (N, 4, 4).
py::array poses_array(const std::vector<api::Pose>& poses);

/// A read-only array that looks into memory which `owner` keeps alive.
py::array read_only_view(const py::dtype& type, std::vector<py::ssize_t> shape,
                         std::vector<py::ssize_t> strides, const void* data, py::handle owner);
/// (rows, columns), or (rows,) where there is one column.
py::array read_only_view(const api::ArrayView& view, py::handle owner);
/// An array that owns what was in the vector.
py::array owning_array(std::vector<float> values, std::vector<py::ssize_t> shape);
/// A copy of six numbers.
py::array six(const std::array<double, 6>& values);

}  // namespace sgs::python
