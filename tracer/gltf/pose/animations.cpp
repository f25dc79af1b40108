#include "tracer/gltf/pose/animations.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <utility>

#include <OpenImageIO/hash.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/error.h"
#include "tracer/gltf/accessors.h"
#include "tracer/gltf/nodes/tree.h"
#include "tracer/gltf/schema/check.h"

namespace ivory::gltf {
namespace {

using nlohmann::json;

// An animation sampler: values of `components` numbers at times; CUBICSPLINE has three a key: tangent in, value,
// tangent out.
struct Sampler {
  std::string what;
  std::vector<float> times;
  std::vector<float> values;
  std::size_t components = 1;
  std::string interpolation;

  std::size_t per_key() const { return interpolation == "CUBICSPLINE" ? 3 : 1; }
  // part 0: tangent in, 1: value, 2: tangent out
  double at(std::size_t key, std::size_t component, std::size_t part = 1) const {
    const std::size_t place = per_key() == 3 ? 3 * key + part : key;
    return double(values[place * components + component]);
  }
};

Sampler read_sampler(const Document& document, const json& source, const std::string& what, int components,
                     std::size_t values_a_key) {
  Sampler sampler;
  sampler.what = what;
  sampler.interpolation = source.value("interpolation", std::string("LINEAR"));
  const int input = source["input"];
  const int output = source["output"];
  if (document.model.accessors[std::size_t(input)].componentType != TINYGLTF_COMPONENT_TYPE_FLOAT)
    document.fail(what + " has times that are not floats", remedy);
  sampler.times = read_floats(document, input, 1, what + " input");
  for (std::size_t k = 0; k < sampler.times.size(); ++k) {
    const bool rises = k == 0 ? sampler.times[0] >= 0 : sampler.times[k] > sampler.times[k - 1];
    if (!rises) document.fail(fmt::format("{} has times that do not rise from 0, at key {}", what, k), remedy);
  }
  const tinygltf::Accessor& accessor = document.model.accessors[std::size_t(output)];
  if (accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT ||
      (accessor.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT && !accessor.normalized))
    document.fail(what + " has values that are neither floats nor normalized integers", remedy);
  sampler.values = read_floats(document, output, components, what + " output");
  sampler.components = std::size_t(components) * values_a_key;
  const std::size_t wanted = sampler.times.size() * sampler.per_key() * sampler.components;
  if (sampler.values.size() != wanted) {
    document.fail(fmt::format("{} has {} numbers for {} keys instead of {}", what, sampler.values.size(),
                              sampler.times.size(), wanted),
                  remedy);
  }
  return sampler;
}

double length_of(const std::vector<double>& v) {
  double sum = 0;
  for (const double x : v) sum += x * x;
  return std::sqrt(sum);
}

// glTF 2.0, C.4: along the shorter arc.
std::vector<double> slerp(const std::vector<double>& from, const std::vector<double>& to, double u) {
  double cosine = 0;
  for (std::size_t i = 0; i < 4; ++i) cosine += from[i] * to[i];
  const double sign = cosine < 0 ? -1 : 1;
  const double angle = std::acos(std::min(1.0, std::abs(cosine)));
  double a = 1 - u;
  double b = u;
  if (angle > 1e-6) {
    a = std::sin(angle * (1 - u)) / std::sin(angle);
    b = std::sin(angle * u) / std::sin(angle);
  }
  std::vector<double> result(4);
  for (std::size_t i = 0; i < 4; ++i) result[i] = a * from[i] + sign * b * to[i];
  return result;
}

std::vector<double> key_value(const Document& document, const Sampler& sampler, std::size_t key, bool is_rotation) {
  std::vector<double> value(sampler.components);
  for (std::size_t i = 0; i < value.size(); ++i) value[i] = sampler.at(key, i);
  if (is_rotation) {
    checked_rotation(document, fmt::format("{} key {}", sampler.what, key), value[0], value[1], value[2], value[3]);
    const double length = length_of(value);
    for (double& x : value) x /= length;
  }
  return value;
}

// glTF 2.0, appendix C.
std::vector<double> eval(const Document& document, const Sampler& sampler, double time_s, bool is_rotation) {
  const auto next = std::ranges::upper_bound(sampler.times, time_s, {}, [](float t) { return double(t); });
  const auto behind = std::size_t(next - sampler.times.begin());
  if (behind == 0) return key_value(document, sampler, 0, is_rotation);
  const std::size_t key = behind - 1;
  std::vector<double> value = key_value(document, sampler, key, is_rotation);
  if (behind == sampler.times.size() || sampler.interpolation == "STEP") return value;
  const double step = double(sampler.times[behind]) - double(sampler.times[key]);
  const double u = (time_s - double(sampler.times[key])) / step;
  const std::vector<double> to = key_value(document, sampler, behind, is_rotation);
  if (sampler.interpolation == "CUBICSPLINE") {
    const double u2 = u * u;
    const double u3 = u2 * u;
    for (std::size_t i = 0; i < value.size(); ++i) {
      value[i] = (2 * u3 - 3 * u2 + 1) * value[i] + step * (u3 - 2 * u2 + u) * sampler.at(key, i, 2) +
                 (-2 * u3 + 3 * u2) * to[i] + step * (u3 - u2) * sampler.at(behind, i, 0);
    }
  } else if (is_rotation) {
    value = slerp(value, to, u);
  } else {
    for (std::size_t i = 0; i < value.size(); ++i) value[i] = (1 - u) * value[i] + u * to[i];
  }
  if (is_rotation) {
    const double length = length_of(value);
    if (!(length > 1e-6))
      document.fail(fmt::format("{} passes through no rotation at {} s", sampler.what, time_s), remedy);
    for (double& x : value) x /= length;
  }
  return value;
}

std::size_t find_animation(const Document& document, const std::string& text) {
  const json& root = *document.json;
  const auto found = root.find("animations");
  const std::size_t count = found != root.end() && found->is_array() ? found->size() : 0;
  if (count == 0) throw ParameterError("time", document.path + " has no animation");
  if (text.empty()) return 0;
  for (std::size_t i = 0; i < count; ++i)
    if ((*found)[i].value("name", std::string()) == text) return i;
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
  if (error == std::errc() && end == text.data() + text.size() && index < count) return index;
  throw ParameterError("animation",
                       fmt::format("{} has no animation '{}'; it has {}, counted from 0", document.path, text, count));
}

// Targets of the mesh that the node shows.
std::size_t morph_count(const Document& document, std::size_t node) {
  const int mesh = document.model.nodes[node].mesh;
  return mesh < 0 ? 0 : document.model.meshes[std::size_t(mesh)].primitives.front().targets.size();
}

class Animator {
 public:
  Animator(Document& document, std::size_t index, double time_s)
      : document_(document),
        source_(element(document, "animations", index)),
        what_(label("animations", index, source_.value("name", std::string()))),
        time_s_(time_s) {}

  void run() {
    for (const json& channel : source_["channels"]) {
      const std::string what = fmt::format("{} channel {}", what_, number_++);
      if (channel["sampler"].get<std::size_t>() >= source_["samplers"].size())
        document_.fail(fmt::format("{} has no sampler {}", what, channel["sampler"].dump()), remedy);
      const json& target = channel["target"];
      const std::string path = target["path"];
      if (path == "pointer") {
        document_.warn(what + " animates by KHR_animation_pointer, which is ignored");
      } else if (path != "translation" && path != "rotation" && path != "scale" && path != "weights") {
        document_.warn(fmt::format("{} animates '{}', which is ignored", what, path));
      } else if (target.contains("node")) {
        apply(channel, target["node"].get<std::size_t>(), path, what);
      }
    }
    if (any_ && !within_) {
      document_.warn(fmt::format("{} runs from {} s to {} s; at {} s its {} pose is taken", what_, begin_s_, end_s_,
                                 time_s_, time_s_ < begin_s_ ? "first" : "last"));
    }
    if (!any_) document_.warn(what_ + " animates nothing that ivory reads; the stored pose is taken");
  }

 private:
  void apply(const json& channel, std::size_t index, const std::string& path, const std::string& what) {
    tinygltf::Node& node = document_.model.nodes[index];
    if (!done_.insert({index, path}).second) {
      document_.fail(fmt::format("{} animates the {} of {} a second time", what, path, node_label(document_, index)),
                     remedy);
    }
    const bool is_weights = path == "weights";
    if (!is_weights && !node.matrix.empty()) {
      document_.fail(
          fmt::format("{} animates the {} of {}, which has a matrix", what, path, node_label(document_, index)),
          remedy);
    }
    const std::size_t morphs = is_weights ? morph_count(document_, index) : 1;
    if (morphs == 0) {
      document_.fail(
          fmt::format("{} animates the weights of {}, which has no morph targets", what, node_label(document_, index)),
          remedy);
    }
    const bool is_rotation = path == "rotation";
    const Sampler sampler = read_sampler(document_, source_["samplers"][channel["sampler"].get<std::size_t>()], what,
                                         is_weights    ? 1
                                         : is_rotation ? 4
                                                       : 3,
                                         morphs);
    std::vector<double> value = eval(document_, sampler, time_s_, is_rotation);
    begin_s_ = any_ ? std::min(begin_s_, sampler.times.front()) : sampler.times.front();
    end_s_ = std::max(end_s_, sampler.times.back());
    within_ = time_s_ >= double(begin_s_) && time_s_ <= double(end_s_);
    any_ = true;
    if (path == "translation") {
      node.translation = std::move(value);
    } else if (path == "rotation") {
      node.rotation = std::move(value);
    } else if (path == "scale") {
      node.scale = std::move(value);
    } else if (path == "weights") {
      node.weights = std::move(value);
    }
  }

  Document& document_;
  const json& source_;
  std::string what_;
  double time_s_;
  int number_ = 0;
  std::set<std::pair<std::size_t, std::string>> done_;
  bool any_ = false;
  bool within_ = true;
  float begin_s_ = 0;
  float end_s_ = 0;
};

}  // namespace

void apply_animation(Document& document, const std::string& animation, double time_s) {
  if (!std::isfinite(time_s)) throw ParameterError("time", "is not finite");
  check_animation_schema(document);
  const std::size_t index = find_animation(document, animation);
  Animator(document, index, time_s).run();
  // What was baked at another time is of another scene.
  const double key[] = {double(index), time_s};
  document.hash = OIIO::xxhash::XXH64(key, sizeof key, document.hash);
}

void warn_of_animations(Document& document) {
  const auto found = document.json->find("animations");
  if (found == document.json->end() || !found->is_array() || found->empty()) return;
  document.warn(fmt::format("has {} animation{}; all stands as it is stored, at none of their times", found->size(),
                            found->size() == 1 ? "" : "s"));
}

}  // namespace ivory::gltf
