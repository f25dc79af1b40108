// The GLSL of the folder shaders/, embedded in the library.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace ivory {

// GLSL 3.30 core of shaders/`name`, such as "ambient/grid.glsl". Every line #include "folder/file.glsl" is replaced by
// that file, each file once; #if is not looked at, so that no #include should stand within one. Has no #version line:
// put it after your own. Throws Error for a name that is not there.
std::string shader_source(std::string_view name);

// `text` with its #include lines resolved likewise: a shader of your own that uses ivory's. Lines of `text` keep their
// numbers in the compiler's messages (as string 0). Throws Error as shader_source() does.
//
// What stands between lines "#ivory_slot NUMBER" and "#ivory_end_slot" may stand several times in one shader, in slots
// of other numbers: it is resolved by itself, and each of its names that begins with ivory_, IVORY_ or Ivory gets the
// slot's number (slot_name()), macros too. Files of renderer/ and base/ that were included before the slot are shared
// by all, under their own names. Slots nest. Throws Error for a slot that does not end.
std::string with_includes(std::string_view text);

// What a slot calls a name: ivory_grid is ivory_s2_grid in slot 2, IvoryGrid is Ivorys2_Grid. Names that begin
// otherwise stay as they are.
std::string slot_name(int slot, std::string_view name);

// The names of all files, in alphabetical order.
std::vector<std::string> shader_names();

}  // namespace ivory
