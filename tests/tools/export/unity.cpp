// ivory export of grids to Unity and VRC Light Volumes: the files parsed, and their readers' formulas.
#include <algorithm>
#include <cmath>
#include <regex>
#include <sstream>

#include <half.h>

#include "tests/tools/export/grid_fixture.h"

namespace ivory {
namespace {

using Imath::V4d;
using Json = nlohmann::json;
constexpr double pi_d = 3.14159265358979323846;

// unity_SHAr to unity_SHC (Shader Variables of Unity's built-in pipeline) of sh[c, i]; E / pi.
double unity_e_over_pi(const std::array<double, 27>& sh, unsigned c, const V3d& n) {
  const auto at = [&](std::size_t i) { return sh[9 * c + i]; };
  return at(0) - at(6) + at(1) * n.y + at(2) * n.z + at(3) * n.x + at(4) * n.x * n.y + at(5) * n.y * n.z +
         3 * at(6) * n.z * n.z + at(7) * n.x * n.z + at(8) * (n.x * n.x - n.y * n.y);
}

struct UnityProbes {
  std::vector<V3d> positions;
  std::vector<std::array<double, 27>> sh;
};
UnityProbes read_probes(const std::string& text) {
  UnityProbes out;
  static const std::regex position(R"(    - \{x: (\S+), y: (\S+), z: (\S+)\})");
  static const std::regex coefficient(R"(  ([- ]) sh\[ ?(\d+)\]: (\S+))");
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (std::regex_match(line, match, position)) {
      out.positions.emplace_back(std::stod(match[1]), std::stod(match[2]), std::stod(match[3]));
    } else if (std::regex_match(line, match, coefficient)) {
      if (match[1] == "-") out.sh.emplace_back();
      out.sh.back()[std::stoul(match[2])] = std::stod(match[3]);
    }
  }
  return out;
}

// At each probe its own light, in the world that glTF importers mirror.
TEST_F(ExportGrid, UnityProbesShowTheGrid) {
  const IrradianceGrid grid = bake(scene("room_boxes.gltf"), "--resolution 8 --basis sh9");
  const Json result = export_to("unity", "room.asset");
  const std::string text = bytes_of(path("room.asset"));
  EXPECT_TRUE(text.starts_with("%YAML 1.1\n%TAG !u! tag:unity3d.com,2011:\n--- !u!258 &25800000\nLightProbes:\n"));
  const UnityProbes probes = read_probes(text);
  ASSERT_EQ(probes.positions.size(), result["written_probes"].get<std::size_t>());
  ASSERT_EQ(probes.sh.size(), probes.positions.size());
  std::mt19937 random(3);
  double squares = 0;
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < probes.positions.size(); ++i) {
    const V3d& u = probes.positions[i];
    const V3f p(float(-u.x), float(u.y), float(u.z));
    const V3f index = grid.frame.to_index(p);
    const V3i at(int(std::lround(index.x)), int(std::lround(index.y)), int(std::lround(index.z)));
    ASSERT_LT((index - V3f(at)).length(), 1e-3);
    const std::size_t vertex = grid.frame.vertex_index(at.x, at.y, at.z);
    if (grid.visible_fraction[vertex] < 0.25F) continue;
    Footprint one;
    one.count = 1;
    one.vertex[0] = std::uint32_t(vertex);
    one.weight[0] = 1;
    const V3f n = random_direction(random);
    const Rgb e = irradiance(grid, one, n, Reconstruction::optimal);
    if (is_black(e)) continue;
    const double shown = std::max(pi_d * unity_e_over_pi(probes.sh[i], 0, V3d(-n.x, n.y, n.z)), 0.0);
    squares += (shown - e.x) * (shown - e.x);
    sum += e.x;
    ++count;
  }
  ASSERT_GT(count, 200);
  EXPECT_LT(std::sqrt(squares / count) / (sum / count), 1e-4);  // floats
}

struct VrcTexture {
  V3i size{0, 0, 0};
  std::vector<V4d> texels;
};
VrcTexture read_texture(const std::string& text) {
  VrcTexture out;
  const auto field = [&](const std::string& name) {
    const std::size_t at = text.find("\n  " + name + ": ");
    EXPECT_NE(at, std::string::npos) << name;
    const std::size_t begin = at + name.size() + 5;
    return text.substr(begin, text.find('\n', begin) - begin);
  };
  EXPECT_EQ(field("m_Format"), "48");
  out.size = V3i(std::stoi(field("m_Width")), std::stoi(field("m_Height")), std::stoi(field("m_Depth")));
  const std::string hex = field("_typelessdata");
  EXPECT_EQ(hex.size(), 2 * std::stoul(field("m_DataSize")));
  EXPECT_EQ(field("image data"), field("m_DataSize"));
  for (std::size_t i = 0; i + 16 <= hex.size(); i += 16) {
    V4d texel;
    for (unsigned c = 0; c < 4; ++c) {
      const auto byte = [&](std::size_t k) { return std::stoul(hex.substr(i + 4 * c + 2 * k, 2), nullptr, 16); };
      half h;
      h.setBits(std::uint16_t(byte(0) | byte(1) << 8U));
      texel[c] = double(float(h));
    }
    out.texels.push_back(texel);
  }
  return out;
}
V4d sample(const VrcTexture& texture, const V3d& uvw) {
  V4d sum(0, 0, 0, 0);
  for (unsigned corner = 0; corner < 8; ++corner) {
    std::size_t index = 0;
    double weight = 1;
    for (int axis = 2; axis >= 0; --axis) {
      const double x = uvw[unsigned(axis)] * texture.size[axis] - 0.5;
      const double base = std::floor(x);
      const bool up = (corner >> unsigned(axis) & 1U) != 0;
      weight *= up ? x - base : 1 - (x - base);
      index = index * std::size_t(texture.size[axis]) +
              std::size_t(std::clamp(int(base) + (up ? 1 : 0), 0, texture.size[axis] - 1));
    }
    sum += texture.texels[index] * weight;
  }
  return sum;
}

// LightVolumes.cginc: L0 + dot(L1, n) of the three textures. A grid of four coefficients a channel holds no more, so
// that the format loses nothing but where L1 is longer than L0.
TEST_F(ExportGrid, VrcLightVolumesShowTheGrid) {
  const IrradianceGrid grid = bake(scene("room_boxes.gltf"), "--resolution 12 --basis sh4");
  const Json result = export_to("vrc", "room.asset");
  std::array<VrcTexture, 3> textures;
  const std::array<const char*, 3> names{"room.asset", "room.1.asset", "room.2.asset"};
  for (std::size_t i = 0; i < 3; ++i) {
    textures[i] = read_texture(bytes_of(path(names[i])));
    ASSERT_EQ(textures[i].texels.size(), grid.frame.vertex_count());
  }
  const Json about = Json::parse(bytes_of(path("room.json")));
  const auto vector = [](const Json& v) { return V3d(v[0], v[1], v[2]); };
  const V3d position = vector(about["transform"]["position"]);
  const V3d scale = vector(about["transform"]["scale"]);
  const auto reader = [&](const V3d& p, const V3d& n) {
    const V3d uvw = (V3d(-p.x, p.y, p.z) - position) / scale + V3d(0.5, 0.5, 0.5);
    const V4d t0 = sample(textures[0], uvw);
    const V4d t1 = sample(textures[1], uvw);
    const V4d t2 = sample(textures[2], uvw);
    const V3d m(-n.x, n.y, n.z);
    const V3d e(t0.x + V3d(t1.x, t2.x, t0.w).dot(m), t0.y + V3d(t1.y, t2.y, t1.w).dot(m),
                t0.z + V3d(t1.z, t2.z, t2.w).dot(m));
    return V3d(std::max(e.x, 0.0), std::max(e.y, 0.0), std::max(e.z, 0.0)) * (about["intensity"].get<double>() * pi_d);
  };
  const double rms =
      relative_rms(points_of(grid, false, 12), reader, [&](const Point& i) { return truth(grid, i.p, i.n); });
  std::printf("VRC: %.2f %% of mean E; said: %.2f %%\n", 100 * rms, 100 * result["loss"]["in_the_open"].get<double>());
  EXPECT_LT(rms, 0.01);
  EXPECT_NEAR(result["loss"]["in_the_open"].get<double>(), rms, 0.005);
}

}  // namespace
}  // namespace ivory
