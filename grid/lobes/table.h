// The product of two cosine lobes as one lobe, by look-up: exact in its integral and its vector moment but for the
// table's interpolation error.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "grid/base/measured_error.h"
#include "grid/lobes/lobe.h"

namespace ivory {

// Nodes along each exponent and along the angle. The default is 0.8 MiB with a mean relative error of the integral of
// 8e-5.
struct LobeTableParams {
  int exponent_nodes = 33;  // 2 to 129
  int angle_nodes = 65;     // 2 to 513
};

// Three numbers a node, smooth because a closed-form guess is taken out of them (see table.cpp). Order: [node of
// e1][node of e2][node of the angle][channel].
struct LobeTable {
  static constexpr int channels = 3;
  int exponent_nodes = 0;
  int angle_nodes = 0;
  std::vector<float> values;

  std::size_t bytes() const { return values.size() * sizeof(float); }
};

// Builds the table, some 0.7 s of one core for the default, on all of TBB's threads; the bits do not depend on their
// number. Throws ParameterError for node counts out of range.
LobeTable make_lobe_table(const LobeTableParams& params = {});
std::size_t lobe_table_bytes(const LobeTableParams& params);

// The product of a and b as one lobe. Exponents above max_lobe_exponent are read at the table's edge.
Lobe lobe_product(const LobeTable& table, const Lobe& a, const Lobe& b);

// The integral of the product of a and b over the sphere: lobe_integral(lobe_product(...)) at half the cost.
float lobe_product_integral(const LobeTable& table, const Lobe& a, const Lobe& b);

// How far the look-up is from the moments it stands for: `samples` pairs with exponents uniform in log(1 + 4 e), the
// table's own axis, and uniform angles, of unit scale. Deterministic. Errors of the integral are absolute, as a
// fraction of the largest integral of two lobes with these exponents (that at angle 0) and of the true integral, where
// that is above 1e-6 of the largest one; the axis' in units of the product's own width 1/sqrt(e + 1).
struct LobeTableErrors {
  struct Distribution {
    double mean = 0;
    double median = 0;
    double worst = 0;
    double worst_e1 = 0;
    double worst_e2 = 0;
    double worst_angle_rad = 0;
  };
  std::uint64_t samples = 0;
  Distribution absolute;    // |I' - I|
  Distribution of_largest;  // |I' - I| / I(angle 0)
  Distribution of_true;     // |I' - I| / I
  Distribution exponent;    // |e' - e| / (e + 1)
  Distribution axis;        // angle between the axes times sqrt(e + 1)
  Distribution shape;       // L2 distance between lobe and product over the product's L2 norm
};
LobeTableErrors lobe_table_errors(const LobeTable& table, std::uint64_t samples, std::uint64_t seed);

// Two lobes of unit scale, drawn as lobe_table_errors() does, and the exact integral of their product.
struct LobePair {
  double e1 = 0;
  double e2 = 0;
  double angle_rad = 0;
  double integral = 0;
};
// Those of `count` draws whose integral is above 1e-6 of that at angle 0.
std::vector<LobePair> make_lobe_pairs(std::uint64_t count, std::uint64_t seed);

// Mean of |I' - I| / I over the pairs, I' by lobe_product_integral().
MeasuredError lobe_integral_error(const LobeTable& table, std::span<const LobePair> pairs);

// make_lobe_table() of which only those nodes are made that the products of these pairs read: to judge a table that is
// not built.
LobeTable make_lobe_table_for(const LobeTableParams& params, std::span<const LobePair> pairs);

}  // namespace ivory
