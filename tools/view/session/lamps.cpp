#include "tools/view/session/lamps.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "tools/cli/numbers.h"
#include "tools/view/session/session.h"

namespace ivory {

bool ViewLamp::changed() const { return !on || scale != 1 || tint != Rgb(1, 1, 1) || offset_m != V3f(0, 0, 0); }

std::vector<ViewLamp> lamps_of(const ViewSession& session) {
  const Scene& scene = session.world.scene();
  std::vector<ViewLamp> lamps(scene.lights.size());
  for (std::size_t i = 0; i < lamps.size(); ++i) {
    const int node = i < scene.light_nodes.size() ? scene.light_nodes[i] : no_index;
    lamps[i].name = node == no_index ? "" : scene.nodes[std::size_t(node)].name;
    if (lamps[i].name.empty()) lamps[i].name = fmt::format("{}", i);
  }
  return lamps;
}

void change_lamp(ViewSession& session, const std::string& text) {
  const std::size_t equals = text.rfind('=');
  constexpr std::string_view form = "NAME=SCALE[,R,G,B[,X,Y,Z]]";
  if (equals == std::string::npos) throw UsageError(fmt::format("--lamp: '{}' is not {}", text, form));
  const std::string_view values = std::string_view(text).substr(equals + 1);
  const auto commas = std::size_t(std::count(values.begin(), values.end(), ','));
  const std::size_t count = commas == 0 ? 1 : commas <= 3 ? 4 : 7;
  const std::vector<double> v = parse_numbers("--lamp", values, count, form);
  for (std::size_t i = 0; i < std::min<std::size_t>(count, 4); ++i) {
    if (!(v[i] >= 0 && v[i] <= 1e9)) throw UsageError("--lamp: brightness and colours are from 0 to 1e9");
  }
  bool any = false;
  for (ViewLamp& lamp : session.lamps) {
    if (lamp.name != text.substr(0, equals)) continue;
    lamp.scale = float(v[0]);
    if (count > 1) lamp.tint = Rgb(float(v[1]), float(v[2]), float(v[3]));
    if (count > 4) lamp.offset_m = V3f(V3d(v[4], v[5], v[6]));
    any = true;
  }
  if (any) return;
  std::set<std::string> names;
  for (const ViewLamp& lamp : session.lamps) names.insert(lamp.name);
  throw UsageError(
      fmt::format("--lamp: no punctual light is called '{}'; {}", text.substr(0, equals),
                  names.empty() ? "the scene has none" : fmt::format("there are {}", fmt::join(names, ", "))));
}

void shine(ViewSession& session) {
  std::vector<RuntimeLight> lights = runtime_lights(session.world.scene());
  bool changed = false;
  // A pose may leave a lamp out that lights nothing: then no number is sure.
  if (lights.size() == session.lamps.size()) {
    for (std::size_t i = 0; i < lights.size(); ++i) {
      const ViewLamp& lamp = session.lamps[i];
      lights[i].intensity *= lamp.tint * lamp.of_group * (lamp.on ? lamp.scale : 0.0F);
      lights[i].position_m += lamp.offset_m;
      changed = changed || lamp.changed();
    }
  }
  std::erase_if(lights, [](const RuntimeLight& light) { return is_black(light.intensity); });
  session.direct = strongest(lights, max_lights, session.world.center_m, session.world.radius_m);
  ++session.lights_version;
  if (!changed || session.told_of_old_lamps) return;
  const ViewAsset* grid = find_asset(session.assets, FileKind::grid);
  if (grid == nullptr) return;
  session.told_of_old_lamps = true;
  session.notes.push_back(fmt::format(
      "note: lamps were changed, and {} keeps what they gave by way of surfaces when it was baked", grid->label()));
}

}  // namespace ivory
