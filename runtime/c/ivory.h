/* ivory's runtime for C, and for whatever calls C: baked assets as light that a fragment shader of yours reads.
 *
 * Load an asset, or add several up; put ivory_shader(light) into your fragment shader, which then has
 *
 *   vec3 ivory_ambient(vec3 p, vec3 ng, vec3 n)
 *       irradiance E in lux at world position p (m) for the unit shading normal n; ng is the unit geometric normal
 *
 * and call ivory_bind() before you draw. runtime/example/ball_in_room.c is a whole program.
 *
 * What loads, binds, places and frees needs a current OpenGL 3.3 core context, the same one for all that belongs
 * together. Nothing is thrown. Where a call fails it returns NULL or -1, and ivory_error() says why. */
#ifndef IVORY_H
#define IVORY_H

#ifdef __cplusplus
extern "C" {
#endif

/* NOLINTBEGIN(modernize-use-using): this is C. */
typedef struct ivory_light ivory_light;

/* One line, "<file>: <cause>; <remedy>", about the last call of this thread that failed; "" where none has. Stays valid
 * until another call of this thread fails. */
const char* ivory_error(void);

/* Reads a file that `ivory bake` wrote, and uploads it. */
ivory_light* ivory_load_grid(const char* path);    /* bake grid */
ivory_light* ivory_load_sh9(const char* path);     /* bake sh9 */
ivory_light* ivory_load_difmap(const char* path);  /* bake difmap */
ivory_light* ivory_load_cubemap(const char* path); /* bake cubemap */

/* The light of an environment, which must be an SH9 or DifMap, less what moving occluders hide of it: tables of
 * `bake fiv`, one for each kind of occluder. None stands anywhere until ivory_set_occluders(). */
ivory_light* ivory_load_fiv(const char* const* paths, int count, const ivory_light* environment);

/* The direct light of spheres with soft shadows: the table of `bake lobes`. No light until ivory_set_spheres(). */
ivory_light* ivory_load_lobes(const char* path);

/* The sum of `count` lights, of any kinds and several of one kind, light i times weights[i] per channel; weights may be
 * NULL for ones. What it is made of may be freed before it. */
ivory_light* ivory_sum(const ivory_light* const* lights, const float (*weights)[3], int count);

/* Frees the light and the OpenGL objects that no sum holds; NULL is ignored. */
void ivory_free(ivory_light* light);

/* GLSL 3.30 without a #version line, all includes resolved, that declares what the light needs and defines
 * ivory_ambient(). Two lights whose text is the same can share a program. Belongs to the light. */
const char* ivory_shader(const ivory_light* light);

/* Makes `program`, linked with ivory_shader(light), current, sets the light's uniforms, and binds its textures from
 * unit `first_unit` on and its uniform buffers. Returns the next free unit. Grids and cube maps of scenes far from the
 * origin want positions less ivory_anchor(). */
int ivory_bind(const ivory_light* light, unsigned program, int first_unit);

/* The box that a grid covers, in metres, as corners of least and greatest coordinates, less its anchor. -1 for all
 * other lights. Returns 0. */
int ivory_bounds(const ivory_light* light, float least_m[3], float greatest_m[3]);

/* What positions given to the shader must be less by: 0 0 0 but for grids and cube maps of scenes far from the origin.
 * -1 for a sum of lights whose anchors differ. Returns 0. */
int ivory_anchor(const ivory_light* light, double anchor_m[3]);

typedef struct ivory_occluder {
  int table;         /* index into the paths of ivory_load_fiv() */
  float center_m[3]; /* of its bounding sphere, in the world */
  float radius_m;
  float turn_deg; /* about +Y, counter-clockwise seen from above; other than the environment's for a table of
                   * `bake fiv --turns` alone */
} ivory_occluder;

/* Replaces all occluders; cheap enough for every frame. Returns 0. */
int ivory_set_occluders(ivory_light* fiv, const ivory_occluder* occluders, int count);

/* Turns an environment about +Y, against how it was baked: an SH9, a DifMap, or FIV tables and with them the
 * environment that they were loaded with. Cheap enough for every frame. Returns 0. */
int ivory_turn_environment(ivory_light* light, float turn_deg);

typedef struct ivory_sphere {
  float center_m[3]; /* in the world */
  float radius_m;
} ivory_sphere;

typedef struct ivory_sphere_light {
  ivory_sphere sphere;
  float radiance_nits[3];
} ivory_sphere_light;

/* Replaces all lights, and the spheres that cast shadows, which must not be those of the lights. Cheap enough for every
 * frame. Returns 0. */
int ivory_set_spheres(ivory_light* lobes, const ivory_sphere_light* lights, int light_count,
                      const ivory_sphere* occluders, int occluder_count);

/* NOLINTEND(modernize-use-using) */

#ifdef __cplusplus
}
#endif

#endif
