// Is a model that is taken for metres one in centimetres or millimetres? glTF says metres; exporters forget.
#pragma once

#include <optional>
#include <string>

#include "tracer/gltf/loader.h"

namespace ivory {

// What to tell the user of a scene that was loaded at scale 1; nothing where it may well be metres. Long extents alone
// say nothing, for land is as long as a flat in millimetres. So two clues are wanted, and both are said: cameras at the
// height of an eye in other units; near planes and reaches of lamps that no one chooses in metres; lamps so weak that
// they would light nothing, the only ones in the scene. Things with a name whose height is known (doors, chairs,
// people), and lamps brighter than searchlights, count for two; a named thing of the right height in metres counts
// against all.
std::optional<std::string> units_hint(const LoadedScene& loaded);

}  // namespace ivory
