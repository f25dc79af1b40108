// Leaks: light that a grid carries through walls that stop it.
#include <algorithm>
#include <cmath>

#include "tools/stability/scenes.h"
#include "tools/stability/stability.h"

namespace ivory {
namespace {

constexpr int cells = 14;  // along a side of the chambers: the wall of 0.1 m is thinner than a voxel
constexpr int lattice = 12;
// 16 bytes hold four planes, which do not cut every corner: 6e-4 at worst. Rays see the very walls.
constexpr double planes_leak = 1e-3;

M44f rotation(float degrees) {
  M44f turn;
  turn.setAxisAngle(V3f(0.3F, 1, 0.5F).normalized(), degrees * pi / 180);
  return turn;
}

GridBakeParams bake_params(const StabilityParams& params, Guard guard) {
  GridBakeParams bake;
  bake.voxel_size_m = 2.0F / cells;
  bake.photons = params.quick ? 60'000 : 200'000;
  bake.guard = guard;
  return bake;
}

// What the dark side of the wall reads, as a share of the lit side's E, with each guard; and what the lit side
// reads less than it should. `of` ends the names of the series.
void add_leaks(Scene&& scene, const Chambers& chambers, const StabilityParams& params, double x, const std::string& of,
               std::vector<StabilityPoint>& points) {
  const LitScene world = make_lit_scene(std::move(scene));
  const auto lit = lit_wall_points(chambers, lattice);
  const auto dark = dark_wall_points(chambers, lattice);
  const IrradianceGrid guarded = bake_all_light(world, bake_params(params, Guard::rays));
  const IrradianceGrid open = bake_all_light(world, bake_params(params, Guard::off));
  points.push_back({"no guard" + of, x, mean_share(world, open, Guard::off, dark), {}});
  points.push_back({"planes" + of, x, mean_share(world, guarded, Guard::planes, dark), planes_leak});
  points.push_back({"rays" + of, x, mean_share(world, guarded, Guard::rays, dark), 1e-4});
  // The mean of 144 points that read some hundred vertices of 3 % noise each, in uniform light.
  points.push_back({"rays, lit side" + of, x, std::abs(mean_share(world, guarded, Guard::rays, lit) - 1), 0.02});
}

std::vector<StabilityPoint> wall_thickness(const StabilityParams& params) {
  std::vector<StabilityPoint> points;
  for (const float thickness : {1e-4F, 1e-3F, 1e-2F, 0.05F, 0.15F, 0.3F}) {
    Chambers chambers;
    chambers.thickness_m = thickness;
    chambers.to_world = rotation(30);
    add_leaks(make_chambers(chambers), chambers, params, double(thickness), "", points);
  }
  // No thickness has no place on a logarithmic axis; it stands left of all others.
  Chambers sheet;
  sheet.thickness_m = 0;
  sheet.to_world = rotation(30);
  add_leaks(make_sheet_chambers(sheet), sheet, params, 1e-5, ", two-sided sheet", points);
  return points;
}

std::vector<StabilityPoint> wall_angle(const StabilityParams& params) {
  std::vector<StabilityPoint> points;
  for (const float angle : {0.0F, 1.0F, 5.0F, 15.0F, 30.0F, 45.0F}) {
    Chambers chambers;
    chambers.thickness_m = 0.01F;
    chambers.to_world = rotation(angle);
    add_leaks(make_chambers(chambers), chambers, params, double(angle), "", points);
  }
  return points;
}

// The wall's lit face swept through a layer of vertices: 0 is exactly on it. The dark face, 1/16 voxel behind it, is so
// at -1/16.
std::vector<StabilityPoint> vertex_on_wall(const StabilityParams& params) {
  std::vector<StabilityPoint> points;
  for (const float offset :
       {-0.5F, -0.25F, -1.0F / 16, -0.01F, -1e-4F, -1e-6F, 0.0F, 1e-6F, 1e-4F, 0.01F, 0.25F, 0.5F}) {
    Chambers chambers;
    chambers.thickness_m = 1.0F / 128;
    constexpr float spacing = 2.0F / 16;
    // Vertices stand at odd multiples of half a voxel, all of these exact in binary.
    constexpr float vertex = spacing / 2;
    chambers.wall_x_m = vertex + offset * spacing + chambers.thickness_m / 2;
    const LitScene world = make_lit_scene(make_chambers(chambers));
    GridBakeParams bake = bake_params(params, Guard::rays);
    bake.voxel_size_m = std::nullopt;
    bake.resolution = V3i(16, 16, 16);
    const IrradianceGrid guarded = bake_all_light(world, bake);
    bake.guard = Guard::off;
    const IrradianceGrid open = bake_all_light(world, bake);
    const auto lit = lit_wall_points(chambers, lattice);
    const auto dark = dark_wall_points(chambers, lattice);
    const auto x = double(offset);
    points.push_back({"no guard, dark side", x, mean_share(world, open, Guard::off, dark), {}});
    points.push_back({"no guard, lit side", x, std::abs(mean_share(world, open, Guard::off, lit) - 1), {}});
    for (const Guard guard : {Guard::planes, Guard::rays}) {
      const std::string series(name_of(guard));
      points.push_back({series + ", dark side", x, mean_share(world, guarded, guard, dark),
                        guard == Guard::rays ? 1e-4 : planes_leak});
      points.push_back({series + ", lit side", x, std::abs(mean_share(world, guarded, guard, lit) - 1), 0.02});
    }
  }
  return points;
}

// A closed room in thick walls whose inside is a furnace (E = 2 pi, as in make_chambers()); nothing shines outside.
constexpr float wall_m = 0.05F;
Scene make_house(const M44f& to_world) {
  Scene scene;
  scene.name = "house";
  const int lit = add_lambert(scene, Rgb(0.5F, 0.5F, 0.5F), Rgb(1, 1, 1));
  const int dark = add_lambert(scene, Rgb(0.5F, 0.5F, 0.5F));
  constexpr float out = 1 + wall_m;
  Mesh shell = make_room(V3f(-out, -out, -out), V3f(out, out, out), dark);
  for (auto& triangle : shell.triangles) std::swap(triangle.y, triangle.z);  // fronts outward
  add_mesh(scene, make_room(V3f(-1, -1, -1), V3f(1, 1, 1), lit), to_world);
  add_mesh(scene, std::move(shell), to_world);
  return scene;
}

// A lattice on all faces of the cube of that half side, its normals outward (1) or inward (-1).
std::vector<ProbePoint> cube_points(const M44f& to_world, float half_m, float side) {
  std::vector<ProbePoint> points;
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2;
    V3f outward(0, 0, 0);
    outward[axis] = face % 2 == 0 ? -1.0F : 1.0F;
    V3f n;
    to_world.multDirMatrix(outward * side, n);
    for (int i = 0; i < lattice; ++i) {
      for (int j = 0; j < lattice; ++j) {
        V3f p = outward * half_m;
        p[(axis + 1) % 3] = 0.98F * half_m * (2 * (float(i) + 0.437F) / lattice - 1);
        p[(axis + 2) % 3] = 0.98F * half_m * (2 * (float(j) + 0.561F) / lattice - 1);
        points.push_back({p * to_world, n.normalized()});
      }
    }
  }
  return points;
}

// Coarse grids have no vertex outside of the house: no vertex sees its outer faces.
std::vector<StabilityPoint> outer_walls(const StabilityParams& params) {
  std::vector<StabilityPoint> points;
  for (const bool turned : {false, true}) {
    const M44f to_world = turned ? rotation(30) : M44f();
    const std::string of = turned ? ", turned" : "";
    const LitScene world = make_lit_scene(make_house(to_world));
    const auto outside = cube_points(to_world, 1 + wall_m, 1);
    const auto inside = cube_points(to_world, 1, -1);
    for (const int vertices : {2, 3, 4, 6, 8, 12, 16}) {
      if (params.quick && vertices != 2 && vertices != 4 && vertices != 8) continue;
      GridBakeParams bake = bake_params(params, Guard::rays);
      bake.photons /= 3;
      bake.voxel_size_m = 2 * (1 + wall_m) / float(vertices);
      const IrradianceGrid guarded = bake_all_light(world, bake);
      bake.guard = Guard::off;
      const auto x = double(vertices);
      const IrradianceGrid open = bake_all_light(world, bake);
      points.push_back({"no guard" + of, x, mean_share(world, open, Guard::off, outside), {}});
      for (const Guard guard : {Guard::planes, Guard::rays}) {
        const std::string series = std::string(name_of(guard)) + of;
        points.push_back(
            {series, x, mean_share(world, guarded, guard, outside), guard == Guard::rays ? 1e-4 : planes_leak});
        // Light is uniform inside: what is missing there is missing in seams. Where two vertices a side stand aslant,
        // planes draw some, of 5 % in all.
        points.push_back({series + ", inside", x, std::abs(mean_share(world, guarded, guard, inside) - 1),
                          guard == Guard::rays ? 0.02 : 0.06});
      }
    }
  }
  return points;
}

}  // namespace

std::vector<StabilityCase> stability_wall_cases() {
  return {
      {.name = "wall_thickness",
       .title = "Light through walls thinner than a voxel",
       .sentence = "Without a guard a third of the light passes a wall thinner than a voxel, however thin it is: keep "
                   "--guard rays, or planes where the scene is not at hand.",
       .x_label = "thickness of the wall, m (voxel 0.14 m, turned by 30 degrees; a sheet without any at 1e-5)",
       .y_label = "E behind the wall / E before it",
       .log_x = true,
       .run = wall_thickness},
      {.name = "wall_angle",
       .title = "Light through a thin wall at an angle to the grid",
       .sentence = "Turning a 1 cm wall against the grid does not help without a guard; with rays nothing leaks at any "
                   "angle.",
       .x_label = "angle between wall and grid, degrees",
       .y_label = "E behind the wall / E before it",
       .run = wall_angle},
      {.name = "vertex_on_wall",
       .title = "Vertices exactly on a wall",
       .sentence = "A layer of vertices in the plane of a wall belongs to neither side and must be read by neither: "
                   "guards leave it out; without a guard both sides are wrong wherever the wall stands.",
       .x_label = "distance of the wall's lit face from a layer of vertices, voxels",
       .y_label = "|error of E| / E before the wall",
       .run = vertex_on_wall},
      {.name = "outer_walls",
       .title = "The outside of a lit house on a coarse grid",
       .sentence = "No vertex of a coarse grid stands outside of the house; with a guard its outer faces are dark, "
                   "without one they read the light inside.",
       .x_label = "voxels along a side of the house",
       .y_label = "E on the outer faces / E inside; inside: |error of E| / E",
       .log_x = true,
       .run = outer_walls},
  };
}

}  // namespace ivory
