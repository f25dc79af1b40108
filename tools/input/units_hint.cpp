#include "tools/input/units_hint.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <string_view>
#include <vector>

#include <fmt/format.h>

namespace ivory {

namespace {

struct Unit {
  const char* name;
  const char* option;
  double metres;
};
constexpr std::array<Unit, 2> units{{{"centimetres", "--scale 0.01", 0.01}, {"millimetres", "--scale 0.001", 0.001}}};

// Heights of things, metres, from the lowest to the highest that anyone would model.
struct Thing {
  std::string_view word;
  double low_m;
  double high_m;
};
constexpr std::array<Thing, 16> things{{{"door", 1.7, 3},
                                        {"chair", 0.5, 1.4},
                                        {"table", 0.3, 1.2},
                                        {"desk", 0.5, 1.3},
                                        {"sofa", 0.5, 1.3},
                                        {"couch", 0.5, 1.3},
                                        {"bed", 0.3, 1.5},
                                        {"human", 1.2, 2.2},
                                        {"person", 1.2, 2.2},
                                        {"character", 1.2, 2.2},
                                        {"man", 1.4, 2.2},
                                        {"woman", 1.4, 2.2},
                                        {"car", 1.1, 2.2},
                                        {"toilet", 0.3, 1.1},
                                        {"bottle", 0.12, 0.4},
                                        {"fridge", 0.8, 2.2}}};

// Is it one of the words that the name is made of? "Door_01" has "door", "doormat" has not.
bool has_word(std::string_view name, std::string_view word) {
  const auto is_letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
  for (std::size_t begin = 0; begin < name.size();) {
    std::size_t end = begin;
    while (end < name.size() && is_letter(name[end])) ++end;
    const std::string_view part = name.substr(begin, end - begin);
    if (std::equal(part.begin(), part.end(), word.begin(), word.end(),
                   [](char a, char b) { return static_cast<char>(std::tolower(static_cast<unsigned char>(a))) == b; }))
      return true;
    begin = end + 1;
  }
  return false;
}

Box3f box_of(const Scene& scene, const Instance& instance) {
  Box3f box;
  for (const V3f& p : scene.meshes[std::size_t(instance.mesh)].positions) box.extendBy(p * instance.to_world);
  return box;
}

struct Facts {
  Box3f bounds;
  std::vector<Box3f> below;  // [node] of all that it and its children place
  double longest_m = 0;
};

Facts facts_of(const Scene& scene) {
  Facts facts;
  facts.below.resize(scene.nodes.size());
  for (const Instance& instance : scene.instances) {
    const Box3f box = box_of(scene, instance);
    facts.bounds.extendBy(box);
    for (int node = instance.node; node != no_index; node = scene.nodes[std::size_t(node)].parent)
      facts.below[std::size_t(node)].extendBy(box);
  }
  if (facts.bounds.isEmpty()) return facts;
  const V3f size = facts.bounds.size();
  facts.longest_m = double(std::max({size.x, size.y, size.z}));
  return facts;
}

class Clues {
 public:
  Clues(const LoadedScene& loaded, const Facts& facts, const Unit& unit) : loaded_(loaded), facts_(facts), unit_(unit) {
    look_at_names();
    look_at_cameras();
    look_at_lamps();
  }

  int points = 0;
  std::vector<std::string> texts;

 private:
  void add(int count, std::string text) {
    points += count;
    texts.push_back(std::move(text));
  }

  void look_at_names() {
    const Scene& scene = loaded_.scene;
    for (const Thing& thing : things) {
      for (std::size_t node = 0; node < scene.nodes.size(); ++node) {
        if (facts_.below[node].isEmpty() || !has_word(scene.nodes[node].name, thing.word)) continue;
        const double height = double(facts_.below[node].size().y);
        if (height >= thing.low_m / 2 && height <= thing.high_m * 2) {
          points -= 4;
        } else if (height * unit_.metres >= thing.low_m && height * unit_.metres <= thing.high_m) {
          add(2, fmt::format("'{}' is {:.4g} m high", scene.nodes[node].name, height));
          break;
        }
      }
    }
  }

  void look_at_cameras() {
    constexpr double low_eye_m = 1;
    constexpr double high_eye_m = 2.2;
    for (const Camera& camera : loaded_.scene.cameras) {
      const V3f eye(camera.to_world[3][0], camera.to_world[3][1], camera.to_world[3][2]);
      const double height = double(eye.y - facts_.bounds.min.y);
      if (!facts_.bounds.intersects(eye) || height * unit_.metres < low_eye_m || height * unit_.metres > high_eye_m)
        continue;
      add(1, fmt::format("a camera stands {:.4g} m above the lowest floor", height));
      break;
    }
    // In metres near planes lie at a hand's breadth.
    const auto nearest = std::min_element(loaded_.camera_near.begin(), loaded_.camera_near.end());
    if (nearest != loaded_.camera_near.end() && *nearest >= 0.01 / unit_.metres)
      add(1, fmt::format("its cameras see nothing within {:.4g} m", *nearest));
  }

  void look_at_lamps() {
    const Scene& scene = loaded_.scene;
    double strongest_cd = 0;
    bool others = scene.environment.has_value() || !scene.sphere_lights.empty();
    for (const PunctualLight& light : scene.lights) {
      if (const auto* point = std::get_if<PointLight>(&light)) {
        strongest_cd = std::max(strongest_cd, double(max_component(point->intensity_cd)));
      } else if (const auto* spot = std::get_if<SpotLight>(&light)) {
        strongest_cd = std::max(strongest_cd, double(max_component(spot->intensity_cd)));
      } else {
        others = true;
      }
    }
    for (const Material& material : scene.materials) others = others || !is_black(material.emission);
    const double reach =
        loaded_.light_ranges.empty() ? 0 : *std::min_element(loaded_.light_ranges.begin(), loaded_.light_ranges.end());
    if (reach >= 1 / unit_.metres) add(1, fmt::format("its lamps reach {:.4g} m", reach));
    if (strongest_cd == 0) return;
    // Lamps made bright enough by eye: a metre taken for a unit asks for the square of it in candela.
    constexpr double brightest_lamp_cd = 1e5;
    if (strongest_cd >= brightest_lamp_cd * (unit_.metres < 0.005 ? 100 : 1)) {
      add(2, fmt::format("a lamp of it has {:.3g} cd", strongest_cd));
    } else if (!others && strongest_cd < 0.01 * std::pow(facts_.longest_m / 4, 2)) {
      add(1, fmt::format("its lamps, of {:.3g} cd at most, leave it dark", strongest_cd));
    }
  }

  const LoadedScene& loaded_;
  const Facts& facts_;
  const Unit& unit_;
};

}  // namespace

std::optional<std::string> units_hint(const LoadedScene& loaded) {
  // Of what a scene is at least and at most, metres: a thing on a table, and a part of a town.
  constexpr double least_m = 0.5;
  constexpr double most_m = 1000;
  constexpr double suspicious_m = 100;
  const Facts facts = facts_of(loaded.scene);
  if (!(facts.longest_m >= suspicious_m)) return std::nullopt;
  std::optional<std::string> hint;
  int most_points = 1;
  for (const Unit& unit : units) {
    const double length = facts.longest_m * unit.metres;
    if (length < least_m || length > most_m) continue;
    const Clues clues(loaded, facts, unit);
    if (clues.points <= most_points) continue;
    most_points = clues.points;
    hint = fmt::format("{} is {:.4g} m long and may be in {} ({}): {} would say so", loaded.scene.name, facts.longest_m,
                       unit.name, fmt::join(clues.texts, "; "), unit.option);
  }
  return hint;
}

}  // namespace ivory
