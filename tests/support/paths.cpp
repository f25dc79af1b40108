#include "tests/support/paths.h"

namespace ivory {

const char* const ivory_binary = IVORY_BUILD_DIR "/ivory";
const char* const source_folder = IVORY_SOURCE_DIR;
const char* const build_folder = IVORY_BUILD_DIR;
const char* const embree_isa = IVORY_BUILD_DIR "/tests/libembree_isa.so";
const char* const output_folder = IVORY_BUILD_DIR "/tests/data";

}  // namespace ivory
