// ivory export of grids to Godot 4.
#include <array>
#include <bit>
#include <cstdlib>

#include "tests/support/gltf_builder.h"
#include "tests/tools/export/grid_fixture.h"

namespace ivory {
namespace {

using Json = nlohmann::json;

// A text resource's probes as Godot 4 taps them (LightStorage::lightmap_tap_sh_light() and the capture's part of
// scene_forward_clustered.glsl), parsed from the text. It shows E / pi, times albedo.
class GodotProbes {
 public:
  explicit GodotProbes(const std::string& text)
      : points_(list(text, "points")),
        sh_(list(text, "sh")),
        tetrahedra_(list(text, "tetrahedra")),
        bsp_(list(text, "bsp")) {
    EXPECT_EQ(sh_.size() / 36, points_.size() / 3);  // or LightmapGIData refuses them
    EXPECT_EQ(tetrahedra_.size() % 4, 0U);
    EXPECT_EQ(bsp_.size() % 6, 0U);
  }
  V3d e_over_pi(const V3d& p, const V3d& n) const {
    int node = 0;
    while (node >= 0) {
      const double* at = &bsp_[std::size_t(6 * node)];
      const auto plane = [&](int i) { return double(std::bit_cast<float>(std::int32_t(at[i]))); };
      const bool over = plane(0) * p.x + plane(1) * p.y + plane(2) * p.z > plane(3);
      const int next = int(over ? at[4] : at[5]);
      EXPECT_TRUE(next < 0 || next > node);
      node = next;
    }
    const std::size_t tetrahedron = std::size_t(std::abs(node) - 1);
    std::array<V3d, 4> v;
    std::array<std::size_t, 4> point{};
    for (std::size_t i = 0; i < 4; ++i) {
      point[i] = std::size_t(tetrahedra_[4 * tetrahedron + i]);
      v[i] = V3d(points_[3 * point[i]], points_[3 * point[i] + 1], points_[3 * point[i] + 2]);
    }
    // Geometry3D::tetrahedron_get_barycentric_coords().
    const V3d vap = p - v[0];
    const V3d vbp = p - v[1];
    const V3d vab = v[1] - v[0];
    const V3d vac = v[2] - v[0];
    const V3d vad = v[3] - v[0];
    const V3d vbc = v[2] - v[1];
    const V3d vbd = v[3] - v[1];
    const double v6 = 1 / vab.dot(vac.cross(vad));
    const std::array<double, 4> weight{vbp.dot(vbd.cross(vbc)) * v6, vap.dot(vac.cross(vad)) * v6,
                                       vap.dot(vad.cross(vab)) * v6, vap.dot(vab.cross(vac)) * v6};
    std::array<V3d, 9> c;
    c.fill(V3d(0, 0, 0));
    for (std::size_t i = 0; i < 4; ++i) {
      const double w = std::clamp(weight[i], 0.0, 1.0);
      for (std::size_t k = 0; k < 9; ++k) {
        const double* colour = &sh_[36 * point[i] + 4 * k];
        c[k] += V3d(colour[0], colour[1], colour[2]) * w;
      }
    }
    V3d e = c[0] * 0.886227 + (c[1] * n.y + c[2] * n.z + c[3] * n.x) * 1.023327;
    e += (c[4] * (n.x * n.y) + c[5] * (n.y * n.z) + c[7] * (n.x * n.z)) * 0.858086;
    return e + c[6] * (0.247708 * (3 * n.z * n.z - 1)) + c[8] * (0.429043 * (n.x * n.x - n.y * n.y));
  }

 private:
  static std::vector<double> list(const std::string& text, const std::string& key) {
    std::size_t at = text.find("\"" + key + "\": Packed");
    at = text.find('(', at) + 1;
    std::vector<double> out;
    const char* next = text.c_str() + at;
    for (char* end = nullptr; *next != ')'; next = *end == ',' ? end + 1 : end) out.push_back(std::strtod(next, &end));
    return out;
  }
  std::vector<double> points_, sh_, tetrahedra_, bsp_;
};

TEST_F(ExportGrid, GodotShowsTheGrid) {
  for (const bool rotated : {false, true}) {
    const IrradianceGrid grid = bake(scene(rotated ? "room_boxes_rotated.gltf" : "room_boxes.gltf"),
                                     std::string("--resolution 16 --basis sh9") + (rotated ? " --rotate-y 30" : ""));
    const Json result = export_to("godot", "room.tres");
    const GodotProbes probes(bytes_of(path("room.tres")));
    // At the probes themselves all is held, to the float sums of a turned basis.
    std::vector<Point> vertices;
    for (const Point& point : points_of(grid, false, 9)) {
      const V3f index = grid.frame.to_index(point.p);
      vertices.push_back(
          {grid.frame.to_world(V3f(std::round(index.x), std::round(index.y), std::round(index.z))), point.n});
    }
    const auto reader = [&](const V3d& p, const V3d& n) { return probes.e_over_pi(p, n) * 3.14159265358979; };
    const auto e_of = [&](const Point& i) { return truth(grid, i.p, i.n); };
    EXPECT_LT(relative_rms(vertices, reader, e_of), 1e-3) << rotated;
    // Between them four corners of a cell answer where ivory asks eight: the format's loss, 1.2 % with the noise of so
    // few photons.
    const double loss = relative_rms(points_of(grid, false, 10), reader, e_of);
    EXPECT_LT(loss, 0.02) << rotated;
    EXPECT_NEAR(result["loss"]["in_the_open"].get<double>() / loss, 1, 0.35) << rotated;
  }
}

}  // namespace
}  // namespace ivory
