// Boxes on the command line: "X0,Y0,Z0:X1,Y1,Z1", any two opposite corners, in metres of the world.
#pragma once

#include <string>
#include <string_view>

#include <ImathBox.h>

namespace ivory {

// `form` shows the user what the option takes. Throws UsageError naming `option` for anything else.
Imath::Box3d parse_box(std::string_view option, std::string_view text, std::string_view form);

// The same, of some extent along each axis and less than a million kilometres: what a grid covers.
Imath::Box3d parse_bounds(std::string_view option, std::string_view text);

}  // namespace ivory
