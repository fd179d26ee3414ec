// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "arrays.h"

#include <cstring>
#include <memory>

#include "sgs/api/error.h"

namespace sgs::python {
namespace {

[[noreturn]] void refuse(const std::string& message, const std::string& remedy) {
  throw api::Error(api::ErrorCode::kInvalidArgument, message, remedy);
}

std::string text_of(const py::object& object) { return py::str(object).cast<std::string>(); }

std::string type_of(const py::object& object) {
  return py::isinstance<py::array>(object)
             ? "an array of " + text_of(object.attr("dtype"))
             : "a " + py::type::of(object).attr("__name__").cast<std::string>();
}

/// The array, if it holds native numbers of one of the kinds ("u1" as numpy says it).
py::array array_of(const std::string& name, const py::object& object,
                   const std::vector<std::string>& kinds, const std::string& wanted) {
  if (py::isinstance<py::array>(object)) {
    auto array = py::reinterpret_borrow<py::array>(object);
    const std::string kind = std::string(1, array.dtype().kind()) +
                             std::to_string(static_cast<int>(array.dtype().itemsize()));
    for (const std::string& allowed : kinds) {
      if (kind == allowed && array.dtype().attr("isnative").cast<bool>()) return array;
    }
  }
  throw py::type_error(name + " must be a numpy array of " + wanted + ", not " + type_of(object));
}

/// Refuses arrays whose rows are not runs of bytes.
void check_rows(const std::string& name, const py::array& array) {
  py::ssize_t expected = array.itemsize();
  bool dense = true;
  for (py::ssize_t axis = array.ndim() - 1; axis > 0; --axis) {
    dense = dense && (array.strides(axis) == expected || array.shape(axis) == 1);
    expected *= array.shape(axis);
  }
  if (dense && (array.shape(0) == 1 || std::abs(array.strides(0)) >= expected)) return;
  refuse("the pixels of " + name + " do not follow each other row by row",
         "pass numpy.ascontiguousarray(" + name + ")");
}

api::ColorFormat color_format(const std::string& order, py::ssize_t channels) {
  if (order != "rgb" && order != "bgr") {
    refuse("color_order is '" + order + "'", "choose 'rgb' or 'bgr'; a fourth channel is ignored");
  }
  if (channels == 4) return order == "rgb" ? api::ColorFormat::kRgba : api::ColorFormat::kBgra;
  return order == "rgb" ? api::ColorFormat::kRgb : api::ColorFormat::kBgr;
}

}  // namespace

api::ColorView color_view(const py::object& image, const std::string& order) {
  const py::array array = array_of("color", image, {"u1"}, "uint8");
  if (array.ndim() != 3 || (array.shape(2) != 3 && array.shape(2) != 4)) {
    refuse("color has the shape " + text_of(array.attr("shape")), "give (height, width, 3)");
  }
  check_rows("color", array);
  const auto height = static_cast<int>(array.shape(0)), width = static_cast<int>(array.shape(1));
  return {static_cast<const std::uint8_t*>(array.data()), width, height,
          height == 1 ? 0 : array.strides(0), color_format(order, array.shape(2))};
}

api::DepthView depth_view(const py::object& image, const py::object& scale) {
  const py::array array = array_of("depth", image, {"u2", "f4"}, "uint16 or float32");
  if (array.ndim() != 2) {
    refuse("depth has the shape " + text_of(array.attr("shape")), "give (height, width)");
  }
  check_rows("depth", array);
  api::DepthView view;
  view.data = array.data();
  view.height = static_cast<int>(array.shape(0));
  view.width = static_cast<int>(array.shape(1));
  view.stride = view.height == 1 ? 0 : array.strides(0);
  const bool raw = array.dtype().kind() == 'u';
  view.format = raw ? api::DepthFormat::kUint16 : api::DepthFormat::kFloat32;
  if (raw && scale.is_none()) {
    refuse("depth is uint16 and its unit is not known",
           "give depth_scale, the units per metre: 1000 for millimetres, 5000 for TUM");
  }
  view.scale = scale.is_none() ? 1.0 : scale.cast<double>();
  return view;
}

api::Pose pose_from(const py::object& pose) {
  const auto array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(pose);
  if (!array || array.ndim() != 2 || array.shape(0) != 4 || array.shape(1) != 4) {
    PyErr_Clear();
    refuse("a pose must be a 4x4 matrix", "give T_world_camera as [R t; 0 0 0 1]");
  }
  api::Pose out;
  std::memcpy(out.data(), array.data(), sizeof(out));
  return out;
}

py::array pose_array(const api::Pose& pose) {
  return py::array_t<double>(std::vector<py::ssize_t>{4, 4}, pose.data());
}

py::array poses_array(const std::vector<api::Pose>& poses) {
  static_assert(sizeof(api::Pose) == 16 * sizeof(double));
  const std::vector<py::ssize_t> shape = {static_cast<py::ssize_t>(poses.size()), 4, 4};
  return py::array_t<double>(shape, poses.empty() ? nullptr : poses.front().data());
}

py::array read_only_view(const py::dtype& type, std::vector<py::ssize_t> shape,
                         std::vector<py::ssize_t> strides, const void* data, py::handle owner) {
  py::array view(type, std::move(shape), std::move(strides), data, owner);
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

py::array read_only_view(const api::ArrayView& view, py::handle owner) {
  const auto rows = static_cast<py::ssize_t>(view.rows);
  const auto columns = static_cast<py::ssize_t>(view.columns);
  const auto type = py::dtype::of<float>();
  if (view.rows == 0) {
    std::vector<py::ssize_t> none = {0};
    if (columns > 1) none.push_back(columns);
    return py::array_t<float>(none);
  }
  if (columns == 1) return read_only_view(type, {rows}, {view.row_stride}, view.data, owner);
  return read_only_view(type, {rows, columns},
                        {view.row_stride, static_cast<py::ssize_t>(sizeof(float))}, view.data,
                        owner);
}

py::array owning_array(std::vector<float> values, std::vector<py::ssize_t> shape) {
  auto kept = std::make_unique<std::vector<float>>(std::move(values));
  const float* data = kept->data();
  const py::capsule owner(kept.get(),
                          [](void* pointer) { delete static_cast<std::vector<float>*>(pointer); });
  kept.release();
  return py::array_t<float>(std::move(shape), data, owner);
}

py::array six(const std::array<double, 6>& values) {
  return py::array_t<double>(static_cast<py::ssize_t>(values.size()), values.data());
}

}  // namespace sgs::python
