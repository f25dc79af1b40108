// Weighted least squares with a few unknowns and three right-hand sides: E(n) in three channels by basis functions.
#pragma once

#include <array>
#include <cmath>

#include "grid/base/types.h"

namespace ivory {

template <std::size_t N>
class LeastSquares {
 public:
  // One equation: sum of x[i] functions[i] = value.
  void add(const std::array<double, N>& functions, const V3d& value, double weight) {
    for (std::size_t i = 0; i < N; ++i) {
      right_[i] += value * (weight * functions[i]);
      for (std::size_t k = 0; k <= i; ++k) left_[i][k] += weight * functions[i] * functions[k];
    }
  }

  // By Cholesky's decomposition; the equations must determine all unknowns.
  std::array<V3d, N> solve() const {
    std::array<std::array<double, N>, N> l{};
    for (std::size_t i = 0; i < N; ++i) {
      for (std::size_t k = 0; k <= i; ++k) {
        double sum = left_[i][k];
        for (std::size_t j = 0; j < k; ++j) sum -= l[i][j] * l[k][j];
        l[i][k] = i == k ? std::sqrt(sum) : sum / l[k][k];
      }
    }
    std::array<V3d, N> x = right_;
    for (std::size_t i = 0; i < N; ++i) {
      for (std::size_t j = 0; j < i; ++j) x[i] -= x[j] * l[i][j];
      x[i] /= l[i][i];
    }
    for (std::size_t i = N; i-- > 0;) {
      for (std::size_t j = i + 1; j < N; ++j) x[i] -= x[j] * l[j][i];
      x[i] /= l[i][i];
    }
    return x;
  }

 private:
  std::array<std::array<double, N>, N> left_{};  // its lower half
  std::array<V3d, N> right_ = zeros();
  static std::array<V3d, N> zeros() {
    std::array<V3d, N> out;
    out.fill(V3d(0, 0, 0));
    return out;
  }
};

}  // namespace ivory
