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
std::string with_includes(std::string_view text);

// The names of all files, in alphabetical order.
std::vector<std::string> shader_names();

}  // namespace ivory
