#include "tools/python/arrays.h"

#include <utility>
#include <variant>

namespace ivory::python {

namespace py = pybind11;

Vectors::Vectors(const py::object& given, const char* name) : name_(name) {
  const auto as_it_is = py::array::ensure(given);
  if (!as_it_is) {
    PyErr_Clear();
    throw ParameterError(name, "it is no array of numbers");
  }
  const bool in_place = py::isinstance<py::array_t<float>>(as_it_is) && (as_it_is.flags() & py::array::c_style) != 0;
  if (in_place) {
    array_ = as_it_is;
  } else {
    array_ = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(given);
    if (!array_) {
      PyErr_Clear();
      throw ParameterError(name, "it is no array of numbers");
    }
  }
  if (array_.ndim() < 1 || array_.shape(array_.ndim() - 1) != 3)
    throw ParameterError(name, "its last axis must have the three coordinates, as (N, 3)");
  shape_.assign(array_.shape(), array_.shape() + array_.ndim());
  count_ = std::size_t(array_.size()) / 3;
  if (in_place) {
    floats_ = static_cast<const float*>(array_.data());
  } else {
    doubles_ = static_cast<const double*>(array_.data());
  }
}

std::vector<py::ssize_t> common_shape(const Vectors& p, const Vectors& n) {
  if (p.is_one()) return n.shape();
  if (!n.is_one() && p.shape() != n.shape())
    throw ParameterError(n.name(), std::string("it must have the shape of ") + p.name() + ", or be one vector");
  return p.shape();
}

py::array view(const float* data, std::vector<py::ssize_t> shape, const py::object& owner) {
  py::array_t<float> array(std::move(shape), data, owner);
  array.attr("flags").attr("writeable") = false;
  return array;
}

py::dict to_dict(const Metadata& metadata) {
  py::dict dict;
  for (const auto& [key, value] : metadata)
    dict[py::str(key)] = std::visit([](const auto& v) -> py::object { return py::cast(v); }, value);
  return dict;
}

py::tuple to_tuple(const V3d& v) { return py::make_tuple(v.x, v.y, v.z); }

}  // namespace ivory::python
