/* A white ball in the middle of a room, lit by nothing but the room's baked grid: ivory from C.
 *
 * usage: ivory_c_example GRID.vdb [FRAMES]      with FRAMES it ends after so many and prints the last one's middle pixel */
#include <stdio.h>
#include <stdlib.h>

#include <GLFW/glfw3.h>
#include <epoxy/gl.h>

#include "runtime/c/ivory.h"

static GLuint add_shader(GLuint program, GLenum stage, int count, const char* const* text) {
  const GLuint shader = glCreateShader(stage);
  glShaderSource(shader, count, text, NULL);
  glCompileShader(shader);
  glAttachShader(program, shader);
  return program;
}

int main(int argc, char** argv) {
  static const char* vertex = "#version 330 core\nout vec2 at;\nvoid main() {"
      "at = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0); gl_Position = vec4(at, 0.0, 1.0); }";
  /* A ball seen from far along -z: the normal from the place in the picture, and white leaves E / pi. */
  static const char* ball = "in vec2 at;\nout vec4 color;\nuniform vec4 place;\nvoid main() {"
      "float z2 = 1.0 - dot(at, at); if (z2 <= 0.0) discard; vec3 n = vec3(at, sqrt(z2));"
      "color = vec4(ivory_ambient(place.xyz + place.w * n, n, n) / 3.14159265, 1.0); }";
  GLFWwindow* window = NULL;
  if (argc < 2 || !glfwInit()) return fputs("usage: ivory_c_example GRID.vdb [FRAMES]\n", stderr), 2;
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  window = glfwCreateWindow(480, 480, "A ball in a room", NULL, NULL);
  if (window == NULL) return fputs("no OpenGL 3.3 window\n", stderr), 1;
  glfwMakeContextCurrent(window);

  ivory_light* grid = ivory_load_grid(argv[1]);
  float least[3], greatest[3];
  if (grid == NULL || ivory_bounds(grid, least, greatest) != 0) return fprintf(stderr, "%s\n", ivory_error()), 1;
  const char* fragment[] = {"#version 330 core\n", ivory_shader(grid), ball};
  const GLuint program = add_shader(add_shader(glCreateProgram(), GL_VERTEX_SHADER, 1, &vertex), GL_FRAGMENT_SHADER, 3, fragment);
  glLinkProgram(program);
  GLuint nothing;
  glGenVertexArrays(1, &nothing);
  glBindVertexArray(nothing);
  glEnable(GL_FRAMEBUFFER_SRGB);
  for (long i = 1, frames = argc > 2 ? strtol(argv[2], NULL, 10) : 0; !glfwWindowShouldClose(window); ++i) {
    glClear(GL_COLOR_BUFFER_BIT);
    if (ivory_bind(grid, program, 0) < 0) return fprintf(stderr, "%s\n", ivory_error()), 1;
    glUniform4f(glGetUniformLocation(program, "place"), (least[0] + greatest[0]) / 2, (least[1] + greatest[1]) / 2,
                (least[2] + greatest[2]) / 2, (greatest[0] - least[0]) / 8);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    if (i == frames) {
      float rgb[3];
      glReadPixels(240, 240, 1, 1, GL_RGB, GL_FLOAT, rgb);
      printf("%.3f %.3f %.3f\n", rgb[0], rgb[1], rgb[2]);
      break;
    }
    glfwSwapBuffers(window);
    glfwPollEvents();
  }
  ivory_free(grid);
  glfwTerminate();
  return 0;
}
