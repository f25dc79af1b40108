// Where the tests find what they run and write. Constants of one small file, not macros of every one: compiled tests
// are then the same wherever the folder lies.
#pragma once

namespace ivory {

extern const char* const ivory_binary;   // the program
extern const char* const source_folder;  // the repository
extern const char* const build_folder;   // of CMake
extern const char* const embree_isa;     // tests/support/embree_isa.cpp as a library
extern const char* const output_folder;  // for what tests write; may not exist yet

}  // namespace ivory
