#include "runtime/assets/sh9.h"

namespace ivory {

GpuSh9 upload(const Sh9& sh) { return {to_float(sh9_matrices(sh))}; }

GpuSh9 load_sh9(const std::string& path) { return upload(read_sh9(path).sh); }

int bind(const GpuSh9& sh, gl::Program& program, int first_unit) {
  const char* names[3] = {"ivory_sh9.red", "ivory_sh9.green", "ivory_sh9.blue"};
  for (std::size_t c = 0; c < 3; ++c) {
    M44f m;
    for (std::size_t i = 0; i < 16; ++i) m[int(i / 4)][i % 4] = sh.matrices[c][i];
    program.set(names[c], m);
  }
  return first_unit;
}

AmbientSource ambient(const GpuSh9& sh) {
  return {"#include \"ambient/sh9.glsl\"\n",
          [&sh](gl::Program& program, int first_unit) { return bind(sh, program, first_unit); }};
}

}  // namespace ivory
