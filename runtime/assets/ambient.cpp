#include "runtime/assets/ambient.h"

#include <vector>

#include <fmt/format.h>

#include "runtime/gl/shader_source.h"

namespace ivory {

namespace {

std::string sum_shader(std::span<const WeightedSource> sources) {
  const int count = int(sources.size());
  std::string text = "#include \"renderer/bsdf.glsl\"\n";
  text += fmt::format("uniform vec3 ivory_weights[{}];\n", count);
  std::string any_radiance;
  std::string irradiances;
  std::string terms;
  for (int i = 0; i < count; ++i) {
    text += fmt::format("#ivory_slot {}\n{}\n#ivory_end_slot\n", i, sources[std::size_t(i)].source.shader);
    const std::string gives_radiance = slot_name(i, "IVORY_AMBIENT_RADIANCE");
    any_radiance += fmt::format("{}defined({})", i == 0 ? "" : " || ", gives_radiance);
    irradiances +=
        fmt::format("{}ivory_weights[{}] * {}(p, ng, n)", i == 0 ? "" : " + ", i, slot_name(i, "ivory_ambient"));
    terms += fmt::format(
        "#ifdef {0}\n  radiance += ivory_weights[{1}] * {2}(s);\n#else\n  e += ivory_weights[{1}] * {3}(s.p, s.ng, "
        "s.ns);\n#endif\n",
        gives_radiance, i, slot_name(i, "ivory_ambient_radiance"), slot_name(i, "ivory_ambient"));
  }
  // E where all give E: debug views and programs may ask for it.
  text += fmt::format(R"(#if {}
#define IVORY_AMBIENT_RADIANCE
vec3 ivory_ambient_radiance(IvorySurface s) {{
  vec3 e = vec3(0.0);
  vec3 radiance = vec3(0.0);
{}  return radiance + ivory_diffuse_reflectance(s) / ivory_pi * e;
}}
#else
vec3 ivory_ambient(vec3 p, vec3 ng, vec3 n) {{ return {}; }}
#endif
)",
                      any_radiance, terms, irradiances);
  return text;
}

}  // namespace

AmbientSource sum_of(std::span<const WeightedSource> sources) {
  if (sources.empty()) return no_ambient();
  if (sources.size() == 1 && sources.front().weight == Rgb(1, 1, 1)) return sources.front().source;
  struct Part {
    std::function<int(gl::Program&, int)> bind;
    Rgb weight;
  };
  std::vector<Part> parts;
  for (const WeightedSource& weighted : sources) parts.push_back({weighted.source.bind, weighted.weight});
  return {sum_shader(sources), [parts = std::move(parts)](gl::Program& program, int unit) {
            for (std::size_t i = 0; i < parts.size(); ++i) {
              program.set(fmt::format("ivory_weights[{}]", i), parts[i].weight);
              const gl::Program::Slot slot(program, int(i));
              unit = parts[i].bind(program, unit);
            }
            return unit;
          }};
}

AmbientSource no_ambient() { return constant_ambient(Rgb(0, 0, 0)); }

AmbientSource constant_ambient(const Rgb& e_lux) {
  return {"#include \"ambient/constant.glsl\"\n", [e_lux](gl::Program& program, int first_unit) {
            program.set("ivory_constant_e", e_lux);
            return first_unit;
          }};
}

}  // namespace ivory
