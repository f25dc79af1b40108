// Directional bases: E(n) from the moments that a vertex of a grid stores. Twin of grid/field/basis.cpp and of
// grid/field/compact_vectors.cpp, where the derivations are.
//
// Moments come as vec3 m[12], one RGB triple a function in the order of grid/field/basis.h (12, 9, 9, 6 or 4 of them
// count), in lux; n is a unit vector in the frame that the moments live in. Answers are lux, never negative.
#include "base/pi.glsl"

const int ivory_basis_vectors = 0;  // the values of enum class Basis
const int ivory_basis_vectors9 = 1;
const int ivory_basis_sh9 = 2;
const int ivory_basis_ambient_cube = 3;
const int ivory_basis_sh4 = 4;
const int ivory_reconstruction_optimal = 0;  // the values of enum class Reconstruction
const int ivory_reconstruction_paper = 1;

int ivory_function_count(int basis) {
  return basis == ivory_basis_vectors ? 12 : basis == ivory_basis_ambient_cube ? 6 : basis == ivory_basis_sh4 ? 4 : 9;
}

// n.v for a vector whose components x, y, z are v_x, v_y, v_z, each RGB.
vec3 ivory_dot(vec3 n, vec3 v_x, vec3 v_y, vec3 v_z) { return v_x * n.x + v_y * n.y + v_z * n.z; }

// Within 2e-8 (Abramowitz & Stegun, Handbook of Mathematical Functions, 4.4.46): GLSL leaves asin's precision open, and
// drivers are content with 1e-4 and more.
vec3 ivory_asin(vec3 x) {
  vec3 a = min(abs(x), vec3(1.0));
  vec3 p = vec3(-0.0012624911);
  p = p * a + 0.0066700901;
  p = p * a - 0.0170881256;
  p = p * a + 0.0308918810;
  p = p * a - 0.0501743046;
  p = p * a + 0.0889789874;
  p = p * a - 0.2145988016;
  p = p * a + 1.5707963050;
  return sign(x) * (0.5 * ivory_pi - sqrt(1.0 - a) * p);
}

// Coefficients of the even half: |n.w| ~ sum_i c[i][i] |w_i| + sum_{i != j} c[i][j] sgn(w_i) w_j.
mat3 ivory_even_coefficients(vec3 n) {
  const float gram_p = 4.18879020479;
  const float gram_q = 2.66666666667;
  vec3 ni = clamp(n, vec3(-1.0), vec3(1.0));
  vec3 angle = ivory_asin(ni);
  vec3 rhs = gram_q * (sqrt(1.0 - ni * ni) + ni * angle);
  float mean = (rhs.x + rhs.y + rhs.z) / 3.0;
  vec3 diagonal = (rhs - mean) / (gram_p - gram_q) + 1.0 / 3.0;
  const float scale = gram_q / (gram_p * gram_p - gram_q * gram_q);
  float b_xy = scale * (gram_p * n.y * angle.x - gram_q * n.x * angle.y);
  float b_xz = scale * (gram_p * n.z * angle.x - gram_q * n.x * angle.z);
  float b_yx = scale * (gram_p * n.x * angle.y - gram_q * n.y * angle.x);
  float b_yz = scale * (gram_p * n.z * angle.y - gram_q * n.y * angle.z);
  float b_zx = scale * (gram_p * n.x * angle.z - gram_q * n.z * angle.x);
  float b_zy = scale * (gram_p * n.y * angle.z - gram_q * n.z * angle.y);
  return mat3(vec3(diagonal.x, b_xy, b_xz), vec3(b_yx, diagonal.y, b_yz), vec3(b_zx, b_zy, diagonal.z));
}

// Bounds on E(n) that hold whatever the light; vectors only.
void ivory_irradiance_bracket(vec3 m[12], vec3 n, out vec3 lower, out vec3 upper) {
  vec3 f = ivory_dot(n, m[0], m[1], m[2]);
  vec3 d_x = ivory_dot(n, m[3], m[4], m[5]);
  vec3 d_y = ivory_dot(n, m[6], m[7], m[8]);
  vec3 d_z = ivory_dot(n, m[9], m[10], m[11]);
  vec3 zero = vec3(0.0);
  lower = max(zero, (f + d_x) * 0.5) + max(zero, (f - d_x) * 0.5);
  lower = max(lower, max(zero, (f + d_y) * 0.5) + max(zero, (f - d_y) * 0.5));
  lower = max(lower, max(zero, (f + d_z) * 0.5) + max(zero, (f - d_z) * 0.5));
  upper = (f + m[3] * abs(n.x) + m[7] * abs(n.y) + m[11] * abs(n.z)) * 0.5;
}

vec3 ivory_optimal_vectors(vec3 m[12], vec3 n) {
  mat3 even = ivory_even_coefficients(n);
  vec3 sum = ivory_dot(n, m[0], m[1], m[2]);
  sum += ivory_dot(even[0], m[3], m[4], m[5]);
  sum += ivory_dot(even[1], m[6], m[7], m[8]);
  sum += ivory_dot(even[2], m[9], m[10], m[11]);
  vec3 lower, upper;
  ivory_irradiance_bracket(m, n, lower, upper);
  return min(max(sum * 0.5, lower), max(lower, upper));
}

// RR-6983 section 4.1: I_x n_x^2 + I_y n_y^2 + I_z n_z^2, of the three hemispheres that n lies in.
vec3 ivory_paper_vectors(vec3 m[12], vec3 n) {
  vec3 f = ivory_dot(n, m[0], m[1], m[2]);
  vec3 d_x = ivory_dot(n, m[3], m[4], m[5]);
  vec3 d_y = ivory_dot(n, m[6], m[7], m[8]);
  vec3 d_z = ivory_dot(n, m[9], m[10], m[11]);
  vec3 sum = (n.x < 0.0 ? f - d_x : f + d_x) * (0.5 * n.x * n.x);
  sum += (n.y < 0.0 ? f - d_y : f + d_y) * (0.5 * n.y * n.y);
  sum += (n.z < 0.0 ? f - d_z : f + d_z) * (0.5 * n.z * n.z);
  return max(vec3(0.0), sum);
}

vec3 ivory_optimal_vectors9(vec3 m[12], vec3 n) {
  mat3 even = ivory_even_coefficients(n);
  vec3 f = ivory_dot(n, m[0], m[1], m[2]);
  vec3 sum = f + ivory_dot(vec3(even[0][0], even[1][1], even[2][2]), m[3], m[4], m[5]);
  vec3 pairs = vec3(even[0][1] + even[1][0], even[0][2] + even[2][0], even[1][2] + even[2][1]);
  sum += ivory_dot(pairs * 0.5, m[6], m[7], m[8]);
  vec3 lower = max(vec3(0.0), f * 0.5);
  vec3 upper = (f + ivory_dot(abs(n), m[3], m[4], m[5])) * 0.5;
  return min(max(sum * 0.5, lower), max(lower, upper));
}

// A_l Y_lm(n) contracted with the first four, or all nine, coefficients.
vec3 ivory_irradiance_sh(vec3 m[12], vec3 n, int count) {
  const float a0_y00 = 0.88622693;  // pi sqrt(1/(4 pi))
  const float a1_y1 = 1.02332671;   // 2/3 pi sqrt(3/(4 pi))
  const float a2_y2 = 0.85808553;   // pi/4 sqrt(15/(4 pi)), twice pi/4 sqrt(15/(16 pi))
  const float a2_y20 = 0.24770796;  // pi/4 sqrt(5/(16 pi))
  vec3 sum = m[0] * a0_y00 + (m[1] * n.y + m[2] * n.z + m[3] * n.x) * a1_y1;
  if (count == 9) {
    sum += (m[4] * (n.x * n.y) + m[5] * (n.y * n.z) + m[7] * (n.x * n.z)) * a2_y2;
    sum += m[6] * ((3.0 * n.z * n.z - 1.0) * a2_y20) + m[8] * ((n.x * n.x - n.y * n.y) * (0.5 * a2_y2));
  }
  return max(vec3(0.0), sum);
}

vec3 ivory_irradiance_ambient_cube(vec3 m[12], vec3 n) {
  return (n.x < 0.0 ? m[1] : m[0]) * (n.x * n.x) + (n.y < 0.0 ? m[3] : m[2]) * (n.y * n.y) +
         (n.z < 0.0 ? m[5] : m[4]) * (n.z * n.z);
}

// `paper` reads the basis vectors only, and is `optimal` for others.
vec3 ivory_irradiance(int basis, int reconstruction, vec3 m[12], vec3 n) {
  if (basis == ivory_basis_vectors && reconstruction == ivory_reconstruction_paper) return ivory_paper_vectors(m, n);
  if (basis == ivory_basis_vectors) return ivory_optimal_vectors(m, n);
  if (basis == ivory_basis_vectors9) return ivory_optimal_vectors9(m, n);
  if (basis == ivory_basis_sh9) return ivory_irradiance_sh(m, n, 9);
  if (basis == ivory_basis_ambient_cube) return ivory_irradiance_ambient_cube(m, n);
  return ivory_irradiance_sh(m, n, 4);
}

// One hemisphere's vector, as its components x, y, z (RGB each), from its norms and its direction of any length.
mat3 ivory_hemisphere_from_compact(vec3 norms, vec3 direction) {
  float squared = dot(direction, direction);
  vec3 d = squared > 0.0 ? direction * inversesqrt(squared) : vec3(0.0);
  return mat3(norms * d.x, norms * d.y, norms * d.z);
}

// In place: six norms and six directions become the twelve moments of the basis vectors, to be read at the unit normal
// n. Each axis states the full vector F anew; n_i^2 weighs them.
void ivory_moments_from_compact(inout vec3 m[12], vec3 n) {
  mat3 px = ivory_hemisphere_from_compact(m[0], m[6]);
  mat3 mx = ivory_hemisphere_from_compact(m[1], m[7]);
  mat3 py = ivory_hemisphere_from_compact(m[2], m[8]);
  mat3 my = ivory_hemisphere_from_compact(m[3], m[9]);
  mat3 pz = ivory_hemisphere_from_compact(m[4], m[10]);
  mat3 mz = ivory_hemisphere_from_compact(m[5], m[11]);
  mat3 f = (px + mx) * (n.x * n.x) + (py + my) * (n.y * n.y) + (pz + mz) * (n.z * n.z);
  mat3 d_x = px - mx;
  mat3 d_y = py - my;
  mat3 d_z = pz - mz;
  for (int i = 0; i < 3; ++i) {
    m[i] = f[i];
    m[3 + i] = d_x[i];
    m[6 + i] = d_y[i];
    m[9 + i] = d_z[i];
  }
}
