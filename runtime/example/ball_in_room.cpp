// A white ball that circles in a room and is lit by nothing but the room's baked grid.
//
// usage: ivory_example GRID.vdb [FRAMES]      with FRAMES it ends after so many and prints the last one's middle pixel
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <numbers>
#include <vector>

#include <GLFW/glfw3.h>
#include <epoxy/gl.h>

#include "runtime/assets/irradiance_grid.h"
#include "runtime/renderer/renderer.h"

namespace {

ivory::GpuMesh make_ball(float radius_m) {
  constexpr std::uint32_t rows = 32;
  constexpr std::uint32_t columns = 64;
  std::vector<ivory::V3f> positions;
  std::vector<ivory::V3f> normals;
  std::vector<Imath::Vec3<std::uint32_t>> triangles;
  for (std::uint32_t row = 0; row <= rows; ++row) {
    for (std::uint32_t column = 0; column <= columns; ++column) {
      const float theta = std::numbers::pi_v<float> * float(row) / rows;
      const float phi = 2 * std::numbers::pi_v<float> * float(column) / columns;
      normals.emplace_back(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
      positions.push_back(normals.back() * radius_m);
      if (row == rows || column == columns) continue;
      const std::uint32_t a = row * (columns + 1) + column;
      const std::uint32_t b = a + columns + 1;
      triangles.emplace_back(a, a + 1, b);
      triangles.emplace_back(a + 1, b + 1, b);
    }
  }
  ivory::MeshData data;
  data.positions = positions;
  data.normals = normals;
  data.triangles = triangles;
  return ivory::upload(data);
}

void run(GLFWwindow* window, const char* path, long frames) {
  const ivory::GpuGrid grid = ivory::load_grid(path);
  const ivory::AmbientSource light = ivory::ambient(grid);
  const ivory::V3f low = grid.frame.to_world({0, 0, 0});
  const ivory::V3f high = grid.frame.to_world(ivory::V3f(grid.frame.size - ivory::V3i(1, 1, 1)));
  const ivory::V3f middle = (low + high) / 2;
  const float reach_m = (high - low).length() / 8;

  const ivory::GpuMesh ball = make_ball(reach_m / 2);
  ivory::SurfaceMaterial white;
  white.dielectric_f0 = ivory::Rgb(0, 0, 0);
  white.dielectric_f90 = 0;
  ivory::DrawItem item{&ball, &white, {}, &light};
  ivory::Renderer renderer;
  ivory::FrameParams frame;
  frame.items = {&item, 1};
  ivory::M44f eye;
  eye.setTranslation(middle + ivory::V3f(0, 0, 4 * reach_m));
  glEnable(GL_FRAMEBUFFER_SRGB);
  for (long i = 0; frames == 0 ? glfwWindowShouldClose(window) == 0 : i < frames; ++i) {
    int width = 1;
    int height = 1;
    glfwGetFramebufferSize(window, &width, &height);
    glViewport(0, 0, width, height);
    const float turn = 0.01F * float(i);
    item.to_world.setTranslation(middle + ivory::V3f(std::sin(turn), 0, std::cos(turn)) * (reach_m / 4));
    frame.camera = ivory::make_perspective(eye, 0.7F, float(width) / float(height), 0.1F * reach_m, 10 * reach_m);
    renderer.draw(frame);
    if (i + 1 == frames) {
      float rgb[3];
      glReadPixels(width / 2, height / 2, 1, 1, GL_RGB, GL_FLOAT, rgb);
      std::printf("%.3f %.3f %.3f\n", double(rgb[0]), double(rgb[1]), double(rgb[2]));
    }
    glfwSwapBuffers(window);
    glfwPollEvents();
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || glfwInit() == 0) return std::fputs("usage: ivory_example GRID.vdb [FRAMES]\n", stderr), 2;
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  GLFWwindow* window = glfwCreateWindow(640, 480, "A ball in a room", nullptr, nullptr);
  if (window == nullptr) return std::fputs("no OpenGL 3.3 window\n", stderr), 1;
  glfwMakeContextCurrent(window);
  try {
    run(window, argv[1], argc > 2 ? std::strtol(argv[2], nullptr, 10) : 0);
  } catch (const std::exception& error) {
    return std::fprintf(stderr, "%s\n", error.what()), 1;
  }
  glfwTerminate();
}
