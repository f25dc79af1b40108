// Sums of ambient sources against the sum of what each gives by itself: of all kinds, and several of one kind.
#include <cmath>

#include <gtest/gtest.h>

#include "runtime/assets/cubemap.h"
#include "runtime/assets/fiv.h"
#include "runtime/assets/irradiance_grid.h"
#include "runtime/assets/lobes.h"
#include "runtime/gl/shader_source.h"
#include "tests/runtime/fiv_synthetic.h"
#include "tests/support/grid_twin.h"
#include "tests/support/render_target.h"
#include "tools/stability/cube_builder.h"

namespace ivory {
namespace {

constexpr int count = 2000;

// Assets about one place, so that all are read where they differ from point to point.
struct Assets {
  GpuGrid vectors = upload(random_grid({6, 5, 7}, Basis::vectors, false, false, 1));
  GpuGrid sh9 = upload(random_grid({9, 4, 5}, Basis::sh9, true, false, 2));
  SyntheticSky sky = synthetic_sky(3);
  GpuDifMap difmap = upload(synthetic_difmap(sky, 8));
  GpuDifMap other_difmap = upload(synthetic_difmap(synthetic_sky(4), 16));
  GpuFivTables fiv = upload(synthetic_tables(sky));
  GpuFivTables other_fiv = upload(synthetic_tables(synthetic_sky(4)));
  GpuLobes lobes = upload(make_lobe_table({9, 9}));
  GpuLocalizedCube cube = upload(make_cube(4, V3f(4, -1, 8), box_around({-4, -4, -4}, {4, 4, 4}),
                                           [](const V3f& w) { return Rgb(2 + w.x, 3, 4 - w.z); }));

  Assets() {
    set_occluders(fiv, std::vector<GpuFivOccluder>{{0, V3f(4, -1, 8), 0.4F}, {2, V3f(3.5F, 0, 8.5F), 0.3F}});
    set_occluders(other_fiv, std::vector<GpuFivOccluder>{{3, V3f(4.5F, -0.5F, 8), 0.5F}});
    place(lobes, std::vector<RuntimeSphereLight>{{{V3f(4, 2, 8), 0.4F}, Rgb(500, 300, 200)}},
          std::vector<Sphere>{{V3f(4, 0.5F, 8), 0.3F}});
  }
};

class RuntimeAmbientSum : public GlTest {
 protected:
  static std::vector<V4f> points() {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(0, 1);
    std::vector<V4f> p;
    for (int i = 0; i < count; ++i)
      p.emplace_back(3 + 2.5F * unit(random), -2 + 2.8F * unit(random), 7 + 2.4F * unit(random), 0.0F);
    return p;
  }
  static std::vector<V4f> normals() {
    std::mt19937 random(6);
    std::vector<V4f> n;
    for (int i = 0; i < count; ++i) n.push_back(to_v4(random_direction(random)));
    return n;
  }
  static std::vector<V4f> light_of(const AmbientSource& source) {
    return evaluate_on_gpu(source.shader + R"(
vec4 evaluate(int i) { return vec4(ivory_ambient(input0(i).xyz, input1(i).xyz, input1(i).xyz), 1.0); })",
                           {points(), normals()}, [&](gl::Program& program) { source.bind(program, 0); });
  }
  // The same arithmetic, added up in another order and optimised by the compiler otherwise: roundings of floats, of
  // the largest term where terms cancel (E of a basis may be negative). 1e-3 is asked for.
  static void expect_sum(const std::vector<WeightedSource>& sources) {
    std::vector<V3f> expected(count, V3f(0, 0, 0));
    std::vector<float> largest(count, 0.0F);
    for (const WeightedSource& s : sources) {
      const std::vector<V4f> single = light_of(s.source);
      for (std::size_t i = 0; i < count; ++i) {
        const V3f term = s.weight * xyz(single[i]);
        expected[i] += term;
        largest[i] = std::max({largest[i], std::abs(term.x), std::abs(term.y), std::abs(term.z)});
      }
    }
    const std::vector<V4f> sum = light_of(sum_of(sources));
    int lit = 0;
    for (std::size_t i = 0; i < count; ++i) {
      for (unsigned c = 0; c < 3; ++c) EXPECT_NEAR(xyz(sum[i])[c], expected[i][c], 1e-5F * largest[i]) << i;
      lit += int(largest[i] > 0);
    }
    EXPECT_GT(lit, count / 2);
  }
};

TEST_F(RuntimeAmbientSum, AllKindsAddUp) {
  const Assets a;
  // Eleven texture units: with the renderer's five, all that OpenGL 3.3 promises.
  expect_sum({{ambient(a.vectors)},
              {ambient(a.fiv, a.difmap), Rgb(10, 20, 30)},
              {ambient(a.lobes, false), Rgb(0.5F, 0.25F, 2)},
              {ambient(a.cube), Rgb(100, 100, 100)},
              {constant_ambient(Rgb(7, 8, 9)), Rgb(3, 2, 1)}});
}

TEST_F(RuntimeAmbientSum, SourcesOfOneKindKeepApart) {
  const Assets a;
  LookupParams tricubic;
  tricubic.interpolation = Interpolation::tricubic;
  tricubic.guard = Guard::off;
  // Grids of other bases, and one grid read in two ways: what is compiled into one is not into the other.
  expect_sum({{ambient(a.vectors)}, {ambient(a.sh9), Rgb(0.5F, 1, 1)}, {ambient(a.vectors, tricubic)}});
  expect_sum({{ambient(a.difmap)}, {ambient(a.other_difmap)}, {ambient(a.difmap), Rgb(2, 2, 2)}});
  // Uniform blocks too.
  FivLightParams product;
  product.overlap = FivOverlap::product;
  expect_sum({{ambient(a.fiv, a.difmap)}, {ambient(a.other_fiv, a.other_difmap, product)}});
  expect_sum({{constant_ambient(Rgb(1, 2, 3))}, {constant_ambient(Rgb(4, 5, 6)), Rgb(1, 0, 2)}});
}

TEST_F(RuntimeAmbientSum, SumsOfSumsAddUp) {
  const Assets a;
  const std::vector<WeightedSource> outdoors{{ambient(a.difmap)}, {constant_ambient(Rgb(5, 5, 5)), Rgb(2, 2, 2)}};
  expect_sum({{ambient(a.sh9)}, {sum_of(outdoors), Rgb(3, 2, 1)}, {sum_of(outdoors)}});
}

// In the renderer, with glossy lobes, which give radiance instead of E; one program for all weights.
TEST_F(RuntimeAmbientSum, RadianceAddsToIrradiance) {
  const Assets a;
  const RenderTarget target(8, 8);
  const GpuMesh mesh = square(2);
  SurfaceMaterial material;  // glossy
  material.base_color = Rgb(0.5F, 0.4F, 0.3F);
  material.roughness = 0.5F;
  Renderer renderer;
  FrameParams frame;
  frame.camera = from_above();
  const auto drawn = [&](const AmbientSource& source) {
    const DrawItem item{&mesh, &material, translation({0, 0, 0}), &source};
    frame.items = {&item, 1};
    renderer.draw(frame);
    return target.pixel(5, 2);
  };
  GpuLobes lobes = upload(make_lobe_table({9, 9}));
  place(lobes, std::vector<RuntimeSphereLight>{{{V3f(0.3F, 2, 0), 0.4F}, Rgb(50, 30, 20)}}, {});
  const V4f glossy = drawn(ambient(lobes, true));
  const V4f even = drawn(ambient(a.difmap));
  ASSERT_GT(glossy.x, 0);
  ASSERT_GT(even.x, 0);
  for (const Rgb& weight : {Rgb(1, 1, 1), Rgb(0.1F, 3, 0)}) {
    const V4f both =
        drawn(sum_of(std::vector<WeightedSource>{{ambient(a.difmap), weight}, {ambient(lobes, true), Rgb(2, 2, 2)}}));
    for (unsigned c = 0; c < 3; ++c)
      EXPECT_NEAR(both[c], weight[c] * even[c] + 2 * glossy[c], 1e-5F * (even[c] + 2 * glossy[c]));
  }
  const auto text = [&](const Rgb& weight) {
    return sum_of(std::vector<WeightedSource>{{ambient(a.difmap), weight}, {ambient(lobes, true)}}).shader;
  };
  EXPECT_EQ(text(Rgb(1, 1, 1)), text(Rgb(2, 3, 4)));
}

TEST(ShaderSlots, NamesAreKeptApartAndSharedFilesAreNot) {
  const std::string text = with_includes(
      "#include \"base/pi.glsl\"\n#ivory_slot 3\n#include \"base/pi.glsl\"\nuniform IvoryThing ivory_x[IVORY_N];  // "
      "ivory_y\nfloat mine = ivory_pi * 2ivory;\n#ivory_slot 1\nivory_z\n#ivory_end_slot\n#ivory_end_slot\nivory_x\n");
  EXPECT_NE(text.find("uniform Ivorys3_Thing ivory_s3_x[IVORY_s3_N];  // ivory_y\nfloat mine = ivory_pi * 2ivory;"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("\nivory_s3_s1_z\n"), std::string::npos) << text;
  EXPECT_NE(text.find("\nivory_x\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("const float ivory_pi"), text.rfind("const float ivory_pi"));
  EXPECT_NE(error_of([] { with_includes("#ivory_slot 0\nivory_x\n"); }).find("end_slot"), std::string::npos);
}

}  // namespace
}  // namespace ivory
