// GLSL functions run on arrays of inputs, to be compared with their C++ twins.
#pragma once

#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/gl/gl.h"
#include "runtime/gl/headless_context.h"

namespace ivory {

// A test with a current headless context, one for the whole suite.
class GlTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { context() = std::make_unique<HeadlessContext>(); }
  static void TearDownTestSuite() { context().reset(); }

 private:
  static std::unique_ptr<HeadlessContext>& context() {
    static std::unique_ptr<HeadlessContext> current;
    return current;
  }
};

// Runs `source`, GLSL that defines
//   vec4 evaluate(int i)
// and may #include "x.glsl" and read inputs[k][i] as inputK(i), for every i in a fragment shader, and returns the
// results as floats. Up to four inputs of equal length. `bind` sets uniforms and binds textures to units 0 to 11.
using BindProgram = std::function<void(gl::Program&)>;
std::vector<V4f> evaluate_on_gpu(const std::string& source, const std::vector<std::vector<V4f>>& inputs,
                                 const BindProgram& bind = {});

// How many textures, buffers, programs and so on with names below 4096 exist in the current context.
int live_gl_objects();

// What the Error says that `action` throws; empty for none.
std::string error_of(const std::function<void()>& action);

// `load` refuses damaged copies of `good`, a file, in one line that names them, and leaves no GL object behind.
void expect_damage_refused(const std::string& good, const std::function<void(const std::string& path)>& load);

// Deterministic inputs for tests.
inline V3f random_direction(std::mt19937& random) {
  std::normal_distribution<float> normal;
  V3f w;
  do {
    w = V3f{normal(random), normal(random), normal(random)};
  } while (w.length2() < 1e-12F);
  return w.normalized();
}
inline V4f to_v4(const V3f& v, float w = 0) { return {v.x, v.y, v.z, w}; }
inline V3f xyz(const V4f& v) { return {v.x, v.y, v.z}; }

}  // namespace ivory
