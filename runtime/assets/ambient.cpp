#include "runtime/assets/ambient.h"

namespace ivory {

AmbientSource no_ambient() { return constant_ambient(Rgb(0, 0, 0)); }

AmbientSource constant_ambient(const Rgb& e_lux) {
  return {"#include \"ambient/constant.glsl\"\n", [e_lux](gl::Program& program, int first_unit) {
            program.set("ivory_constant_e", e_lux);
            return first_unit;
          }};
}

}  // namespace ivory
