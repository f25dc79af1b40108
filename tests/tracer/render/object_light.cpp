// Objects lit by a cube map against path tracing, where both must give the same.
#include "tracer/render/object_light.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tools/stability/scene_builder.h"
#include "tracer/bake/cubemap/capture.h"
#include "tracer/render/path_tracer.h"

namespace ivory {
namespace {

// A black room of 2 m that glows with `emission`, and an octahedron of `material` in its middle: convex, so that it
// does not shadow itself, and the walls reflect nothing back, so that it does not change its own light.
struct Room {
  Scene scene;
  std::vector<bool> is_object{false, true};

  Room(const Rgb& emission, const Material& material) {
    add_mesh(scene, make_room(V3f(-1, -1, -1), V3f(1, 1, 1), add_lambert(scene, Rgb(0, 0, 0), emission)));
    scene.materials.push_back(material);
    Mesh mesh;
    mesh.positions = {{0.3F, 0, 0}, {-0.3F, 0, 0}, {0, 0.3F, 0}, {0, -0.3F, 0}, {0, 0, 0.3F}, {0, 0, -0.3F}};
    mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    mesh.material = 1;
    add_mesh(scene, mesh);
  }
};

Material lambert() {
  Material material;
  material.base_color = Rgb(0.5F, 0.25F, 1);
  material.metallic = 0;
  material.specular = 0;
  return material;
}

// Straight at the object, which fills the picture.
View view_of_object() {
  Camera camera;
  camera.to_world[3][0] = 0.05F;
  camera.to_world[3][1] = 0.05F;
  camera.to_world[3][2] = 0.9F;
  camera.yfov_rad = 0.2F;
  return make_view("test", camera, 8, 8);
}

struct Means {
  Rgb cube;
  Rgb path;
};

Rgb mean(const Film& film) {
  Rgb sum(0, 0, 0);
  for (const Rgb& pixel : film.pixels) sum += pixel;
  return sum / float(film.pixels.size());
}

Means render_both(const Room& room, int samples) {
  const LitScene lit = make_lit_scene(room.scene);
  Scene empty = room.scene;
  empty.instances.erase(empty.instances.begin() + 1);
  CaptureParams capture;
  capture.size = 16;
  capture.samples = 4;
  const LocalizedCube cube = localize(capture_cube(make_lit_scene(std::move(empty)), V3f(0, 0, 0), capture).cube, 4);
  RenderParams params;
  params.samples = samples;
  ObjectLightParams objects;
  objects.is_object = room.is_object;
  CubeLight light;
  light.cube = &cube;
  const View view = view_of_object();
  return {mean(render_with_cube(lit, light, view, params, objects)),
          mean(render_path(lit, view, params, PathParams()))};
}

TEST(ObjectLight, GlowingRoomCountsOnce) {
  const Means m = render_both(Room(Rgb(1, 2, 3), lambert()), 256);
  // L = albedo L_e on every facet. The map's is exact, 16,384 paths spread by less than 1.
  EXPECT_NEAR(m.cube.x, 0.5F, 1e-4F);
  EXPECT_NEAR(m.cube.y, 0.5F, 1e-4F);
  EXPECT_NEAR(m.cube.z, 3, 1e-3F);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(m.path[c] / m.cube[c], 1, 0.03);
}

TEST(ObjectLight, PunctualLightsAreSampledWithShadows) {
  for (const bool shadowed : {false, true}) {
    Room room(Rgb(0.5F, 0.5F, 0.5F), lambert());
    room.scene.lights.push_back(PointLight{V3f(0.3F, 0.2F, 0.9F), Rgb(2, 2, 2)});
    if (shadowed) {
      add_mesh(room.scene, make_quad({0.15F, 0.1F, 0.8F}, {0.3F, 0, 0}, {0, 0.3F, 0}, 0));
      room.is_object.push_back(false);
    }
    Room dark(Rgb(0.5F, 0.5F, 0.5F), lambert());
    const Means lit = render_both(room, 256);
    // The screen hides some of the wall too, from the map as well.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(lit.path[c] / lit.cube[c], 1, 0.04) << shadowed;
    const float point = lit.cube.x - render_both(dark, 4).cube.x;
    EXPECT_EQ(point > 0.05F, !shadowed);
  }
}

TEST(ObjectLight, GlossAndMetalReflectTheScene) {
  Material glossy;
  glossy.base_color = Rgb(0.5F, 0.4F, 0.3F);
  glossy.metallic = 0;
  glossy.roughness = 0.3F;
  Material metal = glossy;
  metal.metallic = 1;
  for (const Material& material : {glossy, metal}) {
    const Means m = render_both(Room(Rgb(1, 1, 1), material), 1024);
    // What GGX loses to the underside of the surface, both lose.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(m.path[c] / m.cube[c], 1, 0.02);
  }
}

// What is no object is rendered as without a map, to the last bit.
TEST(ObjectLight, BackgroundIsPathTraced) {
  Room room(Rgb(1, 1, 1), lambert());
  room.is_object = {false, false};
  const LitScene lit = make_lit_scene(room.scene);
  LocalizedCube unread;
  CubeLight light;
  light.cube = &unread;
  RenderParams params;
  params.samples = 4;
  ObjectLightParams objects;
  objects.is_object = room.is_object;
  const Film film = render_with_cube(lit, light, view_of_object(), params, objects);
  EXPECT_EQ(film.pixels, render_path(lit, view_of_object(), params, PathParams()).pixels);
}

}  // namespace
}  // namespace ivory
