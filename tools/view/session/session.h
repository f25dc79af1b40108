// One run of the viewer: the world, the assets that light it, and the user's choices; with or without a window. All
// functions need a current OpenGL context.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "runtime/assets/fiv.h"
#include "tools/cli/common.h"
#include "tools/input/environment.h"
#include "tools/input/scene.h"
#include "tools/view/session/animation.h"
#include "tools/view/session/assets.h"
#include "tools/view/session/lamps.h"
#include "tools/view/session/settings.h"
#include "tools/view/world/extended_lights.h"
#include "tools/view/world/world.h"
#include "tracer/core/film.h"

namespace ivory {

// A picture to compare with.
struct ReferencePicture {
  std::string path;
  Film film;
  bool is_display = false;  // holds display values (PNG, JPEG), not linear light
  gl::Texture texture;
};

struct ViewSession {
  ViewWorld world;
  std::vector<ViewLamp> lamps;           // of the scene's punctual lights, what the user changed
  std::vector<RuntimeLight> direct;      // of the scene, without extent; max_lights at most: session/lamps.h
  std::vector<ExtendedLights> extended;  // with extent, of the scene and its objects; none that give no light
  int lights_version = 0;                // another one for other lights
  ViewAssets assets;
  std::optional<GpuFivTables> fiv_tables;  // all of the assets'
  ViewSettings settings;
  GroupFactors factors;                   // of the grids' groups of lights: session/groups.h
  const ViewAsset* debug_grid = nullptr;  // that debug views show
  std::optional<ReferencePicture> reference;
  SceneOptions load;     // of the scene, and of objects that join it
  Metadata scene_facts;  // what assets know the scene by: SceneInput::origin
  std::vector<std::pair<const ViewAsset*, Placement>>
      lobes_placed;              // lobe tables and sphere sets, where they were last
  std::string environment;       // name without folders; empty: none
  std::string environment_hash;  // of its file
  Metadata environment_facts;    // what assets know it by: EnvironmentInput::origin
  std::optional<gl::Texture> sky;
  std::shared_ptr<const EnvironmentMap> environment_map;  // as its file has it; null: none
  double environment_turn_deg = 0;                        // about +Y, of all that comes from it
  bool told_of_old_sky = false;                           // that grids and cube maps do not turn
  bool told_of_old_lamps = false;                         // that grids keep their light
  std::unique_ptr<SceneAnimation> animation;              // of the scene; null: none, or it is not to play
  std::vector<std::string> notes;                         // one line each, for the user: what was left out or chosen

  std::size_t bytes() const;  // on the GPU
};

struct SessionInput {
  std::string scene;
  SceneOptions load;
  EnvironmentChoice environment;
  std::string camera;                  // name or index; empty: as ivory render chooses
  Imath::V2i size{640, 480};           // of the picture
  std::vector<std::string> objects;    // FILE@PLACE or NODE
  std::vector<std::string> places;     // OBJECT=PLACE
  std::vector<std::string> paths;      // of the objects, in that order
  std::vector<std::string> lamps;      // NAME=SCALE[,R,G,B[,X,Y,Z]]
  bool plays = false;                  // is there to be an animation that plays?
  bool may_play = false;               // or may there be one?
  std::vector<std::string> assets;     // files of any kind
  std::vector<std::string> occluders;  // NODE=TABLE.exr: objects and the tables they were baked into
  std::vector<std::string> spheres;    // sphere sets: FILE.json or FILE.json@X,Y,Z
  std::vector<SphereLightOption> sphere_lights;
  GroupFactors factors;
};

// Loads all. Throws UsageError for texts that say nothing, Error for files that cannot be read or drawn.
ViewSession open_session(const SessionInput& input);

// One more file, given or dropped: a model becomes an object, moved to `at` where that is given; an asset is offered;
// an image of twice its height's width becomes the environment, another, if of `size`, the reference. Throws Error and
// leaves the session as it was. Returns what it was taken for, for the user.
std::string add_file(ViewSession& session, const std::string& path, const std::optional<V3f>& at,
                     const Imath::V2i& size);

// To be called when objects, their poses or the environment are others.
void find_extended_lights(ViewSession& session);

// From where the scene's camera stands now, as at the start.
void look_as_at_first(ViewSession& session, const SessionInput& input);

// The picture to compare with. Throws Error where it cannot be read or is not of the size.
void set_reference(ViewSession& session, const std::string& path, const Imath::V2i& size);

// Takes an object out; nothing for the scene itself, which is object 0.
void remove_object(ViewSession& session, std::size_t object);

}  // namespace ivory
