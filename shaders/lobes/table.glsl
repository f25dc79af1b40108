// The product of two cosine lobes as one lobe, by a table. Twin of grid/lobes/table.cpp, where the guess is derived
// that the table corrects.
//
// Inputs: IvoryLobeTable and two 3D textures with linear filters from ivory::bind(GpuLobes): x angle, y second
// exponent, z first; `integrals` R32F holds integral/guess, `products` RGB32F that, the axis' correction and the
// exponent's share. Hardware that filters with weights of 8 bits adds at most 1/512 of the difference between
// neighbouring nodes along each axis.
#include "base/pi.glsl"
#include "lobes/lobe.glsl"

struct IvoryLobeTable {
  int exponent_nodes;
  int angle_nodes;
};

// log(1 + x) for x >= 0, to full precision where x is small.
float ivory_log1p(float x) {
  float y = x / (2.0 + x);
  float y2 = y * y;
  // 2 atanh(y); y is under 1/5 where it is used.
  float series = 2.0 * y * (1.0 + y2 * (1.0 / 3.0 + y2 * (0.2 + y2 * (1.0 / 7.0 + y2 * (1.0 / 9.0)))));
  return x < 0.5 ? series : log(1.0 + x);
}

float ivory_asinh(float x) {
  float y = log(abs(x) + sqrt(x * x + 1.0));
  return x < 0.0 ? -y : y;
}

struct IvoryLobeGuess {
  float tan1;      // of the peak's angle from the first axis
  float integral;  // of two lobes of scale 1
};

// The angle between the axes by its cosine y and sine.
IvoryLobeGuess ivory_lobe_guess(float e1, float e2, float y, float sine) {
  float f1 = e1 + 0.5;
  float f2 = e2 + 0.5;
  float n = f1 + f2;
  float a = max(sine, 1e-12) * (f2 / n);
  float b = max(sine, 1e-12) * (f1 / n);
  float h = 0.5 * (sqrt(y * y + 4.0 * a * b) + abs(y));
  float tan1 = y >= 0.0 ? a / h : h / b;
  float tan2 = y >= 0.0 ? b / h : h / a;
  float t1 = tan1 * tan1;
  float t2 = tan2 * tan2;
  float log_peak = -0.5 * (e1 * ivory_log1p(t1) + e2 * ivory_log1p(t2));
  float width = 2.0 * ivory_pi / (e1 + e2 + 1.0) * sqrt(n / (n + f1 * t1 + f2 * t2));
  return IvoryLobeGuess(tan1, width * exp(log_peak));
}

// Cosine, sine and cos(alpha/2) - sin(alpha/2) of the angle between unit vectors.
vec3 ivory_lobe_angle(vec3 a, vec3 b) {
  float s = length(a - b);
  float c = length(a + b);
  return vec3(0.25 * (c - s) * (c + s), 0.5 * s * c, 0.5 * (c - s));
}

// Where the table is read.
vec3 ivory_lobe_locate(IvoryLobeTable table, float e1, float e2, float z) {
  const float last_coordinate = 12.8992224;  // log(1 + 4 100000)
  float last = float(table.exponent_nodes - 1);
  float x1 = min(ivory_log1p(4.0 * e1) * (last / last_coordinate), last);
  float x2 = min(ivory_log1p(4.0 * e2) * (last / last_coordinate), last);
  float k = sqrt(e1 + e2 + 1.0);
  float x = clamp(0.5 * (1.0 + ivory_asinh(k * z) / ivory_asinh(k)), 0.0, 1.0);
  float xy = x * float(table.angle_nodes - 1);
  return vec3((xy + 0.5) / float(table.angle_nodes), vec2(x2 + 0.5, x1 + 0.5) / float(table.exponent_nodes));
}

// Integral of the product over the sphere.
float ivory_lobe_product_integral(IvoryLobeTable table, sampler3D integrals, IvoryLobe a, IvoryLobe b) {
  float e1 = min(a.exponent, 100000.0);
  float e2 = min(b.exponent, 100000.0);
  vec3 angle = ivory_lobe_angle(a.axis, b.axis);
  IvoryLobeGuess guess = ivory_lobe_guess(e1, e2, angle.x, angle.y);
  return a.scale * b.scale * guess.integral * textureLod(integrals, ivory_lobe_locate(table, e1, e2, angle.z), 0.0).r;
}

// The product as one lobe.
IvoryLobe ivory_lobe_product(IvoryLobeTable table, sampler3D products, IvoryLobe a, IvoryLobe b) {
  float e1 = min(a.exponent, 100000.0);
  float e2 = min(b.exponent, 100000.0);
  vec3 angle = ivory_lobe_angle(a.axis, b.axis);
  IvoryLobeGuess guess = ivory_lobe_guess(e1, e2, angle.x, angle.y);
  vec3 read = textureLod(products, ivory_lobe_locate(table, e1, e2, angle.z), 0.0).rgb;
  float exponent = max((e1 + e2 + 2.0) * read.b - 2.0, 0.0);
  float scale = a.scale * b.scale * guess.integral * read.r * (exponent + 1.0) / (2.0 * ivory_pi);
  // cos and sin of atan(tan1) plus the correction: rotated by it.
  float c1 = inversesqrt(1.0 + guess.tan1 * guess.tan1);
  float s1 = guess.tan1 > 1e18 ? 1.0 : guess.tan1 * c1;
  float turn = read.g / sqrt(e1 + e2 + 1.0);
  float ct = cos(turn);
  float st = sin(turn);
  vec3 side = b.axis - a.axis * angle.x;
  float len = length(side);
  vec3 axis = len > 1e-12 ? normalize(a.axis * (c1 * ct - s1 * st) + side * ((s1 * ct + c1 * st) / len)) : a.axis;
  return IvoryLobe(axis, exponent, scale);
}
