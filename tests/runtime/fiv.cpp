// FIV tables in GLSL against C++: looking up moments, and what single occluders hide.
#include "runtime/assets/fiv.h"

#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "grid/base/half.h"
#include "tests/runtime/fiv_synthetic.h"
#include "tests/support/runtime_twin.h"

namespace ivory {
namespace {

class RuntimeFiv : public GlTest {
 protected:
  static const SyntheticSky& sky() {
    static const SyntheticSky the = synthetic_sky(1);
    return the;
  }
  static const std::vector<FivTable>& tables() {
    static const std::vector<FivTable> the = synthetic_tables(sky());
    return the;
  }
};

// Places about every table (w: its index): anywhere, on the polar axis, on the azimuths' seam and beside it, on the
// spheres, within the first, far beyond the last, at the centre.
std::vector<V4f> places(const std::vector<FivTable>& tables) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> exponent(-2, 3);
  std::vector<V4f> out;
  for (std::size_t t = 0; t < tables.size(); ++t) {
    out.emplace_back(0, 0, 0, float(t));
    for (const float r : {1e-3F, 0.5F, 1.0F, 2.0F, 30.0F}) {
      for (const float s : {-1.0F, 1.0F}) {
        out.emplace_back(0, s * r, 0, float(t));
        out.emplace_back(s * 1e-7F * r, -s * r, s * 1e-7F * r, float(t));
        out.emplace_back(s * 0.0F, 0.3F * r, -r, float(t));
        out.emplace_back(s * 1e-6F * r, -0.3F * r, -r, float(t));
        out.emplace_back(s * 1e-3F * r, -0.3F * r, -r, float(t));
      }
    }
    for (const float r : tables[t].radii) {
      for (const float off : {0.999F, 0.999999F, 1.0F, 1.000001F, 1.001F})
        out.push_back(to_v4(random_direction(random) * r * off, float(t)));
    }
  }
  while (out.size() < 10000)
    out.push_back(
        to_v4(random_direction(random) * std::pow(10.0F, exponent(random)), float(out.size() % tables.size())));
  return out;
}

const std::string read_table =
    "#include \"ambient/fiv.glsl\"\n"
    "IvoryFivTable table(int i) { return ivory_fiv_tables[int(input0(i).w)]; }\n"
    "IvoryFivMoments moments(int i) { return ivory_lookup(ivory_fiv_atlas, ivory_fiv_spheres, table(i), "
    "input0(i).xyz, true); }\n";

BindProgram bind_to(const GpuFivTables& gpu) {
  return [&gpu](gl::Program& program) { EXPECT_EQ(bind(gpu, GpuSh9{}, program, 1), 4); };
}

// The number of a sample that a slab's channel holds.
std::size_t number_at(std::size_t slab, std::size_t channel) {
  if (slab < 3) return channel < 3 ? 3 * slab + channel : 9 + slab;
  return 4 * slab + channel;
}

double norm(const FivMoments& m) {
  double sum = 0;
  for (const float x : m) sum += double(x) * double(x);
  return std::sqrt(sum);
}

// Largest difference between the moments by GPU and by C++, over the length of all 36.
double largest_difference(const std::vector<FivTable>& expected_tables, const GpuFivTables& gpu,
                          const std::vector<V4f>& at) {
  std::vector<std::vector<V4f>> slabs;
  for (int s = 0; s < 9; ++s)
    slabs.push_back(evaluate_on_gpu(
        read_table + fmt::format("vec4 evaluate(int i) {{ return moments(i).slab[{}]; }}", s), {at}, bind_to(gpu)));
  double largest = 0;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const FivMoments expected = lookup(expected_tables[std::size_t(at[i].w)], xyz(at[i]));
    FivMoments difference{};
    for (std::size_t s = 0; s < 9; ++s) {
      for (std::size_t c = 0; c < 4; ++c) {
        const std::size_t number = number_at(s, c);
        difference[number] = slabs[s][i][unsigned(c)] - expected[number];
      }
    }
    const double error = norm(difference) / norm(expected);
    EXPECT_LT(error, 1e-3) << "table " << at[i].w << " q " << xyz(at[i]);
    largest = std::max(largest, error);
    if (largest >= 1e-3) break;
  }
  return largest;
}

TEST_F(RuntimeFiv, LooksUpWhatItsTwinDoes) {
  const GpuFivTables gpu = upload(tables());
  // Angles are good to 6e-7 rad, 6e-6 of the widest table's cells, over which noise changes by a factor.
  EXPECT_LT(largest_difference(tables(), gpu, places(tables())), 1e-3);
}

TEST_F(RuntimeFiv, HalvesKeepElevenBits) {
  const GpuFivTables gpu = upload(tables(), {.half_floats = true});
  const GpuFivTables full = upload(tables());
  EXPECT_EQ(2 * gpu.atlas.bytes(), full.atlas.bytes());
  // The tables as halves hold them, each over its sphere's falloff and a power of two.
  std::vector<FivTable> rounded = tables();
  for (FivTable& table : rounded) {
    const std::size_t sphere = table.values.size() / std::size_t(table.size.z);
    float largest = 0;
    for (std::size_t i = 0; i < table.values.size(); ++i)
      largest = std::max(largest, std::abs(table.values[i] / fiv_falloff(table.radii[i / sphere])));
    const float scale = half_scale(largest);
    for (std::size_t i = 0; i < table.values.size(); ++i) {
      const float level = fiv_falloff(table.radii[i / sphere]) * scale;
      const float value = rounded_to_half(table.values[i] / level) * level;
      ASSERT_NEAR(value, table.values[i], std::abs(table.values[i]) / 2048 + 3e-8F * level);
      table.values[i] = value;
    }
  }
  EXPECT_LT(largest_difference(rounded, gpu, places(tables())), 1e-3);
}

// Receivers of random normals at random heights, so that occluders are above, below and astride their planes.
TEST_F(RuntimeFiv, HidesWhatItsTwinDoes) {
  const GpuFivTables gpu = upload(tables());
  const std::vector<V4f> at = places(tables());
  std::mt19937 random(5);
  std::vector<V4f> normals;
  for (const V4f& q : at) {
    V3f n = random_direction(random);
    // Half of them within reach of the plane whatever the distance.
    if (random() % 2 == 0 && xyz(q).length() > 1) n = n.cross(xyz(q)).normalized();
    normals.push_back(to_v4(n, -xyz(q).dot(n)));
  }
  for (const Straddling straddling : {Straddling::bound, Straddling::scale}) {
    const std::vector<V4f> e = evaluate_on_gpu(
        read_table + fmt::format("vec4 evaluate(int i) {{ return vec4(ivory_hidden_irradiance(table(i), moments(i), "
                                 "input1(i).xyz, input1(i).w, {}), 1.0); }}",
                                 straddling == Straddling::scale ? 1 : 0),
        {at, normals}, bind_to(gpu));
    int astride = 0;
    for (std::size_t i = 0; i < at.size(); ++i) {
      const FivTable& table = tables()[std::size_t(at[i].w)];
      const FivMoments m = lookup(table, xyz(at[i]));
      const Rgb expected = hidden_irradiance(table, m, xyz(normals[i]), normals[i].w, straddling);
      // n.F is small where its terms cancel: relative to the moments' length.
      for (unsigned c = 0; c < 3; ++c)
        ASSERT_NEAR(e[i][c], expected[c], 1e-3 * double(expected[c]) + 2e-5 * norm(m)) << i;
      if (std::abs(normals[i].w) < 1) ++astride;
    }
    EXPECT_GT(astride, 3000);
  }
}

TEST_F(RuntimeFiv, LeavesToItsOwnSurfaceWhatItsTwinDoes) {
  const GpuFivTables gpu = upload(tables());
  const std::vector<V4f> at = places(tables());
  std::mt19937 random(6);
  std::vector<V4f> normals;
  for (std::size_t i = 0; i < at.size(); ++i) normals.push_back(to_v4(random_direction(random)));
  const std::vector<V4f> e =
      evaluate_on_gpu(read_table +
                          "vec4 evaluate(int i) { return vec4(ivory_self_shadowed_irradiance(table(i), moments(i), "
                          "input1(i).xyz), 1.0); }",
                      {at, normals}, bind_to(gpu));
  for (std::size_t i = 0; i < at.size(); ++i) {
    const FivTable& table = tables()[std::size_t(at[i].w)];
    const Rgb expected = self_shadowed_irradiance(table, lookup(table, xyz(at[i])), xyz(normals[i]));
    for (unsigned c = 0; c < 3; ++c)
      ASSERT_NEAR(e[i][c], expected[c], 1e-3 * double(expected[c]) + 2e-5 * norm(table.total)) << i;
  }
}

TEST_F(RuntimeFiv, TablesBeyondTheLimitsAreRefused) {
  const int before = live_gl_objects();
  const auto expect_refused = [&](std::span<const FivTable> some, const char* words) {
    try {
      upload(some);
      ADD_FAILURE() << words;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
    EXPECT_EQ(live_gl_objects(), before);
  };
  expect_refused({}, "a set takes 1 to 64");
  expect_refused(std::vector<FivTable>(65, tables()[1]), "there are 65");
  FivTable wide = tables()[1];
  wide.size = {1 << 18, 2, 2};
  wide.values.resize(fiv_sample_count(wide) * 9);
  expect_refused({&wide, 1}, "GL_MAX_3D_TEXTURE_SIZE");
  FivTable close = tables()[3];
  close.radii[1] = close.radii[0] * 1.0001F;
  expect_refused({&close, 1}, "has spheres closer");
  GpuFivTables gpu = upload(tables());
  EXPECT_EQ(live_gl_objects(), before + 4);
  EXPECT_THROW(set_occluders(gpu, std::vector<GpuFivOccluder>(257)), Error);
}

}  // namespace
}  // namespace ivory
