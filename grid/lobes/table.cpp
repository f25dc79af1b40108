#include "grid/lobes/table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <tbb/parallel_for.h>

#include "grid/base/counted_random.h"
#include "grid/base/error.h"
#include "grid/lobes/moments.h"

// Laplace's method gives a guess with every property of the product but a few per cent. In the plane of the axes the
// product peaks where e1 tan(d1) = e2 tan(d2), d1 + d2 = alpha. With A = sin(d1) cos(d2), B = cos(d1) sin(d2) and q =
// cos(d1) cos(d2) that is solved in closed form, N = e1 + e2, y = cos(alpha):
//
//   A = sin(alpha) e2/N,  B = sin(alpha) e1/N,  q^2 - y q - A B = 0,  tan(d1) = A/q,  tan(d2) = B/q.
//
// There its value is P = (1 + tan^2 d1)^(-e1/2) (1 + tan^2 d2)^(-e2/2), the curvature of its logarithm N across the
// plane and K = N + e1 tan^2 d1 + e2 tan^2 d2 within, so that I is near 2 pi P/(N + 1) sqrt(N/K). Where one exponent is
// small the peak moves into the horizon of that lobe and K grows without bound; exponents raised by 1/2 in all of the
// above (but not in P's powers) keep both apart and the guess within a factor of 1.6 of I everywhere. The table holds
//
//   I / guess,   (angle of the vector moment - d1) sqrt(N + 1),   (exponent + 2)/(N + 2).
//
// Of the three all are smooth over log(1 + 4 e) and, since what happens near the horizon scales with 1/sqrt(N), over
// asinh(k z)/asinh(k) with k = sqrt(N + 1) and z = cos(alpha/2) - sin(alpha/2), which runs from 1 to -1 as the angle
// does from 0 to pi, and evenly at both ends: exponents below 1 leave a kink there that is straight in the angle.

namespace ivory {

namespace {

constexpr float exponent_slope = 4;
constexpr float shift = 0.5F;

float exponent_coordinate(float e) { return std::log1p(exponent_slope * e); }
const float last_coordinate = exponent_coordinate(max_lobe_exponent);

struct Guess {
  float tan1 = 0;      // of the peak's angle from the first axis
  float integral = 0;  // of two lobes of scale 1
  float log_integral = 0;
};

// y = cos(alpha), sine = sin(alpha).
Guess make_guess(float e1, float e2, float y, float sine) {
  const float f1 = e1 + shift;
  const float f2 = e2 + shift;
  const float a = std::max(sine, 1e-12F) * (f2 / (f1 + f2));
  const float b = std::max(sine, 1e-12F) * (f1 / (f1 + f2));
  // The root that loses no digits: q itself where y > 0, A B/q where y < 0.
  const float h = 0.5F * (std::sqrt(y * y + 4 * a * b) + std::abs(y));
  const float tan1 = y >= 0 ? a / h : h / b;
  const float tan2 = y >= 0 ? b / h : h / a;
  const float extra = f1 * tan1 * tan1 + f2 * tan2 * tan2;
  const float n = f1 + f2;
  Guess guess;
  guess.tan1 = tan1;
  const float log_peak = -0.5F * (e1 * std::log1p(tan1 * tan1) + e2 * std::log1p(tan2 * tan2));
  const float width = 2 * pi / (e1 + e2 + 1) * std::sqrt(n / (n + extra));
  guess.integral = width * std::exp(log_peak);
  guess.log_integral = log_peak + std::log(width);
  return guess;
}

// Cell and weights of a look-up.
struct Location {
  std::size_t first = 0;  // of the cell's first node, in nodes
  float t1 = 0;
  float t2 = 0;
  float ty = 0;
};

Location locate(const LobeTable& table, float e1, float e2, float z) {
  const float scale = float(table.exponent_nodes - 1) / last_coordinate;
  const float x1 = std::min(exponent_coordinate(e1) * scale, float(table.exponent_nodes - 1));
  const float x2 = std::min(exponent_coordinate(e2) * scale, float(table.exponent_nodes - 1));
  const float k = std::sqrt(e1 + e2 + 1);
  const float x = 0.5F * (1 + std::asinh(k * z) / std::asinh(k));
  const float xy = std::clamp(x, 0.0F, 1.0F) * float(table.angle_nodes - 1);
  const int i1 = std::min(int(x1), table.exponent_nodes - 2);
  const int i2 = std::min(int(x2), table.exponent_nodes - 2);
  const int iy = std::min(int(xy), table.angle_nodes - 2);
  Location at;
  at.first = (std::size_t(i1) * std::size_t(table.exponent_nodes) + std::size_t(i2)) * std::size_t(table.angle_nodes) +
             std::size_t(iy);
  at.t1 = x1 - float(i1);
  at.t2 = x2 - float(i2);
  at.ty = xy - float(iy);
  return at;
}

float interpolate(const LobeTable& table, const Location& at, int channel) {
  const std::size_t step2 = std::size_t(table.angle_nodes);
  const std::size_t step1 = step2 * std::size_t(table.exponent_nodes);
  const auto along_angle = [&](std::size_t node) {
    const float* v = table.values.data() + node * LobeTable::channels + channel;
    return v[0] + at.ty * (v[LobeTable::channels] - v[0]);
  };
  const float v00 = along_angle(at.first);
  const float v01 = along_angle(at.first + step2);
  const float v10 = along_angle(at.first + step1);
  const float v11 = along_angle(at.first + step1 + step2);
  const float v0 = v00 + at.t2 * (v01 - v00);
  const float v1 = v10 + at.t2 * (v11 - v10);
  return v0 + at.t1 * (v1 - v0);
}

// The angle between unit vectors, without the digits that a dot product loses at its ends.
struct Angle {
  float cosine;
  float sine;
  float z;  // cos(alpha/2) - sin(alpha/2)
};
Angle angle_between(const V3f& a, const V3f& b) {
  const float s = (a - b).length();  // 2 sin(alpha/2)
  const float c = (a + b).length();
  return {0.25F * (c - s) * (c + s), 0.5F * s * c, 0.5F * (c - s)};
}

float at_most(float exponent) { return std::min(exponent, max_lobe_exponent); }

}  // namespace

namespace {

// An empty table of that size.
LobeTable sized(const LobeTableParams& params) {
  if (params.exponent_nodes < 2 || params.exponent_nodes > 129 || params.angle_nodes < 2 || params.angle_nodes > 513)
    throw ParameterError("nodes", "a lobe table needs 2 to 129 along the exponents and 2 to 513 along the angle");
  LobeTable table;
  table.exponent_nodes = params.exponent_nodes;
  table.angle_nodes = params.angle_nodes;
  table.values.resize(lobe_table_bytes(params) / sizeof(float));
  return table;
}

void fill_node(LobeTable& table, int i1, int i2, int j) {
  const int n = table.exponent_nodes;
  const auto exponent_at = [&](int i) {
    return i + 1 == n ? double(max_lobe_exponent)
                      : std::expm1(double(last_coordinate) * i / (n - 1)) / double(exponent_slope);
  };
  const double e1 = exponent_at(i1);
  const double e2 = exponent_at(i2);
  const double k = std::sqrt(e1 + e2 + 1);
  const double x = 2.0 * j / (table.angle_nodes - 1) - 1;
  const double z = std::clamp(std::sinh(x * std::asinh(k)) / k, -1.0, 1.0);
  // z = sqrt(2) sin(pi/4 - alpha/2). At the end itself all is 0/0: the limit is taken a little before.
  const double alpha =
      std::clamp(0.5 * double(pi) - 2 * std::asin(z / std::numbers::sqrt2), 0.0, std::numbers::pi - 1e-4);
  const LobeProductMoments moments = lobe_product_moments(e1, e2, alpha);
  const Guess guess = make_guess(float(e1), float(e2), float(std::cos(alpha)), float(std::sin(alpha)));
  const std::size_t node =
      (std::size_t(i1) * std::size_t(n) + std::size_t(i2)) * std::size_t(table.angle_nodes) + std::size_t(j);
  float* out = table.values.data() + node * LobeTable::channels;
  out[0] = float(std::exp(moments.log_integral - double(guess.log_integral)));
  out[1] = float((moments.axis_angle_rad - std::atan(double(guess.tan1))) * k);
  out[2] = float((moments.exponent + 2) / (e1 + e2 + 2));
}

Lobe first_lobe(const LobePair& pair) { return {V3f(1, 0, 0), float(pair.e1), 1}; }
Lobe second_lobe(const LobePair& pair) {
  return {V3f(float(std::cos(pair.angle_rad)), float(std::sin(pair.angle_rad)), 0), float(pair.e2), 1};
}

}  // namespace

std::size_t lobe_table_bytes(const LobeTableParams& params) {
  return std::size_t(params.exponent_nodes) * std::size_t(params.exponent_nodes) * std::size_t(params.angle_nodes) *
         LobeTable::channels * sizeof(float);
}

LobeTable make_lobe_table(const LobeTableParams& params) {
  LobeTable table = sized(params);
  tbb::parallel_for(0, params.exponent_nodes * params.exponent_nodes, [&](int row) {
    for (int j = 0; j < params.angle_nodes; ++j)
      fill_node(table, row / params.exponent_nodes, row % params.exponent_nodes, j);
  });
  return table;
}

LobeTable make_lobe_table_for(const LobeTableParams& params, std::span<const LobePair> pairs) {
  LobeTable table = sized(params);
  const auto n = std::size_t(params.exponent_nodes);
  const auto angles = std::size_t(params.angle_nodes);
  std::vector<std::size_t> nodes;
  for (const LobePair& pair : pairs) {
    const std::size_t first =
        locate(table, float(pair.e1), float(pair.e2), angle_between(first_lobe(pair).axis, second_lobe(pair).axis).z)
            .first;
    for (std::size_t k = 0; k < 8; ++k)
      nodes.push_back(first + ((k & 1U) != 0 ? n * angles : 0) + ((k & 2U) != 0 ? angles : 0) + (k >> 2U));
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  tbb::parallel_for(std::size_t(0), nodes.size(), [&](std::size_t i) {
    const std::size_t row = nodes[i] / angles;
    fill_node(table, int(row / n), int(row % n), int(nodes[i] % angles));
  });
  return table;
}

float lobe_product_integral(const LobeTable& table, const Lobe& a, const Lobe& b) {
  const float e1 = at_most(a.exponent);
  const float e2 = at_most(b.exponent);
  const Angle angle = angle_between(a.axis, b.axis);
  const Guess guess = make_guess(e1, e2, angle.cosine, angle.sine);
  return a.scale * b.scale * guess.integral * interpolate(table, locate(table, e1, e2, angle.z), 0);
}

Lobe lobe_product(const LobeTable& table, const Lobe& a, const Lobe& b) {
  const float e1 = at_most(a.exponent);
  const float e2 = at_most(b.exponent);
  const Angle angle = angle_between(a.axis, b.axis);
  const Guess guess = make_guess(e1, e2, angle.cosine, angle.sine);
  const Location at = locate(table, e1, e2, angle.z);
  const float integral = a.scale * b.scale * guess.integral * interpolate(table, at, 0);
  Lobe product;
  product.exponent = (e1 + e2 + 2) * interpolate(table, at, 2) - 2;
  product.exponent = std::max(product.exponent, 0.0F);
  product.scale = integral * (product.exponent + 1) / (2 * pi);
  const float theta = std::atan(guess.tan1) + interpolate(table, at, 1) / std::sqrt(e1 + e2 + 1);
  // Perpendicular to a's axis, towards b's; any direction does where the axes fall together.
  V3f side = b.axis - a.axis * angle.cosine;
  const float length = side.length();
  product.axis = length > 1e-12F ? (a.axis * std::cos(theta) + side * (std::sin(theta) / length)).normalized() : a.axis;
  return product;
}

namespace {

// Pair number `index`, its integral left out.
LobePair random_pair(std::uint64_t seed, std::uint64_t index) {
  const double span = double(last_coordinate);
  return {std::expm1(span * counted_uniform(seed, 3 * index)) / double(exponent_slope),
          std::expm1(span * counted_uniform(seed, 3 * index + 1)) / double(exponent_slope),
          double(pi) * counted_uniform(seed, 3 * index + 2)};
}

double largest_integral(const LobePair& pair) { return 2 * double(pi) / (pair.e1 + pair.e2 + 1); }
constexpr double least_share = 1e-6;  // of the largest integral: what less is left of counts for nothing

struct Collector {
  std::vector<double> values;
  LobeTableErrors::Distribution result;
  double sum = 0;

  void add(double error, double e1, double e2, double alpha) {
    values.push_back(error);
    sum += error;
    if (!(error > result.worst) && values.size() > 1) return;
    result.worst = error;
    result.worst_e1 = e1;
    result.worst_e2 = e2;
    result.worst_angle_rad = alpha;
  }
  LobeTableErrors::Distribution finish() {
    if (values.empty()) return result;
    result.mean = sum / double(values.size());
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    result.median = *middle;
    return result;
  }
};

}  // namespace

LobeTableErrors lobe_table_errors(const LobeTable& table, std::uint64_t samples, std::uint64_t seed) {
  Collector absolute, of_largest, of_true, exponent, axis, shape;
  for (std::uint64_t i = 0; i < samples; ++i) {
    const LobePair pair = random_pair(seed, i);
    const auto& [e1, e2, alpha, unknown] = pair;
    const LobeProductMoments truth = lobe_product_moments(e1, e2, alpha);
    const double largest = largest_integral(pair);
    const double integral = std::exp(truth.log_integral);
    const Lobe product = lobe_product(table, first_lobe(pair), second_lobe(pair));
    const double error = std::abs(double(lobe_integral(product)) - integral);
    absolute.add(error, e1, e2, alpha);
    of_largest.add(error / largest, e1, e2, alpha);
    if (!(integral > least_share * largest)) continue;
    of_true.add(error / integral, e1, e2, alpha);
    exponent.add(std::abs(double(product.exponent) - truth.exponent) / (truth.exponent + 1), e1, e2, alpha);
    const double angle = std::atan2(double(product.axis.y), double(product.axis.x));
    axis.add(std::abs(angle - truth.axis_angle_rad) * std::sqrt(truth.exponent + 1), e1, e2, alpha);
    // ||f - g||^2 = ||f||^2 - 2 f.g + ||g||^2; lobes in one plane make each term an exact integral.
    const double scale = double(product.scale);
    const double ff = std::exp(log_planar_product({{2 * e1, 0}, {2 * e2, alpha}}));
    const double er = double(product.exponent);
    const double fg = scale * std::exp(log_planar_product({{e1, 0}, {e2, alpha}, {er, angle}}));
    const double gg = scale * scale * 2 * double(pi) / (2 * er + 1);
    shape.add(std::sqrt(std::max(0.0, ff - 2 * fg + gg) / ff), e1, e2, alpha);
  }
  LobeTableErrors errors;
  errors.samples = samples;
  errors.absolute = absolute.finish();
  errors.of_largest = of_largest.finish();
  errors.of_true = of_true.finish();
  errors.exponent = exponent.finish();
  errors.axis = axis.finish();
  errors.shape = shape.finish();
  return errors;
}

std::vector<LobePair> make_lobe_pairs(std::uint64_t count, std::uint64_t seed) {
  std::vector<LobePair> drawn(count);
  tbb::parallel_for(std::uint64_t(0), count, [&](std::uint64_t i) {
    drawn[i] = random_pair(seed, i);
    drawn[i].integral = std::exp(lobe_product_moments(drawn[i].e1, drawn[i].e2, drawn[i].angle_rad).log_integral);
  });
  std::erase_if(drawn, [](const LobePair& pair) { return !(pair.integral > least_share * largest_integral(pair)); });
  return drawn;
}

MeasuredError lobe_integral_error(const LobeTable& table, std::span<const LobePair> pairs) {
  std::vector<double> errors;
  for (const LobePair& pair : pairs) {
    const double integral = double(lobe_product_integral(table, first_lobe(pair), second_lobe(pair)));
    errors.push_back(std::abs(integral - pair.integral) / pair.integral);
  }
  return mean_error(errors);
}

}  // namespace ivory
