#include "grid/io/export/godot.h"

#include <algorithm>
#include <bit>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/io/file.h"
#include "grid/io/json.h"

namespace ivory {

namespace {

// Numbers as Godot's text resources list them.
class PackedArray {
 public:
  PackedArray(std::string& out, const char* type) : out_(out) { out_ += fmt::format("{}(", type); }
  template <typename Number>
  void add(Number value) {
    fmt::format_to(std::back_inserter(out_), "{}{}", first_ ? "" : ", ", value);
    first_ = false;
  }
  void end() { out_ += ")"; }

 private:
  std::string& out_;
  bool first_ = true;
};

}  // namespace

void write_godot_probes(const std::string& path, const ProbeTetrahedra& probes, const std::vector<ProbeSh9>& sh,
                        const Metadata& notes, bool force) {
  Box3f bounds;
  for (const V3f& p : probes.points) bounds.extendBy(p);
  const V3f size = bounds.max - bounds.min;
  std::string out = "[gd_resource type=\"LightmapGIData\" format=3]\n\n[resource]\n";
  out += fmt::format("probe_data = {{\n\"baked_exposure\": 1.0,\n\"bounds\": AABB({}, {}, {}, {}, {}, {}),\n\"bsp\": ",
                     bounds.min.x, bounds.min.y, bounds.min.z, size.x, size.y, size.z);
  PackedArray bsp(out, "PackedInt32Array");
  for (const BspNode& node : probes.nodes) {
    for (const float value : {node.normal.x, node.normal.y, node.normal.z, node.distance})
      bsp.add(std::bit_cast<std::int32_t>(value));
    bsp.add(node.over);
    bsp.add(node.under);
  }
  bsp.end();
  // Kept apart from other lightmaps' probes: it has the light of the whole place that it fills.
  out += ",\n\"interior\": false,\n\"lightprobe_hash\": 0,\n\"points\": ";
  PackedArray points(out, "PackedVector3Array");
  for (const V3f& p : probes.points)
    for (const float value : {p.x, p.y, p.z}) points.add(value);
  points.end();
  // The shader multiplies by A_i K_i and then by albedo alone: what it is given is L / pi
  // (scene_forward_clustered.glsl, "has lightmap capture"; lm_compute.glsl's probes).
  out += ",\n\"sh\": ";
  PackedArray colours(out, "PackedColorArray");
  for (const auto& probe : sh) {
    for (const V3f& c : probe) {
      for (int channel = 0; channel < 3; ++channel) colours.add(c[channel] / pi);
      colours.add(1.0F);
    }
  }
  colours.end();
  out += ",\n\"tetrahedra\": ";
  PackedArray tetrahedra(out, "PackedInt32Array");
  for (const auto& tetrahedron : probes.tetrahedra)
    for (const std::int32_t point : tetrahedron) tetrahedra.add(point);
  tetrahedra.end();
  // A JSON text within a string of Godot's, whose escapes are JSON's.
  const std::string text = to_json(notes).dump(-1, ' ', true, Json::error_handler_t::replace);
  out += "\n}\nmetadata/ivory = " + Json(text).dump(-1, ' ', true) + "\n";
  write_file(path, out, force);
}

}  // namespace ivory
