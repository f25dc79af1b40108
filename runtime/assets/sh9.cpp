#include "runtime/assets/sh9.h"

#include "grid/base/placement.h"

namespace ivory {

namespace {

// (n 1) T M (T)^T (n 1)^T, with T what turns normals back: row vectors go through it from the left.
M44f turned(const M44f& m, float turn_rad) {
  if (turn_rad == 0) return m;
  const M33f back = turn_about_y(double(-turn_rad));
  M44f t;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) t[row][column] = back[row][column];
  return t * m * t.transposed();
}

}  // namespace

GpuSh9 upload(const Sh9& sh) { return {to_float(sh9_matrices(sh))}; }

GpuSh9 load_sh9(const std::string& path) { return upload(read_sh9(path).sh); }

int bind(const GpuSh9& sh, gl::Program& program, int first_unit) {
  const char* names[3] = {"ivory_sh9.red", "ivory_sh9.green", "ivory_sh9.blue"};
  for (std::size_t c = 0; c < 3; ++c) {
    M44f m;
    for (std::size_t i = 0; i < 16; ++i) m[int(i / 4)][i % 4] = sh.matrices[c][i];
    program.set(names[c], turned(m, sh.turn_rad));
  }
  return first_unit;
}

AmbientSource ambient(const GpuSh9& sh) {
  return {"#include \"ambient/sh9.glsl\"\n",
          [&sh](gl::Program& program, int first_unit) { return bind(sh, program, first_unit); }};
}

}  // namespace ivory
