// Content of scenes: which kinds of parts an edit changes.
#include "tracer/core/content.h"

#include <functional>
#include <set>

#include <gtest/gtest.h>

namespace ivory {
namespace {

// A leaf whose texture lets light through, a lamp, a wall, a sun and a camera.
Scene make_scene() {
  Scene scene;
  scene.images.push_back({"leaf", 1, 1, {10, 20, 30, 40}});
  scene.images.push_back({"unseen", 1, 1, {1, 2, 3, 4}});
  scene.textures.push_back({0, Wrap::repeat, Wrap::repeat, false});
  scene.textures.push_back({1, Wrap::repeat, Wrap::repeat, false});
  Material leaf;
  leaf.name = "leaf";
  leaf.base_color_texture.texture = 0;
  leaf.alpha_mode = AlphaMode::mask;
  Material wall;
  wall.name = "wall";
  Material lamp;
  lamp.name = "lamp";
  lamp.emission = Rgb(1, 1, 1);
  Material unused;
  unused.name = "unused";
  unused.base_color_texture.texture = 1;
  scene.materials = {leaf, wall, lamp, unused};
  for (int i = 0; i < 3; ++i) {
    Mesh mesh;
    mesh.name = "mesh";
    mesh.positions = {V3f(0, 0, float(i)), V3f(1, 0, 0), V3f(0, 1, 0)};
    mesh.uvs = {{V2f(0, 0), V2f(1, 0), V2f(0, 1)}};
    mesh.triangles = {{0, 1, 2}};
    mesh.material = i;
    scene.meshes.push_back(mesh);
    scene.nodes.push_back({"node", no_index, "", ""});
    scene.instances.push_back({i, M44f(), i});
  }
  scene.nodes.push_back({"sun", no_index, "", ""});
  scene.lights.emplace_back(DirectionalLight{V3f(0, -1, 0), Rgb(1, 1, 1)});
  scene.light_nodes = {3};
  scene.cameras.push_back({"eye", M44f()});
  return scene;
}

// Of which kinds is a part of one scene not what it is in the other?
std::set<ContentKind> changed_kinds(const Scene& a, const Scene& b) {
  std::set<ContentKind> kinds;
  for (const ContentKind kind :
       {ContentKind::shape, ContentKind::look, ContentKind::light, ContentKind::camera, ContentKind::name}) {
    const auto of_kind = [&](const Scene& scene) {
      std::vector<ContentPart> parts = content_parts(scene);
      std::erase_if(parts, [&](const ContentPart& part) { return part.kind != kind; });
      return hash_of(parts);
    };
    if (of_kind(a) != of_kind(b)) kinds.insert(kind);
  }
  return kinds;
}

TEST(Content, AnEditChangesWhatItTouches) {
  using Kinds = std::set<ContentKind>;
  struct Edit {
    const char* what;
    std::function<void(Scene&)> apply;
    Kinds changes;
  };
  const Kinds nothing;
  const std::vector<Edit> edits{
      {"nothing", [](Scene&) {}, nothing},
      {"a file elsewhere", [](Scene& s) { s.name = "other.glb", s.content_hash = "0"; }, nothing},
      {"names of what is seen", [](Scene& s) { s.materials[0].name = s.meshes[0].name = s.images[0].name = "x"; },
       nothing},
      {"a material that nothing has", [](Scene& s) { s.materials[3].base_color = Rgb(0, 0, 0); }, nothing},
      {"an image that nothing shows", [](Scene& s) { s.images[1].rgba[0] = 9; }, nothing},
      {"a mesh that nothing places", [](Scene& s) { s.meshes.push_back(s.meshes[0]); }, nothing},
      {"handles moved up",
       [](Scene& s) {
         s.materials.insert(s.materials.begin(), Material{});
         for (Mesh& mesh : s.meshes) ++mesh.material;
       },
       nothing},
      {"a wall painted", [](Scene& s) { s.materials[1].base_color = Rgb(0.5F, 1, 1); }, {ContentKind::look}},
      {"two materials exchanged",
       [](Scene& s) { std::swap(s.materials[1].roughness = 0.3F, s.materials[0].roughness); },
       {ContentKind::look}},
      {"a leaf's texture", [](Scene& s) { s.images[0].rgba[3] = 41; }, {ContentKind::shape, ContentKind::look}},
      {"a leaf's coordinates", [](Scene& s) { s.meshes[0].uvs[0][1].x = 2; }, {ContentKind::shape, ContentKind::look}},
      {"a wall's coordinates", [](Scene& s) { s.meshes[1].uvs[0][1].x = 2; }, {ContentKind::look}},
      {"a corner moved", [](Scene& s) { s.meshes[1].positions[0].x = 0.1F; }, {ContentKind::shape}},
      {"an object moved", [](Scene& s) { s.instances[1].to_world[3][0] = 1; }, {ContentKind::shape}},
      {"an object more",
       [](Scene& s) { s.instances.push_back(s.instances[1]); },
       {ContentKind::shape, ContentKind::look}},
      {"a lamp moved", [](Scene& s) { s.instances[2].to_world[3][0] = 1; }, {ContentKind::shape, ContentKind::light}},
      {"a lamp brighter", [](Scene& s) { s.materials[2].emission = Rgb(2, 2, 2); }, {ContentKind::light}},
      {"the sun turned",
       [](Scene& s) {
         s.lights[0] = DirectionalLight{V3f(1, 0, 0), Rgb(1, 1, 1)};
       },
       {ContentKind::light}},
      {"a camera turned", [](Scene& s) { s.cameras[0].yfov_rad = 1; }, {ContentKind::camera}},
      {"a node renamed", [](Scene& s) { s.nodes[1].name = "chair"; }, {ContentKind::name}},
      {"a group of lights", [](Scene& s) { s.nodes[3].light_group = "sun"; }, {ContentKind::name}},
      {"the scene far away", [](Scene& s) { s.anchor_m = V3d(1e6, 0, 0); }, {ContentKind::shape}},
  };
  const Scene scene = make_scene();
  for (const Edit& edit : edits) {
    SCOPED_TRACE(edit.what);
    Scene edited = scene;
    edit.apply(edited);
    EXPECT_EQ(changed_kinds(scene, edited), edit.changes);
  }
}

TEST(Content, PartsHaveNamesOfTheirOwn) {
  std::set<std::pair<ContentKind, std::string>> names;
  for (const ContentPart& part : content_parts(make_scene()))
    EXPECT_TRUE(names.emplace(part.kind, part.name).second) << part.name;
  EXPECT_TRUE(names.contains({ContentKind::look, "material 'leaf'"}));
  EXPECT_TRUE(names.contains({ContentKind::shape, "mesh 'mesh' (3)"}));
  EXPECT_TRUE(names.contains({ContentKind::light, "light 'sun'"}));
}

}  // namespace
}  // namespace ivory
