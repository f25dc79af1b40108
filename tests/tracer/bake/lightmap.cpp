// Lightmaps: where texels lie, what is refused, and light whose answer is known.
#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "tools/stability/scene_builder.h"
#include "tracer/bake/lightmap/baker.h"

namespace ivory {
namespace {

// A quad with its chart: a corner, two edges; the front is towards cross(u, v).
Mesh quad(const V3f& corner, const V3f& u, const V3f& v, const V2f& uv_low, const V2f& uv_high, int material) {
  Mesh mesh;
  mesh.name = "quad";
  mesh.positions = {corner, corner + u, corner + u + v, corner + v};
  mesh.uvs = {{}, {uv_low, V2f(uv_high.x, uv_low.y), uv_high, V2f(uv_low.x, uv_high.y)}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.material = material;
  return mesh;
}
// A floor of 2 x 2 m that looks up, in the middle half of the atlas.
Mesh floor_quad(int material) {
  return quad(V3f(-1, 0, 1), V3f(2, 0, 0), V3f(0, 0, -2), V2f(0.25F, 0.25F), V2f(0.75F, 0.75F), material);
}

TEST(LightmapCharts, TexelsLieWhereTheirCentresDo) {
  Scene scene;
  add_mesh(scene, floor_quad(add_lambert(scene, Rgb(0.5F, 0.5F, 0.5F))));
  const Charts charts = make_charts(scene, 1, 32, 32);
  int covered = 0;
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) {
      const std::size_t i = std::size_t(32 * y + x);
      const bool inside = x >= 8 && x < 24 && y >= 8 && y < 24;
      ASSERT_EQ(charts.texels[i].instance != no_index, inside) << x << " " << y;
      if (!inside) continue;
      ++covered;
      const ChartPoint at = chart_point(scene, charts, i, V2f(0, 0));
      const V3f expected(-1 + (float(x) + 0.5F - 8) / 8, 0, 1 - (float(y) + 0.5F - 8) / 8);
      EXPECT_LT((at.p - expected).length(), 1e-5F);
      EXPECT_LT((at.ng - V3f(0, 1, 0)).length(), 1e-6F);
      // A quarter of a texel is a thirty-second of a metre, within the texel's own triangle.
      if (std::abs(x - y) > 1) {
        const ChartPoint beside = chart_point(scene, charts, i, V2f(0.25F, -0.25F));
        EXPECT_LT((beside.p - expected - V3f(0.03125F, 0, 0.03125F)).length(), 1e-5F);
      }
    }
  }
  EXPECT_EQ(covered, 256);
}

// A texel that a chart only touches stands for the chart's nearest point.
TEST(LightmapCharts, TouchedTexelsStandForTheEdge) {
  Scene scene;
  add_mesh(scene,
           quad(V3f(0, 0, 0), V3f(1, 0, 0), V3f(0, 1, 0), V2f(0, 0), V2f(0.55F, 1), add_lambert(scene, Rgb(1, 1, 1))));
  const Charts charts = make_charts(scene, 1, 10, 10);
  for (int y = 0; y < 10; ++y) {
    // The chart ends at 5.5 texels: the sixth's centre lies on its edge.
    EXPECT_NE(charts.texels[std::size_t(10 * y + 5)].instance, no_index);
    EXPECT_EQ(charts.texels[std::size_t(10 * y + 6)].instance, no_index);
    // A twentieth of a texel inside: 5.5 to the metre.
    const float x = chart_point(scene, charts, std::size_t(10 * y + 5), V2f(0.5F, 0)).p.x;
    EXPECT_LT(x, 1 - 1e-4F);
    EXPECT_GT(x, 1 - 0.05F / 5.5F - 1e-4F);
  }
}

void expect_refused(const Scene& scene, const std::string& text) {
  try {
    make_charts(scene, 1, 32, 32);
    FAIL() << text;
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
}

TEST(LightmapCharts, AreNamedWhereTheyAreWrong) {
  const auto with = [](Mesh mesh) {
    Scene scene;
    mesh.material = add_lambert(scene, Rgb(1, 1, 1));
    add_mesh(scene, std::move(mesh));
    return scene;
  };
  Mesh mesh = floor_quad(0);
  mesh.name = "hall";
  EXPECT_NO_THROW(make_charts(with(mesh), 1, 32, 32));
  Mesh missing = mesh;
  missing.uvs.clear();
  expect_refused(with(missing), "'hall' lacks TEXCOORD_1");
  Mesh flat = mesh;
  for (V2f& uv : flat.uvs[1]) uv = V2f(0, 0);
  expect_refused(with(flat), "'hall' has no area in TEXCOORD_1");
  Mesh outside = mesh;
  outside.uvs[1][2] = V2f(1.5F, 0.5F);
  expect_refused(with(outside), "'hall' lies beyond 0 to 1");
  // Its second triangle on its first.
  Mesh folded = mesh;
  folded.uvs[1][3] = folded.uvs[1][1];
  expect_refused(with(folded), "'hall' overlap each other");
  Scene two = with(mesh);
  Mesh other = mesh;
  other.name = "stairs";
  add_mesh(two, other);
  expect_refused(two, "'hall' and 'stairs' overlap");
  Scene twice = with(mesh);
  twice.instances.push_back(twice.instances.front());
  expect_refused(twice, "place one mesh");
  EXPECT_THROW(make_charts(with(mesh), 1, 0, 32), ParameterError);
}

// A closed box whose walls shine with L_e at albedo rho has L = L_e / (1 - rho) everywhere: E = pi L. What is stored is
// E less that straight from the walls.
TEST(LightmapBake, FurnaceHasTheClosedForm) {
  constexpr float albedo = 0.6F;
  const Rgb emission(2, 1, 0.5F);
  Scene scene;
  const int wall = add_lambert(scene, Rgb(albedo, albedo, albedo), emission);
  Mesh room = make_room(V3f(-1, -1, -1), V3f(1, 1, 1), wall);
  // Its faces side by side: two triangles each.
  Mesh split;
  split.name = "room";
  split.material = wall;
  split.uvs.resize(2);
  for (std::size_t t = 0; t < room.triangles.size(); ++t) {
    const std::array<V2f, 3> half =
        t % 2 == 0 ? std::array{V2f(0, 0), V2f(1, 0), V2f(1, 1)} : std::array{V2f(0, 0), V2f(1, 1), V2f(0, 1)};
    for (unsigned i = 0; i < 3; ++i) {
      split.positions.push_back(room.positions[room.triangles[t][i]]);
      split.uvs[1].push_back((V2f(float(t / 2), 0) + half[i] * 0.9F) / V2f(float((room.triangles.size() + 1) / 2), 1));
    }
    const auto first = std::uint32_t(3 * t);
    split.triangles.emplace_back(first, first + 1, first + 2);
  }
  add_mesh(scene, std::move(split));
  const LitScene lit = make_lit_scene(std::move(scene));
  const Charts charts = make_charts(*lit.scene, 1, 48, 8);
  const Rgb expected = emission * (pi / (1 - albedo));
  const IndirectLight indirect = [&](const Surface&) { return expected - emission * pi; };
  LightmapParams params;
  params.samples = 16;
  params.gather_rays = 4;
  const Lightmap map = bake_lightmap(lit, indirect, charts, params);
  EXPECT_EQ(map.count(TexelState::buried), 0U);
  ASSERT_GT(map.count(TexelState::baked), 200U);
  V3d mean(0, 0, 0);
  for (std::size_t i = 0; i < map.e.size(); ++i) {
    if (map.states[i] != TexelState::baked) continue;
    mean += V3d(map.e[i]) / double(map.count(TexelState::baked));
    // Gathered light has no noise here, direct light little.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(map.e[i][c] / expected[c], 1, 0.25) << i;
  }
  for (unsigned c = 0; c < 3; ++c) EXPECT_NEAR(mean[c] / double(expected[c]), 1, 0.01);

  LightmapParams of_stored = params;
  of_stored.indirect_only = true;
  of_stored.gather_rays = 0;
  const Lightmap stored = bake_lightmap(lit, indirect, charts, of_stored);
  for (std::size_t i = 0; i < stored.e.size(); ++i) {
    if (stored.states[i] == TexelState::baked) {
      EXPECT_NEAR(stored.e[i].x, expected.x - emission.x * pi, 1e-4);
    }
  }
  params.threads = 1;
  EXPECT_EQ(bake_lightmap(lit, indirect, charts, params).e, map.e);
}

// A sun on a floor with a solid box on it: texels under the box are buried and take their neighbours' light, as do
// rings around the chart.
TEST(LightmapBake, FillsWhatIsBuriedAndGrowsCharts) {
  Scene scene;
  const int grey = add_lambert(scene, Rgb(0.5F, 0.5F, 0.5F));
  add_mesh(scene, floor_quad(grey));
  // A box seen from outside: a room turned inside out, without a chart in the atlas' way.
  Mesh box = make_room(V3f(-0.3F, -0.2F, -0.3F), V3f(0.3F, 0.4F, 0.3F), grey);
  for (auto& t : box.triangles) std::swap(t.y, t.z);
  box.normals.clear();
  Mesh split;
  split.name = "box";
  split.material = grey;
  split.uvs.resize(2);
  for (std::size_t t = 0; t < box.triangles.size(); ++t) {
    for (unsigned i = 0; i < 3; ++i) {
      split.positions.push_back(box.positions[box.triangles[t][i]]);
      split.uvs[1].push_back(V2f(0.02F + 0.03F * float(t) + (i == 1 ? 0.02F : 0.0F), i == 2 ? 0.03F : 0.01F));
    }
    const auto first = std::uint32_t(3 * t);
    split.triangles.emplace_back(first, first + 1, first + 2);
  }
  add_mesh(scene, std::move(split));
  scene.lights = {DirectionalLight{V3f(0, -1, 0), Rgb(10, 20, 30)}};
  const LitScene lit = make_lit_scene(std::move(scene));
  const Charts charts = make_charts(*lit.scene, 1, 64, 64);
  const IndirectLight none = [](const Surface&) { return Rgb(0, 0, 0); };
  LightmapParams params;
  params.samples = 2;
  params.gather_rays = 2;
  params.dilate = 3;
  const Lightmap map = bake_lightmap(lit, none, charts, params);
  // 0.6 of 2 m across, on 32 texels: some ten by ten; those on its rim see out.
  EXPECT_NEAR(double(map.count(TexelState::buried)), 81, 25);
  const auto at = [&](int x, int y) { return std::size_t(64 * y + x); };
  for (int y = 16; y < 48; ++y) {
    for (int x = 16; x < 48; ++x) {
      const bool near_box = std::max(std::abs(x - 32), std::abs(y - 32)) < 8;
      EXPECT_GT(map.e[at(x, y)].z, near_box ? 1.0F : 29.9F) << x << " " << y;
    }
  }
  EXPECT_EQ(map.states[at(13, 30)], TexelState::dilated);
  EXPECT_NEAR(map.e[at(13, 30)].y, 20, 1e-4);
  EXPECT_EQ(map.states[at(12, 30)], TexelState::empty);
  EXPECT_EQ(map.e[at(12, 30)], Rgb(0, 0, 0));
}

}  // namespace
}  // namespace ivory
