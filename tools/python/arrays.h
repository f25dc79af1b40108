// NumPy arrays as what ivory computes on, and back.
#pragma once

#include <atomic>
#include <cmath>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "grid/base/anchor.h"
#include "grid/base/error.h"
#include "grid/base/metadata.h"
#include "grid/base/types.h"

namespace ivory::python {

// Vectors of an array of shape (..., 3): one of floats in C order is read in place, all else is turned into doubles
// first. One vector alone, of shape (3,), stands for as many as are asked for.
class Vectors {
 public:
  // Throws ParameterError ("name") for arrays of other shapes and for what is no number.
  Vectors(const pybind11::object& given, const char* name);

  const char* name() const { return name_; }
  std::size_t count() const { return count_; }
  const std::vector<pybind11::ssize_t>& shape() const { return shape_; }
  bool is_one() const { return shape_.size() == 1; }

  // As floats, less the anchor (grid/base/anchor.h).
  V3f local(std::size_t i, const V3d& anchor_m) const {
    if (floats_ != nullptr) {
      V3f v;
      std::memcpy(static_cast<void*>(&v), floats_ + 3 * i, sizeof(v));
      return anchor_m == V3d(0, 0, 0) ? v : to_local(V3d(v), anchor_m);
    }
    V3d v;
    std::memcpy(static_cast<void*>(&v), doubles_ + 3 * i, sizeof(v));
    return to_local(v, anchor_m);
  }

 private:
  pybind11::array array_;  // keeps the numbers alive
  const char* name_;
  std::vector<pybind11::ssize_t> shape_;
  std::size_t count_ = 0;
  const float* floats_ = nullptr;
  const double* doubles_ = nullptr;
};

// The shape of what is computed for each pair. Throws ParameterError where neither has the other's or is one alone.
std::vector<pybind11::ssize_t> common_shape(const Vectors& p, const Vectors& n);

static_assert(sizeof(Rgb) == 3 * sizeof(float) && sizeof(V3f) == 3 * sizeof(float));

// eval(positions, normals, values) for pairs of a position, less the anchor, and a unit normal, at most `grain` at a
// time, as an array of shape (..., 3) of floats, on all of TBB's threads and without the GIL. Throws ParameterError for
// positions that are not finite and normals that are no unit vectors (to a thousandth).
template <typename Eval>
pybind11::array_t<float> map_blocks(const Vectors& p, const Vectors& n, const V3d& anchor_m, std::size_t grain,
                                    const Eval& eval) {
  pybind11::array_t<float> out(common_shape(p, n));
  Rgb* const values = reinterpret_cast<Rgb*>(out.mutable_data());
  const std::size_t count = std::size_t(out.size()) / 3;
  const std::size_t p_step = p.is_one() ? 0 : 1;
  const std::size_t n_step = n.is_one() ? 0 : 1;
  std::atomic<bool> bad_p = false;
  std::atomic<bool> bad_n = false;
  {
    const pybind11::gil_scoped_release free;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain), [&](const auto& range) {
      std::vector<V3f> points(range.size());
      std::vector<V3f> normals(range.size());
      for (std::size_t k = 0; k < range.size(); ++k) {
        const std::size_t i = range.begin() + k;
        points[k] = p.local(i * p_step, anchor_m);
        normals[k] = n.local(i * n_step, V3d(0, 0, 0));
        if (!std::isfinite(points[k].x + points[k].y + points[k].z)) bad_p = true;
        if (!(std::abs(normals[k].length2() - 1) < 2e-3F)) bad_n = true;
      }
      if (bad_p || bad_n) return;
      eval(std::span<const V3f>(points), std::span<const V3f>(normals), values + range.begin());
    });
  }
  if (bad_p) throw ParameterError(p.name(), "some positions are not finite");
  if (bad_n) throw ParameterError(n.name(), "normals must be unit vectors");
  return out;
}

// The same by eval(p, n) for each pair.
template <typename Eval>
pybind11::array_t<float> map_points(const Vectors& p, const Vectors& n, const V3d& anchor_m, const Eval& eval) {
  constexpr std::size_t grain = 64;
  return map_blocks(p, n, anchor_m, grain, [&](std::span<const V3f> points, std::span<const V3f> normals, Rgb* values) {
    for (std::size_t i = 0; i < points.size(); ++i) values[i] = eval(points[i], normals[i]);
  });
}

// The same for what depends on normals alone.
template <typename Eval>
pybind11::array_t<float> map_normals(const Vectors& n, const Eval& eval) {
  return map_points(n, n, V3d(0, 0, 0), [&](const V3f&, const V3f& normal) { return eval(normal); });
}

// Numbers that `owner` holds, in place and read-only.
pybind11::array view(const float* data, std::vector<pybind11::ssize_t> shape, const pybind11::object& owner);

pybind11::dict to_dict(const Metadata& metadata);
pybind11::tuple to_tuple(const V3d& v);

}  // namespace ivory::python
